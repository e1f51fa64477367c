#include "cameras/perspective.h"

#include "base/check.h"
#include "cameras/connection.h"
#include "math/warp.h"

#include <cmath>

namespace abbe {

namespace {

using schema::Dimension;
using schema::field;
using schema::FieldInfo;
using schema::FieldType;
constexpr double kDefaultLens = 0.05; // m

std::vector<FieldInfo> viewFields() {
    using P = PerspectiveParams;
    return {field(FieldType::quantity, "lens", &P::lens)
                .unit({Dimension::length})
                .group("field of view")
                .range(1e-4, 100)
                .usually(3, "mm")
                .doc("Focal length. Default: 50 mm.")
                .example("lens 35 mm")
                .synonyms({"focal-length", "focallength", "focal_length"}),
            field(FieldType::quantity, "fov", &P::fov)
                .unit({Dimension::angle})
                .group("field of view")
                .range(0.001 * kDegree, 179.9 * kDegree)
                .doc("Full horizontal angle of view, instead of `lens`.")
                .example("fov 40 deg")
                .synonyms({"fovx", "angle", "field-of-view"})
                .note("`fov` is the full horizontal angle"),
            fStopField("Focal length over the diameter of the aperture. Without it the camera is a pinhole."),
            field(FieldType::quantity, "aperture", &P::aperture)
                .unit({Dimension::length})
                .group("aperture")
                .range(0, 100)
                .doc("Diameter of the aperture, instead of `f-stop`; 0 is a pinhole.")
                .example("aperture 30 mm")
                .synonyms({"lensdiameter", "aperture-diameter", "lens-radius", "aperture_radius"})
                .note("for an f-number use `f-stop 2.8`")};
}

std::vector<FieldInfo> specialFields() {
    using P = PerspectiveParams;
    return {field(FieldType::number, "squeeze", &P::squeeze)
                .byDefault("1")
                .range(0.1, 10)
                .doc("Squeeze of an anamorphic lens: the picture shows so many times the width of the sensor, and blur "
                     "is so many times as high as wide. `lens` is the vertical focal length.")
                .example("squeeze 2")
                .synonyms({"anamorphic", "aperture-ratio", "bokeh-ratio"}),
            field(FieldType::vector2, "shift", &P::shift)
                .unit({Dimension::length})
                .byDefault("0 0 mm")
                .range(-100, 100)
                .doc("Moves the lens along the sensor, right and up: the picture shows more of that side, and lines "
                     "that are parallel to the sensor stay parallel.")
                .example("shift 0 11 mm")
                .synonyms({"lens-shift", "film-offset", "screenwindow", "principal-point"}),
            field(FieldType::vector2, "tilt", &P::tilt)
                .unit({Dimension::angle})
                .byDefault("0 0 deg")
                .range(-80 * kDegree, 80 * kDegree)
                .doc("Turns the lens down and to the right, and with it the plane that is sharp; the field of view "
                     "stays. `focus` is where that plane meets the axis.")
                .example("tilt 8 0 deg")
                .synonyms({"swing", "scheimpflug", "lens-tilt"})};
}

// Radius of the aperture; 0 for a pinhole.
double lensRadius(const PerspectiveParams& params, double focalLength) {
    if (params.aperture) return *params.aperture / 2;
    return params.fStop && std::isfinite(*params.fStop) ? focalLength / *params.fStop / 2 : 0;
}

std::optional<double> fNumber(const PerspectiveParams& params, double focalLength) {
    if (!params.aperture) return params.fStop;
    return *params.aperture > 0 ? std::optional(focalLength / *params.aperture) : std::nullopt;
}

// Towards the sensor, for a lens that is turned down and to the right.
Vec3d lensNormal(Vec2d tilt) {
    return {-std::sin(tilt.y) * std::cos(tilt.x), std::sin(tilt.x), std::cos(tilt.y) * std::cos(tilt.x)};
}

} // namespace

schema::TypeInfo perspectiveType() {
    schema::TypeInfo type{.kind = schema::Kind::camera,
                          .name = "perspective",
                          .doc = "A pinhole or thin-lens camera.",
                          .example = "camera { from 0 1 4; look-at 0 0.5 0; lens 35 mm }",
                          .isDefault = true,
                          .fields = placementFields()};
    for (auto* fields : {viewFields, lensCameraFields, specialFields})
        for (FieldInfo& f : fields()) type.fields.push_back(std::move(f));
    return type;
}

PerspectiveCamera::PerspectiveCamera(const Frame& axes, Vec2i filmSize, const ThinLens& lens)
    : axes_(axes), lensRadius_(static_cast<float>(lens.aperture.radius())),
      invFocus_(static_cast<float>(1 / lens.focus)), aperture_(lens.aperture),
      invSqueeze_(static_cast<float>(1 / lens.squeeze)) {
    ABBE_CHECK(filmSize.x > 0 && filmSize.y > 0 && lens.tanHalfFov > 0 && lens.focus > 0 && lens.focalLength > 0);
    const double scale = 2 * lens.tanHalfFov / filmSize.x;
    scale_ = static_cast<float>(scale);
    corner_ = {static_cast<float>(lens.shift.x - lens.tanHalfFov),
               static_cast<float>(lens.shift.y + scale * filmSize.y / 2)};
    const Vec3d m = lensNormal(lens.tilt);
    special_ = !lens.aperture.isCircle() || lens.squeeze != 1 || m.z != 1;
    const Vec3d x = normalize(Vec3d{m.z, 0, -m.x});
    lensX_ = Vec3(x);
    lensY_ = Vec3(cross(m, x));
    lean_ = {static_cast<float>(-m.x / lens.focalLength), static_cast<float>(-m.y / lens.focalLength)};
}

Vec3 PerspectiveCamera::lensPoint(Vec2 u) const noexcept {
    const Vec2 p = aperture_.sample(u);
    return lensX_ * (p.x * invSqueeze_) + lensY_ * p.y;
}

// A point of the lens; bends the ray's direction.
Vec3 PerspectiveCamera::special(Vec2 u, Vec3& direction) const noexcept {
    const Vec3 lens = lensPoint(u);
    const float invDistance = std::fma(direction.x, lean_.x, std::fma(direction.y, lean_.y, invFocus_));
    direction = direction - lens * invDistance;
    return lens;
}

CameraRay PerspectiveCamera::ray(const CameraSample& sample) const noexcept {
    Vec3 direction{std::fma(sample.film.x, scale_, corner_.x), std::fma(-sample.film.y, scale_, corner_.y), -1};
    CameraRay result;
    if (lensRadius_ > 0) {
        // From the lens to the point of the sharp plane that the middle of the lens sees, over its distance: an
        // infinite distance needs no case of its own.
        if (special_) {
            result.ray.origin = axes_.toWorld(special(sample.lens, direction));
        } else {
            const Vec2 lens = squareToDisk(sample.lens) * lensRadius_;
            direction = direction - Vec3{lens.x, lens.y, 0} * invFocus_;
            result.ray.origin = axes_.toWorld({lens.x, lens.y, 0});
        }
    }
    result.ray.direction = normalize(axes_.toWorld(direction));
    result.ray.time = sample.time;
    return result;
}

// From the point l of the lens, what its middle sees in the direction c = (cx, cy, -1) lies in the direction v = c - l
// (k·c) with k = (lean, -1/focus): a linear map I - l kᵀ, of determinant 1 - k·l, and a multiple of c belongs to a unit
// vector w = v/|v| as w + l (k·w)/(1 - k·l) [Sherman1950]. As dω = |det(v, ∂v/∂cx, ∂v/∂cy)| / |v|³ dcx dcy, that
// is |1 - k·l| / |v|³, and |v| = 1/|z| for the multiple's z.
PerspectiveCamera::Sight PerspectiveCamera::sight(Vec3d lens, Vec3d away) const noexcept {
    const Vec3d k{static_cast<double>(lean_.x), static_cast<double>(lean_.y), -static_cast<double>(invFocus_)};
    const double determinant = 1 - dot(k, lens);
    const Vec3d middle = away + lens * (dot(k, away) / determinant);
    if (!(middle.z < 0)) return {};
    const auto scale = static_cast<double>(scale_);
    const double z = -middle.z;
    return {middle * (1 / z), 1 / (z * z * z * std::abs(determinant) * scale * scale)};
}

std::optional<LensConnection> PerspectiveCamera::connect(const LensQuery& query) const noexcept {
    CameraConnection found;
    if (lensRadius_ > 0) found.lens = Vec3d(lensPoint(query.lens));
    const Vec3d way = axes_.toLocal(Vec3d(query.p)) - found.lens;
    found.distance = length(way);
    found.away = way * (1 / found.distance);
    const Sight seen = sight(found.lens, found.away);
    if (!(seen.density > 0)) return std::nullopt;
    const auto scale = static_cast<double>(scale_);
    found.film = {(seen.middle.x - static_cast<double>(corner_.x)) / scale,
                  (static_cast<double>(corner_.y) - seen.middle.y) / scale};
    found.pdfFacingArea = seen.density / (found.distance * found.distance);
    return connection(axes_, query, found);
}

float PerspectiveCamera::pdfFacingArea(const LensQuery& query, const CameraRay& ray) const noexcept {
    const Sight seen = sight(axes_.toLocal(Vec3d(ray.ray.origin)), axes_.toLocal(Vec3d(ray.ray.direction)));
    const Vec3d way = Vec3d(query.p) - Vec3d(ray.ray.origin);
    return static_cast<float>(seen.density / lengthSquared(way));
}

std::optional<Vec2d> PerspectiveCamera::project(Vec3d p, double, Vec2d) const noexcept {
    const Vec3d seen = axes_.toLocal(p);
    if (!(seen.z < 0)) return std::nullopt;
    const Vec2d at{seen.x / -seen.z, seen.y / -seen.z}; // at distance 1
    const auto scale = static_cast<double>(scale_);
    return Vec2d{(at.x - static_cast<double>(corner_.x)) / scale, (static_cast<double>(corner_.y) - at.y) / scale};
}

std::optional<PlacedCamera> makePerspective(const PerspectiveParams& params, const CameraContext& context,
                                            Diagnostics& diagnostics) {
    const auto place = placeCamera(params, context, diagnostics);
    if (!place) return std::nullopt;
    const auto focus = focusDistance(params, *place, context, diagnostics);
    const double width = params.sensor.x * params.squeeze;
    ThinLens lens;
    lens.tanHalfFov = params.fov ? std::tan(*params.fov / 2) : width / (2 * params.lens.value_or(kDefaultLens));
    lens.focalLength = width / (2 * lens.tanHalfFov);
    const auto aperture = apertureOf(params, lensRadius(params, lens.focalLength), context, diagnostics);
    const auto exposure = exposureOf(params, fNumber(params, lens.focalLength), context, diagnostics);
    if (!focus || !aperture || !exposure) return std::nullopt;
    lens.aperture = *aperture;
    lens.focus = *focus;
    lens.squeeze = params.squeeze;
    lens.shift = {params.shift.x * params.squeeze / lens.focalLength, params.shift.y / lens.focalLength};
    lens.tilt = params.tilt;
    return PlacedCamera{std::make_unique<PerspectiveCamera>(place->axes, context.filmSize, lens),
                        place->origin,
                        *exposure,
                        place->shutter,
                        place->toWorld,
                        place->lookAtDistance};
}

} // namespace abbe
