#include "geometry/mesh.h"

#include "base/check.h"
#include "geometry/mesh_corners.h"
#include "geometry/near_polygon.h"
#include "geometry/surface_math.h"
#include "math/warp.h"

namespace abbe {

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

Mesh::Mesh(MeshData data, bool mirrored) : data_(std::move(data)), mirrored_(mirrored) {
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

} // namespace abbe
