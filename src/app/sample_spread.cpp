#include "app/sample_spread.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

std::string SampleSpread::text() const { return fmt::format("from {} to {}, {:.3g} on average", least, most, mean); }

SampleSpread sampleSpread(const PixelFilm& film) {
    const PixelBounds b = film.bounds();
    SampleSpread spread{film.samples(b.x0, b.y0), 0, 0};
    std::uint64_t all = 0;
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x) {
            const std::uint64_t n = film.samples(x, y);
            spread.least = std::min(spread.least, n);
            spread.most = std::max(spread.most, n);
            all += n;
        }
    spread.mean = static_cast<double>(all) / static_cast<double>(b.area());
    return spread;
}

} // namespace abbe
