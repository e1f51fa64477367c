#include "geometry/curves.h"

#include "base/check.h"
#include "geometry/curves_surface.h"
#include "geometry/surface_math.h"
#include "geometry/time_steps.h"

#include <numeric>

namespace abbe {

namespace {

// Embree finds hits on tubes by iteration in float: its surface is off the exact one by some roundings of the
// coordinates and of the radius. Measured (tests/unit/geometry/curves_test.cpp).
constexpr float kIterationError = gammaBound(32);

bool visible(CurveBasis basis, const SizedPoint* p) {
    const std::uint32_t count = leastPoints(basis);
    bool wide = false, isLong = false;
    for (std::uint32_t i = 0; i < count; ++i) {
        wide |= p[i].radius > 0;
        isLong |= p[i].position != p[0].position;
    }
    return wide && isLong;
}

} // namespace

Curves::Curves(CurveData data) : data_(std::move(data)) {
    const std::uint64_t total = std::accumulate(data_.strandSizes.begin(), data_.strandSizes.end(), std::uint64_t{0});
    ABBE_CHECK(total == data_.points.size() && total < 0xffffffffu && data_.later.size() < kMaxTimeSteps);
    for (const auto& step : data_.later) ABBE_CHECK(step.size() == total);
    strandFirst_.reserve(data_.strandSizes.size() + 1);
    std::uint32_t first = 0;
    for (std::uint32_t i = 0; i < data_.strandSizes.size(); ++i) {
        addStrand(i, first, data_.strandSizes[i]);
        first += data_.strandSizes[i];
    }
    strandFirst_.push_back(first);
    data_.strandSizes = {}; // strandFirst_ says the same
}

void Curves::addStrand(std::uint32_t strand, std::uint32_t first, std::uint32_t size) {
    const std::uint32_t least = leastPoints(data_.basis), step = pointStep(data_.basis);
    ABBE_CHECK(size >= least && (size - least) % step == 0);
    strandFirst_.push_back(first);
    const bool joined = data_.basis == CurveBasis::linear && data_.form == CurveForm::round;
    bool previous = false;
    for (std::uint32_t i = first; i + least <= first + size; i += step) {
        const bool seen = isVisible(i);
        if (joined && seen && previous) neighbours_.back() |= kNextSegment;
        if (seen) {
            firstPoints_.push_back(i);
            strand_.push_back(strand);
            if (joined) neighbours_.push_back(previous ? kPreviousSegment : 0);
            addBounds(data_.points, i);
            for (const auto& later : data_.later) addBounds(later, i);
        } else {
            ++omitted_;
        }
        previous = seen;
    }
}

// What moves in straight lines stays in the hull of where it is at the steps.
void Curves::addBounds(const std::vector<SizedPoint>& step, std::uint32_t first) {
    std::array<Vec3d, 4> points;
    std::array<double, 4> radii;
    CurveSegment(data_.basis, &step[first]).bezier(points, radii);
    const double r = *std::max_element(radii.begin(), radii.end());
    for (Vec3d p : points) {
        const Vec3d margin = (abs(p) + Vec3d(r, r, r)) * 0x1p-22 + Vec3d(r, r, r);
        bounds_.add(Vec3(p - margin));
        bounds_.add(Vec3(p + margin));
    }
}

bool Curves::isVisible(std::uint32_t first) const {
    return visible(data_.basis, &data_.points[first]) ||
           std::ranges::any_of(data_.later, [&](const auto& step) { return visible(data_.basis, &step[first]); });
}

const SizedPoint* Curves::pointsAt(std::uint32_t first, std::uint32_t count, float time, SizedPoint* room) const {
    if (data_.later.empty()) [[likely]]
        return &data_.points[first];
    const StepPosition at = stepAt(time, data_.later.size() + 1);
    const auto& from = at.step == 0 ? data_.points : data_.later[at.step - 1];
    const auto& to = data_.later[at.step];
    for (std::uint32_t i = 0; i < count; ++i) room[i] = between(from[first + i], to[first + i], at.fraction);
    return room;
}

std::size_t Curves::bytes() const {
    return data_.points.size() * sizeof(SizedPoint) * (1 + data_.later.size()) + neighbours_.size() +
           (firstPoints_.size() + strand_.size() + strandFirst_.size()) * sizeof(std::uint32_t);
}

void Curves::commit(GeometrySink& sink) const {
    std::vector<std::span<const SizedPoint>> steps{data_.points};
    for (const auto& step : data_.later) steps.emplace_back(step);
    if (!firstPoints_.empty()) sink.curves(data_.basis, data_.form, steps, firstPoints_, neighbours_);
}

// Embree's arithmetic for round linear curves loses digits with the square of length / radius and more below a
// millimetre: it finds hits behind the ray's origin, and on ends that are buried in the next segment.
bool Curves::confirms(const RawHit& raw, const Ray& ray) const {
    const std::uint32_t first = firstPoints_[raw.primitive];
    std::array<SizedPoint, 4> room;
    const SizedPoint* p = pointsAt(first, 2, ray.time, room.data());
    const Vec3d o(ray.origin), direction(ray.direction);
    const double l = length(direction), reported = static_cast<double>(raw.distance) * l;
    const Vec3d d = direction * (1 / l);
    const auto met = meetCone(p[0], p[1], o, d);
    if (!met) return false;
    const double t = reported - met->x < met->y - reported ? met->x : met->y;
    if (!(t > 0)) return false;
    const auto buried = [&](std::uint32_t neighbour) {
        const SizedPoint* q = pointsAt(neighbour, 2, ray.time, room.data());
        const double slack = 1e-6 * static_cast<double>(std::max(q[0].radius, q[1].radius));
        const auto inside = meetCone(q[0], q[1], o, d);
        return inside && inside->x < t - slack && t + slack < inside->y;
    };
    const std::uint8_t neighbours = neighbours_[raw.primitive];
    return !((neighbours & kPreviousSegment) && buried(first - 1)) &&
           !((neighbours & kNextSegment) && buried(first + 1));
}

void Curves::surface(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    std::array<SizedPoint, 4> room;
    const SizedPoint* points = pointsAt(firstPoints_[raw.primitive], leastPoints(data_.basis), ray.time, room.data());
    const Vec3d o(ray.origin), direction(ray.direction);
    const double l = length(direction), t = static_cast<double>(raw.distance) * l, u = static_cast<double>(raw.u);
    const Vec3d d = direction * (1 / l);
    const bool linear = data_.basis == CurveBasis::linear;
    const CurveSegment segment(data_.basis, points);
    const CurvePoint at = data_.form == CurveForm::flat ? ribbonPoint(segment, u, o, d)
                          : linear                      ? conePoint(points[0], points[1], o, d, t)
                                                        : tubePoint(segment, u, o, d, t);
    hit.p = Vec3(at.p);
    hit.ng = Vec3(at.normal);
    hit.shading = Frame::fromNormalTangent(hit.ng, Vec3(at.tangent));
    Vec3 magnitude;
    float radius = 0;
    for (std::uint32_t i = 0; i < leastPoints(data_.basis); ++i) {
        magnitude = max(magnitude, abs(points[i].position));
        radius = std::max(radius, points[i].radius);
    }
    hit.pError = (magnitude + Vec3(radius, radius, radius)) * kIterationError;

    const std::uint32_t strand = strand_[raw.primitive], step = pointStep(data_.basis);
    const std::uint32_t first = strandFirst_[strand], size = strandFirst_[strand + 1] - first;
    const double segments = (size - leastPoints(data_.basis)) / step + 1;
    const double before = (firstPoints_[raw.primitive] - first) / step;
    hit.uv = {static_cast<float>((before + at.u) / segments), static_cast<float>(0.5 + 0.5 * at.across)};
    hit.primitive = strand;
}

void Curves::parametrize(const RawHit& raw, const Ray& ray, SurfaceHit& hit) const {
    std::array<SizedPoint, 4> room;
    const std::uint32_t needed = leastPoints(data_.basis), primitive = firstPoints_[raw.primitive];
    const CurveSegment segment(data_.basis, pointsAt(primitive, needed, ray.time, room.data()));
    const std::uint32_t strand = strand_[raw.primitive], first = strandFirst_[strand];
    const double segments = (strandFirst_[strand + 1] - first - needed) / pointStep(data_.basis) + 1;
    const double before = (primitive - first) / pointStep(data_.basis);
    const double u = std::clamp(static_cast<double>(hit.uv.x) * segments - before, 0.0, 1.0);
    // A tube is longer on the outside of its bends.
    Vec3d along = segment.derivative(u);
    const double speed = length(along);
    if (data_.form == CurveForm::round && speed > 0) {
        const Vec3d out = Vec3d(hit.p) - segment.position(u);
        const double bend = dot(out, segment.secondDerivative(u)) / (speed * speed), r = length(out);
        along = along * std::max(1 - bend, 0.0) + (r > 0 ? out * (segment.radiusDerivative(u) / r) : Vec3d());
    }
    const Vec3d side = cross(Vec3d(hit.shading.x), Vec3d(hit.ng));
    hit.dpdu = Vec3(along * segments);
    hit.dpdv = Vec3(side * (-2 * segment.radius(u)));
    if (data_.later.empty()) return;
    const Vec3d moved = CurveSegment(data_.basis, &data_.points[primitive]).position(u) - segment.position(u);
    hit.local = Vec3(Vec3d(hit.p) + moved);
}

// With the point of the axis that it lies around.
Vec3 Curves::carried(const RawHit& raw, const Ray& ray, const SurfaceHit& hit, float time) const {
    if (data_.later.empty()) return hit.p;
    const std::uint32_t needed = leastPoints(data_.basis), primitive = firstPoints_[raw.primitive];
    const std::uint32_t strand = strand_[raw.primitive], first = strandFirst_[strand];
    const double segments = (strandFirst_[strand + 1] - first - needed) / pointStep(data_.basis) + 1;
    const double before = (primitive - first) / pointStep(data_.basis);
    const double u = std::clamp(static_cast<double>(hit.uv.x) * segments - before, 0.0, 1.0);
    const auto axisAt = [&](float t) {
        std::array<SizedPoint, 4> room;
        return CurveSegment(data_.basis, pointsAt(primitive, needed, t, room.data())).position(u);
    };
    return Vec3(Vec3d(hit.p) + (axisAt(time) - axisAt(ray.time)));
}

double Curves::area() const {
    // Simpson's rule per quarter of a segment is far closer than anyone needs.
    double sum = 0;
    for (const std::uint32_t first : firstPoints_) {
        const CurveSegment s(data_.basis, &data_.points[first]);
        constexpr int n = 8;
        for (int i = 0; i <= n; ++i) {
            const double u = i / static_cast<double>(n), weight = i == 0 || i == n ? 1 : i % 2 ? 4 : 2;
            sum += weight / (3 * n) * s.radius(u) * std::hypot(length(s.derivative(u)), s.radiusDerivative(u));
        }
    }
    return sum * (data_.form == CurveForm::round ? 2 * kPiD : 2.0);
}

} // namespace abbe
