#include "lights/beam_light.h"

#include "lights/amount.h"
#include "math/warp.h"

namespace abbe {

namespace {

using schema::Dimension;
using schema::FieldType;

constexpr AmountFields kBeamAmounts = AmountFields(AmountField::power) | AmountField::irradiance;
constexpr double kBeamDegree = kPiD / 180;

std::vector<schema::FieldInfo> openingFields() {
    return {schema::field(FieldType::quantity, "radius", &BeamLightParams::radius)
                .unit({Dimension::length})
                .byDefault("5 mm")
                .range(1e-9, std::numeric_limits<float>::max())
                .doc("Radius of the opening, which is as wide as the beam is there.")
                .example("radius 2 mm")
                .synonyms({"r", "aperture", "waist", "size"}),
            schema::field(FieldType::quantity, "divergence", &BeamLightParams::divergence)
                .unit({Dimension::angle})
                .byDefault("0.01 deg")
                .range(BeamLightParams::kLeast, BeamLightParams::kMost)
                .doc("Full angle by which the light of every point of the opening spreads.")
                .example("divergence 0.06 deg")
                .synonyms({"angle", "spread", "angular-diameter"})};
}

std::vector<schema::FieldInfo> axisFields() {
    return {schema::field(FieldType::vector3, "position", &BeamLightParams::position)
                .unit({Dimension::length})
                .byDefault("0 0 0")
                .doc("The middle of the opening.")
                .example("position 0 1 0")
                .synonyms({"from", "center", "location", "origin"}),
            schema::field(FieldType::vector3, "look-at", &BeamLightParams::lookAt)
                .unit({Dimension::length})
                .group("axis")
                .doc("A point on the axis of the beam.")
                .example("look-at 0 0 0")
                .synonyms({"to", "target"}),
            schema::field(FieldType::vector3, "toward", &BeamLightParams::toward)
                .group("axis")
                .doc("Direction of the beam, of any length. Without `look-at`: 0 0 -1.")
                .example("toward 1 0 0")
                .synonyms({"direction", "axis"})};
}

} // namespace

schema::TypeInfo beamLightType() {
    schema::TypeInfo type{.kind = schema::Kind::light,
                          .name = "beam",
                          .doc = "A collimated beam that leaves a round opening, which itself is not seen.",
                          .example = "light beam { position -1 0 0; toward 1 0 0; radius 2 mm; power 5 mW; color line "
                                     "632.8 }",
                          .fields = axisFields()};
    for (schema::FieldInfo& f : openingFields()) type.fields.push_back(std::move(f));
    addAmountFields<BeamLightParams>(type.fields, kBeamAmounts);
    type.fields.push_back(schema::field(FieldType::transform, "transform", &BeamLightParams::transform)
                              .doc("Places the light: steps from top to bottom, as applied to it.")
                              .example("transform { translate 0 2 0 }")
                              .synonyms({"to-world", "matrix"}));
    return type;
}

BeamLight::BeamLight(Vec3d centre, Vec3d axis, double radius, double halfAngle, ScaledCurve radiance)
    : centre_(centre), z_(axis), radius_(radius), tangent_(std::tan(halfAngle)),
      oneMinusCos_(static_cast<float>(2 * square(std::sin(halfAngle / 2)))),
      chord_(static_cast<float>(2 * std::sin(halfAngle / 2))), radiance_(radiance) {
    // Axes across it, from double.
    const Vec3d other = std::abs(z_.x) < 0.5 ? Vec3d{1, 0, 0} : Vec3d{0, 1, 0};
    x_ = normalize(cross(other, z_));
    y_ = cross(z_, x_);
    const double spread = kPiD * square(radius) * projectedAngle(halfAngle) * radiance.scale;
    power_ = spread * radiantIntegral(*radiance.curve);
    visiblePower_ = spread * visibleIntegral(*radiance.curve);
}

std::optional<LightBounds> BeamLight::bounds(std::uint32_t) const {
    const auto reach = [&](double axis) { return radius_ * safeSqrt((1 - axis) * (1 + axis)); };
    const Vec3d half{reach(z_.x), reach(z_.y), reach(z_.z)};
    return LightBounds{.box = {Vec3(centre_ - half), Vec3(centre_ + half)},
                       .axis = Vec3(z_),
                       .cosNormals = 1,
                       .cosEmission = 1 - oneMinusCos_,
                       .power = static_cast<float>(visiblePower_)};
}

// In the plane of the opening, about its middle: light arrives from the overlap of two disks.
struct BeamLight::Seen {
    Vec3d foot;    // the receiver in the light's own axes
    double spread; // radius of the cone about it where it meets the plane
    double area;   // m², of the smaller disk
    bool fromCone; // which that is

    // 1/sr of a point at this distance², drawn evenly from the area.
    double pdf(double distance2) const { return distance2 * std::sqrt(distance2) / (area * foot.z); }
};

std::optional<BeamLight::Seen> BeamLight::seenFrom(Vec3 p) const noexcept {
    const Vec3d foot = local(Vec3d(p) - centre_);
    constexpr double kNearest = 1e-30;
    if (!(foot.z > kNearest)) return std::nullopt;
    const double spread = foot.z * tangent_;
    if (!(square(foot.x) + square(foot.y) < square(radius_ + spread))) return std::nullopt;
    const bool fromCone = spread < radius_;
    return Seen{foot, spread, kPiD * square(fromCone ? spread : radius_), fromCone};
}

std::optional<LightSample> BeamLight::sample(const Receiver& from, std::uint32_t, Vec2 u, const Wavelengths& lambda,
                                             float) const noexcept {
    const auto seen = seenFrom(from.p);
    if (!seen) return std::nullopt;
    const Vec2 disk = squareToDisk(u);
    const double r = seen->fromCone ? seen->spread : radius_;
    const double x = static_cast<double>(disk.x) * r, y = static_cast<double>(disk.y) * r;
    // Of the point, from the middle of the opening and from below the receiver.
    const double px = seen->fromCone ? seen->foot.x + x : x, py = seen->fromCone ? seen->foot.y + y : y;
    const double dx = px - seen->foot.x, dy = py - seen->foot.y;
    if (seen->fromCone ? square(px) + square(py) > square(radius_) : square(dx) + square(dy) > square(seen->spread))
        return std::nullopt;
    const double distance2 = square(dx) + square(dy) + square(seen->foot.z), distance = std::sqrt(distance2);
    const Vec3 wi((x_ * dx + y_ * dy - z_ * seen->foot.z) / distance);
    std::optional<LightSample> sample(std::in_place, wi, Vec3(centre_ + x_ * px + y_ * py),
                                      static_cast<float>(distance), radiance_.at(lambda),
                                      static_cast<float>(seen->pdf(distance2)), true);
    sample->n = Vec3(z_);
    return sample;
}

// Points and receivers are rounded to float; those at the edge count.
float BeamLight::pdfAtPoint(const Receiver& from, std::uint32_t, Vec3 p, Vec3, float) const noexcept {
    const auto seen = seenFrom(from.p);
    if (!seen) return 0;
    const Vec3d at = local(Vec3d(p) - centre_);
    const double dx = at.x - seen->foot.x, dy = at.y - seen->foot.y;
    const double rounding =
        0x1p-21 * (std::max(length(Vec3d(p)), length(Vec3d(from.p))) + length(centre_) + radius_ + seen->foot.z);
    if (square(dx) + square(dy) > square(seen->spread + rounding)) return 0;
    if (square(at.x) + square(at.y) > square(radius_ + rounding)) return 0;
    return static_cast<float>(seen->pdf(square(dx) + square(dy) + square(seen->foot.z)));
}

// With o + s d in the light's own axes: inside where x² + y² <= (R + z tan)² and z >= 0. Along the ray the beam is
// even, unless it widens: distances are drawn around a point as far from the ray as the beam is long there.
std::optional<LightReach> BeamLight::reach(const Ray& ray, float tMax) const noexcept {
    const Vec3d o = local(Vec3d(ray.origin) - centre_), d = local(Vec3d(ray.direction));
    double from = 0, to = static_cast<double>(tMax);
    if (d.z == 0 && o.z < 0) return std::nullopt;
    if (d.z > 0) from = std::max(from, -o.z / d.z);
    if (d.z < 0) to = std::min(to, -o.z / d.z);
    const double slope = 1.001 * tangent_, wide = 1.001 * radius_ + slope * o.z;
    const double a = square(d.x) + square(d.y) - square(slope * d.z), b = o.x * d.x + o.y * d.y - slope * d.z * wide;
    const double c = square(o.x) + square(o.y) - square(wide), discriminant = b * b - a * c;
    if (std::abs(a) > 1e-12) {
        if (discriminant < 0 && a > 0) return std::nullopt; // of a ray that passes it by
        const double q = -(b + std::copysign(safeSqrt(discriminant), b));
        const double r1 = q / a, r2 = q != 0 ? c / q : r1;
        if (a > 0) {
            from = std::max(from, std::min(r1, r2));
            to = std::min(to, std::max(r1, r2));
        } else if (d.z > 0) { // steeper than the cone: it enters, or leaves, and the other root is behind the opening
            from = std::max(from, std::max(r1, r2));
        } else {
            to = std::min(to, std::min(r1, r2));
        }
    }
    if (!(from < to)) return std::nullopt;
    const double way = to - from;
    Vec3 centre(centre_);
    if (std::isfinite(way) && tangent_ * way < radius_)
        centre = ray.origin + ray.direction * static_cast<float>((from + to) / 2) +
                 Frame::fromNormal(ray.direction).x * static_cast<float>(way);
    return LightReach{centre, static_cast<float>(from), static_cast<float>(to)};
}

std::optional<LightOrigin> BeamLight::sampleOrigin(std::uint32_t, Vec2 u, const Wavelengths&,
                                                   float time) const noexcept {
    const Vec2 q = squareToDisk(u);
    const Vec3 p(centre_ + (x_ * static_cast<double>(q.x) + y_ * static_cast<double>(q.y)) * radius_);
    return originAt(0, p, {}, time);
}

LightOrigin BeamLight::originAt(std::uint32_t, Vec3 p, Vec3, float time) const noexcept {
    LightOrigin origin;
    origin.p = p;
    origin.pError = abs(p) * 0x1p-23f;
    origin.n = Vec3(z_);
    origin.pdf = static_cast<float>(1 / (kPiD * square(radius_)));
    origin.largest = conePdf(oneMinusCos_);
    origin.sides = LightOrigin::Sides::front;
    origin.time = time;
    return origin;
}

bool BeamLight::inside(Vec3 w) const noexcept {
    // The chord of the angle, in which nothing cancels, and what rounding of a direction makes of it.
    return length(Vec3(Vec3d(w) - z_)) <= chord_ + 0x1p-23f;
}

Vec3 BeamLight::sampleDirection(const LightOrigin&, Vec2 u) const noexcept {
    const Vec3d w(squareToCone(u, oneMinusCos_));
    return Vec3(normalize(x_ * w.x + y_ * w.y + z_ * w.z));
}

float BeamLight::pdfDirection(const LightOrigin&, Vec3 w) const noexcept {
    return inside(w) ? conePdf(oneMinusCos_) : 0;
}

Spectrum BeamLight::leaving(const LightOrigin&, Vec3 w, const Wavelengths& lambda) const noexcept {
    return inside(w) ? radiance_.at(lambda) : Spectrum(0.f);
}

std::unique_ptr<PlacedLight> makeBeamLight(const BeamLightParams& params, const LightContext& context,
                                           Diagnostics& diagnostics) {
    if (!params.stated()) {
        reportMissingAmount(kBeamAmounts, context.span, diagnostics);
        return nullptr;
    }
    const Transform toRender = params.transform.at(context.time).then(context.toRender);
    const Vec3d local = params.lookAt ? *params.lookAt - params.position : params.toward.value_or(Vec3d{0, 0, -1});
    const Vec3d axis = toRender.vector(local);
    const double norm = length(axis);
    if (!(norm > 0 && std::isfinite(norm))) {
        diagnostics.error("E0344", context.span, "the axis of the light has no direction",
                          params.lookAt ? "`look-at` is `position`" : "`toward` is zero");
        return nullptr;
    }
    const auto scale = toRender.uniformScale();
    if (!scale) {
        diagnostics.error("E0348", context.span, "a beam can be turned and scaled, but not stretched");
        return nullptr;
    }
    const double radius = params.radius * std::abs(*scale), half = params.divergence / 2;
    const double angle = BeamLight::projectedAngle(half);
    const auto radiance =
        absoluteSpectrum(params, *context.defaultColor, {.power = kPiD * square(radius) * angle, .irradiance = angle},
                         context.span, diagnostics);
    if (!radiance) return nullptr;
    return std::make_unique<BeamLight>(toRender.point(params.position), axis / norm, radius, half, *radiance);
}

} // namespace abbe
