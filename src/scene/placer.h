// Puts shapes, lights, volumes, groups and instances where they stand.
#pragma once

#include "geometry/embree_scene_builder.h"
#include "geometry/instance.h"
#include "math/motion.h"
#include "render/ray.h"
#include "render/shape.h"
#include "scene/build_context.h"
#include "scene/light_builder.h"
#include "scene/material_builder.h"
#include "scene/medium_builder.h"
#include "scene/scene_motion.h"
#include "scene/shape_builder.h"

#include <functional>
#include <utility>
#include <vector>

namespace abbe {

class InstanceBuilder;
struct ObjectGeometry;

// What groups, objects and instances state of their own.
struct Placing {
    KeyedTransform transform;
    Visibility visible = kVisibleToAll;
};

// Whether light goes into a shape, or through holes of it.
struct Passing {
    bool entered = false, open = false;

    void add(Passing p) {
        entered = entered || p.entered;
        open = open || p.open;
    }
};

// What is placed together in one space: the parts of an object, or what moves as one, where it is when the shutter
// opens.
struct Assembly {
    std::vector<std::pair<const Shape*, EmbreeSceneBuilder::Binding>> shapes;
    struct Placed {
        std::uint32_t object; // by number
        std::vector<Placement> places;
        Visibility visible;
    };
    struct Moving {
        std::uint32_t object;
        Motion motion;
        Visibility visible;
    };
    std::vector<Placed> placed;
    std::vector<Moving> moving;
    Bounds3 bounds;
    std::vector<FocusingShape> focusing; // in that space
    int levels = 0;                      // of objects inside of it
};

// Where definitions are placed.
struct Place {
    Motion motion;                    // from their space to that of the scene or of `object`
    Assembly* into = nullptr;         // null: the scene
    Assembly* base = nullptr;         // where what moves by itself goes: `into`, or what `into` moves in
    ObjectGeometry* object = nullptr; // being built, if any
    Visibility visible = kVisibleToAll;
};

class Placer {
  public:
    using Definition = schema::Definition;

    Placer(BuildContext& context, const SceneMotion& motion, MediumBuilder& media, MaterialBuilder& materials,
           ShapeBuilder& shapes, LightBuilder& lights, InstanceBuilder& instances)
        : context_(context), motion_(motion), media_(media), materials_(materials), shapes_(shapes), lights_(lights),
          instances_(instances) {}

    void placeAll(const std::vector<Definition>&, const Place&);
    void placeShape(const Definition&, const Place&);
    void placeLight(const Definition&, const Place&);
    // Adds a shape that stands as `place` says.
    void add(const Shape&, EmbreeSceneBuilder::Binding, const Place&);

    // Builds what has a transform of its own in the place around it, or, if that moves, in an assembly that is then set
    // going. What moves in something that moves is set going by itself, with both motions.
    void carry(const KeyedTransform& own, const Place& outer, Span where, const std::function<void(const Place&)>&);
    std::uint32_t addAssembly(Assembly);
    void addMoving(std::uint32_t object, int levels, const Bounds3&, const std::vector<FocusingShape>&, const Motion&,
                   Assembly* into, Span where, Visibility = kVisibleToAll);
    bool nest(Assembly& into, int levels, Span where); // makes room for an object with so many in it, or reports
    void tooDeep(Span where);
    std::vector<FocusingShape>& focusingIn(Assembly* into) {
        return into ? into->focusing : context_.built.scene.focusing;
    }

    // What groups, objects and instances state of their own.
    Placing ownPlacing(const Definition&);
    Passing passingOf(const ShapeParams&);
    // Notes what the scene asks of those who trace rays. What light goes through it, it meets on its way in and out,
    // whatever ray it is: such a shape is seen by all.
    void noteVisible(Visibility, Passing, const Definition& definition);
    void checkLightPathsSeeAll();

    // Where a shape is, for `abbe info`. Boxes in objects stay in the object's space, which its instances place; all
    // others are those when the shutter opens.
    void noteBounds(const Definition&, const Bounds3&, const Place&, std::size_t places = 1);
    void extend(const Bounds3& box) { bounds_.add(Bounds3d{Vec3d(box.lower), Vec3d(box.upper)}); }
    const Bounds3d& bounds() const { return bounds_; } // of finite geometry, render space

    EmbreeSceneBuilder embree;

  private:
    void placeGroup(const Definition&, const Place&);
    void placeVolume(const Definition&, const Place&);
    void placeAtmosphere(const Definition&);
    void placeLoaded(LoadedShape&, const Place&); // whose own transform is part of the place
    void checkTextures(LoadedShape&, const Shape&);
    void countShape(const LoadedShape&);
    void noteEffects(const LoadedShape&);
    void noteFocusing(const Material&, FocusingShape, Assembly* into);

    BuildContext& context_;
    const SceneMotion& motion_;
    MediumBuilder& media_;
    MaterialBuilder& materials_;
    ShapeBuilder& shapes_;
    LightBuilder& lights_;
    InstanceBuilder& instances_;
    Bounds3d bounds_;
};

} // namespace abbe
