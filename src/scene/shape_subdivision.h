// Subdivision surfaces in scenes: what they may say, and how they become meshes.
#pragma once

#include "geometry/subdivision_surface.h"
#include "io/mesh_file.h"
#include "render/camera.h"
#include "scene/shape_displacement.h"
#include "scene/shape_mesh.h"

#include <functional>
#include <string_view>

namespace abbe {

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
// is still met by reflections and shadows.
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
