// Bounds of an atmosphere hold at every distance that a tracker asks for, far from its origin too, where distances are
// coarse.
#include "media/atmosphere.h"
#include "media/phase_functions.h"
#include "spectrum/curve.h"
#include "support/statistics.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe::test {

TEST_CASE("atmosphere: density is within the bounds of its segment, at the segment's ends too") {
    int thick = 0;
    for (const double extinction : {100.0, 0.01, 1e-6}) {
        const SampledCurve curve([=](double) { return extinction; });
        MediumOptics optics;
        optics.extinction = &curve;
        optics.phase = std::make_shared<HenyeyGreenstein>(0.f);
        const Atmosphere fog(optics, {0, 1, 0}, 0, 0.9);
        WalkSpace space;
        int segments = 0;
        for (int i = 0; i < 2000; ++i) {
            const float slope = std::pow(10.f, -4.f * static_cast<float>(i) / 2000) * (i % 2 == 0 ? 1.f : -1.f);
            const Ray ray{{0, 1.7f + static_cast<float>(i % 7), 0}, {std::sqrt(1 - slope * slope), slope, 0}};
            MediumWalk* walk = fog.walk(ray, 1e5f, space);
            MediumSegment s;
            while (walk->next(s)) {
                ++segments;
                for (const float t : {s.tNear, s.tFar, std::nextafter(s.tFar, s.tNear), (s.tNear + s.tFar) / 2}) {
                    const float density = walk->density(t);
                    if (density > s.maximum || density < s.minimum)
                        FAIL(density, " at ", t, " is not within ", s.minimum, " and ", s.maximum);
                }
            }
        }
        if (extinction > 1) thick = segments;
        CHECK(segments > 2000);
        // In clear air few pieces do.
        if (extinction < 1e-5) CHECK(segments < thick / 4);
    }
}

// From a hundred thousand scale heights, e^-h is 0 and grows by a factor that is infinite.
TEST_CASE("atmosphere: mean densities are numbers however far above a thin layer a ray begins") {
    const SampledCurve curve([](double) { return 2e-5; });
    MediumOptics optics;
    optics.extinction = &curve;
    optics.phase = std::make_shared<HenyeyGreenstein>(0.f);
    const Atmosphere layer(optics, {0, 1, 0}, 0, 1e-5);
    WalkSpace space;
    int segments = 0, wrong = 0;
    for (int i = 0; i < 2000; ++i) {
        const float slope = -0.05f - 0.9f * static_cast<float>(i) / 2000;
        MediumWalk* walk = layer.walk({{0, 1, 4}, {0, slope, -std::sqrt(1 - slope * slope)}}, 1e3f, space);
        MediumSegment s;
        for (; walk->next(s); ++segments) wrong += !(s.mean >= s.minimum && s.mean <= s.maximum);
    }
    CHECK(segments > 2000);
    CHECK(wrong == 0);
}

} // namespace abbe::test
