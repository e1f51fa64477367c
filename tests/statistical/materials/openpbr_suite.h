// OpenPBR surfaces for the tests: one lossless surface of each structure, and random ones from the whole parameter
// cube.
#pragma once

#include "materials/openpbr.h"
#include "suite.h"

#include <deque>

namespace abbe::test {

inline schema::TexturedNumber number(double value) { return {value, nullptr, {}}; }
inline schema::TexturedSpectrum color(const Curve& curve) { return {&curve, nullptr, {}}; }

inline const Curve& white() {
    static const ConstantCurve one(1);
    return one;
}

inline OpenPbrParams whiteOpenPbr() {
    OpenPbrParams p;
    p.baseColor = p.specularColor = p.transmissionColor = p.subsurfaceColor = p.coatColor = p.fuzzColor =
        color(white());
    return p;
}

// The width that cells of a χ² test must resolve is that of the narrowest lobe.
inline BsdfUnderTest openPbr(const OpenPbrParams& p, std::string name,
                             Wavelengths wavelengths = Wavelengths::single(550)) {
    const double r = std::max(0.05, p.specularRoughness.value), c = std::max(0.05, p.coatRoughness.value);
    const double width = p.coatWeight.value > 0 ? std::min(r, c) : r;
    const bool refracts = p.transmissionWeight.value > 0 && p.baseMetalness.value < 1;
    const double index = p.specularIor ? p.specularIor->at(550.0) : 1.5;
    return {std::move(name), makeOpenPbr(p), static_cast<float>(width * width),
            refracts && !p.geometryThinWalled ? static_cast<float>(index) : 0, wavelengths};
}

// A surface out of the cube whose parts lose nothing: white, or metal that reflects all, whatever the weights.
struct RandomOpenPbr {
    explicit RandomOpenPbr(std::uint64_t seed) : random(seed) {}

    // `opaque`: without transmission. Curves live as long as this.
    OpenPbrParams operator()(bool opaque, bool smooth, bool stretched) {
        OpenPbrParams p = whiteOpenPbr();
        const auto weight = [&] { // often at an end, where surfaces usually are
            const double u = random.uniformDouble();
            return number(u < 0.4 ? 0 : u < 0.7 ? 1 : random.uniformDouble());
        };
        const auto roughness = [&] {
            return number(smooth && random.uniformDouble() < 0.4 ? 0 : 0.05 + 0.95 * random.uniformDouble());
        };
        p.baseDiffuseRoughness = number(random.uniformDouble());
        p.baseMetalness = weight();
        p.specularWeight = number(p.baseMetalness.value > 0 ? 1 : weight().value);
        p.specularRoughness = roughness();
        p.specularIor = &curves.emplace_back(1.05 + 1.5 * random.uniformDouble());
        p.transmissionWeight = opaque ? number(0) : weight();
        p.coatWeight = weight();
        p.coatRoughness = roughness();
        p.coatIor = number(1.1 + random.uniformDouble());
        p.coatDarkening = weight();
        p.fuzzWeight = weight();
        p.fuzzRoughness = number(random.uniformDouble());
        p.thinFilmWeight = weight();
        p.thinFilmThickness = 1e-6 * random.uniformDouble();
        p.thinFilmIor = number(1.1 + random.uniformDouble());
        p.geometryThinWalled = random.uniformDouble() < 0.3;
        if (p.geometryThinWalled) {
            p.subsurfaceWeight = weight();
            p.subsurfaceScatterAnisotropy = 2 * random.uniformDouble() - 1;
        } else if (opaque) {
            p.subsurfaceWeight = weight();
        }
        if (stretched) {
            p.specularRoughnessAnisotropy = number(0.9 * random.uniformDouble());
            p.coatRoughnessAnisotropy = number(0.9 * random.uniformDouble());
        }
        return p;
    }

    Random random;
    std::deque<ConstantCurve> curves;
};

inline std::string describe(const OpenPbrParams& p) {
    return fmt::format(
        "metal {:.3g} rough {:.3g}/{:.3g} ior {:.3g} weight {:.3g} trans {:.3g} sub {:.3g} coat {:.3g} "
        "rough {:.3g}/{:.3g} ior {:.3g} dark {:.3g} fuzz {:.3g}/{:.3g} film {:.3g} {:.4g}nm {:.3g} thin {}",
        p.baseMetalness.value, p.specularRoughness.value, p.specularRoughnessAnisotropy.value,
        p.specularIor ? p.specularIor->at(550.0) : 1.5, p.specularWeight.value, p.transmissionWeight.value,
        p.subsurfaceWeight.value, p.coatWeight.value, p.coatRoughness.value, p.coatRoughnessAnisotropy.value,
        p.coatIor.value, p.coatDarkening.value, p.fuzzWeight.value, p.fuzzRoughness.value, p.thinFilmWeight.value,
        p.thinFilmThickness * 1e9, p.thinFilmIor.value, p.geometryThinWalled);
}

} // namespace abbe::test
