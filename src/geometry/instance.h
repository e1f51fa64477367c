// The placement of an object in the space around it: rays inwards, hits outwards.
#pragma once

#include "math/bounds.h"
#include "math/transform.h"
#include "render/ray.h"
#include "render/surface_hit.h"

#include <cstring>
#include <optional>
#include <string>

namespace abbe {

using Float4 = float __attribute__((vector_size(16)));
using Double4 = double __attribute__((vector_size(32)));

// A ray's numbers in registers; what stands in the fourth lanes does not matter.
struct RayLanes {
    Float4 origin, direction;
};

// A map from an object's space to the space that it is placed in, in 48 bytes: what a table keeps of an instance. The
// map is rounded to float once; rays inwards and hits outwards both use it as rounded, in double.
class Placement {
  public:
    // Requires that findFault() finds none.
    explicit Placement(const Transform& objectToOuter);

    // What keeps a map from placing anything, in words for a message: it is not finite, flattens the object
    // (|det| < 1e-30 |A|³), or makes it so small or large that float cannot hold a ray inside of it.
    static std::optional<std::string> findFault(const Transform&);

    bool operator==(const Placement&) const = default;

    Transform map() const; // as rounded
    // The direction keeps its length in object units, so distances along the ray stay those outside.
    Ray toObject(const Ray&) const;
    RayLanes toObject(RayLanes) const;
    // A box that holds the image of the box, whatever the rounding of rays on their way inwards.
    Bounds3 toOuter(const Bounds3&) const;

  private:
    float a_[3][3];
    float t_[3]; // right behind: rows are read four floats at a time
};
static_assert(sizeof(Placement) == 48);

// By Cramer's rule in double: a table of inverses would be 36 bytes per instance more to keep and to fetch, and no
// rounding but that of the result is left to bound. Inline, because every instance that a ray comes near asks for it.
[[gnu::always_inline]] inline RayLanes Placement::toObject(RayLanes ray) const {
    const auto load = [](const float* p) {
        Float4 v;
        std::memcpy(&v, p, sizeof v);
        return __builtin_convertvector(v, Double4);
    };
    const auto turned = [](Double4 v) { return __builtin_shufflevector(v, v, 1, 2, 0, 3); };
    const auto cross = [&](Double4 a, Double4 b) { return turned(a * turned(b) - turned(a) * b); };
    const Double4 r0 = load(a_[0]), r1 = load(a_[1]), r2 = load(a_[2]), last = load(&a_[2][2]);
    const Double4 t = __builtin_shufflevector(last, last, 1, 2, 3, 0);
    const Double4 x = cross(r1, r2), y = cross(r2, r0), z = cross(r0, r1);
    const Double4 products = r0 * x;
    const double scale = 1 / (products[0] + products[1] + products[2]);
    const auto inside = [&](Double4 v) {
        return __builtin_convertvector((x * v[0] + y * v[1] + z * v[2]) * scale, Float4);
    };
    return {inside(__builtin_convertvector(ray.origin, Double4) - t),
            inside(__builtin_convertvector(ray.direction, Double4))};
}

// A placement with all that carrying hits outwards takes.
class Instance {
  public:
    // Requires a map without fault.
    explicit Instance(const Transform& objectToRender) : Instance(Placement(objectToRender)) {}
    explicit Instance(const Placement&);

    const Transform& map() const { return objectToRender_; } // as rounded
    Ray toObject(const Ray&) const;
    // From object to render space: point, error bound, normals, frame. Outward normals stay outward.
    void toRender(SurfaceHit&) const;
    // The same for what SurfaceHit says of the parametrisation.
    void parametrizationToRender(SurfaceHit&) const;
    Bounds3 toRender(const Bounds3&) const;

  private:
    Transform objectToRender_, renderToObject_;
};

} // namespace abbe
