// Collects a scene's geometry for Embree.
#pragma once

#include "geometry/instance.h"
#include "math/motion.h"
#include "render/intersector.h"
#include "render/shape.h"

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

namespace abbe {

struct EmbreeStructure;

// The trees that one builder leaves to the next: of equal shapes at equal places they are taken over, and materials
// and lights alone are new. Those of objects without others in them are taken over one by one.
struct KeptGeometry {
    std::shared_ptr<const EmbreeStructure> last; // null: none
    std::size_t built = 0, kept = 0;             // trees, by the last build()
};

// Collects shapes, then builds the intersector once. Shapes are referred to, not owned: they, and the spans that
// their commit() hands out, must outlive the intersector. Spans of vertices must be readable for 4 bytes past their
// end (Embree loads 16 bytes). Not thread-safe; the build itself uses threadCount() threads.
class EmbreeSceneBuilder {
  public:
    struct Binding {
        const Material* material = nullptr;
        const SurfaceLight* light = nullptr;
        // For textures: from the coordinates of the shape to its own space, before its transform; nothing: the same.
        std::optional<Transform> toOwn = {};
        bool parametrized = false; // even if no material looks at textures
        Visibility visible = kVisibleToAll;
    };

    EmbreeSceneBuilder();
    ~EmbreeSceneBuilder();
    EmbreeSceneBuilder(const EmbreeSceneBuilder&) = delete;
    EmbreeSceneBuilder& operator=(const EmbreeSceneBuilder&) = delete;

    // A shape in render space. Returns how many were added before.
    std::uint32_t addShape(const Shape&, Binding);
    // Shapes in a space of their own, seen only through instances. Returns the object's number. There may be none: an
    // object can consist of instances alone.
    std::uint32_t addObject(std::vector<std::pair<const Shape*, Binding>>);

    static constexpr std::uint32_t kScene = 0xffffffffu;
    // Places an object in the scene, or inside an object that was added after it; many times at 48 bytes each, and
    // about 60 more for Embree. Requires maps without fault (Placement::findFault), object numbers from addObject, and
    // objects in at most kMaxInstanceLevels objects.
    void addInstance(std::uint32_t object, const Transform&, std::uint32_t inside = kScene);
    void addInstances(std::uint32_t object, std::vector<Placement>, std::uint32_t inside = kScene,
                      Visibility = kVisibleToAll);
    // The time, in s, at which Ray::time is 0, and how much later it is 1. Before the first addMoving.
    void setShutter(double open, double duration);
    Interval shutter() const;
    // Whether Intersector::coincident() is to find anything, for which meshes of dielectrics pay.
    void setNested(bool);
    // Places an object that moves while the shutter is open, as addInstance. Requires maps without fault at all times
    // of the interval.
    void addMoving(std::uint32_t object, const Motion&, std::uint32_t inside = kScene, Visibility = kVisibleToAll);
    // Ends the builder. Throws std::runtime_error with Embree's text when it runs out of memory or refuses data.
    std::unique_ptr<Intersector> build();
    // The same with trees of an earlier one, and for a later one. `owners` has all shapes: they live as long as any
    // tree over them.
    std::unique_ptr<Intersector> build(KeptGeometry&, std::span<const std::shared_ptr<const Shape>> owners);

  private:
    struct Impl;
    std::unique_ptr<Impl> impl_;
};

} // namespace abbe
