#include "materials/diffuse.h"

#include "math/warp.h"
#include "render/surface_input.h"
#include "spectrum/curve.h"

namespace abbe {
namespace {

class DiffuseBsdf final : public Bsdf {
  public:
    explicit DiffuseBsdf(Spectrum reflectance) : reflectance_(reflectance) {}

    Lobes lobes() const noexcept override { return Lobes(Lobe::diffuse) | Lobe::reflection; }

    BsdfEval eval(Vec3 wo, Vec3 wi, Transport) const noexcept override {
        // The signs, not the product: it underflows at grazing angles.
        if (!(wo.z > 0 ? wi.z > 0 : wo.z < 0 && wi.z < 0)) return {};
        const float pdf = cosineHemispherePdf(std::abs(wi.z));
        return {reflectance_ * pdf, pdf};
    }

    std::optional<BsdfSample> sample(Vec3 wo, float, Vec2 u, Transport) const noexcept override {
        Vec3 wi = squareToCosineHemisphere(u);
        const float pdf = cosineHemispherePdf(wi.z);
        if (pdf == 0 || wo.z == 0) return std::nullopt;
        wi.z = std::copysign(wi.z, wo.z);
        return std::optional<BsdfSample>(std::in_place, wi, reflectance_, pdf, lobes());
    }

  private:
    Spectrum reflectance_;
};

class Diffuse final : public Material {
  public:
    explicit Diffuse(const DiffuseParams& params) : reflectance_(params.reflectance, 0.5f) {
        traits_ = {.choosesLobe = false, .isOpaque = true, .focuses = false, .usesTextures = reflectance_.textured()};
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& wavelengths, Arena& arena) const noexcept override {
        return arena.make<DiffuseBsdf>(reflectance_.at(hit, wavelengths));
    }

  private:
    SpectrumInput reflectance_;
};

} // namespace

schema::TypeInfo diffuseType() {
    using namespace schema;
    return {.kind = Kind::material,
            .name = "diffuse",
            .doc = "Ideal matte surface: reflects the same radiance in every direction, on both sides.",
            .example = "material wall diffuse { reflectance 0.8 }",
            .fields = {
                field(FieldType::spectrum, "reflectance", &DiffuseParams::reflectance)
                    .doc("Reflected share of the light, 0 … 1 at every wavelength.")
                    .example("reflectance rgb 0.6 0.5 0.4")
                    .role(SpectrumRole::albedo)
                    .range(0, 1)
                    .byDefault("0.5")
                    .synonyms({"Kd", "albedo", "color", "colour", "diffuse_color", "base_color", "baseColor"}),
            }};
}

std::unique_ptr<const Material> makeDiffuse(const DiffuseParams& params) { return std::make_unique<Diffuse>(params); }

} // namespace abbe
