#include "geometry/points.h"

#include "base/check.h"
#include "geometry/round_shapes.h"
#include "geometry/surface_math.h"

namespace abbe {

namespace {

// Embree intersects in float relative to the ray's origin; the bound covers its surface too. Measured
// (tests/unit/geometry/points_test.cpp).
constexpr float kIntersectionError = gammaBound(16);

Vec3 errorBound(const SizedPoint& point) {
    const float r = point.radius;
    return (abs(point.position) + Vec3(r, r, r)) * kIntersectionError;
}

float turn(double y, double x) {
    const double turns = std::atan2(y, x) / (2 * kPiD);
    return static_cast<float>(turns < 0 ? turns + 1 : turns);
}

} // namespace

Points::Points(PointData data) : data_(std::move(data)) {
    ABBE_CHECK(data_.points.size() < 0xffffffffu && data_.later.size() < kMaxTimeSteps);
    ABBE_CHECK(data_.normals.size() == (data_.form == PointForm::orientedDisk ? data_.points.size() : 0));
    for (const PointData::Step& step : data_.later)
        ABBE_CHECK(step.points.size() == data_.points.size() && step.normals.size() == data_.normals.size());
    removeInvisible();
    data_.normals.reserve(data_.normals.size() + 2); // Embree reads normals as 16 bytes
    addBounds(data_.points);
    for (PointData::Step& step : data_.later) {
        step.normals.reserve(step.normals.size() + 2);
        addBounds(step.points);
    }
}

void Points::addBounds(const std::vector<SizedPoint>& points) {
    for (const SizedPoint& p : points) {
        const float r = p.radius;
        const Vec3 half = (abs(p.position) + Vec3(r, r, r)) * 0x1p-22f + Vec3(r, r, r);
        bounds_.add(p.position - half);
        bounds_.add(p.position + half);
    }
}

void Points::removeInvisible() {
    std::size_t kept = 0;
    const auto keep = [&](std::size_t i, std::vector<SizedPoint>& points, std::vector<Vec3>& normals) {
        points[kept] = points[i];
        if (!normals.empty()) normals[kept] = normals[i];
    };
    const auto isWide = [](const SizedPoint& p) { return p.radius > 0; };
    for (std::size_t i = 0; i < data_.points.size(); ++i) {
        if (!isWide(data_.points[i]) &&
            std::ranges::none_of(data_.later, [&](const auto& step) { return isWide(step.points[i]); }))
            continue;
        keep(i, data_.points, data_.normals);
        for (PointData::Step& step : data_.later) keep(i, step.points, step.normals);
        ++kept;
    }
    omitted_ = data_.points.size() - kept;
    const auto cut = [kept](std::vector<SizedPoint>& points, std::vector<Vec3>& normals) {
        points.resize(kept);
        if (!normals.empty()) normals.resize(kept);
    };
    cut(data_.points, data_.normals);
    for (PointData::Step& step : data_.later) cut(step.points, step.normals);
}

std::size_t Points::bytes() const {
    return (data_.points.size() * sizeof(SizedPoint) + data_.normals.size() * sizeof(Vec3)) * (1 + data_.later.size());
}

void Points::commit(GeometrySink& sink) const {
    if (data_.points.empty()) return;
    std::vector<std::span<const SizedPoint>> steps{data_.points};
    std::vector<std::span<const Vec3>> normals{data_.normals};
    for (const PointData::Step& step : data_.later) {
        steps.emplace_back(step.points);
        normals.emplace_back(step.normals);
    }
    if (data_.normals.empty()) normals.clear();
    sink.points(data_.form, steps, normals);
}

SizedPoint Points::pointAt(std::uint32_t i, float time) const {
    if (data_.later.empty()) [[likely]]
        return data_.points[i];
    const StepPosition at = stepAt(time, data_.later.size() + 1);
    return between(at.step == 0 ? data_.points[i] : data_.later[at.step - 1].points[i], data_.later[at.step].points[i],
                   at.fraction);
}

Vec3 Points::normalAt(std::uint32_t i, float time) const {
    if (data_.later.empty()) [[likely]]
        return data_.normals[i];
    const StepPosition at = stepAt(time, data_.later.size() + 1);
    const Vec3 first = at.step == 0 ? data_.normals[i] : data_.later[at.step - 1].normals[i];
    const Vec3 n = between(first, data_.later[at.step].normals[i], at.fraction);
    return lengthSquared(n) > 0 ? normalize(n) : first; // a disk that turns over has no side halfway
}

void Points::surface(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const SizedPoint point = pointAt(raw.primitive, ray.time);
    const Vec3d o(ray.origin), direction(ray.direction);
    const double l = length(direction);
    const Vec3d d = direction * (1 / l);
    if (data_.form == PointForm::sphere)
        sphere(point, o, d, static_cast<double>(raw.distance) * l, hit);
    else
        disk(point, data_.form == PointForm::disk ? Vec3(-d) : normalAt(raw.primitive, ray.time), o, d, hit);
    hit.pError = errorBound(point);
    hit.primitive = raw.primitive;
}

void Points::parametrize(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    const SizedPoint point = pointAt(raw.primitive, ray.time);
    if (data_.form == PointForm::sphere) {
        parametrizeSphere(hit.ng, point.radius, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, hit);
    } else {
        const Vec3d w = Vec3d(hit.p) - Vec3d(point.position), x(hit.shading.x), y(hit.shading.y);
        parametrizeDisk(dot(w, x), dot(w, y), static_cast<double>(point.radius), x, y, hit);
    }
    hit.local = hit.p - point.position + data_.points[raw.primitive].position;
}

// Of what grows or turns, the point goes along with the middle.
Vec3 Points::carried(const RawHit& raw, const Ray& ray, const SurfaceHit& hit, float time) const {
    if (data_.later.empty()) return hit.p;
    return hit.p - pointAt(raw.primitive, ray.time).position + pointAt(raw.primitive, time).position;
}

void Points::sphere(const SizedPoint& point, Vec3d o, Vec3d d, double t, SurfaceHit& hit) const {
    const Vec3d c(point.position);
    const auto r = static_cast<double>(point.radius);
    const double middle = dot(c - o, d);
    const Vec3d off = o + d * middle - c;
    const double half = safeSqrt(r * r - lengthSquared(off));
    // A ray that Embree lets graze the sphere may pass it by a rounding: the nearest point then.
    const Vec3d w = off + d * (t <= middle ? -half : half);
    const Vec3d n = lengthSquared(w) > 0 ? normalize(w) : -d;
    hit.p = Vec3(c + n * r);
    hit.ng = Vec3(n);
    const Vec3 f = hit.ng;
    hit.uv = {turn(n.x, n.z), 1 - std::acos(std::clamp(f.y, -1.f, 1.f)) * kInvPi};
    hit.shading = Frame::fromNormalTangent(f, {f.z, 0, -f.x});
}

void Points::disk(const SizedPoint& point, Vec3 normal, Vec3d o, Vec3d d, SurfaceHit& hit) const {
    const Vec3d c(point.position), n(normal);
    const double facing = dot(d, n);
    const double t = std::abs(facing) > 1e-12 ? dot(c - o, n) / facing : dot(c - o, d);
    const Vec3d w = o + d * t - c;
    const Frame frame = Frame::fromNormal(normal);
    const double x = dot(w, Vec3d(frame.x)), y = dot(w, Vec3d(frame.y));
    hit.p = Vec3(c + w);
    hit.ng = normal;
    hit.uv = {static_cast<float>(std::min(1.0, std::hypot(x, y) / static_cast<double>(point.radius))), turn(y, x)};
    hit.shading = frame;
}

double Points::area() const {
    double sum = 0;
    for (const SizedPoint& p : data_.points) sum += square(static_cast<double>(p.radius));
    return sum * (data_.form == PointForm::sphere ? 4 * kPiD : kPiD);
}

} // namespace abbe
