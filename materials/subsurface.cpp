#include "materials/subsurface.h"

#include "materials/dielectric.h"
#include "materials/direction_pairs.h"
#include "materials/gloss.h"
#include "math/warp.h"

namespace abbe {
namespace {

// Light enters and leaves evenly in all directions, under a gloss that reflects its share from outside and lets
// everything out: energy is kept in both directions, reciprocity is not [Kulla2017].
class DiffuseBoundaryBsdf final : public Bsdf {
  public:
    explicit DiffuseBoundaryBsdf(const Gloss& gloss) : gloss_(gloss) {}

    Lobes lobes() const noexcept override {
        const Lobes through = Lobes(Lobe::diffuse) | Lobe::transmission;
        if (gloss_.absent()) return through;
        return through | Lobe::reflection | (gloss_.smooth() ? Lobe::delta : Lobe::glossy);
    }
    BsdfEval eval(Vec3 wo, Vec3 wi, Transport) const noexcept override {
        if (wo.z == 0 || wi.z == 0) return {};
        if (wo.z < 0) return wi.z > 0 ? through(wi, 1) : BsdfEval{};
        const float reflected = gloss_.albedo(wo.z);
        if (wi.z < 0) return through(wi, 1 - reflected);
        if (gloss_.smooth() || gloss_.absent()) return {};
        const Gloss::Value v = gloss_.eval(wo, wi);
        return {Spectrum(v.fcos), v.pdf * reflected};
    }
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport) const noexcept override {
        if (wo.z == 0) return std::nullopt;
        const float reflected = wo.z > 0 ? gloss_.albedo(wo.z) : 0;
        if (uLobe < reflected) return glossy(wo, u, reflected);
        Vec3 wi = squareToCosineHemisphere(u);
        const float pdf = cosineHemispherePdf(wi.z) * (1 - reflected);
        if (!(pdf > 0)) return std::nullopt;
        wi.z = std::copysign(wi.z, -wo.z);
        return std::optional<BsdfSample>(std::in_place, wi, Spectrum(1.f), pdf,
                                         Lobes(Lobe::diffuse) | Lobe::transmission);
    }
    DeltaEval evalDelta(Vec3 wo, Vec3 wi) const noexcept override {
        if (!(wo.z > 0) || !gloss_.smooth() || gloss_.absent() || !isMirrored(wo, wi)) return {};
        const float reflected = gloss_.albedo(wo.z);
        return {Spectrum(reflected), reflected};
    }

  private:
    static BsdfEval through(Vec3 wi, float share) {
        const float pdf = cosineHemispherePdf(std::abs(wi.z)) * share;
        return {Spectrum(pdf), pdf};
    }
    std::optional<BsdfSample> glossy(Vec3 wo, Vec2 u, float reflected) const {
        if (gloss_.smooth())
            return std::optional<BsdfSample>(std::in_place, Vec3{-wo.x, -wo.y, wo.z}, Spectrum(1.f), reflected,
                                             Lobes(Lobe::delta) | Lobe::reflection);
        const auto wi = gloss_.sample(wo, u);
        if (!wi) return std::nullopt;
        return std::optional<BsdfSample>(std::in_place, *wi, Spectrum(gloss_.weight(wo, *wi) / reflected),
                                         gloss_.eval(wo, *wi).pdf * reflected, Lobes(Lobe::glossy) | Lobe::reflection);
    }
    Gloss gloss_;
};

class DiffuseBoundary final : public Material {
  public:
    DiffuseBoundary(double ior, const schema::TexturedNumber& roughness, KeptTables* kept)
        : gloss_(ior, roughness, kept) {
        traits_ = {.usesTextures = gloss_.textured()};
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths&, Arena& arena) const noexcept override {
        return arena.make<DiffuseBoundaryBsdf>(gloss_.at(hit));
    }

  private:
    GlossRange gloss_;
};

} // namespace

schema::TypeInfo subsurfaceType() {
    using namespace schema;
    using P = SubsurfaceParams;
    return {.kind = Kind::material,
            .name = "subsurface",
            .doc = "Translucent solid: light wanders under the surface and comes out elsewhere. Skin, marble, wax.",
            .example = "material marble subsurface { reflectance 0.85; mean-free-path 3 mm; roughness 0.2 }",
            .fields = {
                field(FieldType::spectrum, "reflectance", &P::reflectance)
                    .role(SpectrumRole::albedo)
                    .range(0, 1)
                    .byDefault("0.8")
                    .synonyms({"color", "colour", "albedo", "subsurface_color", "base_color"})
                    .doc("Share of diffuse light that a thick piece sends back, without the gloss on top.")
                    .example("reflectance rgb 0.8 0.5 0.4"),
                field(FieldType::spectrum, "mean-free-path", &P::meanFreePath)
                    .role(SpectrumRole::unbounded)
                    .unit({Dimension::length})
                    .range(1e-9, 1e9)
                    .byDefault("1 mm")
                    .synonyms({"radius", "mfp", "subsurface_radius", "dmfp", "scattering_distance"})
                    .doc("Mean distance between two collisions, for each wavelength: how far light spreads.")
                    .example("mean-free-path rgb 0.48 0.17 0.08 mm"),
                field(FieldType::number, "anisotropy", &P::anisotropy)
                    .range(-0.99, 0.99)
                    .byDefault("0")
                    .synonyms({"g", "subsurface_anisotropy", "scatter_anisotropy"})
                    .doc("Mean cosine of a collision: 0 scatters evenly, towards 1 forward. The colour stays.")
                    .example("anisotropy 0.8"),
                field(FieldType::spectrum, "ior", &P::ior)
                    .role(SpectrumRole::index)
                    .range(0.2, 10)
                    .byDefault("1.4")
                    .synonyms({"eta", "int_ior", "index", "specular_ior"})
                    .doc("Refractive index of the inside; 1 has no gloss.")
                    .example("ior 1.4"),
                field(FieldType::number, "roughness", &P::roughness)
                    .unit({Dimension::none, Dimension::fraction})
                    .range(0, 1)
                    .byDefault("0.3")
                    .synonyms({"alpha", "specular_roughness"})
                    .doc("Roughness of the surface: 0 polished, 1 matte.")
                    .example("roughness 0.4"),
                field(FieldType::choice, "boundary", &P::boundary)
                    .choices({"dielectric", "diffuse"})
                    .byDefault("dielectric")
                    .synonyms({"interface", "method", "entry"})
                    .doc("`dielectric`: light refracts in and out, and is reflected inside. `diffuse`: it enters and "
                         "leaves evenly, so that `reflectance` is met exactly.")
                    .example("boundary diffuse"),
            }};
}

std::unique_ptr<const Material> makeSubsurfaceSurface(const SubsurfaceParams& params, KeptTables* kept) {
    if (params.boundary.word == "diffuse")
        return std::make_unique<DiffuseBoundary>(params.ior->at(587.6), params.roughness, kept);
    DielectricParams dielectric;
    dielectric.ior = params.ior;
    dielectric.roughness = params.roughness;
    return makeDielectric(dielectric);
}

std::optional<SubsurfaceInside> insideOf(const SubsurfaceParams& params) {
    return makeSubsurfaceInside(*params.reflectance, *params.meanFreePath, params.anisotropy);
}

} // namespace abbe
