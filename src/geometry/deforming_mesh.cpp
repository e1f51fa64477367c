#include "geometry/deforming_mesh.h"

#include "base/check.h"
#include "geometry/mesh_corners.h"
#include "geometry/surface_math.h"

namespace abbe {

namespace {

// The corners of a triangle at one time, and how large their coordinates are at the steps around it.
struct MovedTriangle {
    Vec3 a, b, c;
    Vec3 magnitude;
};

MovedTriangle moved(const std::vector<Vec3>& from, const std::vector<Vec3>& to, const MeshCorners& corner,
                    float fraction) {
    MovedTriangle t;
    const auto vertex = [&](std::uint32_t i) {
        t.magnitude = max(t.magnitude, max(abs(from[i]), abs(to[i])));
        return between(from[i], to[i], fraction);
    };
    t.a = vertex(corner.a);
    t.b = vertex(corner.b);
    t.c = vertex(corner.c);
    return t;
}

} // namespace

DeformingMesh::DeformingMesh(MeshData faces, std::vector<MeshStep> steps)
    : Shape({.hasTextureCoordinates = !faces.uvs.empty()}), faces_(std::move(faces)), steps_(std::move(steps)) {
    ABBE_CHECK(steps_.size() >= 2 && steps_.size() <= kMaxTimeSteps);
    faces_.positions = {};
    faces_.normals = {};
    const std::size_t vertices = steps_[0].positions.size(), normals = steps_[0].normals.size();
    ABBE_CHECK(normals == 0 || normals == vertices);
    ABBE_CHECK(faces_.uvs.empty() || faces_.uvs.size() == vertices);
    for (const MeshAttribute& a : faces_.attributes)
        ABBE_CHECK(a.values.size() == vertices * static_cast<std::size_t>(a.channels));
    std::vector<bool> used(vertices); // other vertices do not count
    for (const auto& t : faces_.triangles)
        for (const std::uint32_t v : t) used[v] = true;
    for (const auto& q : faces_.quads)
        for (const std::uint32_t v : q) used[v] = true;
    for (MeshStep& step : steps_) {
        ABBE_CHECK(step.positions.size() == vertices && step.normals.size() == normals);
        step.positions.reserve(vertices + 2); // Embree reads vertices as 16 bytes
        for (std::size_t i = 0; i < vertices; ++i)
            if (used[i]) bounds_.add(step.positions[i]);
    }
}

std::size_t DeformingMesh::bytes() const {
    std::size_t sum = faces_.triangles.size() * sizeof(faces_.triangles[0]) +
                      faces_.quads.size() * sizeof(faces_.quads[0]) + faces_.uvs.size() * sizeof(Vec2);
    for (const MeshAttribute& a : faces_.attributes) sum += a.values.size() * sizeof(float);
    for (const MeshStep& step : steps_) sum += (step.positions.size() + step.normals.size()) * sizeof(Vec3);
    return sum;
}

std::optional<Vec3> DeformingMesh::attribute(std::string_view name, const SurfaceHit& hit) const {
    return attributeAt(faces_, name, hit);
}

std::vector<std::string_view> DeformingMesh::attributeNames() const { return attributeNamesOf(faces_); }

void DeformingMesh::commit(GeometrySink& sink) const {
    std::vector<std::span<const Vec3>> vertices;
    for (const MeshStep& step : steps_) vertices.emplace_back(step.positions);
    if (!faces_.triangles.empty()) sink.triangles(vertices, faces_.triangles);
    if (!faces_.quads.empty()) sink.quads(vertices, faces_.quads);
}

void DeformingMesh::surface(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const MeshCorners corner = cornersOf(faces_, raw);
    const StepPosition at = stepAt(ray.time, steps_.size());
    const MeshStep &from = steps_[at.step], &to = steps_[at.step + 1];
    const MovedTriangle t = moved(from.positions, to.positions, corner, at.fraction);
    trianglePoint(t.a, t.b, t.c, corner.s, corner.t, hit.p, hit.pError);
    hit.pError += t.magnitude * gammaBound(3); // of the moved corners
    const Vec3d twice = triangleCross(Vec3d(t.a), Vec3d(t.b), Vec3d(t.c));
    const double l = length(twice);
    hit.ng = l > 0 ? Vec3(twice * (1 / l)) : -ray.direction;
    hit.uv = {raw.u, raw.v};
    hit.primitive = corner.primitive;
    Vec3 n = hit.ng;
    if (!from.normals.empty()) {
        const auto normal = [&](std::uint32_t i) { return between(from.normals[i], to.normals[i], at.fraction); };
        const Vec3 smooth =
            normal(corner.a) * (1 - corner.s - corner.t) + normal(corner.b) * corner.s + normal(corner.c) * corner.t;
        if (isUsableNormal(smooth)) n = normalize(smooth);
        if (dot(n, hit.ng) < 0) n = -n;
    }
    if (faces_.uvs.empty()) {
        hit.shading = Frame::fromNormal(n);
        return;
    }
    const auto& uv = faces_.uvs;
    const Vec2 uv1 = uv[corner.b] - uv[corner.a], uv2 = uv[corner.c] - uv[corner.a];
    hit.uv = uv[corner.a] + uv1 * corner.s + uv2 * corner.t;
    hit.shading = texturedFrame(n, t.b - t.a, t.c - t.a, uv1, uv2);
}

void DeformingMesh::parametrize(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const MeshCorners corner = cornersOf(faces_, raw);
    const StepPosition at = stepAt(ray.time, steps_.size());
    const MovedTriangle t = moved(steps_[at.step].positions, steps_[at.step + 1].positions, corner, at.fraction);
    const auto& uv = faces_.uvs;
    if (uv.empty())
        parametrizeFace(raw, t.b - t.a, t.c - t.a, corner.primitive >= faces_.triangles.size(), false, hit);
    else
        parametrizeTriangle(t.b - t.a, t.c - t.a, uv[corner.b] - uv[corner.a], uv[corner.c] - uv[corner.a], hit);
    const auto& first = steps_[0].positions;
    hit.local = first[corner.a] * (1 - corner.s - corner.t) + first[corner.b] * corner.s + first[corner.c] * corner.t;
}

Vec3 DeformingMesh::carried(const RawHit& raw, const Ray&, const SurfaceHit&, float time) const {
    const MeshCorners corner = cornersOf(faces_, raw);
    const StepPosition at = stepAt(time, steps_.size());
    const MovedTriangle t = moved(steps_[at.step].positions, steps_[at.step + 1].positions, corner, at.fraction);
    Vec3 p, error;
    trianglePoint(t.a, t.b, t.c, corner.s, corner.t, p, error);
    return p;
}

double DeformingMesh::area() const {
    double largest = 0;
    for (const MeshStep& step : steps_) {
        const auto& p = step.positions;
        double sum = 0;
        const auto add = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
            sum += 0.5 * length(triangleCross(Vec3d(p[a]), Vec3d(p[b]), Vec3d(p[c])));
        };
        for (const auto& t : faces_.triangles) add(t[0], t[1], t[2]);
        for (const auto& q : faces_.quads)
            for (const auto& half : kQuadHalves) add(q[half[0]], q[half[1]], q[half[2]]);
        largest = std::max(largest, sum);
    }
    return largest;
}

} // namespace abbe
