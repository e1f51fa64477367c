// Objects, which are built once, and their instances: single ones, and many at once.
#pragma once

#include "base/diagnostic.h"
#include "math/motion.h"
#include "render/visible_field.h"
#include "scene/placer.h"
#include "schema/type.h"

#include <cstdint>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// `instances OBJECT { … }`: one object at many places, which come from a file, a grid or a surface.

struct InstancesParams : VisibleParams {
    schema::Text points;         // resolved path of a PLY file
    std::optional<Vec3d> grid;   // counts along the axes
    std::optional<double> count; // of `scatter`
    Vec3d spacing{1, 1, 1};
    schema::Text over;         // name of a shape
    std::optional<Vec2d> area; // rectangle about the origin, instead of a shape
    std::int64_t seed = 0;
    double turn = 2 * kPiD;   // rad, at most, about up
    Vec2d scale{1, 1};        // smallest and largest
    bool align = false;       // up becomes the normal of the surface
    KeyedTransform transform; // of all places together
};

schema::TypeInfo instancesType();

// A surface to scatter on: triangles with the sums of their areas, or one disk.
struct ScatterSurface {
    struct Disk {
        Vec3d centre, normal;
        double radius = 0;
    };
    std::vector<std::array<Vec3d, 3>> triangles;
    std::vector<double> areaSums; // of the triangles up to each
    std::optional<Disk> disk;
};

// What says where instances go besides their own properties.
struct PlaceContext {
    Vec3d up{0, 1, 0};
    double unit = 1;                         // m per unit of a file
    const ScatterSurface* surface = nullptr; // for `scatter` over a shape
    Span span;                               // of the definition
};

// Takes the place with a number; false ends the list.
using PlaceVisitor = std::function<bool(std::uint64_t index, const Transform&)>;

// All places in order, each without the params' own transform; the same for the same params on every machine. Returns
// false after an error.
bool visitPlaces(const InstancesParams&, const PlaceContext&, Diagnostics&, const PlaceVisitor&);

// An object inside another one, which is to be taken apart because of its lights.
struct NestedObject {
    const ObjectGeometry* object;
    std::vector<Placement> placements;
    Motion carried; // from there on
    Visibility visible;
};

// The geometry of an object that instances share.
struct ObjectGeometry {
    std::string_view name;
    std::optional<std::uint32_t> embreeObject; // absent: nothing in it can be shared
    struct Unshared {
        const schema::Definition* definition;
        Motion motion; // of their group
        Visibility visible;
    };
    std::vector<Unshared> unshared; // emitters, planes and lights
    std::vector<NestedObject> nested;
    Bounds3 bounds;                      // of what is shared, object space
    std::vector<FocusingShape> focusing; // likewise
    std::size_t shown = 0;               // how many objects with shapes one instance shows, nested ones included
    int levels = 0;                      // of objects inside of it
    bool hasUnshared = false;            // nested ones included
    bool hasShapes = false;              // of its own
    Passing passing;                     // of all shapes in it
    bool busy = false;                   // being built: meeting it again is a cycle
};

class InstanceBuilder {
  public:
    using Definition = schema::Definition;

    InstanceBuilder(BuildContext& context, const SceneMotion& motion, ShapeBuilder& shapes, Placer& placer)
        : context_(context), motion_(motion), shapes_(shapes), placer_(placer) {}

    // `siblings` are the definitions among which an instance stands.
    void place(const Definition&, const std::vector<Definition>& siblings, const Place&);
    // The parts of an object that its instances share are built once, in the object's own space.
    ObjectGeometry& object(const Definition&);

  private:
    void placeMoving(const Definition&, const ObjectGeometry&, const Place&);
    void placeStill(const Definition&, std::vector<Placement>, const ObjectGeometry&, const Place&);
    void placeFocusing(const std::vector<FocusingShape>& shared, const std::vector<Placement>&, Assembly* into);
    void placeUnshared(const ObjectGeometry&, const Motion& toRender, Span where, Visibility);
    // Where an `instance` (without parameters) or `instances` puts its object; nothing after an error.
    std::vector<Placement> placements(const Definition&, const InstancesParams*,
                                      const std::vector<Definition>& siblings, const Transform& outwards);
    bool scatterSurface(const schema::Text& over, const std::vector<Definition>& siblings, ScatterSurface&);
    const ObjectGeometry* instanced(const Definition&, const Place&);

    BuildContext& context_;
    const SceneMotion& motion_;
    ShapeBuilder& shapes_;
    Placer& placer_;
    std::map<const Definition*, ObjectGeometry> objects_;
    std::vector<const Definition*> chain_; // objects being built
    std::size_t instanceCount_ = 0, unsharedCount_ = 0;
};

} // namespace abbe
