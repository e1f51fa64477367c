#include "study/time_model.h"

#include "base/check.h"

namespace abbe {

std::optional<TimeModel> TimeModel::fit(std::span<const double> samples, std::span<const double> seconds) {
    ABBE_CHECK(samples.size() == seconds.size());
    if (samples.size() < 2) return std::nullopt;
    double w = 0, x = 0, y = 0, xx = 0, xy = 0; // sums with the weights 1/seconds²
    for (std::size_t i = 0; i < samples.size(); ++i) {
        if (!(seconds[i] > 0)) return std::nullopt;
        const double weight = 1 / (seconds[i] * seconds[i]);
        w += weight;
        x += weight * samples[i];
        y += weight * seconds[i];
        xx += weight * samples[i] * samples[i];
        xy += weight * samples[i] * seconds[i];
    }
    const double determinant = w * xx - x * x;
    if (!(determinant > 1e-12 * w * xx)) return std::nullopt;
    TimeModel model{(xx * y - x * xy) / determinant, (w * xy - x * y) / determinant};
    if (model.fixed < 0) model = {0, xy / xx};
    if (!(model.perSample > 0)) return std::nullopt;
    return model;
}

} // namespace abbe
