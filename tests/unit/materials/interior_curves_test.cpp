// The inversion from colours to single-scattering albedos.
#include "materials/interior_curves.h"
#include "spectrum/curve.h"

#include <doctest/doctest.h>

namespace abbe {

TEST_CASE("the inversion is van de Hulst's fit, backwards") {
    for (const double g : {0.0, 0.5, 0.9, -0.6})
        for (double color = 0; color <= 1; color += 0.05) {
            const double albedo = singleScatteringAlbedo(color, g);
            const double s = std::sqrt((1 - albedo) / (1 - g * albedo));
            CHECK((1 - s) * (1 - 0.139 * s) / (1 + 1.17 * s) == doctest::Approx(color).epsilon(1e-9));
            // As OpenPBR writes it, with its rounded constants.
            const double t = 4.09712 + 4.20863 * color - std::sqrt(9.59217 + 41.6808 * color + 17.7126 * color * color);
            CHECK(std::abs((1 - t * t) / (1 - g * t * t) - albedo) < 1e-4);
            CHECK(static_cast<double>(
                      singleScatteringAlbedo(Spectrum(static_cast<float>(color)), static_cast<float>(g))[3]) ==
                  doctest::Approx(albedo).epsilon(2e-6));
        }
    CHECK(singleScatteringAlbedo(0, 0.3) == 0);
    CHECK(singleScatteringAlbedo(1, 0.3) == 1);
    CHECK(1 - singleScatteringAlbedo(1 - 1e-9, 0) < 1e-12); // no digits are lost near white
}

TEST_CASE("the inside of a translucent solid") {
    const ConstantCurve color(0.8), path(0.002), nothing(0), white(1);
    const SubsurfaceInside inside = makeSubsurfaceInside(color, path, 0.4);
    CHECK(inside.extinction->at(550.0) == doctest::Approx(500));
    CHECK(inside.extinction->isConstant());
    CHECK(inside.albedo->at(550.0) == doctest::Approx(singleScatteringAlbedo(0.8, 0.4)));
    CHECK(inside.albedo->maximum() <= 1);
    CHECK(makeSubsurfaceInside(white, path, 0).albedo->at(550.0) == 1);
    // The eight wavelengths of a path see the same curves as a single one.
    const SampledCurve red([](double nm) { return nm < 600 ? 0.3 : 0.9; }), far([](double nm) { return 1e-5 * nm; });
    const Wavelengths lanes = Wavelengths::sample(0.3f);
    const SubsurfaceInside varied = makeSubsurfaceInside(red, far, 0.4, 0.5);
    for (int i = 0; i < kLanes; ++i) {
        const auto nm = static_cast<double>(lanes.nm[i]);
        CHECK(varied.extinction->at(nm) == doctest::Approx(2 / far.at(nm)).epsilon(1e-6));
        CHECK(varied.extinction->at(lanes)[i] == doctest::Approx(varied.extinction->at(nm)).epsilon(1e-4));
        CHECK(varied.albedo->at(lanes)[i] == doctest::Approx(varied.albedo->at(nm)).epsilon(1e-4));
        CHECK(varied.albedo->at(nm) == doctest::Approx(singleScatteringAlbedo(red.at(nm), 0.4)));
    }
    CHECK(std::isfinite(makeSubsurfaceInside(color, nothing, 0).extinction->at(550.0)));
}

} // namespace abbe
