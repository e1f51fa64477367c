// What fills a shape, as the inside of OpenPBR: extinction -ln(color) / depth, scattering scatter / depth
// [Andersson2024].
#include "exchange/usd_export/usd_look.h"
#include "spectrum/curve.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

// Per metre, of one wavelength.
struct InsideCoefficients {
    const StatedCurve *first = nullptr, *second = nullptr; // scattering and absorption, or extinction and albedo
    bool sums = false;                                     // the former
    double plainFirst = 0, plainSecond = 0;                // where they are no curves
    const StatedCurve* alsoAbsorbed = nullptr;             // by the surface's own glass

    bool isGrey() const {
        return (!first || first->isConstant()) && (!second || second->isConstant()) && !alsoAbsorbed;
    }
    double scattering(double nm) const {
        const double a = first ? first->at(nm) : plainFirst, b = second ? second->at(nm) : plainSecond;
        return sums ? a : a * b;
    }
    double extinction(double nm) const {
        const double a = first ? first->at(nm) : plainFirst, b = second ? second->at(nm) : plainSecond;
        return (sums ? a + b : a) + (alsoAbsorbed ? alsoAbsorbed->at(nm) : 0);
    }
};

InsideCoefficients insideOf(const StatedThing& m) {
    InsideCoefficients inside;
    inside.sums = m.has("scattering") || m.has("absorption");
    const char *const first = inside.sums ? "scattering" : "extinction", *const second =
                                                                             inside.sums ? "absorption" : "albedo";
    inside.first = m.spectrum(first).curve;
    inside.second = m.spectrum(second).curve;
    inside.plainFirst = m.number(first, inside.sums ? 0 : 1);
    inside.plainSecond = m.number(second, inside.sums ? 0 : 1);
    return inside;
}

// One that varies is a colour of three numbers there.
Vec3d insideColor(const UsdLook& look, const InsideCoefficients& inside, const std::function<double(double)>& of) {
    if (inside.isGrey()) return {of(550), of(550), of(550)};
    const Vec3d rgb = look.reflected(of);
    return {std::min(1.0, rgb.x), std::min(1.0, rgb.y), std::min(1.0, rgb.z)};
}

// The surface of a solid that can be filled; false for others.
bool writeClear(UsdLook& look, const StatedThing* material, InsideCoefficients& inside) {
    if (!material) return false;
    if (material->type == "openpbr") {
        for (const char* own : {"transmission-color", "transmission-depth", "transmission-scatter"})
            if (material->has(own)) return false;
        if (!material->has("transmission-weight") || material->word("geometry-thin-walled") == "on") return false;
        usdWriteSurface(look, *material);
        return true;
    }
    if (material->type != "boundary" && material->type != "dielectric") return false;
    look.constant("transmission_weight", 1);
    if (material->type == "boundary") {
        look.constant("specular_ior", 1);
        look.constant("specular_roughness", 0);
        return true;
    }
    look.index("specular_ior", *material, "ior");
    look.number("specular_roughness", material->textured("roughness", 0));
    const StatedCurve* const absorbed = material->spectrum("absorption").curve;
    if (absorbed && absorbed->maximum() > 0) inside.alsoAbsorbed = absorbed;
    if (material->spectrum("attenuation-color").curve)
        look.w.out.leftOut(material->span, "`attenuation-color` besides an `interior`", "the medium alone is inside");
    Export::ignore(*material, {"attenuation-distance"});
    return true;
}

} // namespace

double usdAnisotropy(const StatedThing& medium, UsdWriter& w) {
    const StatedThing* const phase = medium.reference("phase");
    if (!phase || phase->type == "isotropic") return 0;
    if (phase->type == "henyey-greenstein") return phase->number("g", phase->number("anisotropy", 0));
    w.out.approximated(phase->span, fmt::format("phase function `{}`", phase->type), "it scatters evenly");
    return 0;
}

bool usdCanFill(const StatedThing& medium) { return medium.type == "homogeneous"; }

void usdFill(UsdLook& look, const StatedThing* material, const StatedThing& medium) {
    InsideCoefficients inside = insideOf(medium);
    if (!usdCanFill(medium) || !writeClear(look, material, inside)) {
        look.w.out.leftOut(medium.span, "an `interior`", "OpenPBR fills clear solids, evenly and with one inside each");
        if (material) usdWriteSurface(look, *material);
        for (const auto& unused : medium.takeUnused()) medium.has(unused.property);
        return;
    }
    double most = 0;
    for (double nm = 360; nm <= 830; nm += 5) most = std::max(most, inside.extinction(nm));
    const double depth = most > 0 ? rounded(1 / most) : 1; // so scattering times it is at most 1
    look.constant("transmission_color",
                  insideColor(look, inside, [&](double nm) { return std::exp(-inside.extinction(nm) * depth); }));
    look.constant("transmission_depth", depth);
    look.constant("transmission_scatter",
                  insideColor(look, inside, [&](double nm) { return inside.scattering(nm) * depth; }));
    look.constant("transmission_scatter_anisotropy", usdAnisotropy(medium, look.w));
    if (!inside.isGrey())
        look.w.out.approximated(medium.span, "a medium that varies with the wavelength", "by red, green and blue");
    look.w.out.leaveOutUnused(medium);
}

} // namespace abbe::exchange
