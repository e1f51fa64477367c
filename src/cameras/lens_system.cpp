#include "cameras/lens_system.h"

#include "base/check.h"
#include "cameras/connection.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe {

using schema::Dimension;
using schema::field;
using schema::FieldInfo;
using schema::FieldType;

namespace {

constexpr double kReference = 587.5618; // nm, the d line: focal length, focus and f-number are meant there

std::vector<FieldInfo> lensFields() {
    using P = LensSystemParams;
    std::vector<std::string_view> names;
    for (const PublishedLens& lens : publishedLenses()) names.push_back(lens.name);
    return {field(FieldType::choice, "prescription", &P::prescription)
                .group("lens")
                .required()
                .choices(names)
                .doc("A published lens, see docs/cameras.md.")
                .example("prescription double-gauss")
                .synonyms({"lensfile", "lens-file", "lens-model"}),
            field(FieldType::table, "surfaces", &P::surfaces)
                .unit({Dimension::length})
                .group("lens")
                .required()
                .doc("The surfaces from the scene to the film: radius (positive if the centre lies towards the film), "
                     "`flat` or `stop`; thickness to the next; medium behind; semi-aperture.")
                .example("surfaces mm { - stop 1 air 11.4; - 62.8 4 N-BK7 12.7; - -45.7 2.5 N-SF5 12.7; "
                         "- -128.2 0 air 12.7 }"),
            field(FieldType::quantity, "lens", &P::lens)
                .unit({Dimension::length})
                .range(1e-4, 100)
                .usually(3, "mm")
                .doc("Scales the whole lens to this focal length. Default: that of the prescription.")
                .example("lens 50 mm")
                .synonyms({"focal-length", "focallength", "focal_length"}),
            fStopField("Focal length over the diameter of the entrance pupil. Default: the stop wide open.")};
}

Diagnostic& fault(const CameraContext& context, Diagnostics& diagnostics, std::string message, std::string label) {
    return diagnostics.error("E0356", context.span, std::move(message), std::move(label));
}

// The film's place for a distance of the sharp plane from the entrance pupil. Nothing after an error.
std::optional<double> filmPlace(const LensTrain& train, const CardinalPoints& points, double focus,
                                const CameraContext& context, Diagnostics& diagnostics) {
    const double object = focus - (train.entrancePupil(kReference) - points.frontPrincipal); // to the principal point
    const double f = points.focalLength;
    if (!(object > f)) {
        auto& d = fault(context, diagnostics, "the lens cannot focus so close",
                        fmt::format("`focus` must be beyond {:.4g} m", f + focus - object));
        d.help = "the image of anything nearer than the focal length is not real";
        return std::nullopt;
    }
    const double film = points.rearPrincipal + 1 / (1 / f - 1 / object);
    if (film > train.length() && film > train.rearEdge()) return film;
    fault(context, diagnostics, "the lens has no room for a film",
          fmt::format("its image lies {:.4g} mm in front of the last surface", 1e3 * (train.length() - film)));
    return std::nullopt;
}

// The radius of the stop. Nothing after an error.
std::optional<double> stopRadius(const LensSystemParams& params, const LensTrain& train, double focalLength,
                                 const CameraContext& context, Diagnostics& diagnostics) {
    const double scale = train.entrancePupilScale(kReference);
    const double widest = focalLength / (2 * scale * train.stopRadius());
    if (!params.fStop) return train.stopRadius();
    if (*params.fStop >= widest * (1 - 1e-3))
        return std::min(focalLength / (2 * scale * *params.fStop), train.stopRadius());
    fault(context, diagnostics, fmt::format("the lens does not open to f/{:.4g}", *params.fStop),
          fmt::format("wide open it has f/{:.3g}", widest));
    return std::nullopt;
}

std::optional<LensTrain> trainOf(const LensSystemParams& params, const CameraContext& context,
                                 Diagnostics& diagnostics) {
    std::optional<LensPrescription> lens;
    if (params.surfaces)
        lens = readPrescription(*params.surfaces, diagnostics);
    else
        lens = publishedLens(params.prescription.word);
    if (!lens) return std::nullopt;
    LensTrain train(*lens);
    const double f = train.cardinalPoints(kReference).focalLength;
    if (!(f > 0) || !std::isfinite(f)) {
        fault(context, diagnostics, "the lens does not gather light",
              std::isfinite(f) ? fmt::format("its focal length is {:.4g} mm", 1e3 * f) : "it has no power");
        return std::nullopt;
    }
    if (!params.lens) return train;
    lens->rescale(*params.lens / f);
    return LensTrain(*lens);
}

} // namespace

schema::TypeInfo lensSystemType() {
    schema::TypeInfo type{.kind = schema::Kind::camera,
                          .name = "lens-system",
                          .doc = "A lens of real glass, traced surface by surface: aberrations, colour errors and "
                                 "vignetting come out by themselves.",
                          .example = "camera lens-system { prescription double-gauss; lens 50 mm; f-stop 2.8; "
                                     "from 0 1 4; look-at 0 0.5 0 }",
                          .fields = placementFields()};
    for (auto* fields : {lensFields, lensCameraFields})
        for (FieldInfo& f : fields()) type.fields.push_back(std::move(f));
    return type;
}

LensSystemCamera::LensSystemCamera(const Frame& axes, Vec2i filmSize, double width, LensTrain train,
                                   const Optics& optics)
    : axes_(axes), train_(std::move(train)), optics_(optics),
      pixel_(width / filmSize.x), corner_{-width / 2, pixel_ * filmSize.y / 2} {
    ABBE_CHECK(!optics.opening.isPoint() && filmSize.x > 0 && filmSize.y > 0 && width > 0);
    exitPupil_ = ExitPupil(train_, optics_.opening, optics_.film, std::hypot(corner_.x, corner_.y));
    const double distance = optics_.film - train_.length();
    weight_ = 4 * optics_.fNumber * optics_.fNumber / (kPiD * distance * distance);
}

const EntrancePupil& LensSystemCamera::entrancePupil() const {
    std::call_once(searched_, [this] {
        const double radius = std::hypot(corner_.x, corner_.y);
        entrancePupil_ = EntrancePupil(train_, optics_.opening, optics_.pupil, exitPupil_, optics_.film, radius);
    });
    return entrancePupil_;
}

LensSystemCamera::Zone LensSystemCamera::zoneOf(Vec2d film) const noexcept {
    const double r = std::hypot(film.x, film.y);
    return {r > 0 ? Vec2d{film.x / r, film.y / r} : Vec2d{1, 0}, &exitPupil_.at(r)};
}

Vec3d LensSystemCamera::inLens(Vec3 p) const noexcept { return axes_.toLocal(Vec3d(p)) + Vec3d{0, 0, optics_.pupil}; }

// The illuminance at a film point is the integral of L cos⁴θ / Z² over the exit pupil's plane at distance Z
// [Kolb1995]; `cosine` is that of θ.
double LensSystemCamera::rayWeight(const ExitPupil::Box& box, double cosine) const noexcept {
    const double square = cosine * cosine;
    return weight_ * box.area() * square * square;
}

CameraRay LensSystemCamera::ray(const CameraSample& sample) const noexcept {
    CameraRay result;
    result.heroOnly = train_.disperses();
    // The image on the film stands on its head.
    const Vec2d film{-(corner_.x + pixel_ * static_cast<double>(sample.film.x)),
                     -(corner_.y - pixel_ * static_cast<double>(sample.film.y))};
    const auto [turn, box] = zoneOf(film);
    const double x = box->lower.x + static_cast<double>(sample.lens.x) * (box->upper.x - box->lower.x);
    const double y = box->lower.y + static_cast<double>(sample.lens.y) * (box->upper.y - box->lower.y);
    const Vec3d from{film.x, film.y, optics_.film};
    LensRay ray{from, normalize(Vec3d{turn.x * x - turn.y * y, turn.y * x + turn.x * y, train_.length()} - from)};
    result.weight = static_cast<float>(rayWeight(*box, ray.d.z));
    if (!(result.weight > 0) || !train_.toScene(ray, static_cast<double>(sample.wavelength), optics_.opening)) {
        result.weight = 0;
        return result;
    }
    result.ray.origin = axes_.toWorld(Vec3(Vec3d{ray.p.x, ray.p.y, ray.p.z - optics_.pupil}));
    result.ray.direction = normalize(axes_.toWorld(Vec3(ray.d)));
    result.ray.time = sample.time;
    return result;
}

// weight d(film) d(lens) of ray() is weight_ Z² / pixel² times the étendue cosθ dA dω behind the lens, dA on the film
// and dω = cos³θ/Z² of a patch of the exit pupil; and the étendue of a bundle is the same in the air before the lens,
// however the glass bends it [Born1999, §4.8.3]. So the importance that the lens emits is a constant where it lets
// light through.
double LensSystemCamera::importance(Vec3d p, Vec3d target, const PupilBox& box) const noexcept {
    const double z = optics_.film - train_.length(), emitted = weight_ * z * z / (pixel_ * pixel_);
    const Vec3d way = target - p;
    const double d2 = lengthSquared(way);
    return emitted * (way.z / std::sqrt(d2)) * box.area() / d2;
}

std::optional<LensConnection> LensSystemCamera::connect(const LensQuery& query) const noexcept {
    const Vec3d p = inLens(query.p);
    const auto aim = entrancePupil().towards(p);
    if (!aim) return std::nullopt;
    const Vec3d target = aim->at({static_cast<double>(query.lens.x), static_cast<double>(query.lens.y)});
    const Vec3d away = normalize(p - target);
    LensRay ray{p, -away};
    Vec3d entry;
    if (!train_.toFilm(ray, static_cast<double>(query.wavelength), optics_.opening, &entry)) return std::nullopt;
    const auto on = [&](double z) {
        const double way = (z - ray.p.z) / ray.d.z;
        return Vec2d{ray.p.x + ray.d.x * way, ray.p.y + ray.d.y * way};
    };
    const Vec2d film = on(optics_.film), exit = on(train_.length());
    const auto [turn, box] = zoneOf(film);
    if (!box->contains({turn.x * exit.x + turn.y * exit.y, turn.x * exit.y - turn.y * exit.x})) return std::nullopt;
    CameraConnection found;
    found.lens = entry - Vec3d{0, 0, optics_.pupil};
    found.away = away;
    found.distance = dot(p - entry, away);
    found.film = {(-film.x - corner_.x) / pixel_, (corner_.y + film.y) / pixel_};
    found.weight = rayWeight(*box, ray.d.z);
    found.pdfFacingArea = importance(p, target, aim->box) / found.weight;
    found.heroOnly = train_.disperses();
    return connection(axes_, query, found);
}

float LensSystemCamera::pdfFacingArea(const LensQuery& query, const CameraRay& ray) const noexcept {
    const Vec3d p = inLens(query.p), d = axes_.toLocal(Vec3d(ray.ray.direction));
    const auto aim = entrancePupil().towards(p);
    if (!aim || !(d.z < 0)) return 0;
    const Vec3d from = inLens(ray.ray.origin), target = from + d * ((aim->plane - from.z) / d.z);
    if (!aim->contains(target)) return 0;
    return static_cast<float>(importance(p, target, aim->box) / static_cast<double>(ray.weight));
}

// The ray through the middle of the entrance pupil, followed to the film.
std::optional<Vec2d> LensSystemCamera::project(Vec3d p, double, Vec2d) const noexcept {
    const Vec3d place = axes_.toLocal(p) + Vec3d{0, 0, optics_.pupil};
    const Vec3d pupil{0, 0, optics_.pupil};
    if (!(place.z < 0)) return std::nullopt;
    LensRay ray{place, normalize(pupil - place)};
    if (!train_.toFilm(ray, kReference, optics_.opening)) return std::nullopt;
    const double way = (optics_.film - ray.p.z) / ray.d.z;
    const Vec2d upright{-(ray.p.x + ray.d.x * way), -(ray.p.y + ray.d.y * way)};
    return Vec2d{(upright.x - corner_.x) / pixel_, (corner_.y - upright.y) / pixel_};
}

std::optional<PlacedCamera> makeLensSystem(const LensSystemParams& params, const CameraContext& context,
                                           Diagnostics& diagnostics) {
    const auto place = placeCamera(params, context, diagnostics);
    auto train = trainOf(params, context, diagnostics);
    if (!place || !train) return std::nullopt;
    const auto focus = focusDistance(params, *place, context, diagnostics);
    const CardinalPoints points = train->cardinalPoints(kReference);
    const auto radius = stopRadius(params, *train, points.focalLength, context, diagnostics);
    if (!focus || !radius) return std::nullopt;
    const auto film = filmPlace(*train, points, *focus, context, diagnostics);
    const auto opening = apertureOf(params, *radius, context, diagnostics);
    LensSystemCamera::Optics optics;
    optics.fNumber = points.focalLength / (2 * train->entrancePupilScale(kReference) * *radius);
    const auto exposure = exposureOf(params, optics.fNumber, context, diagnostics);
    if (!film || !opening || !exposure) return std::nullopt;
    optics.film = *film;
    optics.pupil = train->entrancePupil(kReference);
    optics.opening = *opening;
    return PlacedCamera{
        std::make_unique<LensSystemCamera>(place->axes, context.filmSize, params.sensor.x, std::move(*train), optics),
        place->origin,
        *exposure,
        place->shutter,
        place->toWorld,
        place->lookAtDistance};
}

} // namespace abbe
