// The 24 ColorChecker patches as a path would see them: eight hero wavelengths per sample, against direct integration.
#include "spectrum/color_space.h"
#include "spectrum/lab.h"
#include "spectrum/named_spectra.h"
#include "spectrum/observer.h"

#include <doctest/doctest.h>
#include <string>

using namespace abbe;

namespace {

Xyz heroEstimate(const Curve& patch, const Curve& light, int samples) {
    Xyz sum;
    for (int i = 0; i < samples; ++i) {
        const Wavelengths w = Wavelengths::sample((static_cast<float>(i) + 0.5f) / static_cast<float>(samples));
        sum += toXyz(patch.at(w) * light.at(w), w);
    }
    return sum * (1.0 / samples);
}

} // namespace

TEST_CASE("ColorChecker patches under D65, A and FL11 within CIEDE2000 0.1 of direct integration") {
    for (const char* lamp : {"D65", "A", "FL11"}) {
        const auto light = illuminantCurve(*findIlluminant(lamp));
        const Xyz white = integrate(*light);
        double worst = 0;
        for (int i = 1; i <= 24; ++i) {
            const auto patch = reflectanceCurve(*findMeasured("macbeth-" + std::to_string(i)));
            const Lab direct = toLab(integrate(*patch, *light), white);
            worst = std::max(worst, deltaE2000(direct, toLab(heroEstimate(*patch, *light, 4096), white)));
        }
        CAPTURE(lamp);
        CHECK(worst < 0.1);
        CHECK(worst < 0.01); // what is reached
    }
}

TEST_CASE("ColorChecker patches have their published sRGB colours") {
    // Rough check that the data sit under the right names: BabelColor's sRGB values, D50 data seen under D65 here.
    const auto light = illuminantCurve(*findIlluminant("D65"));
    const auto srgb = [&](const char* name) {
        const Vec3d c = toRgb(integrate(*reflectanceCurve(*findMeasured(name)), *light), rgb::rec709);
        return Vec3d(linearToSrgb(c.x), linearToSrgb(c.y), linearToSrgb(c.z)) * 255;
    };
    CHECK(length(srgb("dark-skin") - Vec3d(115, 82, 68)) < 12);
    CHECK(length(srgb("green") - Vec3d(70, 148, 73)) < 12);
    CHECK(length(srgb("red") - Vec3d(175, 54, 60)) < 12);
    CHECK(length(srgb("neutral-5") - Vec3d(122, 122, 121)) < 8);
}
