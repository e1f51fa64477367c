#include "materials/boundary.h"

namespace abbe {

namespace {

// Paths go through before they ask for it.
class NothingBsdf final : public Bsdf {
  public:
    Lobes lobes() const noexcept override { return {}; }
    BsdfEval eval(Vec3, Vec3, Transport) const noexcept override { return {}; }
    std::optional<BsdfSample> sample(Vec3, float, Vec2, Transport) const noexcept override { return std::nullopt; }
};

class Boundary final : public Material {
  public:
    Boundary() {
        // Only the path loop of media looks through.
        traits_ = {.needs = Effect::media, .choosesLobe = false, .isBoundary = true, .focuses = false};
    }

    const Bsdf* bsdf(const SurfaceHit&, const Wavelengths&, Arena& arena) const noexcept override {
        return arena.make<NothingBsdf>();
    }
};

} // namespace

schema::TypeInfo boundaryType() {
    return {.kind = schema::Kind::material,
            .name = "boundary",
            .doc = "No surface, only the limit of the shape's interior: light goes straight on.",
            .example = "shape fog box { material boundary; interior homogeneous { extinction 0.5 per-m } }",
            .fields = {}};
}

std::unique_ptr<const Material> makeBoundary(const BoundaryParams&) { return std::make_unique<Boundary>(); }

} // namespace abbe
