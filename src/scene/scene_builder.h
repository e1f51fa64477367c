// The work of buildScene(): one pass over the definitions, split by what is built.
#pragma once

#include "cameras/camera_params.h"
#include "geometry/embree_scene_builder.h"
#include "geometry/subdivision_surface.h"
#include "lights/amount.h"
#include "lights/area_light_types.h"
#include "lights/environment_light.h"
#include "lights/light_context.h"
#include "lights/light_motion.h"
#include "media/atmosphere.h"
#include "media/medium_optics.h"
#include "render/medium.h"
#include "render/shape.h"
#include "render/texture.h"
#include "scene/build.h"
#include "scene/closed_surface.h"
#include "scene/curve_library.h"
#include "scene/instances_type.h"
#include "scene/shape_types.h"
#include "scene/visible.h"
#include "textures/texture_store.h"
#include "volumes/voxel_grid.h"

#include <map>
#include <set>
#include <unordered_map>

namespace abbe {

struct CurvesParams;
struct IesLightParams;
struct GridExtras;
struct LoadedCage;
struct BumpMap;
struct MaterialDress;
struct NormalMap;
class NoiseMedium;
struct PointsParams;
struct SubsurfaceInside;
struct VdbGrid;
struct VdbParams;

// The box around anything.
inline constexpr Bounds3 kEverything{{-kInfinity, -kInfinity, -kInfinity}, {kInfinity, kInfinity, kInfinity}};

class SceneBuilder final : public schema::Resolver {
  public:
    SceneBuilder(const schema::SceneTree&, const schema::TypeTable&, const BuildOptions&, Diagnostics&);

    // Fills `built`; see buildScene().
    void build(BuiltScene& built);

    const Curve* curve(const schema::SpectrumValue&, schema::SpectrumRole, Diagnostics&) override;
    schema::ComplexIndex metal(std::string_view name, Span, Diagnostics&) override;
    schema::Reference reference(const schema::Definition&, Diagnostics&) override;
    const Texture* texture(const schema::TextureRequest&, Diagnostics&) override;

  private:
    using Definition = schema::Definition;

    // A shape whose geometry is made but not yet placed: made once per definition, placed once or, in objects with
    // emitters and planes, once per instance.
    struct LoadedShape {
        const Definition* definition = nullptr;
        ShapeParams common;
        std::shared_ptr<const MeshData> mesh; // mesh shapes
        Vec3d meshOrigin;                     // in the shape's own space; positions of `mesh` are relative to it
        std::function<std::unique_ptr<const Shape>(const Transform&)> place;
        std::vector<std::uint16_t> faceMaterials;          // of the last placement: of its triangles, then of its quads
        std::size_t strands = 0, segments = 0, points = 0; // of curves and points
        std::size_t dicedTriangles = 0, dicedQuads = 0;    // of the last placement of a subdivision surface
        std::string_view openBecause;                      // why no medium can fill it, if so
        OpenEdges cageEdges;                               // of a cage that a medium fills
        bool infinite = false;
        bool deforms = false; // while the shutter is open
        bool sound = false;
        bool texturesChecked = false;
    };
    struct ObjectGeometry;
    using SharedShapes = std::vector<std::pair<const Shape*, EmbreeSceneBuilder::Binding>>;
    // What is placed together in one space: the parts of an object, or what moves as one, where it is when the shutter
    // opens.
    struct Assembly {
        SharedShapes shapes;
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
    // An object inside another one, which is to be taken apart because of its lights.
    struct NestedObject {
        const ObjectGeometry* object;
        std::vector<Placement> placements;
        Motion carried; // from there on
        Visibility visible;
    };
    // The geometry of an object that instances share.
    struct ObjectGeometry {
        std::optional<std::uint32_t> embreeObject; // absent: nothing in it can be shared
        struct Unshared {
            const Definition* definition;
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

    template <typename P> std::optional<P> bound(const Definition&);

    // build.cpp
    schema::Reference makeReference(const Definition&, Diagnostics&);
    // Binds to the parameters that it is given; false after a diagnostic. Both arguments must outlive it.
    std::function<bool(void*)> binder(const Definition&, Diagnostics&);
    void buildSettings(BuiltScene&);
    void finish(BuiltScene&);
    const Definition* only(schema::Kind, std::string_view name);

    // build_effects.cpp
    void noteEffect(Effect, Span asker, std::string_view why);
    void noteEffects();
    void checkForbidden();
    void checkCompiled();

    // effect_switches.cpp
    bool leavesOut(EffectSwitch, Span asker);
    const Curve* switchedIndex(const Curve*, Span asker);
    std::unique_ptr<const Material> switchedAbsorption(std::unique_ptr<const Material>, Span asker);
    void switchParameters(const Definition&, void* params);
    void switchCamera(BuiltScene&, const Definition& camera);

    // build_materials.cpp
    schema::Reference materialReference(const Definition&);
    std::uint32_t keepMaterial(std::unique_ptr<const Material>, Span asker);
    // The material in its dress, or the material itself where it wears nothing; null after an error.
    std::unique_ptr<const Material> dressed(std::unique_ptr<const Material>, const MaterialDress&, const Definition&);
    std::unique_ptr<const Material> translucent(std::unique_ptr<const Material> surface, const SubsurfaceInside&,
                                                const Definition&);
    bool checkDress(const Material&, const MaterialDress&, const Definition&);
    std::optional<std::pair<NormalMap, BumpMap>> mapsOf(const MaterialDress&);

    // build_camera.cpp
    void buildCamera(BuiltScene&);
    const Definition* findShape(const std::vector<Definition>&, std::string_view name, double time, Transform& place);
    std::optional<Vec3d> middleOfShape(std::string_view name, double time); // of its bounds, world space

    // build_shapes.cpp
    void placeAll(const std::vector<Definition>&, const Place&);
    void placeGroup(const Definition&, const Place&);
    void placeShape(const Definition&, const Place&);
    void placeLoaded(LoadedShape&, const Place&); // whose own transform is part of the place
    void addPlaced(const Shape&, EmbreeSceneBuilder::Binding, const Place&);
    LoadedShape& loadedShape(const Definition&);
    void loadMeshShape(const Definition&, LoadedShape&);
    void checkInterior(LoadedShape&); // closed_surface.cpp
    // shape_parametric.cpp; false for other types.
    bool loadParametric(const Definition&, LoadedShape&, Vec3d up);
    void loadBox(const Definition&, LoadedShape&);
    void loadFrustum(const Definition&, LoadedShape&, Vec3d up);
    void loadTorus(const Definition&, LoadedShape&, Vec3d up);
    // shape_subdivision.cpp; loadSubdivision is false for other types.
    bool loadSubdivision(const Definition&, LoadedShape&);
    std::unique_ptr<const Shape> placeInObject(const LoadedShape&, const Transform& toObject);
    // shape_subdivision_camera.cpp
    struct DicingCamera {
        const Camera* camera;
        Vec3d toCamera; // what takes render space to the space of its rays
    };
    std::optional<std::vector<std::uint16_t>> cageChoices(const ShapeParams&, const LoadedCage&);
    bool checkDicingCamera(const schema::Quantity& dicing);
    std::optional<DicingCamera> dicingCamera(const schema::Quantity& dicing);
    Dicing dicingFor(Dicing, const schema::Quantity& asked, double offscreen, const SubdivisionCage&,
                     const Transform& place);
    // shape_deform_mesh.cpp, shape_deform_points.cpp: shapes with keys
    void noteFiles(const std::vector<ShapeKey>&);
    void deformMesh(const Definition&, const MeshParams&, LoadedShape&);
    void deformCurves(const Definition&, const CurvesParams&, LoadedShape&);
    void deformPoints(const Definition&, const PointsParams&, LoadedShape&);
    // shape_groups.cpp
    std::optional<std::vector<std::uint16_t>> groupChoices(const ShapeParams&, const std::vector<std::string>& names);
    void chooseFaceMaterials(LoadedShape&, const FaceGroups&);
    std::unique_ptr<const Shape> withFaceMaterials(const LoadedShape&, std::unique_ptr<const Shape>);
    // textures.cpp
    schema::Reference textureReference(const Definition&, Diagnostics&);
    const std::shared_ptr<TextureStore>& textureStore(); // made with the first call
    // Null for none, or after an error at `user`.
    const Texture* textureFor(schema::Reference, TextureUse, Span user);
    bool prepareTexture(std::uint32_t, TextureUse, Span user);
    void askTextures(std::uint32_t material); // of a material that is part of another one
    void checkTextures(const LoadedShape&, const Shape&);
    void checkTexture(std::uint32_t texture, Span asker, const Definition& shape, const Shape&);
    void checkAttributes(std::uint32_t texture, Span asker, const Definition& shape, const Shape&);
    // shape_curves.cpp, shape_points.cpp; loadCurves is false for other types than these two.
    bool loadCurves(const Definition&, LoadedShape&);
    void loadPoints(const Definition&, LoadedShape&);
    bool refuseEmission(const Definition&, const ShapeParams&);
    const Shape* keepShape(std::unique_ptr<const Shape>);
    // visible.cpp
    Placing ownPlacing(const Definition&);
    Passing passingOf(const ShapeParams&);
    void noteVisible(Visibility, Passing, const Definition& asker);
    void checkLightPathsSeeAll();
    const Material* materialOf(const ShapeParams&);
    const Material* plainMaterial(double reflectance);
    // build_phases.cpp
    schema::Reference phaseReference(const Definition&);
    std::shared_ptr<const PhaseFunction> makeTablePhase(const Definition&);
    std::shared_ptr<const PhaseFunction> makeMixPhase(const Definition&);
    // build_media.cpp
    schema::Reference mediumReference(const Definition&);
    std::uint32_t keepMedium(std::unique_ptr<Medium>, const Definition&);
    std::optional<MediumOptics> opticsOf(const MediumParams&, const Definition&);
    void placeVolume(const Definition&, const Place&);
    void placeAtmosphere(const Definition&);
    std::unique_ptr<Medium> makeAtmosphere(const AtmosphereParams&, const Definition&, const Transform& toRender);
    // build_vdb.cpp
    std::unique_ptr<Medium> loadVdb(const Definition&, const Transform& toRender);
    GridExtras vdbExtras(const VdbParams&, const MediumOptics&, std::span<VdbGrid>);
    bool checkGlow(const VdbParams&, const MediumOptics&, const Definition&);
    bool checkDrift(const VdbParams&, const VoxelGrid& density, const GridExtras&, const Transform& place);
    std::unique_ptr<Medium> makeVolume(const VdbParams&, const MediumOptics&, VoxelGrid density, GridExtras,
                                       const Transform& place, const Definition&);
    // build_noise.cpp
    std::unique_ptr<Medium> makeNoiseVolume(const Definition&, const Transform& toRender);
    std::unique_ptr<Medium> makeNoiseMedium(const Definition&);
    void placeNoise(Vec3d origin);
    const Material* filled(const Material* surface, const ShapeParams&);
    void noteInterior(const Medium&);
    bool holdsMedium(const ShapeParams&) const; // of its own, or of its materials
    void notePlaced(const Material&, const Bounds3&, bool repeated);
    void noteFocusing(const Material&, FocusingShape, Assembly* into);
    std::vector<FocusingShape>& focusingIn(Assembly* into) { return into ? into->focusing : built_->scene.focusing; }
    void placeFocusing(const std::vector<FocusingShape>& shared, const std::vector<Placement>&, Assembly* into);
    bool mayLieInDielectric(bool dielectrics) const;
    void noteMedia(Scene&), limitDenseMedia(); // the second: dense_media.cpp
    void countShape(const LoadedShape&);
    void noteBounds(const Definition&, const Bounds3&, const Place&, std::size_t places = 1); // shape_facts.cpp
    void noteShape(const LoadedShape&);

    // build_motion.cpp
    bool moves(const KeyedTransform&) const;          // while the shutter is open
    bool deforms(std::span<const double> keys) const; // likewise
    Motion within(const Motion& outer, const KeyedTransform& own) const;
    Transform atOpening(const Motion& motion) const { return motion.at(built_->shutter.open); }
    Motion fromOpening(const Motion&) const; // requires an invertible map at the opening
    bool checkMotion(const Motion&, Span asker);
    Bounds3 swept(const Motion&, const Bounds3&) const;
    void carry(const KeyedTransform& own, const Place& outer, Span asker, const std::function<void(const Place&)>&);
    std::uint32_t addAssembly(Assembly);
    void addMoving(std::uint32_t object, int levels, const Bounds3&, const std::vector<FocusingShape>&, const Motion&,
                   Assembly* into, Span asker, Visibility = kVisibleToAll);
    bool nest(Assembly& into, int levels, Span asker); // makes room for an object with so many in it, or reports
    void tooDeep(Span asker);
    // False after an error; nothing if the light stands still.
    bool lightMotion(const Motion& toRender, Span asker, std::optional<LightMotion>&);

    // build_instances.cpp; `siblings` are the definitions among which an instance stands.
    void placeInstances(const Definition&, const std::vector<Definition>& siblings, const Place&);
    void placeMoving(const Definition&, const ObjectGeometry&, const Place&);
    void placeStill(const Definition&, std::vector<Placement>, const ObjectGeometry&, const Place&);
    // Where an `instance` (without parameters) or `instances` puts its object; nothing after an error.
    std::vector<Placement> placements(const Definition&, const InstancesParams*,
                                      const std::vector<Definition>& siblings, const Transform& outwards);
    bool scatterSurface(const schema::Text& over, const std::vector<Definition>& siblings, ScatterSurface&);
    void placeUnshared(const ObjectGeometry&, const Motion& toRender, Span asker, Visibility);
    ObjectGeometry& objectGeometry(const Definition& object);
    const ObjectGeometry* instanced(const Definition&, const Place&);

    // build_lights.cpp
    void placeLight(const Definition&, const Place&);
    std::unique_ptr<Light> makeIes(const IesLightParams&, const LightContext&);
    void placeDaylight(const Definition&, const Place&);
    void placeAreaLight(const Definition&, const Place&);
    template <typename P, typename Make> void placeBareLight(const Definition&, const Place&, Make);
    std::unique_ptr<Light> makeEnvironment(const EnvironmentLightParams&, const LightContext&);
    bool takeTexture(const AreaLightParams&, const Shape&, const Definition&, LightContext&);
    std::unique_ptr<const Shape> lightShape(const Definition&, const Transform& toRender, AreaLightParams&);
    void checkEnclosure(const Scene&);
    void checkMattes(const BuiltScene&);
    void checkLightGroups(const BuiltScene&);
    // Its name or, without one, its type and a number.
    const std::string& nameOf(const Definition&);
    bool checkPower(const Light&, Span);
    void addLight(std::unique_ptr<Light>, const Definition&, Visibility = kVisibleToAll);
    struct Emission {
        ScaledCurve radiance; // no curve: none
        const Texture* texture = nullptr;
        Span span; // where the texture is asked for
        bool bothSides = false;
        const EmissionVeil* veil = nullptr;
    };
    Emission emissionOf(const LoadedShape&);
    const Curve* textureWhite(const Texture&);
    // Ready for a light over the shape; false after an error.
    bool checkLightTexture(const Texture&, Span asker, const Definition&, const Shape&);
    const Light* emitterOf(const LoadedShape&, const Shape&, const Motion& toRender, Visibility);
    LightContext lightContext(const Definition&, const Motion& toRender);

    const schema::SceneTree& tree_;
    const schema::TypeTable& types_;
    const BuildOptions& options_;
    Diagnostics& diagnostics_;
    CurveLibrary curves_;
    EmbreeSceneBuilder embree_;
    BuiltScene* built_ = nullptr;
    Span cameraSpan_;

    std::vector<std::unique_ptr<const Material>> materials_, undressed_;
    std::vector<const Definition*> openMaterials_;                        // being made
    std::unordered_map<const Definition*, schema::Reference> references_; // of what has a name
    std::vector<std::unique_ptr<Texture>> textures_;
    std::shared_ptr<TextureStore> textureStore_;
    struct TextureParts {
        std::uint32_t size = 1; // how many textures it asks at most, itself included
        // The textures that it is made of, and whether as numbers whatever it is asked for itself.
        std::vector<std::pair<std::uint32_t, bool>> parts;
    };
    struct OpenTexture {
        const Definition* definition;
        TextureParts made;
    };
    std::vector<TextureParts> textureParts_; // like textures_
    std::vector<OpenTexture> openTextures_;  // being made, each for the one before
    struct TextureAsker {
        std::uint32_t texture;
        Span span; // where
    };
    std::vector<std::vector<TextureAsker>> openAskers_;                // of materials being made
    std::map<std::uint32_t, std::vector<TextureAsker>> textureAskers_; // of materials, with those that they are made of
    std::vector<std::pair<std::uint32_t, Span>> materialAskers_;       // who made it, for effects
    std::map<double, std::optional<std::uint32_t>> plainMaterials_;    // by reflectance
    std::set<std::uint32_t> usedMaterials_;                            // of shapes that were placed
    std::vector<std::shared_ptr<const PhaseFunction>> phases_;
    std::vector<const Definition*> openMixes_; // being made
    std::vector<std::unique_ptr<const Medium>> media_;
    std::vector<NoiseMedium*> noiseMedia_;            // those of media_
    std::vector<class HomogeneousMedium*> evenMedia_; // likewise
    std::vector<Span> mediumSpans_;                   // where each of media_ is defined
    std::vector<std::pair<const Medium*, Span>> openMedia_, interiorAskers_;
    struct PlacedShape {
        Bounds3 box; // render space; of what is placed in objects or moves: everything
        const Material* material;
        bool repeated; // in an object, of which there may be several
    };
    std::vector<PlacedShape> placedShapes_; // that a medium or a dielectric fills, or that look otherwise in one
    std::map<std::pair<const Material*, const Medium*>, std::optional<std::uint32_t>> filled_;
    std::vector<std::unique_ptr<const Shape>> shapes_;
    std::vector<std::unique_ptr<Light>> lights_;
    std::vector<Span> lightTextures_; // where lights ask for theirs
    std::map<const RgbSpace*, const Curve*> textureWhites_;
    std::vector<std::pair<std::string, std::string>> lightNames_;               // name and type, like lights_
    std::map<std::pair<std::uint32_t, std::uint32_t>, std::string> givenNames_; // of definitions without one, by place
    std::unordered_map<std::string, int> nameless_;                             // definitions without a name, by type
    std::map<const Definition*, LoadedShape> loaded_;
    std::map<const Definition*, std::unique_ptr<const PlacedCamera>> dicingCameras_; // null: being made, or faulty
    std::map<const Definition*, ObjectGeometry> objects_;
    std::vector<const Definition*> chain_; // objects being built
    std::size_t instanceCount_ = 0, unsharedCount_ = 0;
    bool inObject_ = false; // placeInObject() is running: no camera to measure pixels by
    Bounds3d bounds_;       // of finite geometry, render space
};

template <typename P> std::optional<P> SceneBuilder::bound(const Definition& definition) {
    P params;
    if (!schema::bind(definition, tree_, types_, *this, definition.type ? &params : nullptr, diagnostics_))
        return std::nullopt;
    return params;
}

} // namespace abbe
