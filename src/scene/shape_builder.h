// Shapes as their definitions state them, before it is known where they stand.
#pragma once

#include "geometry/open_edges.h"
#include "geometry/shape_params.h"
#include "lights/amount.h"
#include "math/mesh_data.h"
#include "scene/build_context.h"
#include "scene/material_builder.h"
#include "scene/scene_motion.h"
#include "scene/texture_builder.h"
#include "schema/type.h"

#include <cstdint>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace abbe {

// `at TIME { … }` blocks of shapes that deform: where their points are at that time.

// One block. Either a file or points; what else may stand in it depends on the type of the shape.
struct ShapeKey {
    double time = 0; // s
    Span span;
    schema::Text file;
    std::vector<Vec3d> points;
    std::optional<double> radius; // curves and points
    std::vector<double> radii;
    std::vector<Vec3d> normals; // points
};

// Fields of a block, by the type of the shape.
std::vector<schema::FieldInfo> meshKeyFields();
// A field for files of meshes with the keys that choose from a glTF file.
schema::FieldInfo withGltfKeys(schema::FieldInfo file);
std::vector<schema::FieldInfo> curvesKeyFields();
std::vector<schema::FieldInfo> pointsKeyFields();

// The property `at` of a type. Requires a member P::keys.
template <typename P> schema::FieldInfo keysField(std::vector<schema::FieldInfo> block) {
    return schema::field<P, std::vector<ShapeKey>>(schema::FieldType::moments, "at", &P::keys)
        .doc("Where the points are at a time, instead of `file` and `points`: the shape deforms. The same points at "
             "every time, in straight lines from one to the next.")
        .example("at \"1/48\" s { points { - 0 0 0; - 1 0 0; - 1 1 0.2 } }")
        .block(std::move(block));
}

class CameraBuilder;

// Made once per definition, placed once or, in objects with lights and planes, once per instance.
struct LoadedShape : UnplacedShape {
    const schema::Definition* definition = nullptr;
    ShapeParams common;
    std::vector<std::uint16_t> faceMaterials;          // of the last placement: of its triangles, then of its quads
    std::size_t strands = 0, segments = 0, points = 0; // of curves and points
    std::size_t dicedTriangles = 0, dicedQuads = 0;    // of the last placement of a subdivision surface
    OpenEdges cageEdges;                               // of a cage that a medium fills
    bool subdivided = false;                           // the limit of a cage
    bool deforms = false;                              // while the shutter is open
    bool sound = false;
    bool texturesChecked = false;
    Meaning meaning; // of what it is, without its place and its materials; where buildings take over from others
    // What its dicing depends on besides, in an object or out of it; empty: nothing.
    std::function<void(DigestWriter&, bool inObject)> view = {};
};

// What a shape gives off.
struct ShapeEmission {
    ScaledCurve radiance; // no curve: none
    const Texture* texture = nullptr;
    Span span; // where the texture is asked for
    bool bothSides = false;
    const EmissionVeil* veil = nullptr;
};

class ShapeBuilder;

// Fills a shape from bound parameters of its registered type: `sound` stays false after an error.
using LoadShape = void (*)(const BindParams&, ShapeBuilder&, LoadedShape&);

class ShapeBuilder {
  public:
    using Definition = schema::Definition;

    ShapeBuilder(BuildContext& context, const SceneMotion& sceneMotion, TextureBuilder& textureBuilder,
                 MediumBuilder& mediumBuilder, MaterialBuilder& materialBuilder, CameraBuilder& cameraBuilder)
        : scene(context), motion(sceneMotion), textures(textureBuilder), media(mediumBuilder),
          materials(materialBuilder), cameras(cameraBuilder) {}

    LoadedShape& loaded(const Definition&);
    // In the space that the map leads to, with the materials of its faces; null after an error. `inObject`: it is seen
    // from many places, or from none that is known yet.
    std::shared_ptr<const Shape> placed(LoadedShape&, const Transform&, bool inObject);
    bool placesInObject() const { return inObject_; } // there is no camera to measure pixels by
    const Shape* keep(std::shared_ptr<const Shape> shape) { return shapes_.emplace_back(std::move(shape)).get(); }
    std::vector<std::shared_ptr<const Shape>> release() { return std::move(shapes_); }
    std::span<const std::shared_ptr<const Shape>> all() const { return shapes_; }
    // The surface of a light: what `addMeaning` adds is all that it depends on besides its place.
    std::shared_ptr<const Shape> lightSurface(const Definition&, const Transform& place,
                                              const std::function<void(DigestWriter&)>& addMeaning,
                                              const std::function<std::unique_ptr<const Shape>()>& make);

    // Its own emission, or else that of its material.
    ShapeEmission emissionOf(const LoadedShape&);

    // For those who load shapes.
    ShapeContext contextOf(const Definition&);
    void noteFiles(const std::vector<struct ShapeKey>&);
    // What the loader of a shape reads and what it states in place: from `make`, which returns null after an error, or
    // from an earlier building. Once for each shape.
    template <typename T, typename Make> std::shared_ptr<const T> data(const LoadedShape& shape, Make make) {
        return scene.reused<T>(Reused::shape, shape.meaning.digest, shape.meaning.spans, std::move(make));
    }
    // For each group of faces the material that it has, by its position in `groupMaterials` from 1 on; 0: the shape's
    // own. Nothing after an error.
    std::optional<std::vector<std::uint16_t>> groupChoices(const ShapeParams&, const std::vector<std::string>& names);
    void chooseFaceMaterials(LoadedShape&, const FaceGroups&);

    BuildContext& scene;
    const SceneMotion& motion;
    TextureBuilder& textures;
    MediumBuilder& media;
    MaterialBuilder& materials;
    CameraBuilder& cameras;

  private:
    void checkInterior(LoadedShape&);
    OpenEdges edgesOf(const LoadedShape&);
    Digest placeDigest(const LoadedShape&, const Transform&, bool inObject);
    std::shared_ptr<const Shape> withFaceMaterials(const LoadedShape&, std::shared_ptr<const Shape>);

    std::map<const Definition*, LoadedShape> loaded_;
    std::vector<std::shared_ptr<const Shape>> shapes_; // those that were placed
    bool inObject_ = false;                            // placed() is running for an object
};

struct CurvesParams;
struct MeshParams;
struct PointsParams;
struct SubdivisionParams;
void loadMeshShape(const MeshParams&, ShapeBuilder&, LoadedShape&);
void loadCurves(const CurvesParams&, ShapeBuilder&, LoadedShape&);
void loadPoints(const PointsParams&, ShapeBuilder&, LoadedShape&);
void loadSubdivision(const SubdivisionParams&, ShapeBuilder&, LoadedShape&);
// The same for shapes with keys: shape_deform.cpp.
void deformMesh(const MeshParams&, ShapeBuilder&, LoadedShape&);
void deformCurves(const CurvesParams&, ShapeBuilder&, LoadedShape&);
void deformPoints(const PointsParams&, ShapeBuilder&, LoadedShape&);

} // namespace abbe
