#include "scene/shape_subdivision.h"

#include "geometry/mesh.h"
#include "geometry/shape_params.h"
#include "geometry/subdivision_surface.h"
#include "scene/camera_builder.h"
#include "scene/shape_builder.h"
#include "scene/shape_deform.h"
#include "scene/shape_mesh.h"

#include <algorithm>
#include <iterator>

namespace abbe {

using namespace schema;
using namespace subdivision_words;

namespace {

using SP = SubdivisionParams;

template <std::size_t n> std::vector<std::string_view> words(const std::string_view (&list)[n]) {
    return {list, list + n};
}

// The cage and what its points carry.
std::vector<FieldInfo> cageFields() {
    return {
        field<SP, Text>(FieldType::file, "file", &SP::file)
            .argument(0)
            .group("source")
            .synonyms({"filename", "path"})
            .doc("OBJ file with its creases and other `t` tags, or PLY file: the cage.")
            .example("file \"body.obj\""),
        field<SP, std::vector<Vec3d>>(FieldType::points, "points", &SP::points)
            .unit({Dimension::length})
            .group("source")
            .synonyms({"vertices", "SP", "positions"})
            .doc("Points of the cage, one row of three numbers each, or one long list.")
            .example("points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 1 0 }"),
        field<SP, IndexRows>(FieldType::indexRows, "faces", &SP::faces)
            .synonyms({"indices", "polygons"})
            .doc("Rows of point numbers from 0, counter-clockwise seen from outside; polygons of any size.")
            .example("faces { - 0 1 2 3 }"),
        field<SP, std::vector<double>>(FieldType::numbers, "uvs", &SP::uvs)
            .synonyms({"st", "texture-coordinates", "vt"})
            .doc("Texture coordinates, rows of two numbers: one per point, or those that `uv-faces` names.")
            .example("uvs { - 0 0; - 1 0; - 1 1; - 0 1 }"),
        field<SP, IndexRows>(FieldType::indexRows, "uv-faces", &SP::uvFaces)
            .synonyms({"face-varying-indices", "uv-indices"})
            .doc("The rows of `uvs` that the corners of each face have, like `faces`: seams where neighbours differ.")
            .example("uv-faces { - 0 1 2 3 }"),
        attributeField<SP>(),
    };
}

// How the cage is smoothed.
std::vector<FieldInfo> ruleFields() {
    return {
        field<SP, Choice>(FieldType::choice, "scheme", &SP::scheme)
            .choices(words(kSchemes))
            .byDefault("catmull-clark")
            .synonyms({"type"})
            .doc("How the cage is smoothed: catmull-clark for quads mostly, loop for triangles only; bilinear not at "
                 "all.")
            .example("scheme loop"),
        field<SP, std::optional<Choice>>(FieldType::choice, "boundary", &SP::boundary)
            .choices(words(kBoundaries))
            .synonyms({"interpolateboundary", "interpolate-boundary"})
            .doc("Open edges: the rim faces left out, its edges kept, or its corners too. The file's own choice when "
                 "absent, else edge-and-corner.")
            .example("boundary edge-only"),
        field<SP, std::optional<Choice>>(FieldType::choice, "texture-boundary", &SP::faceVarying)
            .choices(words(kFaceVarying))
            .synonyms({"facevaryinginterpolateboundary", "fvar-interpolation", "face-varying"})
            .doc("Where texture coordinates are linear instead of smooth. The file's own choice when absent, else "
                 "corners-plus1.")
            .example("texture-boundary boundaries"),
        field<SP, std::optional<Choice>>(FieldType::choice, "creasing", &SP::creasing)
            .choices(words(kCreasings))
            .synonyms({"creasemethod", "crease-method"})
            .doc("How sharpness fades along a crease of several values. The file's own choice when absent, else "
                 "uniform.")
            .example("creasing chaikin"),
    };
}

// What stays sharp, and what is left out.
std::vector<FieldInfo> sharpFields() {
    return {
        field<SP, std::vector<SharpRow>>(FieldType::sharpRow, "crease", &SP::creases)
            .synonyms({"creases", "crease-edges"})
            .doc("A chain of points whose edges stay sharp: 0 smooth, 10 (when absent) infinitely sharp.")
            .example("crease 0 1 2 3 sharpness=2.5"),
        field<SP, std::vector<SharpRow>>(FieldType::sharpRow, "corner", &SP::corners)
            .synonyms({"corners", "sharp-vertices"})
            .doc("Points that stay sharp: 0 smooth, 10 (when absent) infinitely sharp.")
            .example("corner 4 7 sharpness=3"),
        field<SP, std::vector<double>>(FieldType::numbers, "holes", &SP::holes)
            .range(0, 4294967294.0)
            .synonyms({"hole"})
            .doc("Numbers of faces, from 0, that shape the surface and are left out.")
            .example("holes 3 4"),
    };
}

// How finely the limit surface is cut.
std::vector<FieldInfo> dicingFields() {
    return {
        field<SP, Quantity>(FieldType::quantity, "dicing", &SP::dicing)
            .unit({Dimension::none, Dimension::pixels, Dimension::length})
            .range(0, 1e15)
            .byDefault("2 px")
            .synonyms({"dicing-rate", "edge-length", "levels", "level", "subdivision-level"})
            .doc("How finely: the length of edges in pixels or as a length, or a level, 0 to 10, that cuts every edge "
                 "into 2^level pieces. Pixels are those in the middle of the picture, at the distance of the edge; in "
                 "an `object` those of the shape filling the height of the picture.")
            .key({"camera", {}, "The camera whose pixels these are, by its name; the render camera when absent."})
            .example("dicing 0.5 px"),
        field<SP, double>(FieldType::number, "offscreen", &SP::offscreen)
            .range(1, 1e6)
            .byDefault("4")
            .doc("How many times longer edges in pixels may be where the camera does not look: 30° outside of the "
                 "picture and behind it. 1: no longer.")
            .example("offscreen 16"),
        displacementField<SP>(),
        field<SP, double>(FieldType::number, "memory", &SP::memory)
            .range(1, 1e9)
            .byDefault("4096")
            .doc("Most memory for the diced surface, in MiB: a finer `dicing` is made coarser, with a warning.")
            .example("memory 512"),
    };
}

} // namespace

TypeInfo subdivisionType() {
    std::vector<FieldInfo> fields = cageFields();
    for (const auto more : {ruleFields, sharpFields, dicingFields})
        std::ranges::move(more(), std::back_inserter(fields));
    fields.push_back(keysField<SP>(meshKeyFields()));
    addGroupedShapeFields<SP>(fields);
    return {Kind::shape,
            "subdivision",
            "Smooth limit surface of a polygon cage.",
            "shape subdivision \"body.obj\" { crease 0 1 2 sharpness=3; material diffuse }",
            false,
            std::move(fields)};
}

using Cage = SubdivisionCage;

namespace {

// A mirror turns a surface inside out: this turns it back.
void turnRound(MeshData& mesh) {
    for (Vec3& n : mesh.normals) n = -n;
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    for (auto& q : mesh.quads) std::swap(q[1], q[3]);
}

std::optional<DicedSurface> dice(const Cage& cage, const Dicing& dicing, double memory, Span span,
                                 Diagnostics& diagnostics, const Displacement* displacement = nullptr) {
    const SubdivisionSurface surface(cage);
    const DicingPlan plan = surface.plan(dicing, static_cast<std::uint64_t>(memory * (1 << 20)), displacement);
    if (plan.coarser > 1) warnOfBudget(surface, dicing, plan, memory, span, diagnostics, displacement);
    try {
        return surface.dice(plan, displacement);
    } catch (const std::bad_alloc&) {
        diagnostics.error("E0404", span, "the diced surface does not fit into memory", describe(plan));
        return std::nullopt;
    }
}

std::unique_ptr<const Shape> unlessEmpty(std::unique_ptr<const Mesh> shape, Span span, Diagnostics& diagnostics) {
    if (shape->area() > 0) return shape;
    diagnostics.error("E0604", span, "this subdivision surface has no faces with an area", "nothing to see here").help =
        "holes are left out, and with `boundary none` all faces at open edges";
    return nullptr;
}

} // namespace

std::unique_ptr<const Shape> placeSubdivision(Cage cage, const Dicing& dicing, double memory, const Transform& place,
                                              Span span, Diagnostics& diagnostics,
                                              std::vector<DicedSurface::Face>* faces) {
    for (Vec3& p : cage.positions) p = Vec3(place.point(Vec3d(p))); // the limit of the image is the image of the limit
    if (findFault(cage)) {
        diagnostics.error("E0605", span, "a shape reaches farther than 1e15 m from the camera", "too far away");
        return nullptr;
    }
    auto diced = dice(cage, dicing, memory, span, diagnostics);
    if (!diced) return nullptr;
    if (faces) *faces = std::move(diced->faces);
    if (place.determinant() < 0) turnRound(diced->mesh);
    return unlessEmpty(std::make_unique<const Mesh>(std::move(diced->mesh)), span, diagnostics);
}

std::unique_ptr<const Shape> placeDisplaced(const Cage& cage, const Displacement& displacement, const Dicing& dicing,
                                            double memory, const Transform& place, Span span, Diagnostics& diagnostics,
                                            std::vector<DicedSurface::Face>* faces) {
    Dicing placed = dicing;
    placed.place = place;
    auto diced = dice(cage, placed, memory, span, diagnostics, &displacement);
    if (!diced) return nullptr;
    if (faces) *faces = std::move(diced->faces);
    auto shape = placeMesh(std::move(diced->mesh), place, span, diagnostics);
    if (!shape) return nullptr;
    return unlessEmpty(std::unique_ptr<const Mesh>(static_cast<const Mesh*>(shape.release())), span, diagnostics);
}

namespace {

// The material of each face of a cage, as groupChoices() numbers them: empty if all have the shape's own.
std::optional<std::vector<std::uint16_t>> cageChoices(const ShapeParams& params, const LoadedCage& loaded,
                                                      ShapeBuilder& builder) {
    if (params.groupMaterials.empty()) return std::vector<std::uint16_t>{};
    std::vector<std::string> names;
    for (const CageFile::Group& group : loaded.groups) names.push_back(group.name);
    const auto ofGroup = builder.groupChoices(params, names);
    if (!ofGroup) return std::nullopt;
    std::vector<std::uint16_t> ofFace(loaded.cage.faceSizes.size());
    for (std::size_t g = 0; g < names.size(); ++g)
        std::fill(ofFace.begin() + static_cast<std::ptrdiff_t>(loaded.groups[g].firstFace), ofFace.end(),
                  (*ofGroup)[g]); // the next group begins where this one ends
    return ofFace;
}

// Everything about a subdivision surface that does not depend on where it stands.
struct CageToPlace {
    std::shared_ptr<const Cage> cage;
    std::shared_ptr<const CageKeys> keys;
    Dicing dicing;
    schema::Quantity asked; // of the dicing
    double offscreen, memory;
    std::vector<std::uint16_t> choices; // see cageChoices
    DisplacementChoice displacement;
    std::function<bool()> readMap; // of a displacement: into memory; false after an error
};

// Places it, and counts in `shape` what it is diced into.
std::unique_ptr<const Shape> placeCage(const CageToPlace& c, const ShapeContext& context, CameraBuilder& cameras,
                                       bool inObject, const Transform& place, LoadedShape& shape) {
    if (c.displacement.moves && !c.readMap()) return nullptr;
    const Dicing rate = cameras.dicingFor(c.dicing, c.asked, c.offscreen, *c.cage, place, inObject);
    std::vector<DicedSurface::Face> faces;
    const Displacement* const moves = c.displacement.moves ? &c.displacement.displacement : nullptr;
    const Span span = context.span;
    auto placed = !c.keys->times.empty() ? placeCageKeys(*c.cage, *c.keys, context.shutter, moves, rate, c.memory,
                                                         place, span, context.diagnostics, &faces)
                  : moves ? placeDisplaced(*c.cage, *moves, rate, c.memory, place, span, context.diagnostics, &faces)
                          : placeSubdivision(*c.cage, rate, c.memory, place, span, context.diagnostics, &faces);
    if (!placed) return placed;
    shape.dicedTriangles = faces.back().firstTriangle;
    shape.dicedQuads = faces.back().firstQuad;
    if (c.choices.empty()) return placed;
    shape.faceMaterials.assign(shape.dicedTriangles + shape.dicedQuads, 0);
    for (std::size_t f = 0; f < c.choices.size(); ++f) {
        auto* const first = shape.faceMaterials.data();
        std::fill(first + faces[f].firstTriangle, first + faces[f + 1].firstTriangle, c.choices[f]);
        std::fill(first + shape.dicedTriangles + faces[f].firstQuad,
                  first + shape.dicedTriangles + faces[f + 1].firstQuad, c.choices[f]);
    }
    return placed;
}

// What is read from files or stated in place.
struct CageData {
    LoadedCage loaded;
    CageKeys keys;
};

// The map is read when a surface is diced that is not there already; what is wrong with it is said once.
std::function<bool()> mapReader(TextureBuilder& textures, schema::Reference map, Span user) {
    return [&textures, map, user, good = std::make_shared<std::optional<bool>>()] {
        if (!*good) *good = textures.textureFor(map, TextureUse::heights, user) != nullptr;
        return **good;
    };
}

} // namespace

void loadSubdivision(const SubdivisionParams& params, ShapeBuilder& builder, LoadedShape& shape) {
    const ShapeContext context = builder.contextOf(*shape.definition);
    Diagnostics& diagnostics = context.diagnostics;
    shape.subdivided = true;
    const auto dicing = dicingOf(params.dicing, diagnostics);
    SubdivisionParams stated = params;
    if (!useFirstKey(stated, diagnostics)) return;
    const auto data = builder.data<CageData>(shape, [&]() -> std::shared_ptr<const CageData> {
        auto loaded = loadCage(stated, context.unit, context.span, diagnostics);
        if (!loaded) return nullptr;
        auto keys = loadCageKeys(params, loaded->cage, context.unit, diagnostics);
        return keys ? std::make_shared<const CageData>(CageData{std::move(*loaded), std::move(*keys)}) : nullptr;
    });
    if (!builder.cameras.checkDicingCamera(params.dicing) || !data || !dicing) return;
    if (!params.file.value.empty()) builder.scene.noteFile(params.file.value);
    builder.noteFiles(params.keys);
    const SubdivisionCage& outline = data->loaded.cage;
    auto choices = cageChoices(params, data->loaded, builder);
    if (!choices) return;
    const Texture* const map = builder.textures.unprepared(params.displacementMap);
    auto displacement = chooseDisplacement(params, map, outline, diagnostics);
    if (!displacement) return;
    if (displacement->moves && builder.scene.leavesOut({SwitchedEffect::displacement}, context.span))
        displacement.emplace();
    shape.sound = true;
    shape.deforms = !data->keys.times.empty() && builder.motion.deforms(data->keys.times);
    if (builder.materials.holdsMedium(params)) shape.cageEdges = openEdges(outline);
    const Span user = params.displacement ? params.displacement->span : context.span;
    CageToPlace cage{
        {data, &outline},    {data, &data->keys}, *dicing,
        params.dicing,       params.offscreen,    params.memory,
        std::move(*choices), *displacement,       mapReader(builder.textures, params.displacementMap, user)};
    shape.view = [&builder, dicing = *dicing, asked = params.dicing, offscreen = params.offscreen](DigestWriter& writer,
                                                                                                   bool inObject) {
        builder.cameras.addView(writer, dicing, asked, offscreen, inObject);
    };
    shape.place = [&builder, &shape, context, cage = std::move(cage)](const Transform& place) {
        return placeCage(cage, context, builder.cameras, builder.placesInObject(), place, shape);
    };
}

} // namespace abbe
