// The scattering functions that the statistical tests run over: every material, every roughness of interest.
#pragma once

#include "bsdf_checks.h"
#include "materials/conductor.h"
#include "materials/dielectric.h"
#include "materials/diffuse.h"

#include <fmt/format.h>

namespace abbe::test {

inline constexpr float kRoughnesses[] = {0.1f, 0.3f, 0.6f, 1.f};

inline const Curve& flat(double value) {
    static const ConstantCurve values[] = {ConstantCurve(0),    ConstantCurve(0.2), ConstantCurve(3),
                                           ConstantCurve(1.33), ConstantCurve(1.5), ConstantCurve(2.4)};
    for (const ConstantCurve& c : values)
        if (c.at(0) == value) return c;
    ABBE_CHECK(!"a value of the table");
    return values[0];
}

inline BsdfUnderTest conductor(double n, double k, float roughness, float anisotropy = 0) {
    ConductorParams params;
    params.index = {&flat(n), &flat(k)};
    params.roughness.value = roughness;
    params.anisotropy.value = anisotropy;
    return {fmt::format("conductor n {} k {} roughness {} anisotropy {}", n, k, roughness, anisotropy),
            makeConductor(params), roughness * roughness};
}
inline BsdfUnderTest dielectric(double ior, float roughness) {
    DielectricParams params;
    params.ior = &flat(ior);
    params.roughness.value = roughness;
    return {fmt::format("dielectric ior {} roughness {}", ior, roughness), makeDielectric(params),
            roughness * roughness, static_cast<float>(ior)};
}

// Flint-like glass at the given wavelengths (lane 0 is the hero).
inline BsdfUnderTest dispersiveGlass(const Curve& ior, float roughness, Wavelengths wavelengths) {
    DielectricParams params;
    params.ior = &ior;
    params.roughness.value = roughness;
    return {fmt::format("dispersive glass roughness {}", roughness), makeDielectric(params), roughness * roughness,
            static_cast<float>(ior.at(static_cast<double>(wavelengths.nm[0]))), wavelengths};
}

// Everything with a density: no delta lobes.
inline std::vector<BsdfUnderTest> roughSuite() {
    static const CauchyCurve flint(1.6, 0.02);
    std::vector<BsdfUnderTest> suite;
    suite.emplace_back("diffuse", makeDiffuse({}), 1.f);
    for (const float r : kRoughnesses) {
        suite.push_back(conductor(0.2, 3, r));
        suite.push_back(conductor(0.2, 3, r, 0.7f));
        suite.push_back(dielectric(1.5, r));
        suite.push_back(dielectric(2.4, r));
        suite.push_back(dispersiveGlass(flint, r, Wavelengths::sample(0.3f)));
    }
    return suite;
}

} // namespace abbe::test
