// The work of buildScene(): one pass over the definitions, split by what is built.
#pragma once

#include "geometry/embree_scene.h"
#include "lights/area_light_types.h"
#include "lights/light_context.h"
#include "media/atmosphere.h"
#include "media/grid_medium.h"
#include "render/medium.h"
#include "render/shape.h"
#include "scene/build.h"
#include "scene/curve_library.h"
#include "scene/instances_type.h"
#include "scene/shape_types.h"

#include <map>
#include <set>
#include <unordered_map>

namespace abbe {

class SceneBuilder final : public schema::Resolver {
  public:
    SceneBuilder(const schema::SceneTree&, const schema::TypeTable&, const BuildOptions&, Diagnostics&);

    // Fills `built`; see buildScene().
    void build(BuiltScene& built);

    const Curve* curve(const schema::SpectrumValue&, schema::SpectrumRole, Diagnostics&) override;
    schema::ComplexIndex metal(std::string_view name, Span, Diagnostics&) override;
    schema::Reference reference(const schema::Definition&, Diagnostics&) override;

  private:
    using Definition = schema::Definition;

    // A shape whose geometry is made but not yet placed: made once per definition, placed once or, in objects with
    // emitters and planes, once per instance.
    struct LoadedShape {
        const Definition* definition = nullptr;
        ShapeParams common;
        std::shared_ptr<const MeshData> mesh; // mesh shapes
        std::function<std::unique_ptr<const Shape>(const Transform&)> place;
        std::size_t strands = 0, segments = 0, points = 0; // of curves and points
        std::size_t dicedTriangles = 0, dicedQuads = 0;    // of the last placement of a subdivision surface
        bool infinite = false;
        bool sound = false;
    };
    struct ObjectGeometry;
    // An object inside another one.
    struct NestedObject {
        const ObjectGeometry* object;
        std::vector<Placement> placements;
    };
    // The geometry of an object that instances share.
    struct ObjectGeometry {
        std::optional<std::uint32_t> embreeObject; // absent: nothing in it can be shared
        std::vector<const Definition*> unshared;   // emitters, planes and lights, with the transform of their group
        std::vector<Transform> unsharedPlace;
        std::vector<NestedObject> nested;
        Bounds3 bounds;           // of what is shared, object space
        std::size_t shown = 0;    // how many objects with shapes one instance shows, nested ones included
        int levels = 0;           // of objects inside of it
        bool hasUnshared = false; // nested ones included
        bool busy = false;        // being built: meeting it again is a cycle
    };

    template <typename P> std::optional<P> bound(const Definition&);

    // build.cpp
    void buildSettings(BuiltScene&);
    void finish(BuiltScene&);
    void noteEffects(BuiltScene&);
    bool checkPlanned(const Definition&);
    void reportPlanned();
    const Definition* only(schema::Kind, std::string_view name);

    // build_camera.cpp
    void buildCamera(BuiltScene&);
    const Definition* findShape(const std::vector<Definition>&, std::string_view name, Transform& place);
    std::optional<Vec3d> middleOfShape(std::string_view name); // of its bounds, world space

    // build_shapes.cpp
    void placeAll(const std::vector<Definition>&, const Transform& toRender);
    void placeShape(const Definition&, const Transform& toRender);
    LoadedShape& loadedShape(const Definition&);
    void loadMeshShape(const Definition&, LoadedShape&);
    // shape_parametric.cpp; false for other types.
    bool loadParametric(const Definition&, LoadedShape&, Vec3d up);
    void loadBox(const Definition&, LoadedShape&);
    void loadFrustum(const Definition&, LoadedShape&, Vec3d up);
    void loadTorus(const Definition&, LoadedShape&, Vec3d up);
    // shape_subdivision.cpp; loadSubdivision is false for other types.
    bool loadSubdivision(const Definition&, LoadedShape&);
    std::unique_ptr<const Shape> placeInObject(const LoadedShape&, const Transform& toObject);
    // shape_curves.cpp, shape_points.cpp; loadCurves is false for other types than these two.
    bool loadCurves(const Definition&, LoadedShape&);
    void loadPoints(const Definition&, LoadedShape&);
    bool refuseEmission(const Definition&, const ShapeParams&);
    const Shape* keepShape(std::unique_ptr<const Shape>);
    Transform ownTransform(const Definition&);
    std::optional<KeyedTransform> ownKeys(const Definition&); // of what can move; nothing without keys
    const Material* materialOf(const ShapeParams&);
    const Material* plainMaterial(double reflectance);
    // build_media.cpp
    schema::Reference phaseReference(const Definition&);
    schema::Reference mediumReference(const Definition&);
    std::optional<MediumOptics> opticsOf(const MediumParams&, const Definition&);
    void placeVolume(const Definition&, const Transform& toRender);
    std::unique_ptr<const Medium> makeAtmosphere(const AtmosphereParams&, const Definition&, const Transform& toRender);
    std::unique_ptr<const Medium> loadVdb(const VdbParams&, const Definition&, const Transform& toRender);
    const Material* filled(const Material* surface, const ShapeParams&);
    void noteMedia(Scene&);
    void countShape(const LoadedShape&);

    // build_instances.cpp; `siblings` are the definitions among which an instance stands.
    using SharedShapes = std::vector<std::pair<const Shape*, EmbreeSceneBuilder::Binding>>;
    void placeInstances(const Definition&, const std::vector<Definition>& siblings, const Transform& toRender);
    void placeMoving(const Definition&, const Motion& toRender);
    std::vector<Placement> placements(const Definition&, const std::vector<Definition>& siblings,
                                      const Transform& toParent);
    bool scatterSurface(const schema::Text& over, const std::vector<Definition>& siblings, ScatterSurface&);
    void placeUnshared(const ObjectGeometry&, const Transform& toRender, Span asker);
    ObjectGeometry& objectGeometry(const Definition& object);
    void collect(const std::vector<Definition>&, const Transform& toObject, ObjectGeometry&, SharedShapes&);
    void collectNested(const Definition&, const std::vector<Definition>& siblings, const Transform& toObject,
                       ObjectGeometry&);

    // build_lights.cpp
    void placeLight(const Definition&, const Transform& toRender);
    void placeAreaLight(const Definition&, const Transform& toRender);
    void placeEnvironment(const Definition&, const LightContext&);
    std::unique_ptr<const Shape> lightShape(const Definition&, const Transform& toRender, AreaLightParams&);
    void addLight(std::unique_ptr<Light>, const Definition&);
    const Light* emitterOf(const LoadedShape&, const Shape&);
    LightContext lightContext(const Definition&, const Transform& toRender);

    const schema::SceneTree& tree_;
    const schema::TypeTable& types_;
    const BuildOptions& options_;
    Diagnostics& diagnostics_;
    CurveLibrary curves_;
    EmbreeSceneBuilder embree_;
    BuiltScene* built_ = nullptr;

    std::vector<std::unique_ptr<const Material>> materials_;
    std::unordered_map<const Definition*, schema::Reference> materialIndex_; // of named materials
    std::vector<std::pair<std::uint32_t, Span>> materialAskers_;             // who made it, for effects
    std::map<double, std::optional<std::uint32_t>> plainMaterials_;          // by reflectance
    std::set<std::uint32_t> usedMaterials_;                                  // of shapes that were placed
    std::vector<std::shared_ptr<const PhaseFunction>> phases_;
    std::vector<std::unique_ptr<const Medium>> media_;
    std::vector<Span> mediumSpans_; // where media that fill shapes are defined, like media_
    std::vector<std::pair<const Medium*, Span>> openMedia_, interiorAskers_;
    std::map<std::pair<const Material*, const Medium*>, std::optional<std::uint32_t>> filled_;
    std::unordered_map<const Definition*, schema::Reference> mediumIndex_; // of named phases and media
    std::vector<std::unique_ptr<const Shape>> shapes_;
    std::vector<std::unique_ptr<Light>> lights_;
    std::vector<std::pair<std::string, std::string>> lightNames_; // name and type, like lights_
    std::map<const Definition*, LoadedShape> loaded_;
    std::map<const Definition*, ObjectGeometry> objects_;
    std::vector<const Definition*> chain_; // objects being built
    std::size_t instanceCount_ = 0, unsharedCount_ = 0;
    std::vector<std::pair<std::string, Span>> planned_; // types that this version does not render, and where
    bool inObject_ = false;                             // placeInObject() is running: no camera to measure pixels by
    Bounds3d bounds_;                                   // of finite geometry, render space
};

template <typename P> std::optional<P> SceneBuilder::bound(const Definition& definition) {
    P params;
    const std::size_t before = diagnostics_.errorCount();
    schema::bind(definition, tree_, types_, *this, definition.type ? &params : nullptr, diagnostics_);
    if (!definition.type || diagnostics_.errorCount() != before) return std::nullopt;
    return params;
}

} // namespace abbe
