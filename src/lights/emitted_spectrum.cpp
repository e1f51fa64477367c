#include "lights/emitted_spectrum.h"

#include "lights/amount.h"
#include "spectrum/curve.h"

#include <map>

namespace abbe {

std::vector<double> emittedSpectrum(std::span<const std::unique_ptr<Light>> lights) {
    std::map<const Curve*, double> watts; // many lights share few spectra
    for (const auto& light : lights) watts[light->powerShape()] += light->power();
    // In the order of the lights: that of addresses changes from run to run, and with it the rounding of the sum.
    std::vector<double> total(SampledCurve::kSize);
    const ConstantCurve even(1);
    for (const auto& light : lights) {
        const auto entry = watts.extract(light->powerShape());
        if (!entry || !(entry.mapped() > 0)) continue;
        const Curve& shape = entry.key() ? *entry.key() : even;
        const double integral = radiantIntegral(shape);
        if (!(integral > 0)) continue;
        for (std::size_t i = 0; i < total.size(); ++i)
            total[i] +=
                shape.at(static_cast<double>(kMinWavelength) + static_cast<double>(i)) * (entry.mapped() / integral);
    }
    return total;
}

} // namespace abbe
