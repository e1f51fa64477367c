#include "materials/two_sided.h"

#include "materials/bent_normal.h"

namespace abbe {
namespace {

// Which side is hit is known by the geometric normal where the hit says how it was hit, else by wo.
class TwoSidedBsdf final : public Bsdf {
  public:
    TwoSidedBsdf(const Bsdf& front, const Bsdf& back) : front_(front), back_(back) {}

    Lobes lobes() const noexcept override { return front_.lobes() | back_.lobes(); }
    BsdfEval eval(Vec3 wo, Vec3 wi, Transport transport) const noexcept override {
        return side(wo).eval(wo, wi, transport);
    }
    std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport transport) const noexcept override {
        return side(wo).sample(wo, uLobe, u, transport);
    }
    DeltaEval evalDelta(Vec3 wo, Vec3 wi) const noexcept override { return side(wo).evalDelta(wo, wi); }
    ScatterOutline outline(Vec3 wo) const noexcept override { return side(wo).outline(wo); }

  private:
    const Bsdf& side(Vec3 wo) const { return wo.z < 0 ? back_ : front_; }
    const Bsdf &front_, &back_;
};

// Half a turn about x.
Frame turned(const Frame& f) { return {f.x, -f.y, -f.z}; }

SurfaceHit fromBehind(const SurfaceHit& hit) {
    SurfaceHit back = hit;
    back.ng = -hit.ng;
    back.shading = turned(hit.shading);
    return back;
}

class TwoSided final : public Material {
  public:
    TwoSided(const Material& front, const Material& back) : front_(front), back_(back) {
        traits_ = {
            .needs = front.needs() | back.needs(),
            .choosesLobe = front.choosesLobe() || back.choosesLobe(),
            .reversible = front.reversible() && back.reversible(),
            .focuses = front.focuses() || back.focuses(),
            .usesTextures = front.usesTextures() || back.usesTextures(),
            .bends = true, // nothing for the whole: asks for hit.arrival
            .mayBeOpen = front.mayBeOpen() || back.mayBeOpen(),
            .seesOutside = front.seesOutside() || back.seesOutside(),
        };
    }

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        const float side = dot(hit.arrival, hit.ng);
        if (side < 0) return &partBsdf(front_, hit, lambda, arena);
        const Bsdf* back = arena.make<TurnedBsdf>(partBsdf(back_, fromBehind(hit), lambda, arena), turned(Frame{}));
        return side > 0 ? back : arena.make<TwoSidedBsdf>(partBsdf(front_, hit, lambda, arena), *back);
    }
    float opacity(const SurfaceHit& hit) const noexcept override {
        return dot(hit.arrival, hit.ng) > 0 ? back_.opacity(fromBehind(hit)) : front_.opacity(hit);
    }

  private:
    const Material &front_, &back_;
};

} // namespace

schema::TypeInfo twoSidedType() {
    using namespace schema;
    return {.kind = Kind::material,
            .name = "two-sided",
            .doc = "A sheet with a material on each side.",
            .example =
                "material card two-sided { front diffuse { reflectance 0.8 }; back diffuse { reflectance 0.1 } }",
            .fields = {
                field(FieldType::reference, "front", &TwoSidedParams::front)
                    .to(Kind::material)
                    .required()
                    .synonyms({"outside", "front_material"})
                    .doc("Material of the side that normals point to: counter-clockwise faces, the outside.")
                    .example("front diffuse { reflectance 0.8 }"),
                field(FieldType::reference, "back", &TwoSidedParams::back)
                    .to(Kind::material)
                    .required()
                    .synonyms({"inside", "back_material"})
                    .doc("Material of the other side.")
                    .example("back diffuse { reflectance 0.1 }"),
            }};
}

std::unique_ptr<const Material> makeTwoSided(const Material& front, const Material& back) {
    return std::make_unique<TwoSided>(front, back);
}

} // namespace abbe
