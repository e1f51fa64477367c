#include "geometry/mesh.h"

#include "base/check.h"
#include "geometry/mesh_corners.h"
#include "geometry/spherical_sampling.h"
#include "geometry/surface_math.h"
#include "math/bounds.h"
#include "math/warp.h"
#include "render/material.h"

#include <algorithm>
#include <fmt/format.h>
#include <utility>

namespace abbe {

namespace {

template <typename Faces>
std::optional<std::string> indexError(const Faces& faces, std::size_t vertices, const char* what) {
    for (std::size_t i = 0; i < faces.size(); ++i)
        for (std::uint32_t v : faces[i])
            if (v >= vertices)
                return fmt::format("{} {} refers to vertex {}, but there are {} vertices", what, i, v, vertices);
    return std::nullopt;
}

std::optional<std::string> findError(const MeshData& m) {
    const std::size_t n = m.positions.size();
    if (n > 0xfffffffeu || m.triangles.size() + 2 * m.quads.size() >= 0xffffffffu)
        return "the mesh has more vertices or faces than 32 bits can count";
    if (!m.normals.empty() && m.normals.size() != n)
        return fmt::format("{} normals for {} vertices", m.normals.size(), n);
    if (!m.uvs.empty() && m.uvs.size() != n) return fmt::format("{} uvs for {} vertices", m.uvs.size(), n);
    for (std::size_t i = 0; i < n; ++i)
        if (!isFinite(m.positions[i])) return fmt::format("the position of vertex {} is not finite", i);
    for (std::size_t i = 0; i < m.normals.size(); ++i)
        if (!isFinite(m.normals[i])) return fmt::format("the normal of vertex {} is not finite", i);
    for (std::size_t i = 0; i < m.uvs.size(); ++i)
        if (!isFinite(m.uvs[i].x) || !isFinite(m.uvs[i].y)) return fmt::format("the uv of vertex {} is not finite", i);
    if (auto e = indexError(m.triangles, n, "triangle")) return e;
    return indexError(m.quads, n, "quad");
}

// Erases faces together with their entries in `groups`. Returns how many.
template <typename Face, typename Predicate>
std::size_t eraseFaces(std::vector<Face>& faces, std::vector<std::uint32_t>* groups, const Predicate& unwanted) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < faces.size(); ++i) {
        if (unwanted(i)) continue;
        faces[kept] = faces[i];
        if (groups) (*groups)[kept] = (*groups)[i];
        ++kept;
    }
    const std::size_t erased = faces.size() - kept;
    faces.resize(kept);
    if (groups) groups->resize(kept);
    return erased;
}

// Quads that name one corner twice in a row become triangles; faces with fewer than three corners go.
void removeRepeated(MeshData& m, FaceGroups* groups, MeshCleanup& report) {
    const auto repeated = [](const auto& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; };
    report.repeatedIndices += eraseFaces(m.triangles, groups ? &groups->triangles : nullptr,
                                         [&](std::size_t i) { return repeated(m.triangles[i]); });
    eraseFaces(m.quads, groups ? &groups->quads : nullptr, [&](std::size_t face) {
        const auto& q = m.quads[face];
        if (q[0] == q[2] || q[1] == q[3]) {
            ++report.repeatedIndices;
            return true;
        }
        for (int i = 0; i < 4; ++i) {
            if (q[i] != q[(i + 1) % 4]) continue;
            const std::array<std::uint32_t, 3> t{q[i], q[(i + 2) % 4], q[(i + 3) % 4]};
            if (repeated(t)) {
                ++report.repeatedIndices;
            } else {
                m.triangles.push_back(t);
                if (groups) groups->triangles.push_back(groups->quads[face]);
                ++report.quadsToTriangles;
            }
            return true;
        }
        return false;
    });
}

} // namespace

MeshCleanup cleanMesh(MeshData& m, FaceGroups* groups) {
    MeshCleanup report;
    report.error = findError(m);
    if (report.error) return report;
    removeRepeated(m, groups, report);

    Bounds3d box;
    for (Vec3 p : m.positions) box.add(Vec3d(p));
    const double diagonal2 = box.empty() ? 0 : lengthSquared(box.diagonal());
    const auto sliver = [&](std::uint32_t a, std::uint32_t b, std::uint32_t c) {
        const Vec3d p0(m.positions[a]), p1(m.positions[b]), p2(m.positions[c]);
        const double longest2 = std::max({lengthSquared(p1 - p0), lengthSquared(p2 - p1), lengthSquared(p0 - p2)});
        const double twice = length(triangleCross(p0, p1, p2));
        return !(twice > 1e-6 * longest2) && !(0.5 * twice > 1e-12 * diagonal2);
    };
    report.zeroArea += eraseFaces(m.triangles, groups ? &groups->triangles : nullptr, [&](std::size_t i) {
        const auto& t = m.triangles[i];
        return sliver(t[0], t[1], t[2]);
    });
    report.zeroArea += eraseFaces(m.quads, groups ? &groups->quads : nullptr, [&](std::size_t i) {
        const auto& q = m.quads[i];
        return sliver(q[0], q[1], q[3]) && sliver(q[2], q[3], q[1]);
    });
    return report;
}

namespace {

Vec3 interpolate(const std::vector<Vec3>& v, std::uint32_t a, std::uint32_t b, std::uint32_t c, float s, float t) {
    return v[a] * (1 - s - t) + v[b] * s + v[c] * t;
}

// A polygon as seen from near, or nothing where sampling per area serves.
std::optional<NearPolygon> nearPolygon(const MeshData& data, std::uint32_t part, const Receiver& from) {
    const auto& p = data.positions;
    if (part < data.triangles.size()) {
        const auto& t = data.triangles[part];
        const NearPolygon::Corners corners{p[t[0]], p[t[1]], p[t[2]]};
        return NearPolygon::seen({&corners, 1}, from);
    }
    const auto& quad = data.quads[part - data.triangles.size()];
    std::array<NearPolygon::Corners, 2> corners;
    for (std::size_t k = 0; k < 2; ++k)
        for (std::size_t i = 0; i < 3; ++i) corners[k][i] = p[quad[kQuadHalves[k][i]]];
    return NearPolygon::seen(corners, from);
}

} // namespace

Mesh::Mesh(MeshData data, bool mirrored)
    : Shape({.relief = data.normals.empty() ? Relief::facets : Relief::smooth,
             .hasTextureCoordinates = !data.uvs.empty()}),
      data_(std::move(data)), mirrored_(mirrored) {
    ABBE_CHECK(data_.normals.empty() || data_.normals.size() == data_.positions.size());
    ABBE_CHECK(data_.uvs.empty() || data_.uvs.size() == data_.positions.size());
    for (const MeshAttribute& a : data_.attributes)
        ABBE_CHECK(a.values.size() == data_.positions.size() * static_cast<std::size_t>(a.channels));
    ABBE_CHECK(triangleCount() < 0xffffffffu);
    data_.positions.reserve(data_.positions.size() + 2); // Embree reads vertices as 16 bytes
    faceNormals_.resize(triangleCount());
    for (std::uint64_t i = 0; i < triangleCount(); ++i) {
        const auto [a, b, c] = triangle(i);
        const Vec3d twice =
            triangleCross(Vec3d(data_.positions[a]), Vec3d(data_.positions[b]), Vec3d(data_.positions[c]));
        for (std::uint32_t v : {a, b, c}) bounds_.add(data_.positions[v]); // unused vertices do not count
        const double l = length(twice);
        faceNormals_[i] = l > 0 ? Vec3(twice * (1 / l)) : Vec3(0, 0, 1);
        area_ += 0.5 * l;
    }
    if (!data_.normals.empty()) countNormals();
    if (data_.triangles.empty() && data_.quads.size() == 1) {
        const auto& q = data_.quads[0];
        const auto& p = data_.positions;
        lone_ = std::make_unique<const Quad>(p[q[0]], p[q[1]], p[q[2]], p[q[3]]);
    }
}

Mesh::~Mesh() = default;

std::array<std::uint32_t, 3> Mesh::triangle(std::uint64_t i) const {
    if (i < data_.triangles.size()) return data_.triangles[i];
    const std::uint64_t k = i - data_.triangles.size();
    const auto& quad = data_.quads[k / 2];
    const auto& half = kQuadHalves[k % 2];
    return {quad[half[0]], quad[half[1]], quad[half[2]]};
}

void Mesh::countNormals() {
    for (std::uint64_t i = 0; i < triangleCount(); ++i)
        for (std::uint32_t v : triangle(i)) {
            const Vec3 n = data_.normals[v];
            if (!isUsableNormal(n))
                ++normalReport_.missing;
            else if (dot(n, faceNormals_[i]) < 0)
                ++normalReport_.inverted;
        }
}

void Mesh::commit(GeometrySink& sink) const {
    if (!data_.triangles.empty()) sink.triangles(data_.positions, data_.triangles);
    if (!data_.quads.empty()) sink.quads(data_.positions, data_.quads);
}

void Mesh::surface(const RawHit& raw, const Ray&, SurfaceHit& hit) const {
    const MeshCorners c = cornersOf(data_, raw);
    const auto& p = data_.positions;
    trianglePoint(p[c.a], p[c.b], p[c.c], c.s, c.t, hit.p, hit.pError);
    hit.ng = faceNormals_[c.normal];
    hit.uv = {raw.u, raw.v};
    hit.primitive = c.primitive;
    if (data_.normals.empty() && data_.uvs.empty()) [[likely]]
        hit.shading = Frame::fromNormal(hit.ng);
    else
        shade(c, hit);
}

void Mesh::shade(const MeshCorners& c, SurfaceHit& hit) const {
    Vec3 n = hit.ng;
    if (!data_.normals.empty()) {
        const Vec3 smooth = interpolate(data_.normals, c.a, c.b, c.c, c.s, c.t);
        if (isUsableNormal(smooth)) {
            n = normalize(smooth);
            if (dot(n, hit.ng) < 0) n = -n;
        }
    }
    if (data_.uvs.empty()) {
        hit.shading = Frame::fromNormal(n);
        return;
    }
    const auto& uv = data_.uvs;
    const Vec2 s = uv[c.b] - uv[c.a], t = uv[c.c] - uv[c.a];
    hit.uv = uv[c.a] + s * c.s + t * c.t;
    const auto& p = data_.positions;
    hit.shading = texturedFrame(n, p[c.b] - p[c.a], p[c.c] - p[c.a], s, t);
}

void Mesh::parametrize(const RawHit& raw, const Ray&, SurfaceHit& hit) const {
    const MeshCorners c = cornersOf(data_, raw);
    const auto& p = data_.positions;
    const Vec3 p1 = p[c.b] - p[c.a], p2 = p[c.c] - p[c.a];
    const auto& uv = data_.uvs;
    if (uv.empty())
        parametrizeFace(raw, p1, p2, c.primitive >= data_.triangles.size(), mirrored_, hit);
    else
        parametrizeTriangle(p1, p2, uv[c.b] - uv[c.a], uv[c.c] - uv[c.a], hit);
}

// Half the divergence of the normal, which is linear over the triangle; of a quad the first half counts.
float Mesh::meanCurvature(const SurfaceHit& hit) const {
    if (data_.normals.empty()) return 0;
    const std::uint64_t i = trianglesOf(hit.primitive).first;
    const auto [a, b, c] = triangle(i);
    const auto normal = [&, this](std::uint32_t v) {
        const Vec3 n = data_.normals[v];
        if (!isUsableNormal(n)) return faceNormals_[i];
        return normalize(dot(n, faceNormals_[i]) < 0 ? -n : n);
    };
    const Vec3 e1 = data_.positions[b] - data_.positions[a], e2 = data_.positions[c] - data_.positions[a];
    const Vec3 n = normal(a), d1 = normal(b) - n, d2 = normal(c) - n;
    const float e = dot(e1, e1), f = dot(e1, e2), g = dot(e2, e2), determinant = e * g - f * f;
    if (!(determinant > 1e-12f * e * g)) return 0;
    return 0.5f * (g * dot(d1, e1) - f * (dot(d1, e2) + dot(d2, e1)) + e * dot(d2, e2)) / determinant;
}

std::optional<Vec3> Mesh::attribute(std::string_view name, const SurfaceHit& hit) const {
    return attributeAt(data_, name, hit);
}

std::vector<std::string_view> Mesh::attributeNames() const { return attributeNamesOf(data_); }

double Mesh::triangleArea(std::uint64_t i) const {
    const auto [a, b, c] = triangle(i);
    const auto& p = data_.positions;
    return 0.5 * length(triangleCross(Vec3d(p[a]), Vec3d(p[b]), Vec3d(p[c])));
}

std::uint32_t Mesh::emitterParts() const {
    return lone_ ? 1 : static_cast<std::uint32_t>(data_.triangles.size() + data_.quads.size());
}

// The triangles of a polygon: the first, and how many.
std::pair<std::uint64_t, int> Mesh::trianglesOf(std::uint32_t primitive) const {
    const std::uint64_t triangles = data_.triangles.size();
    if (primitive < triangles) return {primitive, 1};
    return {triangles + 2 * (primitive - triangles), 2};
}

double Mesh::partArea(std::uint32_t primitive) const {
    const auto [first, count] = trianglesOf(primitive);
    return triangleArea(first) + (count > 1 ? triangleArea(first + 1) : 0);
}

EmitterPart Mesh::emitterPart(std::uint32_t i) const {
    const auto [first, count] = trianglesOf(i);
    EmitterPart part{.box = {}, .area = partArea(i), .axis = faceNormals_[first], .cosNormals = 1};
    for (int k = 0; k < count; ++k)
        for (const std::uint32_t v : triangle(first + k)) part.box.add(data_.positions[v]);
    // Between the normals of the halves of a quad, each half the angle away. They do not count where they are empty.
    if (count > 1 && triangleArea(first) > 0 && triangleArea(first + 1) > 0) {
        const Vec3 sum = faceNormals_[first] + faceNormals_[first + 1];
        if (lengthSquared(sum) > 1e-6f) part.axis = normalize(sum);
        part.cosNormals = std::min(dot(part.axis, faceNormals_[first]), dot(part.axis, faceNormals_[first + 1]));
    } else if (count > 1 && !(triangleArea(first) > 0)) {
        part.axis = faceNormals_[first + 1];
    }
    return part;
}

Mesh::TrianglePoint Mesh::pointOfPart(std::uint32_t primitive, double area, Vec2 u) const {
    auto [i, count] = trianglesOf(primitive);
    if (count > 1) {
        const auto first = static_cast<float>(triangleArea(i) / area);
        const bool second = !(u.x < first);
        u.x = std::min(second ? (u.x - first) / (1 - first) : u.x / first, kOneMinusEpsilon);
        i += second;
    }
    return {i, squareToTriangle(u)};
}

std::optional<ShapePoint> Mesh::samplePoint(std::uint32_t part, Vec2 u) const {
    if (lone_) return lone_->samplePoint(0, u);
    const double area = partArea(part);
    if (!(area > 0)) return std::nullopt;
    const TrianglePoint in = pointOfPart(part, area, u);
    const auto [i0, i1, i2] = triangle(in.triangle);
    const auto& p = data_.positions;
    ShapePoint s{.p = {}, .pError = {}, .ng = faceNormals_[in.triangle], .pdfArea = static_cast<float>(1 / area)};
    trianglePoint(p[i0], p[i1], p[i2], in.weights.x, in.weights.y, s.p, s.pError);
    return s;
}

float Mesh::pdfPoint(std::uint32_t part, Vec3 ng) const {
    if (lone_) return lone_->pdfPoint(0, ng);
    const double area = partArea(part);
    return area > 0 ? static_cast<float>(1 / area) : 0;
}

std::optional<ShapeSample> Mesh::sample(const Receiver& from, std::uint32_t part, Vec2 u) const {
    if (lone_) return lone_->sample(from, 0, u);
    const double area = partArea(part);
    if (!(area > 0)) return std::nullopt;
    TrianglePoint in;
    float pdf = 0;
    const auto near = nearPolygon(data_, part, from);
    if (near) {
        const auto s = near->sample(u);
        if (!s) return std::nullopt;
        in = {trianglesOf(part).first + static_cast<std::uint64_t>(s->half), s->weights};
        pdf = s->pdf;
    } else {
        in = pointOfPart(part, area, u);
    }
    const auto [i0, i1, i2] = triangle(in.triangle);
    const auto& p = data_.positions;
    Vec3 point, pError;
    trianglePoint(p[i0], p[i1], p[i2], in.weights.x, in.weights.y, point, pError);
    const Vec3 ng = faceNormals_[in.triangle];
    if (!near) pdf = areaToSolidAngle(static_cast<float>(1 / area), point - from.p, ng);
    if (!(pdf > 0)) return std::nullopt;
    return std::optional<ShapeSample>(std::in_place, point, pError, ng, pdf);
}

float Mesh::pdfSolidAngle(const Receiver& from, const SurfaceHit& hit) const {
    if (lone_) return lone_->pdfSolidAngle(from, hit);
    const double area = partArea(hit.primitive);
    if (!(area > 0)) return 0;
    if (const auto near = nearPolygon(data_, hit.primitive, from)) return near->pdf(hit.p);
    return areaToSolidAngle(static_cast<float>(1 / area), hit.p - from.p, hit.ng);
}

std::optional<RawHit> Mesh::locate(Vec3 p, std::uint32_t part, const Ray& ray) const {
    const auto triangles = static_cast<std::uint32_t>(data_.triangles.size());
    if (lone_) return lone_->locate(p, 0, ray);
    RawHit raw;
    raw.part = part >= triangles && triangles > 0 ? 1 : 0;
    raw.primitive = part >= triangles ? part - triangles : part;
    const auto [first, count] = trianglesOf(part);
    Vec2 q;
    for (int i = 0; i < count; ++i) {
        const auto [a, b, c] = triangle(first + static_cast<std::uint64_t>(i));
        q = barycentrics(p, data_.positions[a], data_.positions[b], data_.positions[c]);
        const bool inside = q.x + q.y <= 1; // NaN where it is empty
        if (i == 1) q = {1 - q.x, 1 - q.y};
        if (inside) break;
    }
    if (!std::isfinite(q.x) || !std::isfinite(q.y)) return std::nullopt;
    raw.u = std::clamp(q.x, 0.f, 1.f);
    raw.v = std::clamp(q.y, 0.f, 1.f);
    return raw;
}

namespace {

// Where a line meets the plane of a triangle with the edges e1 and e2 from `corner`, and by how much that is outside.
struct PlanePoint {
    double s = 0, t = 0, outside = std::numeric_limits<double>::infinity();
    Vec3d p;
};

PlanePoint intersectPlane(Vec3d corner, Vec3d e1, Vec3d e2, Vec3d origin, Vec3d direction) {
    const Vec3d across = cross(e1, e2);
    const double area2 = lengthSquared(across), distance = dot(corner - origin, across) / dot(direction, across);
    if (!(area2 > 0) || !std::isfinite(distance)) return {};
    PlanePoint q;
    q.p = origin + direction * distance;
    const Vec3d d = q.p - corner;
    q.s = dot(d, cross(e2, across)) / area2;
    q.t = dot(d, cross(across, e1)) / area2;
    q.outside = std::max(std::max(-q.s, -q.t), std::max(q.s + q.t - 1, 0.0));
    return q;
}

} // namespace

std::optional<SurfacePatch> Mesh::patch(const SurfaceHit& hit, Vec3d origin, Vec3d direction) const noexcept {
    const auto& p = data_.positions;
    const auto [first, count] = trianglesOf(hit.primitive);
    std::uint64_t chosen = first;
    PlanePoint at;
    for (std::uint64_t i = first; i < first + static_cast<std::uint64_t>(count); ++i) {
        const auto [a, b, c] = triangle(i);
        const PlanePoint q =
            intersectPlane(Vec3d(p[a]), Vec3d(p[b]) - Vec3d(p[a]), Vec3d(p[c]) - Vec3d(p[a]), origin, direction);
        if (q.outside < at.outside) at = q, chosen = i;
    }
    if (!std::isfinite(at.outside)) return std::nullopt;
    const auto [a, b, c] = triangle(chosen);
    const Vec3d e1 = Vec3d(p[b]) - Vec3d(p[a]), e2 = Vec3d(p[c]) - Vec3d(p[a]), across = cross(e1, e2);
    const Vec3d ng = normalize(across);
    SurfacePatch patch{at.p, ng, ng, {}, {}};
    if (data_.normals.empty()) return patch;
    // As shade(): linear over the triangle, then made unit.
    const Vec3d n0(data_.normals[a]), d1 = Vec3d(data_.normals[b]) - n0, d2 = Vec3d(data_.normals[c]) - n0;
    const Vec3d n = n0 + d1 * at.s + d2 * at.t;
    if (!isUsableNormal(Vec3(n))) return patch;
    const double area2 = lengthSquared(across), scale = (dot(n, ng) < 0 ? -1 : 1) / length(n);
    patch.n = n * scale;
    patch.along = {cross(e2, across) / area2, cross(across, e1) / area2};
    patch.change = {(d1 - patch.n * dot(d1, patch.n)) * scale, (d2 - patch.n * dot(d2, patch.n)) * scale};
    return patch;
}

namespace {

// Nothing is said of the relief: chains are not followed through materials that change from face to face.
ShapeTraits traitsWith(const Shape& shape, const std::vector<const Material*>& materials) {
    const auto looksAtTextures = [](const Material* m) { return m && m->usesTextures(); };
    return {.hasTextureCoordinates = shape.hasTextureCoordinates(),
            .usesTextures = std::ranges::any_of(materials, looksAtTextures),
            .primitives = &shape.primitives()};
}

} // namespace

FaceMaterials::FaceMaterials(std::shared_ptr<const Shape> shape, std::vector<const Material*> materials,
                             std::vector<std::uint16_t> choice)
    : Shape(traitsWith(*shape, materials)), shape_(std::move(shape)), materials_(std::move(materials)),
      choice_(std::move(choice)) {
    for (const std::uint16_t c : choice_) ABBE_CHECK(c < materials_.size());
}

void FaceMaterials::surface(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    shape_->surface(raw, ray, hit);
    ABBE_DCHECK(hit.primitive < choice_.size());
    if (const Material* own = materials_[choice_[hit.primitive]]) hit.material = own;
}

} // namespace abbe
