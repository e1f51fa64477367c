// Subdivision surfaces in scenes: what they may say, also of their displacement, and how they become meshes.
#pragma once

#include "base/diagnostic.h"
#include "geometry/displacement.h"
#include "geometry/subdivision_surface.h"
#include "io/mesh_file.h"
#include "math/mesh_data.h"
#include "render/camera.h"
#include "scene/shape_mesh.h"
#include "schema/type.h"

#include <functional>
#include <optional>
#include <string_view>
#include <vector>

namespace abbe {

// Displacement in scenes: what a shape may say about it, and how that becomes geometry/displacement.h.

struct DisplacementParams {
    std::optional<schema::Quantity> displacement;
    schema::Reference displacementMap;
    std::optional<double> midpoint; // unset: 0.5 for a scalar, 0 for a vector
    std::optional<schema::Choice> displacementKind, displacementSpace;
};

// The map of a definition applied to a cage; `moves` is false without one, or where nothing would move.
struct DisplacementChoice {
    Displacement displacement;
    bool moves = false;
};

// Checks that map and cage fit; nothing after an error. `map` is null where the definition names none.
std::optional<DisplacementChoice> chooseDisplacement(const DisplacementParams&, const Texture* map,
                                                     const SubdivisionCage&, Diagnostics&);

template <typename P> schema::FieldInfo displacementField() {
    using namespace schema;
    return field<P, std::optional<Quantity>>(FieldType::quantity, "displacement", &P::displacement)
        .unit({Dimension::length})
        .range(-1e9, 1e9)
        .synonyms({"displace", "bump", "height"})
        .elsewhere(
            "only `shape subdivision` is displaced; for a polygon mesh write `shape subdivision … { scheme bilinear }`")
        .doc("Moves the surface by the length times the map less its midpoint, in the shape's own space.")
        .example("displacement 2 mm { map noise { scale 1 cm } }")
        .block({
            field<P, Reference>(FieldType::reference, "map", &P::displacementMap)
                .to(Kind::texture)
                .synonyms({"texture", "image"})
                .doc("Name of a texture, or one written in place.")
                .example("map image \"bark.exr\" space=data"),
            field<P, std::optional<double>>(FieldType::number, "midpoint", &P::midpoint)
                .range(-1e9, 1e9)
                .synonyms({"zero-value", "midlevel"})
                .doc("Value of the map that moves nothing; when absent 0.5, with `kind vector` 0.")
                .example("midpoint 0.5"),
            field<P, std::optional<Choice>>(FieldType::choice, "kind", &P::displacementKind)
                .choices({"scalar", "vector"})
                .doc("`scalar` (when absent): the first channel, along the normal. `vector`: three channels.")
                .example("kind vector"),
            field<P, std::optional<Choice>>(FieldType::choice, "space", &P::displacementSpace)
                .choices({"tangent", "object"})
                .doc("What the channels of a vector mean. `tangent` (when absent): along the texture's u, across it, "
                     "and along the normal. `object`: x, y and z.")
                .example("space object"),
        });
}

// Words of its options, in the order of the enumerators of SubdivisionCage.
namespace subdivision_words {
inline constexpr std::string_view kSchemes[] = {"catmull-clark", "loop", "bilinear"};
inline constexpr std::string_view kBoundaries[] = {"none", "edge-only", "edge-and-corner"};
inline constexpr std::string_view kFaceVarying[] = {"none",          "corners-only", "corners-plus1",
                                                    "corners-plus2", "boundaries",   "all"};
inline constexpr std::string_view kCreasings[] = {"uniform", "chaikin"};
} // namespace subdivision_words

struct SubdivisionParams : ShapeParams, DisplacementParams {
    schema::Text file; // resolved path, or empty: points and faces
    std::vector<Vec3d> points;
    schema::IndexRows faces;
    std::vector<double> uvs; // pairs
    schema::IndexRows uvFaces;
    std::vector<schema::NamedNumbers> attributes;
    schema::Choice scheme;
    std::optional<schema::Choice> boundary, faceVarying, creasing; // unset: the file's, or the manual's
    std::vector<schema::SharpRow> creases, corners;
    std::vector<double> holes;
    schema::Quantity dicing;
    double offscreen = 4;
    double memory = 4096;       // MiB
    std::vector<ShapeKey> keys; // instead of file and points: it deforms
};

schema::TypeInfo subdivisionType();

struct LoadedCage {
    SubdivisionCage cage;
    std::vector<CageFile::Group> groups; // of a file
};

// The cage of a definition in its own space: from a file (OBJ or PLY, its coordinates times `unit`) or from points and
// faces, with the properties applied. Sound, or nothing after an error.
std::optional<LoadedCage> loadCage(const SubdivisionParams&, double unit, Span, Diagnostics&);

// How to dice: nothing after an error. Pixels still need a Dicing::pixelSize.
std::optional<Dicing> dicingOf(const schema::Quantity&, Diagnostics&);

// The size of a pixel in the middle of the film, as a function of the distance to the camera, in the space that the
// camera's rays are in. Outside of the picture it grows with the angle to it, up to `offscreen` times: what is not seen
// is still hit by reflections and shadows.
std::function<double(Vec3)> pixelSizeOf(const Camera&, Vec2d filmSize, double offscreen);

// How much a plan makes, in words.
std::string describe(const DicingPlan&);
// Says that the budget `memory` (MiB) lowered the rates of a plan.
void warnOfBudget(const SubdivisionSurface&, const Dicing&, const DicingPlan&, double memory, Span, Diagnostics&,
                  const Displacement* = nullptr);

// Dices in the space that `place` leads to, whose outer side stays outside under mirrors. Before anything large is made
// a warning says if the budget (MiB) lowers the rates. Null after an error located at `span`.
// `faces` receives where those of the cage begin in the mesh.
std::unique_ptr<const Shape> placeSubdivision(SubdivisionCage, const Dicing&, double memory, const Transform& place,
                                              Span, Diagnostics&, std::vector<DicedSurface::Face>* faces = nullptr);
// The same displaced in the cage's own space, before `place`.
std::unique_ptr<const Shape> placeDisplaced(const SubdivisionCage&, const Displacement&, const Dicing&, double memory,
                                            const Transform& place, Span, Diagnostics&,
                                            std::vector<DicedSurface::Face>* faces = nullptr);

} // namespace abbe
