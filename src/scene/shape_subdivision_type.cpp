#include "scene/shape_mesh.h"
#include "scene/shape_subdivision.h"

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

} // namespace abbe
