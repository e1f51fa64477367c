// Shapes that deform: their keys, cut to the time that the shutter is open and put onto equally spaced steps.
#pragma once

#include "base/diagnostic.h"
#include "geometry/deforming_mesh.h"
#include "geometry/subdivision_surface.h"
#include "math/mesh_data.h"
#include "math/motion.h"
#include "math/transform.h"
#include "scene/shape_builder.h"
#include "scene/shape_mesh.h"
#include "scene/shape_points.h"

#include <algorithm>
#include <span>

namespace abbe {

struct SubdivisionParams;

// What deforms, at every key; faces, texture coordinates, strands and forms are those of the first.
template <typename T> struct Keys {
    std::vector<double> times;
    std::vector<T> states; // one for each time
};
using MeshKeys = Keys<MeshData>; // all but the first have positions and normals only
using CageKeys = Keys<std::vector<Vec3>>;
using CurveKeys = Keys<CurveData>;
using PointKeys = Keys<PointData>;

// What every type asks of its blocks: one source each, none beside them, and no emission. False after an error.
bool checkKeys(const ShapeParams&, const std::vector<ShapeKey>&, bool hasOwnPoints, bool hasOwnRadius, Diagnostics&);

// The points of every key. Located errors if they are not the same ones; then, and after others, nothing.
// `groups` receives those of the first file.
std::optional<MeshKeys> loadMeshKeys(const MeshParams&, double unit, bool zUp, FaceGroups* groups, Diagnostics&);
// Checks the keys of a subdivision surface and states the points of the first in place of its own. True without keys.
bool useFirstKey(SubdivisionParams&, Diagnostics&);
// Of all keys, empty without any; `first` is the cage of the first one.
std::optional<CageKeys> loadCageKeys(const SubdivisionParams&, const SubdivisionCage& first, double unit, Diagnostics&);
std::optional<CurveKeys> loadCurveKeys(const CurvesParams&, double unit, Diagnostics&);
std::optional<PointKeys> loadPointKeys(const PointsParams&, double unit, Diagnostics&);

// Shapes in the space that `place` leads to, as they move during the interval; one that stands still if nothing
// changes. A warning says if steps cannot hold the keys exactly. Null after an error located at `span`.
std::unique_ptr<const Shape> placeMeshKeys(const MeshKeys&, Interval, const Transform& place, Span, Diagnostics&);
std::unique_ptr<const Shape> placeCurveKeys(const CurveKeys&, Interval, const Transform& place, Span, Diagnostics&);
std::unique_ptr<const Shape> placePointKeys(const PointKeys&, Interval, const Transform& place, Span, Diagnostics&);
// `faces` receives where those of the cage begin in the mesh.
std::unique_ptr<const Shape> placeCageKeys(SubdivisionCage, const CageKeys&, Interval, const Displacement*, Dicing,
                                           double memory, const Transform& place, Span, Diagnostics&,
                                           std::vector<DicedSurface::Face>* faces);
// From meshes of the same faces at the steps of a grid, in their own space.
std::unique_ptr<const Shape> placeMeshSteps(MeshData faces, std::vector<MeshStep>, const Transform& place, Span,
                                            Diagnostics&);

KeyGrid gridOf(std::span<const double> times, Interval);
// Values between two keys, whose number both have. Directions become unit vectors.
std::vector<Vec3> stateOf(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double fraction);
std::vector<SizedPoint> stateOf(const std::vector<SizedPoint>& a, const std::vector<SizedPoint>& b, double fraction);
std::vector<Vec3> directionsOf(const std::vector<Vec3>& a, const std::vector<Vec3>& b, double fraction);

// Says how far keys that are no steps move. `state(i)` and `step(i)` are the points of a key and of a step.
double offGridDistance(const std::vector<Vec3>& key, const std::vector<Vec3>& instead, const Transform& place);
double offGridDistance(const std::vector<SizedPoint>& key, const std::vector<SizedPoint>& instead, const Transform&);
void warnOffGrid(double distance, Span, Diagnostics&);
// E0680: a key has not the points of the first one. False.
bool mismatch(Span, Diagnostics&, const std::string& message);

template <typename State, typename Step>
void warnOffGrid(const KeyGrid& grid, State state, Step step, const Transform& place, Span span,
                 Diagnostics& diagnostics) {
    double distance = 0;
    for (const KeyGrid::Between& b : grid.offGrid)
        distance = std::max(distance,
                            offGridDistance(state(b.key), stateOf(step(b.step), step(b.step + 1), b.fraction), place));
    warnOffGrid(distance, span, diagnostics);
}

// The state at a position among keys, of the member that `get` reads from a key.
template <typename T, typename Get> auto stateAt(const Keys<T>& keys, KeyPosition p, Get get) {
    auto state = get(keys.states[p.key]);
    return p.fraction == 0 ? state : stateOf(state, get(keys.states[p.key + 1]), p.fraction);
}
template <typename T, typename Get> std::vector<Vec3> directionsAt(const Keys<T>& keys, KeyPosition p, Get get) {
    std::vector<Vec3> state = get(keys.states[p.key]);
    return p.fraction == 0 ? state : directionsOf(state, get(keys.states[p.key + 1]), p.fraction);
}

} // namespace abbe
