// A shape of polygons whose faces have materials of their own.
#pragma once

#include "render/shape.h"

#include <memory>
#include <vector>

namespace abbe {

// One geometry, so that there are no seams between materials: what is hit is the inner shape; only the material of the
// hit is another. `choice[SurfaceHit::primitive]` is a position in `materials`; where that is null, the hit keeps the
// material that the shape was bound to. Materials are referred to and must outlive this.
class FaceMaterials final : public Shape {
  public:
    // Requires a choice for every primitive of the shape, within `materials`.
    FaceMaterials(std::unique_ptr<const Shape> shape, std::vector<const Material*> materials,
                  std::vector<std::uint16_t> choice);

    const Shape& inner() const { return *shape_; }

    Bounds3 bounds() const override { return shape_->bounds(); }
    void commit(GeometrySink& sink) const override { shape_->commit(sink); }
    std::optional<RawHit> intersect(const Ray& ray) const override { return shape_->intersect(ray); }
    bool confirms(const RawHit& raw, const Ray& ray) const override { return shape_->confirms(raw, ray); }
    void surface(const RawHit&, const Ray&, SurfaceHit&) const override;
    void parametrize(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const override {
        shape_->parametrize(raw, ray, hit);
    }
    bool hasTextureCoordinates() const override { return shape_->hasTextureCoordinates(); }
    const SurfaceSampling* sampling() const override { return shape_->sampling(); }
    const VertexAttributes* attributes() const override { return shape_->attributes(); }
    float meanCurvature(const SurfaceHit& hit) const override { return shape_->meanCurvature(hit); }
    bool usesTextures() const override;
    double area() const override { return shape_->area(); }

  private:
    std::unique_ptr<const Shape> shape_;
    std::vector<const Material*> materials_;
    std::vector<std::uint16_t> choice_;
};

} // namespace abbe
