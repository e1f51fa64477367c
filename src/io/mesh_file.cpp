#include "io/mesh_file.h"

#include "io/array_geometry.h"
#include "io/file.h"
#include "io/gltf.h"

#include <algorithm>
#include <array>

namespace abbe {

namespace {

bool isPly(std::string_view bytes) {
    return bytes.starts_with("ply\n") || bytes.starts_with("ply\r") || bytes.starts_with("ply ");
}

} // namespace

MeshFile readMesh(const std::string& path) {
    if (const auto arrays = findArrays(path)) return meshOf(*arrays, path);
    const LargeFile file(path);
    const std::string_view bytes = file.bytes();
    if (looksLikeGltf(bytes)) return parseGltf(bytes, path);
    return isPly(bytes) ? parsePly(bytes, path) : parseObj(bytes, path);
}

CageFile readCage(const std::string& path) {
    if (const auto arrays = findArrays(path)) return cageOf(*arrays, path);
    const LargeFile file(path);
    const std::string_view bytes = file.bytes();
    if (looksLikeGltf(bytes))
        throw IoError("cannot read `" + path + "`: glTF files hold triangles, no cages; `shape mesh` takes them");
    return isPly(bytes) ? parsePlyCage(bytes, path) : parseObjCage(bytes, path);
}

MeshData extractGroup(const MeshFile& file, const MeshGroup& group) {
    constexpr std::uint32_t unused = 0xffffffffu;
    const MeshData& all = file.mesh;
    MeshData part;
    std::vector<std::uint32_t> map(all.positions.size(), unused);
    const auto vertex = [&](std::uint32_t v) {
        if (map[v] == unused) {
            map[v] = static_cast<std::uint32_t>(part.positions.size());
            part.positions.push_back(all.positions[v]);
            if (!all.normals.empty()) part.normals.push_back(all.normals[v]);
            if (!all.uvs.empty()) part.uvs.push_back(all.uvs[v]);
        }
        return map[v];
    };
    for (std::size_t i = 0; i < group.triangleCount; ++i) {
        const auto& t = all.triangles[group.firstTriangle + i];
        part.triangles.push_back({vertex(t[0]), vertex(t[1]), vertex(t[2])});
    }
    for (std::size_t i = 0; i < group.quadCount; ++i) {
        const auto& q = all.quads[group.firstQuad + i];
        part.quads.push_back({vertex(q[0]), vertex(q[1]), vertex(q[2]), vertex(q[3])});
    }
    return part;
}

namespace {

// Twice the vector area of a polygon by Newell's sum; its direction is the mean normal.
Vec3d newellNormal(const MeshData& mesh, std::span<const std::uint32_t> corners) {
    const Vec3d origin(mesh.positions[corners[0]]);
    Vec3d sum;
    Vec3d last = Vec3d(mesh.positions[corners.back()]) - origin;
    for (std::uint32_t c : corners) {
        const Vec3d p = Vec3d(mesh.positions[c]) - origin;
        sum += cross(last, p);
        last = p;
    }
    return sum;
}

// A polygon laid into the plane of its mean normal.
std::vector<Vec2d> project(const MeshData& mesh, std::span<const std::uint32_t> corners, Vec3d normal) {
    const Vec3d a = abs(normal);
    const int drop = a.x >= a.y && a.x >= a.z ? 0 : a.y >= a.z ? 1 : 2;
    const int i = (drop + 1) % 3, j = (drop + 2) % 3;
    const double sign = normal[drop] < 0 ? -1 : 1; // keep it counter-clockwise
    std::vector<Vec2d> points;
    points.reserve(corners.size());
    for (std::uint32_t c : corners) {
        const Vec3d p(mesh.positions[c]);
        points.push_back({sign * p[i], p[j]});
    }
    return points;
}

// Twice the signed area of the triangle.
double turn(Vec2d a, Vec2d b, Vec2d c) { return (b.x - a.x) * (c.y - a.y) - (b.y - a.y) * (c.x - a.x); }

bool convex(const std::vector<Vec2d>& p) {
    const std::size_t n = p.size();
    for (std::size_t i = 0; i < n; ++i)
        if (turn(p[i], p[(i + 1) % n], p[(i + 2) % n]) < 0) return false;
    // Turning left everywhere is not enough: a star turns left too, but around more than once. Its fan folds over.
    for (std::size_t i = 1; i + 1 < n; ++i)
        if (turn(p[0], p[i], p[i + 1]) < 0) return false;
    return true;
}

bool inside(Vec2d p, Vec2d a, Vec2d b, Vec2d c) {
    return turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0;
}

// Whether the corner `at` of the remaining polygon can be cut off.
bool isEar(const std::vector<Vec2d>& p, const std::vector<std::uint32_t>& left, std::size_t at) {
    const std::size_t n = left.size();
    const std::size_t before = (at + n - 1) % n, after = (at + 1) % n;
    const Vec2d a = p[left[before]], b = p[left[at]], c = p[left[after]];
    if (!(turn(a, b, c) > 0)) return false;
    for (std::size_t i = 0; i < n; ++i) {
        if (i == at || i == before || i == after) continue;
        const Vec2d q = p[left[i]];
        if (q == a || q == b || q == c) continue; // bridges to holes pass a point twice
        if (inside(q, a, b, c)) return false;
    }
    return true;
}

// The corners that are left of a polygon, and which of them can be cut off. In one that does not cross itself a cut
// changes that for its two neighbours alone, so that the time grows with the square of the corners.
class EarCutter {
  public:
    explicit EarCutter(const std::vector<Vec2d>& points) : points_(points), left_(points.size()) {
        for (std::size_t i = 0; i < left_.size(); ++i) left_[i] = static_cast<std::uint32_t>(i);
        lookAgain();
    }
    std::size_t size() const { return left_.size(); }
    // The triangle of a corner, by numbers of points.
    std::array<std::uint32_t, 3> triangle(std::size_t at) const {
        const std::size_t n = left_.size();
        return {left_[(at + n - 1) % n], left_[at], left_[(at + 1) % n]};
    }
    // The next ear from `at` on, around. A polygon that crosses itself may run out of them: all are looked at a few
    // times more, and then what is left is cut in order.
    std::size_t next(std::size_t at) {
        constexpr int kMostLooks = 3;
        for (;;) {
            for (std::size_t i = 0; i < left_.size(); ++i)
                if (const std::size_t k = (at + i) % left_.size(); ears_[k]) return k;
            if (looks_ >= kMostLooks) return at % left_.size();
            lookAgain();
            if (std::find(ears_.begin(), ears_.end(), true) == ears_.end()) looks_ = kMostLooks;
        }
    }
    void cut(std::size_t at) {
        left_.erase(left_.begin() + static_cast<std::ptrdiff_t>(at));
        ears_.erase(ears_.begin() + static_cast<std::ptrdiff_t>(at));
        const std::size_t n = left_.size(), after = at % n, before = (at + n - 1) % n;
        for (const std::size_t k : {before, after}) ears_[k] = isEar(points_, left_, k);
    }

  private:
    void lookAgain() {
        ++looks_;
        ears_.resize(left_.size());
        for (std::size_t i = 0; i < left_.size(); ++i) ears_[i] = isEar(points_, left_, i);
    }

    const std::vector<Vec2d>& points_;
    std::vector<std::uint32_t> left_; // of the points
    std::vector<bool> ears_;
    int looks_ = 0;
};

void cutEars(MeshData& mesh, std::span<const std::uint32_t> corners, const std::vector<Vec2d>& points) {
    EarCutter cutter(points);
    const auto add = [&](std::size_t at) {
        const auto t = cutter.triangle(at);
        mesh.triangles.push_back({corners[t[0]], corners[t[1]], corners[t[2]]});
    };
    std::size_t at = 0;
    while (cutter.size() > 3) {
        at = cutter.next(at);
        add(at);
        cutter.cut(at);
    }
    add(1);
}

void addQuad(MeshData& mesh, std::span<const std::uint32_t> c) {
    // A quad is traced as two triangles on either side of the diagonal from its second to its fourth corner, which
    // lies outside when it is concave at the first or the third.
    const Vec3d p0(mesh.positions[c[0]]), p1(mesh.positions[c[1]]), p2(mesh.positions[c[2]]), p3(mesh.positions[c[3]]);
    const Vec3d first = cross(p1 - p0, p3 - p0), second = cross(p3 - p2, p1 - p2);
    if (dot(first, second) < 0)
        mesh.quads.push_back({c[1], c[2], c[3], c[0]});
    else
        mesh.quads.push_back({c[0], c[1], c[2], c[3]});
}

} // namespace

bool addPolygon(MeshData& mesh, std::span<const std::uint32_t> corners) {
    if (corners.size() == 3) {
        mesh.triangles.push_back({corners[0], corners[1], corners[2]});
        return true;
    }
    if (corners.size() == 4) {
        addQuad(mesh, corners);
        return true;
    }
    const std::vector<Vec2d> points = project(mesh, corners, newellNormal(mesh, corners));
    if (convex(points)) {
        for (std::size_t i = 1; i + 1 < corners.size(); ++i)
            mesh.triangles.push_back({corners[0], corners[i], corners[i + 1]});
        return true;
    }
    if (corners.size() > kMaxConcaveCorners) return false;
    cutEars(mesh, corners, points);
    return true;
}

} // namespace abbe
