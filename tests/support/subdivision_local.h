// A level-10 refinement of a cage, one face at a time: a face and the faces around it hold all that the next level of
// that face needs, so that ten levels cost ten small refinements, however large the cage. Every level is the
// library's uniform refinement of a mesh of its own: no patch and no limit mask takes part.
#pragma once

#include "support/subdivision_reference.h"

#include <array>

namespace abbe::test {

// A face with the faces that share a vertex with it. What lies beyond is missing, so the rules of the vertices at the
// rim are wrong; the rules of the vertices and edges at the face itself, which alone make its children and the faces
// around these, are right.
class LocalMesh {
  public:
    // Face `face` of the cage.
    LocalMesh(const SubdivisionCage& cage, std::uint32_t face) {
        options_.scheme = cage.scheme;
        options_.boundary = cage.boundary;
        options_.creasing = cage.creasing;
        options_.smoothTriangles = cage.smoothTriangles;
        std::vector<std::uint32_t> first{0};
        for (const std::uint32_t n : cage.faceSizes) first.push_back(first.back() + n);
        std::set<std::uint32_t> mine(cage.corners.begin() + first[face], cage.corners.begin() + first[face + 1]);
        std::vector<std::uint32_t> ring{face};
        for (std::uint32_t f = 0; f < cage.faceSizes.size(); ++f)
            for (std::uint32_t c = first[f]; c < first[f + 1]; ++c)
                if (f != face && mine.contains(cage.corners[c])) {
                    ring.push_back(f);
                    break;
                }
        for (const std::uint32_t f : ring)
            addFace(std::vector<int>(cage.corners.begin() + first[f], cage.corners.begin() + first[f + 1]),
                    [&](int v) { return Vec3d(cage.positions[static_cast<std::size_t>(v)]); });
        for (const auto& c : cage.creases) addCrease(static_cast<int>(c.a), static_cast<int>(c.b), c.sharpness);
        for (const auto& c : cage.sharpCorners) addCorner(static_cast<int>(c.vertex), c.sharpness);
    }

    int corners() const { return sizes_[0]; }
    Vec3d position(int corner) const { return positions_[static_cast<std::size_t>(vertex(corner))]; }
    // The face as it is seen from a corner: perpendicular to the edges there, 0 where these vanish or are parallel.
    Vec3d normal(int corner) const {
        const int n = corners();
        const Vec3d p = position(corner);
        const Vec3d a = position((corner + 1) % n) - p, b = position((corner + n - 1) % n) - p;
        const Vec3d c = cross(a, b);
        return length(c) > 1e-3 * length(a) * length(b) ? normalize(c) : Vec3d{};
    }

    // Puts a corner at the origin, so that rounding shrinks with the face.
    void center(int corner) {
        const Vec3d by = position(corner);
        for (Vec3d& p : positions_) p = p - by;
    }

    // The child at each corner of the face, whose own corner of the same place has the number `turned` of that child.
    struct Child;
    std::vector<Child> children() const;
    // The vertex has no tangent plane in this face, or one that is reached too slowly to be seen at level 10.
    bool hasSlowNormal(int corner) const {
        const auto refined = refiner();
        const OpenSubdiv::Far::TopologyLevel& level = refined->GetLevel(0);
        const int v = vertex(corner);
        // Two faces about an inner vertex fold over.
        if (level.GetVertexFaces(v).size() == 2 && !level.IsVertexBoundary(v)) return true;
        return abbe::test::hasSlowNormal(level, v);
    }

  private:
    int vertex(int corner) const { return vertices_[static_cast<std::size_t>(corner)]; }
    LocalMesh(const LocalMesh& parent, const OpenSubdiv::Far::TopologyLevel& level, int face,
              const std::vector<detail::Vertex>& points)
        : options_(parent.options_) {
        std::vector<int> ring{face};
        for (const int v : level.GetFaceVertices(face))
            for (const int f : level.GetVertexFaces(v))
                if (std::find(ring.begin(), ring.end(), f) == ring.end()) ring.push_back(f);
        std::set<int> edges;
        for (const int f : ring) {
            const auto around = level.GetFaceVertices(f);
            addFace(std::vector<int>(around.begin(), around.end()),
                    [&](int v) { return points[static_cast<std::size_t>(v)].p; });
            for (const int e : level.GetFaceEdges(f)) edges.insert(e);
        }
        for (const int e : edges) {
            const auto ends = level.GetEdgeVertices(e);
            if (level.GetEdgeSharpness(e) > 0) addCrease(ends[0], ends[1], level.GetEdgeSharpness(e));
        }
        const std::map<int, int> all = number_;
        for (const auto& [v, local] : all)
            if (level.GetVertexSharpness(v) > 0) addCorner(v, level.GetVertexSharpness(v));
    }

    template <typename Position> void addFace(const std::vector<int>& around, const Position& position) {
        sizes_.push_back(static_cast<int>(around.size()));
        for (const int v : around) {
            const auto [found, isNew] = number_.try_emplace(v, static_cast<int>(positions_.size()));
            if (isNew) positions_.push_back(position(v));
            vertices_.push_back(found->second);
        }
    }
    void addCrease(int a, int b, float sharpness) {
        const auto i = number_.find(a), j = number_.find(b);
        if (i == number_.end() || j == number_.end()) return;
        creaseEnds_.push_back(i->second);
        creaseEnds_.push_back(j->second);
        creases_.push_back(sharpness);
    }
    void addCorner(int v, float sharpness) {
        const auto i = number_.find(v);
        if (i == number_.end()) return;
        cornerVertices_.push_back(i->second);
        cornerSharpness_.push_back(sharpness);
    }

    std::unique_ptr<OpenSubdiv::Far::TopologyRefiner> refiner() const {
        using namespace OpenSubdiv;
        Far::TopologyDescriptor d;
        d.numVertices = static_cast<int>(positions_.size());
        d.numFaces = static_cast<int>(sizes_.size());
        d.numVertsPerFace = sizes_.data();
        d.vertIndicesPerFace = vertices_.data();
        d.numCreases = static_cast<int>(creases_.size());
        d.creaseVertexIndexPairs = creaseEnds_.data();
        d.creaseWeights = creases_.data();
        d.numCorners = static_cast<int>(cornerVertices_.size());
        d.cornerVertexIndices = cornerVertices_.data();
        d.cornerWeights = cornerSharpness_.data();
        using Factory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
        return std::unique_ptr<Far::TopologyRefiner>(
            Factory::Create(d, Factory::Options(detail::scheme(options_), detail::options(options_))));
    }

    SubdivisionCage options_; // nothing but the options
    std::vector<Vec3d> positions_;
    std::map<int, int> number_;         // of the vertices in the mesh that this one is a part of
    std::vector<int> sizes_, vertices_; // the face itself comes first
    std::vector<int> creaseEnds_, cornerVertices_;
    std::vector<float> creases_, cornerSharpness_;
};

struct LocalMesh::Child {
    LocalMesh mesh;
    int turned;
};

inline std::vector<LocalMesh::Child> LocalMesh::children() const {
    using namespace OpenSubdiv;
    const auto refined = refiner();
    Far::TopologyRefiner::UniformOptions uniform(1);
    uniform.fullTopologyInLastLevel = true;
    refined->RefineUniform(uniform);
    std::vector<detail::Vertex> now(positions_.size());
    for (std::size_t i = 0; i < now.size(); ++i) now[i].p = positions_[i];
    const Far::TopologyLevel& level = refined->GetLevel(1);
    std::vector<detail::Vertex> next(static_cast<std::size_t>(level.GetNumVertices()));
    Far::PrimvarRefinerReal<double>(*refined).Interpolate(1, now, next);
    std::vector<Child> result;
    const auto faces = refined->GetLevel(0).GetFaceChildFaces(0); // in the order of the corners, under Loop one more
    for (int corner = 0; corner < corners(); ++corner) {
        const int vertex = refined->GetLevel(0).GetVertexChildVertex(this->vertex(corner));
        result.push_back(
            {LocalMesh(*this, level, faces[corner], next), level.GetFaceVertices(faces[corner]).FindIndex(vertex)});
    }
    return result;
}

// A vertex of a face of the cage refined a few times, followed further inside of that face. The face that it is a
// corner of is turned away from the limit by its size over the radius of curvature, and a semi-sharp crease is a round
// edge as narrow as the faces that its sharpness leaves: positions are taken at level 10, normals at level 20.
struct LocalVertex {
    Vec3d position;
    Vec3d normal;      // 0 where there is none
    bool slow = false; // the normal is reached too slowly to be compared
};
inline constexpr int kPositionLevel = 10, kNormalLevel = 40;

namespace detail {

inline LocalVertex follow(LocalMesh mesh, int corner, int level) {
    LocalVertex result;
    Vec3d origin;
    for (; level < kNormalLevel; ++level) {
        if (level == kPositionLevel) result.position = origin + mesh.position(corner);
        origin = origin + mesh.position(corner);
        mesh.center(corner);
        std::vector<LocalMesh::Child> children = mesh.children();
        LocalMesh::Child child = std::move(children[static_cast<std::size_t>(corner)]);
        corner = child.turned;
        mesh = std::move(child.mesh);
    }
    result.normal = mesh.normal(corner);
    result.slow = mesh.hasSlowNormal(corner);
    return result;
}

template <typename Body>
void visitLocal(const LocalMesh& mesh, int level, int target, const Body& wanted, std::vector<LocalVertex>& out) {
    if (level == target) {
        for (int corner = 0; corner < mesh.corners(); ++corner)
            if (wanted()) out.push_back(follow(mesh, corner, level));
        return;
    }
    for (const auto& child : mesh.children()) visitLocal(child.mesh, level + 1, target, wanted, out);
}

} // namespace detail

// Vertices of a face refined `level` times (of its corner children: under Loop the middle ones share them). Those that
// several children share come several times; `wanted()` picks some of all.
template <typename Wanted>
std::vector<LocalVertex> followVertices(const SubdivisionCage& cage, std::uint32_t face, int level,
                                        const Wanted& wanted) {
    std::vector<LocalVertex> result;
    detail::visitLocal(LocalMesh(cage, face), 0, level, wanted, result);
    return result;
}

} // namespace abbe::test
