// OpenPBR Surface 1.1: the exchange standard for everyday surfaces, with the parameter names of its specification.
#pragma once

#include "base/diagnostic.h"
#include "materials/interior_curves.h"
#include "render/material.h"
#include "schema/type.h"

#include <memory>
#include <optional>

namespace abbe {

// Defaults are the specification's; null colours stand for them too.
struct OpenPbrParams {
    using Color = schema::TexturedSpectrum;
    using Number = schema::TexturedNumber;

    Number baseWeight{1, nullptr, {}};
    Color baseColor; // null: 0.8
    Number baseDiffuseRoughness{0, nullptr, {}};
    Number baseMetalness{0, nullptr, {}};
    schema::ComplexIndex baseMetalIndex; // measured metal; instead of the colours

    Number specularWeight{1, nullptr, {}};
    Color specularColor; // null: 1
    Number specularRoughness{0.3, nullptr, {}};
    Number specularRoughnessAnisotropy{0, nullptr, {}};
    const Curve* specularIor = nullptr; // null: 1.5

    Number transmissionWeight{0, nullptr, {}};
    Color transmissionColor;                    // null: 1
    double transmissionDepth = 0;               // m
    const Curve* transmissionScatter = nullptr; // null: 0
    double transmissionScatterAnisotropy = 0;
    double transmissionDispersionScale = 0;
    double transmissionDispersionAbbeNumber = 20;

    Number subsurfaceWeight{0, nullptr, {}};
    Color subsurfaceColor;                        // null: 0.8
    double subsurfaceRadius = 1e-3;               // m
    const Curve* subsurfaceRadiusScale = nullptr; // null: 1
    double subsurfaceScatterAnisotropy = 0;

    Number coatWeight{0, nullptr, {}};
    Color coatColor; // null: 1
    Number coatRoughness{0, nullptr, {}};
    Number coatRoughnessAnisotropy{0, nullptr, {}};
    Number coatIor{1.6, nullptr, {}};
    Number coatDarkening{1, nullptr, {}};
    // Turns from the texture's u to the direction that the base's highlight is stretched along. Or a texture of
    // directions, 0 … 1 for -1 … 1.
    Number geometryTangent{0, nullptr, {}};
    // How far the coat's normal follows that of the base: 1 wholly, 0 it is the shape's own. Or a normal map of its
    // own.
    Number geometryCoatNormal{1, nullptr, {}};
    Number geometryCoatTangent{0, nullptr, {}};

    Number fuzzWeight{0, nullptr, {}};
    Color fuzzColor; // null: 1
    Number fuzzRoughness{0.5, nullptr, {}};

    double emissionLuminance = 0; // cd/m²
    Color emissionColor;          // of Y = 1 where it is white, or a factor of D65; neither: D65

    Number thinFilmWeight{0, nullptr, {}};
    double thinFilmThickness = 0.5e-6; // m, where the map is 1
    Number thinFilmMap{1, nullptr, {}};
    Number thinFilmIor{1.4, nullptr, {}};

    bool geometryThinWalled = false;
};

// Whether a colour changes what it is a factor of.
inline bool tints(const OpenPbrParams::Color& c) {
    return c.texture || (c.curve && (c.curve->minimum() != 1 || c.curve->maximum() != 1));
}
// Whether the base is stretched along a direction of its own.
inline bool turnsTangent(const OpenPbrParams& p) {
    const bool turned = p.geometryTangent.texture || p.geometryTangent.value != 0;
    return turned && (p.specularRoughnessAnisotropy.texture || p.specularRoughnessAnisotropy.value > 0);
}

schema::TypeInfo openPbrType();
// Reports what no single property can say wrong; false if it did.
bool checkParams(const OpenPbrParams&, const schema::PlaceOf&, Diagnostics&);
// The surface alone; what fills solids is insideOf(). The curves and textures must outlive it.
std::unique_ptr<const Material> makeOpenPbr(const OpenPbrParams&);

// What fills solids with an OpenPBR surface: the medium of their subsurface part, or of scattering glass.

// Whether light goes in and out through the matte part of the surface of a solid.
bool hasSubsurfaceInside(const OpenPbrParams&);
// Whether light refracts into the solid.
bool mayRefract(const OpenPbrParams&);
// Whether its clear part leads into a medium that scatters, which then absorbs, too.
bool hasScatteringGlass(const OpenPbrParams&);

// The medium of either; nothing if there is none. The curves of the parameters must outlive it. Requires parameters
// that checkParams() has found right: there are never both.
std::optional<SubsurfaceInside> insideOf(const OpenPbrParams&);

} // namespace abbe
