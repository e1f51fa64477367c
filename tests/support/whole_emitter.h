// A shape that is sampled part by part, as one that is sampled as a whole.
#pragma once

#include "math/distribution.h"
#include "render/shape.h"

#include <algorithm>
#include <memory>
#include <vector>

namespace abbe::test {

// Parts are chosen by area. Requires shapes that can be sampled.
class WholeEmitter final : public Shape, public SurfaceSampling {
  public:
    explicit WholeEmitter(std::unique_ptr<const Shape> shape)
        : owned_(std::move(shape)), shape_(*owned_), byArea_(areas(shape_)) {}
    // Refers to the shape.
    explicit WholeEmitter(const Shape& shape) : shape_(shape), byArea_(areas(shape_)) {}

    Bounds3 bounds() const override { return shape_.bounds(); }
    void commit(GeometrySink& sink) const override { shape_.commit(sink); }
    std::optional<RawHit> intersect(const Ray& ray) const override { return shape_.intersect(ray); }
    void surface(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const override { shape_.surface(raw, ray, hit); }
    double area() const override { return shape_.area(); }
    const SurfaceSampling* sampling() const override { return this; }
    EmitterPart emitterPart(std::uint32_t) const override { return {.box = bounds(), .area = area()}; }
    // No path starts here, and no texture dims it.
    std::optional<ShapePoint> samplePoint(std::uint32_t, Vec2) const override { return std::nullopt; }
    float pdfPoint(std::uint32_t, Vec3) const override { return 0; }
    std::optional<RawHit> locate(Vec3, std::uint32_t, const Ray&) const override { return std::nullopt; }
    // Which part sample() takes for the first of its numbers: a point alone does not tell.
    std::uint32_t partOf(float u) const { return static_cast<std::uint32_t>(byArea_.sample(u).index); }
    std::optional<ShapeSample> sample(const Receiver& from, std::uint32_t, Vec2 u) const override {
        const BinSample bin = byArea_.sample(u.x);
        auto s = shape_.sampling()->sample(from, static_cast<std::uint32_t>(bin.index), {bin.offset, u.y});
        if (s) s->pdfSolidAngle *= static_cast<float>(share(bin.index));
        return s;
    }
    float pdfSolidAngle(const Receiver& from, const SurfaceHit& hit) const override {
        return shape_.sampling()->pdfSolidAngle(from, hit) *
               static_cast<float>(share(shape_.sampling()->emitterParts() > 1 ? hit.primitive : 0));
    }

  private:
    static std::vector<double> areas(const Shape& shape) {
        std::vector<double> result;
        for (std::uint32_t i = 0; i < shape.sampling()->emitterParts(); ++i)
            result.push_back(shape.sampling()->emitterPart(i).area);
        return result;
    }
    double share(std::size_t part) const {
        return shape_.sampling()->emitterPart(static_cast<std::uint32_t>(part)).area / shape_.area();
    }

    std::unique_ptr<const Shape> owned_;
    const Shape& shape_;
    Distribution1D byArea_;
};

} // namespace abbe::test
