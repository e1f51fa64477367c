// Objects, which are built once, and their instances.
#pragma once

#include "scene/instances_type.h"
#include "scene/placer.h"

#include <map>
#include <optional>
#include <string_view>
#include <vector>

namespace abbe {

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
    void placeUnshared(const ObjectGeometry&, const Motion& toRender, Span asker, Visibility);
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
