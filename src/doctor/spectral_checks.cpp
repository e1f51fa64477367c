#include "doctor/numeric_check.h"
#include "spectrum/curve.h"
#include "spectrum/named_spectra.h"
#include "spectrum/rgb_upsampling.h"
#include "spectrum/sensor.h"

namespace abbe::doctor {

double rgbRoundTripError() {
    const auto light = illuminantCurve(*findIlluminant("D65"));
    double worst = 0;
    for (int i = 0; i < 27; ++i) {
        const Vec3d wanted(i % 3 / 2.0, i / 3 % 3 / 2.0, i / 9 / 2.0);
        const UpsampledCurve fitted = reflectanceFromRgb(wanted, rgb::rec709);
        const Vec3d got = toRgb(integrate(*fitted.curve, *light), rgb::rec709);
        worst = std::max(worst, maxComponent(abs(got - wanted)));
        if (!(fitted.curve->minimum() >= 0 && fitted.curve->maximum() <= 1)) return 1;
    }
    return worst;
}

double lineLightColourError() {
    const auto illuminant = findIlluminant("FL11");
    std::vector<double> nm;
    for (std::size_t i = 0; i < illuminant->values.size(); ++i)
        nm.push_back(illuminant->firstNm + 5 * static_cast<double>(i));
    const SampledCurve points = SampledCurve::fromPoints(nm, illuminant->values);
    Xyz sum;
    for (int i = 380; i <= 780; ++i) {
        const Wavelengths w = Wavelengths::single(static_cast<float>(i));
        sum += Xyz{static_cast<double>(xbar(w)[0]), static_cast<double>(ybar(w)[0]), static_cast<double>(zbar(w)[0])} *
               points.at(static_cast<double>(i));
    }
    const Xyz table = integrate(*illuminantCurve(*illuminant));
    return std::max(std::abs(table.x / table.y * sum.y / sum.x - 1), std::abs(table.z / table.y * sum.y / sum.z - 1));
}

double equalEnergyError() {
    const Xyz exact = integrate(ConstantCurve(1));
    Xyz mean;
    constexpr int kPaths = 1 << 16;
    for (int i = 0; i < kPaths; ++i) {
        const Wavelengths w = Wavelengths::sample((static_cast<float>(i) + 0.5f) / kPaths);
        mean += toXyz(Spectrum(1.f), w) * (1.0 / kPaths);
    }
    return std::max({std::abs(mean.x - exact.x), std::abs(mean.y - 1), std::abs(mean.z - exact.z)});
}

} // namespace abbe::doctor
