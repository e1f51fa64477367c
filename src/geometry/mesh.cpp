#include "geometry/mesh.h"

#include "base/check.h"
#include "geometry/surface_math.h"
#include "math/warp.h"

namespace abbe {

namespace {

// Corners of the two triangles of a quad, in Embree's order.
constexpr std::array<std::array<std::uint8_t, 3>, 2> kQuadHalves{{{0, 1, 3}, {2, 3, 1}}};

Vec3 interpolate(const std::vector<Vec3>& v, std::uint32_t a, std::uint32_t b, std::uint32_t c, float s, float t) {
    return v[a] * (1 - s - t) + v[b] * s + v[c] * t;
}

bool usable(Vec3 n) {
    const float l2 = lengthSquared(n);
    return l2 > 0 && l2 < kInfinity; // false for NaN
}

} // namespace

Mesh::Mesh(MeshData data) : data_(std::move(data)) {
    ABBE_CHECK(data_.normals.empty() || data_.normals.size() == data_.positions.size());
    ABBE_CHECK(data_.uvs.empty() || data_.uvs.size() == data_.positions.size());
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
            if (!usable(n))
                ++normalReport_.missing;
            else if (dot(n, faceNormals_[i]) < 0)
                ++normalReport_.inverted;
        }
}

void Mesh::commit(GeometrySink& sink) const {
    if (!data_.triangles.empty()) sink.triangles(data_.positions, data_.triangles);
    if (!data_.quads.empty()) sink.quads(data_.positions, data_.quads);
}

Mesh::Corners Mesh::corners(const RawHit& raw) const {
    const auto triangles = static_cast<std::uint32_t>(data_.triangles.size());
    if (raw.part == 0 && triangles > 0) {
        const auto& [a, b, c] = data_.triangles[raw.primitive];
        return {a, b, c, raw.u, raw.v, raw.primitive, raw.primitive};
    }
    const bool second = raw.u + raw.v > 1; // Embree's own split
    const auto& quad = data_.quads[raw.primitive];
    const auto& half = kQuadHalves[second];
    return {quad[half[0]],
            quad[half[1]],
            quad[half[2]],
            second ? 1 - raw.u : raw.u,
            second ? 1 - raw.v : raw.v,
            triangles + 2 * raw.primitive + second,
            triangles + raw.primitive};
}

void Mesh::surface(const RawHit& raw, const Ray&, SurfaceHit& hit) const {
    const Corners c = corners(raw);
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

void Mesh::shade(const Corners& c, SurfaceHit& hit) const {
    Vec3 n = hit.ng;
    if (!data_.normals.empty()) {
        const Vec3 smooth = interpolate(data_.normals, c.a, c.b, c.c, c.s, c.t);
        if (usable(smooth)) {
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
    // dp/du up to a positive factor; parallel or equal uv edges give no direction (docs/hard_cases.md, case 10).
    const float determinant = s.x * t.y - s.y * t.x;
    const float scale = std::max(s.x * s.x + s.y * s.y, t.x * t.x + t.y * t.y);
    const auto& p = data_.positions;
    const Vec3 tangent = ((p[c.b] - p[c.a]) * t.y - (p[c.c] - p[c.a]) * s.y) * std::copysign(1.f, determinant);
    const bool defined = std::abs(determinant) > 1e-6f * scale && isFinite(tangent);
    hit.shading = defined ? Frame::fromNormalTangent(n, tangent) : Frame::fromNormal(n);
}

void Mesh::weighByArea() const {
    std::vector<double> areas(triangleCount());
    for (std::uint64_t i = 0; i < triangleCount(); ++i) {
        const auto [a, b, c] = triangle(i);
        const auto& p = data_.positions;
        areas[i] = 0.5 * length(triangleCross(Vec3d(p[a]), Vec3d(p[b]), Vec3d(p[c])));
    }
    byArea_.emplace(areas);
}

std::optional<ShapeSample> Mesh::sample(Vec3 from, Vec2 u) const {
    if (lone_) return lone_->sample(from, u);
    if (!(area_ > 0)) return std::nullopt;
    std::call_once(byAreaOnce_, [this] { weighByArea(); });
    const BinSample bin = byArea_->sample(u.x);
    const Vec2 b = squareToTriangle({bin.offset, u.y});
    const auto [i0, i1, i2] = triangle(bin.index);
    const auto& p = data_.positions;
    Vec3 point, pError;
    trianglePoint(p[i0], p[i1], p[i2], b.x, b.y, point, pError);
    const Vec3 ng = faceNormals_[bin.index];
    const float pdf = areaToSolidAngle(static_cast<float>(1 / area_), point - from, ng);
    if (!(pdf > 0)) return std::nullopt;
    return std::optional<ShapeSample>(std::in_place, point, pError, ng, pdf);
}

float Mesh::pdfSolidAngle(Vec3 from, const SurfaceHit& hit) const {
    if (lone_) return lone_->pdfSolidAngle(from, hit);
    if (!(area_ > 0)) return 0;
    return areaToSolidAngle(static_cast<float>(1 / area_), hit.p - from, hit.ng);
}

} // namespace abbe
