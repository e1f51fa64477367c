#include "geometry/flat_shapes.h"

#include "geometry/mesh_corners.h"
#include "geometry/round_shapes.h"
#include "geometry/shape_params.h"
#include "geometry/spherical_sampling.h"
#include "geometry/surface_math.h"
#include "math/warp.h"

#include <immintrin.h>
#include <tuple>

namespace abbe {

Plane::Plane(Vec3d point, Vec3d normal) : Shape({.relief = Relief::smooth}), point_(point), z_(normalize(normal)) {
    const Vec3d guess(Frame::fromNormal(Vec3(z_)).x);
    x_ = normalize(guess - z_ * dot(guess, z_));
    y_ = cross(z_, x_);
    byU_ = toU_ = x_;
    byV_ = toV_ = y_;
}

Plane::Plane(Vec3d point, Vec3d normal, const Transform& place) : Plane(point, normal) {
    std::tie(byU_, byV_) = axesAfter(place, z_);
    const double uu = dot(byU_, byU_), uv = dot(byU_, byV_), vv = dot(byV_, byV_), scale = 1 / (uu * vv - uv * uv);
    toU_ = (byU_ * vv - byV_ * uv) * scale;
    toV_ = (byV_ * uu - byU_ * uv) * scale;
}

Bounds3 Plane::bounds() const {
    // A plane across an axis is thin along it: the box of an axis-aligned floor is flat.
    const auto extent = [](double n) { return 1e15 * safeSqrt(1 - n * n); };
    const Vec3d half(extent(z_.x), extent(z_.y), extent(z_.z));
    const Vec3d margin = (abs(point_) + Vec3d(1e-6, 1e-6, 1e-6)) * 0x1p-20;
    return {Vec3(point_ - half - margin), Vec3(point_ + half + margin)};
}

void Plane::commit(GeometrySink& sink) const { sink.analytic(bounds()); }

std::optional<RawHit> Plane::intersect(const Ray& ray) const {
    const Vec3d o = Vec3d(ray.origin) - point_, d(ray.direction);
    const double t = -dot(o, z_) / dot(d, z_); // parallel: infinite or NaN, refused below
    if (!(t > 0) || !(t <= static_cast<double>(ray.tMax)) || !(t < 1e15)) return std::nullopt;
    return RawHit{.distance = static_cast<float>(t)};
}

void Plane::surface(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const Vec3d d = Vec3d(ray.origin) + Vec3d(ray.direction) * static_cast<double>(raw.distance) - point_;
    const double x = dot(d, x_), y = dot(d, y_);
    const Vec3d p = point_ + x_ * x + y_ * y;
    hit.p = Vec3(p);
    hit.pError = analyticError(p, maxComponent(abs(point_)) + std::abs(x) + std::abs(y));
    hit.ng = Vec3(z_);
    hit.shading = {Vec3(x_), Vec3(y_), Vec3(z_)};
    hit.uv = {static_cast<float>(x), static_cast<float>(y)};
    hit.primitive = 0;
}

void Plane::parametrize(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const Vec3d d = Vec3d(ray.origin) + Vec3d(ray.direction) * static_cast<double>(raw.distance) - point_;
    hit.uv = {static_cast<float>(dot(d, toU_)), static_cast<float>(dot(d, toV_))};
    hit.dpdu = Vec3(byU_);
    hit.dpdv = Vec3(byV_);
}

double Plane::area() const { return std::numeric_limits<double>::infinity(); }

std::optional<SurfacePatch> Plane::patch(const SurfaceHit&, Vec3d origin, Vec3d direction) const noexcept {
    return planarPatch(point_, z_, origin, direction);
}

schema::TypeInfo planeType() {
    using namespace schema;
    using P = PlaneParams;
    std::vector<FieldInfo> fields = {centerField<P>("A point of the plane."), normalField<P>()};
    addShapeFields<P>(fields);
    return {Kind::shape, "plane",          "Infinite plane, the ground by default.", "shape plane { material diffuse }",
            false,       std::move(fields)};
}

UnplacedShape makePlane(const PlaneParams& params, const ShapeContext& context) {
    UnplacedShape shape;
    shape.infinite = true;
    shape.place = [params, context](const Transform& place) -> std::unique_ptr<const Shape> {
        const Vec3d normal = params.normal.value_or(context.up);
        if (!(length(normal) > 0)) return reportNoArea(context.span, context.diagnostics, "normal"), nullptr;
        const Vec3d p = place.point(params.center);
        if (!inReach(p)) return reportOutOfReach(context.span, context.diagnostics), nullptr;
        return std::make_unique<Plane>(p, normalize(place.normal(normal)), place);
    };
    return shape;
}

namespace {

// Beyond this ratio of diagonal² to distance² (to the centre) directions to the rectangle are as good as uniform per
// area, and the cheap density wins.
constexpr float kNearRatio = 0.3f;
// Solid angles come as a difference of angles near 2π: below this their relative error passes 3e-4.
constexpr float kSmallestSolidAngle = 5e-3f;

// The solid-angle view of the rectangle from a point, or nothing where area sampling serves. sample() and
// pdfSolidAngle() both decide by this function, hence alike.
template <typename Rectangle> std::optional<SphericalRectangle> sphericalView(const Rectangle& r, Vec3 from) {
    const Vec3 d = r.centre - from;
    if (r.diagonalSquared < kNearRatio * lengthSquared(d)) return std::nullopt;
    const float x = dot(d, r.x), y = dot(d, r.y), z = dot(d, r.z);
    const float w = 0.5f * r.width, h = 0.5f * r.height;
    const SphericalRectangle view(x - w, y - h, x + w, y + h, z);
    if (!(view.solidAngle() > kSmallestSolidAngle)) return std::nullopt;
    return view;
}

// Cosines at the receiver over the rectangle, as a bilinear density over the square that is sampled into it
// [Hart2020]; nothing if the rectangle is behind the horizon. The least corner keeps a share, because some of what lies
// between a corner below the horizon and one above it is seen.
template <typename Rectangle> std::optional<BilinearDensity> cosineDensity(const Rectangle& r, const Receiver& from) {
    constexpr float kLeastCorner = 0.01f;
    const Vec3 d = r.centre - from.p, x = r.x * (0.5f * r.width), y = r.y * (0.5f * r.height);
    const auto corners = [](float middle, float alongX, float alongY) {
        return _mm_set1_ps(middle) + _mm_setr_ps(-alongX, alongX, -alongX, alongX) +
               _mm_setr_ps(-alongY, -alongY, alongY, alongY);
    };
    const __m128 cx = corners(d.x, x.x, y.x), cy = corners(d.y, x.y, y.y), cz = corners(d.z, x.z, y.z);
    const __m128 height = cx * _mm_set1_ps(from.n.x) + cy * _mm_set1_ps(from.n.y) + cz * _mm_set1_ps(from.n.z);
    const __m128 cosine = height / _mm_sqrt_ps(cx * cx + cy * cy + cz * cz);
    const __m128 above = _mm_and_ps(cosine, _mm_cmpgt_ps(height, _mm_setzero_ps()));
    const float most = std::max(std::max(above[0], above[1]), std::max(above[2], above[3]));
    if (!(most > 0)) return std::nullopt;
    BilinearDensity density{};
    _mm_storeu_ps(density.corner.data(), _mm_max_ps(above, _mm_set1_ps(kLeastCorner * most)));
    return density;
}

} // namespace

Quad::Quad(Vec3 p00, Vec3 p10, Vec3 p11, Vec3 p01, bool mirrored)
    : Shape({.relief = Relief::facets}), corners_{p00, p10, p11, p01, p00}, mirrored_(mirrored) {
    const std::array<std::array<Vec3, 3>, 2> triangles{{{p00, p10, p01}, {p11, p01, p10}}};
    std::array<double, 2> areas{};
    Vec3 magnitude, extent;
    for (int i = 0; i < 2; ++i) {
        const auto& [a, b, c] = triangles[i];
        const Vec3d twice = triangleCross(Vec3d(a), Vec3d(b), Vec3d(c));
        areas[i] = 0.5 * length(twice);
        // One triangle of a degenerate quad may be empty: Embree never hits it, but its frame must be finite.
        const Vec3 n = areas[i] > 0 ? Vec3(normalize(twice)) : Vec3(0, 0, 1);
        const Vec3 tangent = i == 0 ? b - a : a - b;
        halves_[i] = {a, b - a, c - a, Frame::fromNormalTangent(n, tangent)};
        magnitude = max(magnitude, max(abs(a), max(abs(b), abs(c))));
        extent = max(extent, abs(b - a) + abs(c - a));
    }
    // The edges and 1 - u round relative to the edges, the sum relative to the point.
    pError_ = magnitude * gammaBound(3) + extent * gammaBound(2);
    area_ = areas[0] + areas[1];
    pdfArea_ = static_cast<float>(1 / area_);
    firstHalf_ = static_cast<float>(areas[0] / area_);
    rectangle_ = asRectangle({p00, p10, p11, p01});
}

std::optional<Quad::Rectangle> Quad::asRectangle(const std::array<Vec3, 4>& p) {
    constexpr double tolerance = 1e-5;
    const Vec3d a(p[0]), ex = Vec3d(p[1]) - a, ey = Vec3d(p[3]) - a;
    const double width = length(ex), height = length(ey);
    if (!(width > 0 && height > 0)) return std::nullopt;
    if (std::abs(dot(ex, ey)) > tolerance * width * height) return std::nullopt;
    if (length(Vec3d(p[2]) - (a + ex + ey)) > tolerance * std::min(width, height)) return std::nullopt;
    const Vec3d x = ex * (1 / width), z = normalize(cross(ex, ey)), y = cross(z, x);
    const Vec3d centre = a + (ex + ey) * 0.5;
    return Rectangle{Vec3(x),
                     Vec3(y),
                     Vec3(z),
                     static_cast<float>(width),
                     static_cast<float>(height),
                     Vec3(centre),
                     static_cast<float>(square(width) + square(height))};
}

Bounds3 Quad::bounds() const {
    Bounds3 b;
    for (Vec3 p : corners_) b.add(p);
    return b;
}

EmitterPart Quad::emitterPart(std::uint32_t) const {
    const Vec3 a = halves_[0].frame.z, b = halves_[1].frame.z;
    const bool first = firstHalf_ > 0, second = firstHalf_ < 1; // not empty
    EmitterPart part{.box = bounds(), .area = area_, .axis = first ? a : b, .cosNormals = 1};
    if (first && second) {
        if (lengthSquared(a + b) > 1e-6f) part.axis = normalize(a + b);
        part.cosNormals = std::min(dot(part.axis, a), dot(part.axis, b));
    }
    return part;
}

void Quad::commit(GeometrySink& sink) const {
    static constexpr std::array<std::array<std::uint32_t, 4>, 1> index{{{0, 1, 2, 3}}};
    sink.quads(std::span(corners_).first<4>(), index);
}

void Quad::surface(const RawHit& raw, const Ray&, SurfaceHit& hit) const {
    const bool second = raw.u + raw.v > 1; // Embree's own split
    const Half& half = halves_[second];
    const float side = second; // s and t are u and v, or what they lack to 1
    const float s = std::abs(side - raw.u), t = std::abs(side - raw.v);
    const auto axis = [s, t](float p, float a, float b) { return std::fma(t, b, std::fma(s, a, p)); };
    hit.p = {axis(half.corner.x, half.edgeS.x, half.edgeT.x), axis(half.corner.y, half.edgeS.y, half.edgeT.y),
             axis(half.corner.z, half.edgeS.z, half.edgeT.z)};
    hit.pError = pError_;
    hit.ng = half.frame.z;
    hit.shading = half.frame;
    hit.uv = {raw.u, raw.v};
    hit.primitive = 0;
}

void Quad::parametrize(const RawHit& raw, const Ray&, SurfaceHit& hit) const {
    const Half& half = halves_[raw.u + raw.v > 1];
    parametrizeFace(raw, half.edgeS, half.edgeT, true, mirrored_, hit);
}

void Quad::sampleArea(Vec2 u, Vec3& p, Vec3& ng) const {
    const bool second = !(u.x < firstHalf_);
    u.x = second ? (u.x - firstHalf_) / (1 - firstHalf_) : u.x / firstHalf_;
    const Vec2 b = squareToTriangle({std::min(u.x, kOneMinusEpsilon), u.y});
    const Half& half = halves_[second];
    p = half.corner + half.edgeS * b.x + half.edgeT * b.y;
    ng = half.frame.z;
}

std::optional<ShapePoint> Quad::samplePoint(std::uint32_t, Vec2 u) const {
    if (!rectangle_) {
        ShapePoint s{.p = {}, .pError = pError_, .ng = {}, .pdfArea = pdfArea_};
        sampleArea(u, s.p, s.ng);
        return s;
    }
    const Half& half = halves_[0];
    return ShapePoint{half.corner + half.edgeS * u.x + half.edgeT * u.y, pError_, rectangle_->z, pdfArea_};
}

std::optional<RawHit> Quad::locate(Vec3 p, std::uint32_t, const Ray&) const {
    Vec2 q;
    for (const bool second : {false, true}) {
        const Half& half = halves_[second];
        q = barycentrics(p, half.corner, half.corner + half.edgeS, half.corner + half.edgeT);
        const bool inside = q.x + q.y <= 1; // NaN where this half is empty
        if (second) q = {1 - q.x, 1 - q.y};
        if (inside) break;
    }
    if (!std::isfinite(q.x) || !std::isfinite(q.y)) return std::nullopt;
    return RawHit{.u = std::clamp(q.x, 0.f, 1.f), .v = std::clamp(q.y, 0.f, 1.f)};
}

std::optional<UvPoint> Quad::uvPoint(Vec2 uv) const {
    const Vec2 q = mirrored_ ? Vec2{uv.y, uv.x} : uv;
    const bool second = q.x + q.y > 1;
    const Half& half = halves_[second];
    const float side = second;
    return UvPoint{half.corner + half.edgeS * std::abs(side - q.x) + half.edgeT * std::abs(side - q.y), pError_,
                   half.frame.z, length(cross(half.edgeS, half.edgeT))};
}

std::optional<ShapeSample> Quad::sample(const Receiver& from, std::uint32_t, Vec2 u) const {
    Vec3 p, ng;
    if (rectangle_) {
        const Rectangle& r = *rectangle_;
        ng = r.z;
        if (const auto view = sphericalView(r, from.p)) {
            float pdf = 1 / view->solidAngle();
            if (from.oneSided()) {
                const auto density = cosineDensity(r, from);
                if (!density) return std::nullopt;
                u = density->sample(u);
                pdf *= density->pdf(u);
            }
            const Vec2 q = view->sample(u);
            const Vec3 d = r.centre - from.p;
            p = r.centre + r.x * (q.x - dot(d, r.x)) + r.y * (q.y - dot(d, r.y));
            return std::optional<ShapeSample>(std::in_place, p, pError_, ng, pdf);
        }
        p = halves_[0].corner + halves_[0].edgeS * u.x + halves_[0].edgeT * u.y;
    } else {
        sampleArea(u, p, ng);
    }
    const float pdf = areaToSolidAngle(pdfArea_, p - from.p, ng);
    if (!(pdf > 0)) return std::nullopt;
    return std::optional<ShapeSample>(std::in_place, p, pError_, ng, pdf);
}

float Quad::pdfSolidAngle(const Receiver& from, const SurfaceHit& hit) const {
    if (rectangle_) {
        const Rectangle& r = *rectangle_;
        if (const auto view = sphericalView(r, from.p)) {
            if (!from.oneSided()) return 1 / view->solidAngle();
            const auto density = cosineDensity(r, from);
            if (!density) return 0;
            const Vec3 d = hit.p - from.p;
            return density->pdf(view->inverse({dot(d, r.x), dot(d, r.y)})) / view->solidAngle();
        }
    }
    return areaToSolidAngle(pdfArea_, hit.p - from.p, hit.ng);
}

std::optional<SurfacePatch> Quad::patch(const SurfaceHit& hit, Vec3d origin, Vec3d direction) const noexcept {
    // The half whose normal the hit has.
    const Vec3d shown(hit.ng), first(halves_[0].frame.z), second(halves_[1].frame.z);
    const Half& half = halves_[dot(shown, second) > dot(shown, first)];
    const Vec3d n = normalize(cross(Vec3d(half.edgeS), Vec3d(half.edgeT)));
    return planarPatch(Vec3d(half.corner), n, origin, direction);
}

schema::TypeInfo quadType() {
    using namespace schema;
    using P = QuadParams;
    std::vector<FieldInfo> fields = {
        field<P, std::vector<Vec3d>>(FieldType::points, "points", &P::points)
            .unit({Dimension::length})
            .group("extent")
            .doc("Four corners, counter-clockwise seen from the outer side.")
            .example("points 0 0 0   1 0 0   1 1 0   0 1 0"),
        field<P, Vec2d>(FieldType::vector2, "size", &P::size)
            .unit({Dimension::length})
            .range(1e-30, 1e15)
            .group("extent")
            .doc("Width and height of a rectangle about the origin in the xy-plane, facing +z; 1 1 when absent.")
            .example("size 60 120 cm"),
    };
    addShapeFields<P>(fields);
    return {Kind::shape, "quad",           "Flat four-cornered surface.", "shape quad { size 2 1; material diffuse }",
            false,       std::move(fields)};
}

std::unique_ptr<const Shape> placeQuad(const std::vector<Vec3d>& points, Vec2d size, const Transform& place, Span span,
                                       Diagnostics& diagnostics) {
    if (!points.empty() && points.size() != 4) {
        diagnostics.error("E0603", span, "a quad has four `points`", std::to_string(points.size()) + " given");
        return nullptr;
    }
    std::array<Vec3d, 4> corners;
    const double w = size.x / 2, h = size.y / 2;
    if (points.empty())
        corners = {Vec3d{-w, -h, 0}, {w, -h, 0}, {w, h, 0}, {-w, h, 0}};
    else
        std::copy(points.begin(), points.end(), corners.begin());
    const bool mirrored = place.determinant() < 0; // keep the outer side outside
    if (mirrored) std::swap(corners[1], corners[3]);
    for (Vec3d& p : corners) {
        p = place.point(p);
        if (!inReach(p)) return reportOutOfReach(span, diagnostics), nullptr;
    }
    const Vec3d normal = cross(corners[1] - corners[0], corners[3] - corners[0]) +
                         cross(corners[3] - corners[2], corners[1] - corners[2]);
    const double extent = std::max(lengthSquared(corners[2] - corners[0]), lengthSquared(corners[3] - corners[1]));
    if (!(length(normal) > 1e-12 * extent) || !(extent > 0)) return reportNoArea(span, diagnostics, "quad"), nullptr;
    return std::make_unique<Quad>(Vec3(corners[0]), Vec3(corners[1]), Vec3(corners[2]), Vec3(corners[3]), mirrored);
}

UnplacedShape makeQuad(const QuadParams& params, const ShapeContext& context) {
    UnplacedShape shape;
    shape.openBecause = "it has no inside";
    shape.quads = 1;
    shape.place = [params, context](const Transform& place) {
        return placeQuad(params.points, params.size, place, context.span, context.diagnostics);
    };
    return shape;
}

namespace {

schema::FieldInfo cornerField(std::string_view name, std::optional<Vec3d> BoxParams::*member, std::string_view doc,
                              std::string_view example) {
    return schema::field<BoxParams, std::optional<Vec3d>>(schema::FieldType::vector3, name, member)
        .unit({schema::Dimension::length})
        .doc(doc)
        .example(example);
}

std::optional<std::string> boxFault(const BoxParams& p) {
    if (p.size && (p.min || p.max)) return "a box has a `size` or two corners, not both";
    if (p.min.has_value() != p.max.has_value()) return "`min` and `max` of a box belong together";
    if (p.min && !(p.min->x < p.max->x && p.min->y < p.max->y && p.min->z < p.max->z))
        return "`min` of a box lies below `max` in x, y and z";
    if (p.min && length(p.center) > 0) return "`min` and `max` place a box without `center`";
    return std::nullopt;
}

} // namespace

MeshData boxMesh(Vec3d lower, Vec3d upper) {
    MeshData mesh;
    mesh.positions.reserve(8);
    for (int i = 0; i < 8; ++i) // bit 0: x, bit 1: y, bit 2: z
        mesh.positions.push_back(Vec3(Vec3d{(i & 1) != 0 ? upper.x : lower.x, (i & 2) != 0 ? upper.y : lower.y,
                                            (i & 4) != 0 ? upper.z : lower.z}));
    mesh.quads = {{0, 4, 6, 2}, {5, 1, 3, 7}, {0, 1, 5, 4}, {6, 7, 3, 2}, {1, 0, 2, 3}, {4, 5, 7, 6}};
    return mesh;
}

schema::TypeInfo boxType() {
    using namespace schema;
    using P = BoxParams;
    std::vector<FieldInfo> fields = {
        centerField<P>("Centre; not beside `min` and `max`."),
        field<P, std::optional<Vec3d>>(FieldType::vector3, "size", &P::size)
            .unit({Dimension::length})
            .range(1e-30, 1e15)
            .synonyms({"dimensions", "extent"})
            .doc("Lengths of the edges along x, y and z; 1 1 1 when absent.")
            .example("size 20 10 30 cm"),
        cornerField("min", &P::min, "Corner with the smallest coordinates, instead of `size`.", "min -1 0 -1"),
        cornerField("max", &P::max, "Corner with the largest coordinates, together with `min`.", "max 1 2 1"),
    };
    addShapeFields<P>(fields);
    return {Kind::shape,      "box", "Box of six flat faces.", "shape box { size 2 1 1; material diffuse }", false,
            std::move(fields)};
}

std::optional<UnplacedShape> makeBox(const BoxParams& params, const ShapeContext& context) {
    if (const auto fault = boxFault(params)) {
        context.diagnostics.error("E0614", context.span, *fault).help =
            "`size 1 2 1` with `center`, or `min 0 0 0; max 1 2 1`";
        return std::nullopt;
    }
    const Vec3d size = params.min ? *params.max - *params.min : params.size.value_or(Vec3d{1, 1, 1});
    UnplacedShape shape;
    shape.mesh = std::make_shared<const MeshData>(boxMesh(size * -0.5, size * 0.5));
    shape.meshOrigin = params.min ? (*params.min + *params.max) * 0.5 : params.center;
    shape.uvOnFaces = true;
    shape.place = [mesh = shape.mesh, origin = shape.meshOrigin, context](const Transform& place) {
        return placeMesh(*mesh, Transform::translate(origin).then(place), context.span, context.diagnostics);
    };
    return shape;
}

} // namespace abbe
