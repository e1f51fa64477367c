// What tests at the edge of the ranges of directions and surfaces share.
#pragma once

#include "suite.h"

namespace abbe::test {

// Towards a direction with that cosine, in [0, 1], about z.
inline Vec3 withCosine(float c, float azimuth) {
    const float r = std::sqrt(1 - c * c);
    return {r * std::cos(azimuth), r * std::sin(azimuth), c};
}

// Surfaces of all kinds, at the ends of their ranges.
inline std::vector<BsdfUnderTest> extremeSuite() {
    static const CauchyCurve flint(1.6, 0.02);
    static const ConstantCurve matched(1.00001), nearly(1.0000001);
    std::vector<BsdfUnderTest> all = roughSuite();
    for (const float r : {0.f, 0.02f, 0.0225f}) {
        all.push_back(conductor(0, 3, r));
        all.push_back(conductor(0.2, 3, r, 1));
        all.push_back(dielectric(1.5, r));
        all.push_back(dispersiveGlass(flint, r, Wavelengths::sample(0.9f)));
    }
    for (const Curve* ior : {static_cast<const Curve*>(&matched), static_cast<const Curve*>(&nearly)})
        for (const float r : {0.f, 0.5f, 1.f}) all.push_back(dispersiveGlass(*ior, r, Wavelengths::single(500)));
    all.push_back(conductor(0, 3, 1, 1));
    return all;
}

} // namespace abbe::test
