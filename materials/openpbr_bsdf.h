// The OpenPBR surface as a mixture of lobes: fuzz over coat over a base of metal, glossy-diffuse and translucent parts
// [Andersson2024].
//
// Layers are put together by their albedos: what an upper layer does not reflect of the light from wo goes on to the
// lower one. That is not reciprocal but loses no light: white surfaces return all of it. Everything is analytic; the
// value and the density of a pair of directions have no noise.
#pragma once

#include "materials/eon_diffuse.h"
#include "materials/ggx_lobe.h"
#include "materials/openpbr_interface.h"
#include "materials/sheen.h"
#include "math/frame.h"
#include "render/bsdf.h"

#include <optional>

namespace abbe {

// The parameters at one point and the wavelengths of one path.
struct OpenPbrPoint {
    float metalness, transmission, subsurface; // shares, 0 … 1
    bool thinWalled;
    bool filled;      // with the medium of the subsurface part: light from within leaves whole and evenly
    float forward;    // share of subsurface light that goes through: scattered by a thin wall, into what is filled
    Spectrum base;    // colour of the diffuse base
    Spectrum under;   // colour of the subsurface part
    Spectrum tint;    // of the dielectric's reflection
    Spectrum through; // factor of the transmitted light; thin-walled: transmittance of the sheet at normal incidence
    Spectrum coatLog; // logarithm of the coat's transmittance at normal incidence, one way
    float diffuseRoughness, roughness;
    float coatDarkening; // 0 … 1
    float coatReturns;   // share of diffuse light from below that the coat's surface returns
    float fuzz;          // share covered, 0 … 1
    Spectrum fuzzColor;
    SheenLobe sheen;
    std::optional<Frame> coatFrame; // the coat's axes in those of the base, if they are its own
    OpenPbrCover cover;
    OpenPbrDielectric dielectric;
    OpenPbrMetal metal;
    GgxLobe specular, coat, sheet; // of the base, of the coat, of light through a thin-walled sheet
};

class OpenPbrBsdf final : public Bsdf {
  public:
    explicit OpenPbrBsdf(const OpenPbrPoint&);

    Lobes lobes() const noexcept override;
    BsdfEval eval(Vec3 wo, Vec3 wi, Transport) const noexcept override;
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport) const noexcept override;
    DeltaEval evalDelta(Vec3 wo, Vec3 wi) const noexcept override;
    ScatterOutline outline(Vec3 wo) const noexcept override;

  private:
    enum Choice { kFuzz, kCoat, kSpecular, kSheet, kDiffuse, kDiffuseThrough, kChoices };

    // All that depends on wo alone. Lobes live on wo's side turned to +z.
    struct View {
        Vec3 wo;             // wo.z > 0
        bool within;         // wo lies inside a translucent base
        Frame coatFrame;     // of the coat on this side
        Vec3 coatWo;         // wo in it, coatWo.z > 0
        float ground;        // share of the light that passes the fuzz
        Spectrum coatScale;  // factor of the coat's single scattering
        Spectrum covered;    // what the coat lets through, times its coverage
        Spectrum darkening;  // of opaque bases under the coat
        Spectrum pathOut;    // logarithm of the coat's transmittance along wo
        Spectrum scale;      // factor of the dielectric's single scattering, reflected
        Spectrum through;    // and refracted
        Spectrum metalScale; // of the metal's
        Spectrum below;      // share of the light that enters the dielectric base
        Spectrum sheet;      // of that, what leaves a thin-walled sheet on the other side
        float opaque, clear; // shares of the base
        float pick[kChoices];
    };
    struct LaneEval {
        Spectrum fcos, pdf;
    };

    // Kept for the next call: the path loop asks for a sample and for a value with the same wo, and an object belongs
    // to one vertex of one path.
    const View& view(Vec3 wo) const;
    View makeView(Vec3 wo) const;
    void viewCoat(View&) const;
    void viewDielectric(View&) const;
    void viewWithin(View&) const;
    template <typename F>
    Spectrum lobeMean(const GgxLobe&, Vec3 wo, Spectrum eta, const MetCosines::Kinks&, F&& f, bool varies,
                      float beyond) const;
    template <typename Covered, typename Bare>
    void setInterface(View&, Spectrum eta, Covered&& covered, Bare&& bare) const;
    void choose(View&) const;
    Spectrum opaqueAlbedo() const;
    struct Sheet {
        Spectrum reflected, through;
    };
    Sheet sheetFacet(Spectrum c) const;

    BsdfEval evalFrom(const View&, Vec3 wi, Transport) const;
    // Directions in the coat's axes, and cosines at which light goes through it.
    Vec3 inCoat(const View& v, Vec3 w) const { return point_.coatFrame ? v.coatFrame.toLocal(w) : w; }
    Vec3 outOfCoat(const View& v, Vec3 w) const { return point_.coatFrame ? v.coatFrame.toWorld(w) : w; }
    void turnCoat(View&, bool back) const;
    LaneEval coatReflection(const View&, Vec3 wi) const;
    LaneEval reflection(const View&, Vec3 wi) const;
    LaneEval sheetTransmission(const View&, Vec3 wi) const;
    LaneEval entering(const View&, Vec3 wi) const;
    BsdfEval leaving(Vec3 wi) const;
    LaneEval refraction(const View&, Vec3 wi, Transport) const;
    std::optional<Vec3> direction(const View&, Choice, float uLobe, Vec2 u) const;
    std::optional<Vec3> refracted(const View&, Vec3 m, float c) const;
    // Factor of light that leaves a translucent base through the coat at cosine cosI.
    Spectrum leavingCoat(float cosI) const;

    // Factor of opaque and of clear base lobes for light from wi, which passes the coat on its way in if `entering`.
    struct Passing {
        Spectrum opaque, clear;
    };
    Passing passing(const View&, float cosI, bool entering) const;
    // At a microfacet that light hits at cosine c: factor of the mirror's value, and the part that goes through.
    struct Facet {
        Spectrum opaque, clear, transmitted;
    };
    Facet facet(const View&, Spectrum c) const;
    std::optional<BsdfSample> sampleSmooth(const View&, Choice, float uLobe, Transport) const;
    // The delta lobes from v.wo: off the coat, straight through a sheet, off the base and, with its direction's cosine
    // below, into or out of the base.
    DeltaEval coatMirror(const View&) const;
    DeltaEval sheetPassage(const View&) const;
    DeltaEval baseMirror(const View&, const Facet&) const;
    DeltaEval basePassage(const View&, const Facet&, float cosI, Transport) const;
    // Probability of reflection against refraction there; 1 unless the base refracts.
    float reflectionShare(const Facet&) const;
    bool refracts() const { return point_.transmission > 0 && !point_.thinWalled && point_.metalness < 1; }

    OpenPbrPoint point_;
    Spectrum baseAlbedo_; // of the opaque base, at normal incidence
    float baseRoughness_; // how far the base scatters light into all directions
    bool smooth_;         // the specular lobe is a mirror
    bool disperses_;      // the base's index differs between the lanes
    bool coatAbsorbs_, sheetAbsorbs_;
    mutable Vec3 viewed_; // the direction of view_; 0: none yet
    mutable View view_;
};

} // namespace abbe
