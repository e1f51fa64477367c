// The limit surface a second way: uniform refinement in double precision, then the library's limit masks at the
// refined vertices. Nothing here goes through the patches that the renderer dices.
#pragma once

#include "geometry/subdivision_surface.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <map>
#include <memory>
#include <opensubdiv/far/primvarRefiner.h>
#include <opensubdiv/far/topologyDescriptor.h>
#include <set>
#include <vector>

namespace abbe::test {

struct ReferenceVertex {
    Vec3d position;
    Vec3d normal;       // 0 where there is none, or none that is soon reached
    bool smooth = true; // one tangent plane: no corner and no crease
};

namespace detail {

struct Vertex {
    Vec3d p;
    void Clear(void* = nullptr) { p = {}; }
    void AddWithWeight(const Vertex& v, double w) { p += v.p * w; }
};

inline OpenSubdiv::Sdc::SchemeType scheme(const SubdivisionCage& cage) {
    using namespace OpenSubdiv;
    return cage.scheme == SubdivisionCage::Scheme::loop       ? Sdc::SCHEME_LOOP
           : cage.scheme == SubdivisionCage::Scheme::bilinear ? Sdc::SCHEME_BILINEAR
                                                              : Sdc::SCHEME_CATMARK;
}

inline OpenSubdiv::Sdc::Options options(const SubdivisionCage& cage) {
    using Options = OpenSubdiv::Sdc::Options;
    Options o;
    o.SetVtxBoundaryInterpolation(cage.boundary == SubdivisionCage::Boundary::none ? Options::VTX_BOUNDARY_NONE
                                  : cage.boundary == SubdivisionCage::Boundary::edgeOnly
                                      ? Options::VTX_BOUNDARY_EDGE_ONLY
                                      : Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    if (cage.creasing == SubdivisionCage::Creasing::chaikin) o.SetCreasingMethod(Options::CREASE_CHAIKIN);
    if (cage.smoothTriangles) o.SetTriangleSubdivision(Options::TRI_SUB_SMOOTH);
    return o;
}

inline std::unique_ptr<OpenSubdiv::Far::TopologyRefiner> refiner(const SubdivisionCage& cage, int level) {
    using namespace OpenSubdiv;
    const std::vector<int> sizes(cage.faceSizes.begin(), cage.faceSizes.end());
    const std::vector<int> corners(cage.corners.begin(), cage.corners.end());
    const std::vector<int> holes(cage.holes.begin(), cage.holes.end());
    std::vector<int> ends, sharp;
    std::vector<float> creaseWeights, cornerWeights;
    for (const auto& c : cage.creases) {
        ends.push_back(static_cast<int>(c.a));
        ends.push_back(static_cast<int>(c.b));
        creaseWeights.push_back(c.sharpness);
    }
    for (const auto& c : cage.sharpCorners) {
        sharp.push_back(static_cast<int>(c.vertex));
        cornerWeights.push_back(c.sharpness);
    }
    Far::TopologyDescriptor d;
    d.numVertices = static_cast<int>(cage.positions.size());
    d.numFaces = static_cast<int>(sizes.size());
    d.numVertsPerFace = sizes.data();
    d.vertIndicesPerFace = corners.data();
    d.numCreases = static_cast<int>(creaseWeights.size());
    d.creaseVertexIndexPairs = ends.data();
    d.creaseWeights = creaseWeights.data();
    d.numCorners = static_cast<int>(sharp.size());
    d.cornerVertexIndices = sharp.data();
    d.cornerWeights = cornerWeights.data();
    d.numHoles = static_cast<int>(holes.size());
    d.holeIndices = holes.data();
    using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::unique_ptr<Far::TopologyRefiner> result(Factory::Create(d, Factory::Options(scheme(cage), options(cage))));
    Far::TopologyRefiner::UniformOptions uniform(level);
    uniform.fullTopologyInLastLevel = true;
    result->RefineUniform(uniform);
    return result;
}

} // namespace detail

// Edges between the infinitely sharp ones around a crease vertex bound a single face. There the normal reaches its
// limit only with the logarithm of the distance (the eigenvalue 1/4 of the crease rules has a Jordan block), and at
// corners amid smooth edges the surface is a spike without a normal.
inline bool hasSlowNormal(const OpenSubdiv::Far::TopologyLevel& level, int v) {
    using OpenSubdiv::Sdc::Crease;
    if (Crease::IsInfinite(level.GetVertexSharpness(v)) || level.IsVertexNonManifold(v)) return true;
    const auto edges = level.GetVertexEdges(v);
    std::set<int> sharp;
    for (const int e : edges)
        if (Crease::IsInfinite(level.GetEdgeSharpness(e))) sharp.insert(e);
    if (sharp.empty()) return false;
    const auto faces = level.GetVertexFaces(v);
    const auto locals = level.GetVertexFaceLocalIndices(v);
    for (int i = 0; i < faces.size(); ++i) {
        const auto around = level.GetFaceEdges(faces[i]);
        const int a = around[locals[i]], b = around[(locals[i] + around.size() - 1) % around.size()];
        if (sharp.contains(a) && sharp.contains(b)) return true;
    }
    return false;
}

// The vertices of the cage refined `level` times, moved to the limit. The masks that do so know creases that end only
// approximately, so they are applied `deeper` levels below. Vertices of holes alone are left out.
inline std::vector<ReferenceVertex> referenceLimit(const SubdivisionCage& cage, int level, int deeper) {
    using namespace OpenSubdiv;
    const auto refiner = detail::refiner(cage, level + deeper);
    const Far::PrimvarRefinerReal<double> primvars(*refiner);
    std::vector<detail::Vertex> now(cage.positions.size());
    for (std::size_t i = 0; i < now.size(); ++i) now[i].p = Vec3d(cage.positions[i]);
    for (int l = 1; l <= level + deeper; ++l) {
        std::vector<detail::Vertex> next(static_cast<std::size_t>(refiner->GetLevel(l).GetNumVertices()));
        primvars.Interpolate(l, now, next);
        now = std::move(next);
    }
    std::vector<detail::Vertex> limit(now.size()), du(now.size()), dv(now.size());
    primvars.Limit(now, limit, du, dv);
    const Far::TopologyLevel& last = refiner->GetLevel(level + deeper);
    std::vector<ReferenceVertex> result;
    for (int start = 0; start < refiner->GetLevel(level).GetNumVertices(); ++start) {
        int v = start;
        for (int l = level; l < level + deeper; ++l) v = refiner->GetLevel(l).GetVertexChildVertex(v);
        const auto faces = last.GetVertexFaces(v);
        if (std::all_of(faces.begin(), faces.end(), [&](int f) { return last.IsFaceHole(f); })) continue;
        const auto i = static_cast<std::size_t>(v);
        const Vec3d n = cross(du[i].p, dv[i].p);
        const double scale = length(du[i].p) * length(dv[i].p);
        const auto rule = last.GetVertexRule(v);
        const bool slow = hasSlowNormal(last, v);
        bool crease = false;
        for (const int e : last.GetVertexEdges(v)) crease = crease || last.GetEdgeSharpness(e) > 0;
        const bool defined = !slow && scale > 0 && length(n) > 1e-3 * scale;
        result.push_back(
            {limit[i].p, defined ? normalize(n) : Vec3d{},
             rule == Sdc::Crease::RULE_SMOOTH && !crease && cage.scheme != SubdivisionCage::Scheme::bilinear});
    }
    return result;
}

inline double sizeOf(const SubdivisionCage& cage) {
    Vec3 lower(kInfinity, kInfinity, kInfinity), upper(-kInfinity, -kInfinity, -kInfinity);
    for (const Vec3 p : cage.positions) lower = min(lower, p), upper = max(upper, p);
    return static_cast<double>(length(upper - lower));
}

struct Agreement {
    std::size_t vertices = 0, normals = 0; // of the reference, compared
    double distance = 0;                   // largest, to the nearest diced vertex and back, over the size of the cage
    double angle = 0;                      // largest, of the best diced normal at the place, degrees
    double worstSmooth = 0;                // largest, of any diced normal at a smooth place, degrees
    double uncompared = 0;                 // share of reference vertices without a normal
};

// Diced vertices in space, to be found by place.
class VertexGrid {
  public:
    VertexGrid(const std::vector<Vec3>& points, double cell) : points_(points), cell_(cell) {
        for (std::size_t i = 0; i < points.size(); ++i) cells_[key(Vec3d(points[i]))].push_back(i);
    }
    // Calls body(i, distance) for all points within a cell's width.
    template <typename Body> void near(Vec3d p, const Body& body) const {
        const auto k = key(p);
        for (long x = -1; x <= 1; ++x)
            for (long y = -1; y <= 1; ++y)
                for (long z = -1; z <= 1; ++z) {
                    const auto found = cells_.find({k[0] + x, k[1] + y, k[2] + z});
                    if (found == cells_.end()) continue;
                    for (const std::size_t i : found->second) {
                        const double d = length(Vec3d(points_[i]) - p);
                        if (d <= cell_) body(i, d);
                    }
                }
    }

  private:
    using Key = std::array<long, 3>;
    Key key(Vec3d p) const { return {std::lround(p.x / cell_), std::lround(p.y / cell_), std::lround(p.z / cell_)}; }
    const std::vector<Vec3>& points_;
    double cell_;
    std::map<Key, std::vector<std::size_t>> cells_;
};

inline double degreesBetween(Vec3d a, Vec3d b) { return std::atan2(length(cross(a, b)), dot(a, b)) * 180 / kPiD; }

// Compares the surface diced at a level with the reference refined as often: the same points of the limit.
inline Agreement compareWithReference(const SubdivisionCage& cage, const MeshData& mesh, int level, int deeper) {
    const std::vector<ReferenceVertex> reference = referenceLimit(cage, level, deeper);
    const double size = sizeOf(cage), reach = 1e-2 * size;
    const VertexGrid diced(mesh.positions, reach);
    Agreement a;
    std::size_t none = 0;
    for (const ReferenceVertex& r : reference) {
        double nearest = 1e9, best = 180, worst = 0;
        diced.near(r.position, [&](std::size_t, double d) { nearest = std::min(nearest, d); });
        a.distance = std::max(a.distance, nearest / size);
        ++a.vertices;
        if (!(length(r.normal) > 0)) {
            ++none;
            continue;
        }
        // Sheets may touch: only the vertices of this very place count.
        diced.near(r.position, [&](std::size_t i, double d) {
            if (d > nearest + 1e-6 * size) return;
            const double angle = degreesBetween(Vec3d(mesh.normals[i]), r.normal);
            best = std::min(best, angle);
            worst = std::max(worst, angle);
        });
        ++a.normals;
        a.angle = std::max(a.angle, best);
        if (r.smooth) a.worstSmooth = std::max(a.worstSmooth, worst);
    }
    a.uncompared = static_cast<double>(none) / static_cast<double>(std::max<std::size_t>(reference.size(), 1));
    std::vector<Vec3> points;
    for (const ReferenceVertex& r : reference) points.push_back(Vec3(r.position));
    const VertexGrid back(points, reach);
    for (const Vec3 p : mesh.positions) {
        double nearest = 1e9;
        back.near(Vec3d(p), [&](std::size_t, double d) { nearest = std::min(nearest, d); });
        a.distance = std::max(a.distance, nearest / size);
    }
    return a;
}

// Edges of a mesh, its vertices told apart by the bits of their positions alone, that do not join exactly two faces
// running against each other. 0: closed, and the same to a ray.
inline std::size_t openEdges(const MeshData& m) {
    std::map<std::array<float, 3>, std::uint32_t> places;
    std::vector<std::uint32_t> place;
    for (const Vec3 p : m.positions)
        place.push_back(places.try_emplace({p.x, p.y, p.z}, static_cast<std::uint32_t>(places.size())).first->second);
    std::map<std::pair<std::uint32_t, std::uint32_t>, int> edges;
    const auto add = [&](std::uint32_t a, std::uint32_t b) {
        a = place[a], b = place[b];
        if (a < b) ++edges[{a, b}];
        if (b < a) --edges[{b, a}];
    };
    for (const auto& t : m.triangles)
        for (std::size_t i = 0; i < 3; ++i) add(t[i], t[(i + 1) % 3]);
    for (const auto& q : m.quads)
        for (std::size_t i = 0; i < 4; ++i) add(q[i], q[(i + 1) % 4]);
    return static_cast<std::size_t>(
        std::count_if(edges.begin(), edges.end(), [](const auto& e) { return e.second != 0; }));
}

} // namespace abbe::test
