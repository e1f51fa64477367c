#include "lights/daylight_light.h"

#include "lights/amount.h"
#include "lights/clear_sky.h"
#include "lights/light_context.h"
#include "lights/sun_light.h"

#include <array>
#include <fmt/format.h>

namespace abbe {

namespace {

using schema::FieldType;

constexpr int kSkyColumns = 256, kSkyRows = 256; // the horizon lies between two rows
constexpr double kCellSolidAngle = 4 * kPiD / (kSkyColumns * kSkyRows);
constexpr double kGroundAlbedo = 0.2;

double rowHeight(double row) { return 2 * row / kSkyRows - 1; }

Vec3 direction(double column, double row) {
    const double z = rowHeight(row), r = safeSqrt((1 - z) * (1 + z)), phi = 2 * kPiD * column / kSkyColumns;
    return Vec3(Vec3d{r * std::cos(phi), r * std::sin(phi), z});
}

Vec3 mirrored(Vec3 w, Vec3 n) { return normalize(w - n * (2 * dot(w, n))); }

// Gases are taken as if all light of the sky had come the sun's way.
SampledCurve sourceCurve(double sunElevation) {
    const double airMass = relativeAirMass(kPiD / 2 - std::max(sunElevation, 0.0));
    return SampledCurve([airMass](double nm) {
        return solarIrradianceInSpace(nm) * gasTransmittance(nm, airMass) * ClearSky::scale(nm);
    });
}

} // namespace

schema::TypeInfo daylightType() {
    schema::TypeInfo type{.kind = schema::Kind::light,
                          .name = "daylight",
                          .doc = "Sun and sky of a cloudless day or twilight in absolute units, and the light from the "
                                 "ground below the horizon.",
                          .example = "light daylight { elevation 40 deg; azimuth 200 deg; turbidity 3 }",
                          .fields = sunPlaceFields<DaylightParams>()};
    type.fields.push_back(schema::field(FieldType::number, "turbidity", &DaylightParams::turbidity)
                              .byDefault("3")
                              .range(1, 10)
                              .doc("How hazy the air is: 1 pure air, 2 very clear, 3 clear, 6 warm and moist, 10 hazy.")
                              .example("turbidity 2.5")
                              .synonyms({"haze"}));
    type.fields.push_back(schema::field(FieldType::number, "ozone", &DaylightParams::ozone)
                              .byDefault("300")
                              .range(0, 1000)
                              .doc("Ozone overhead in Dobson units; it keeps the sky of twilight blue.")
                              .example("ozone 350"));
    type.fields.push_back(schema::field(FieldType::spectrum, "ground-albedo", &DaylightParams::groundAlbedo)
                              .byDefault("0.2")
                              .role(schema::SpectrumRole::albedo)
                              .doc("Share of the light that the ground far away reflects: seen below the horizon, and "
                                   "scattered down again by the air.")
                              .example("ground-albedo 0.3")
                              .synonyms({"ground_albedo", "albedo"}));
    type.fields.push_back(schema::field(FieldType::toggle, "sun", &DaylightParams::sun)
                              .byDefault("on")
                              .doc("Whether the disk of the sun shines; the sky stays as it is without.")
                              .example("sun off")
                              .synonyms({"sun-disk", "sun_disc"}));
    type.fields.push_back(portalsField<DaylightParams>());
    type.fields.push_back(distantVisibleField<DaylightParams>());
    type.fields.push_back(schema::field(FieldType::transform, "transform", &DaylightParams::transform)
                              .doc("Turns the light; moving it has no effect.")
                              .example("transform { rotate y 30 deg }")
                              .synonyms({"to-world", "matrix"}));
    return type;
}

DaylightSky::DaylightSky(const Frame& axes, double sunElevation, const AirParams& air, const Curve& groundAlbedo,
                         bool sunOnGround)
    : axes_(axes), sky_(air, sunElevation, SkyBands::mean([&](double nm) { return groundAlbedo.at(nm); })),
      source_(sourceCurve(sunElevation)),
      sunlight_(std::make_shared<SampledCurve>(solarIrradiance(kPiD / 2 - sunElevation, air))),
      totals_(totals(groundAlbedo, sunOnGround ? std::max(std::sin(sunElevation), 0.0) : 0)), distribution_(tabulate()),
      groundShare_(luminousIntegral(*totals_.ground) * kSkyColumns * kSkyRows / 2 / distribution_.total()),
      radiant_(radiantIntegral(*totals_.fluence)), visibleFluence_(visibleIntegral(*totals_.fluence)) {
    commit(Bounds3{});
}

void DaylightSky::commit(const Bounds3& bounds) { power_ = radiant_ * sceneDiskArea(bounds); }

DaylightSky::Totals DaylightSky::totals(const Curve& groundAlbedo, double sunHeight) const {
    SkyBands scalar(0), horizontal(0); // ∫ L dω, ∫ L cos θ dω
    for (int row = kSkyRows / 2; row < kSkyRows; ++row)
        for (int column = 0; column < kSkyColumns; ++column) {
            const SkyBands value = sky_.at(direction(column + 0.5, row + 0.5)) * static_cast<float>(kCellSolidAngle);
            scalar += value;
            horizontal = fma(value, static_cast<float>(rowHeight(row + 0.5)), horizontal);
        }
    Totals result;
    result.ground = std::make_shared<SampledCurve>([&](double nm) {
        const double sky = source_.at(nm) * horizontal.at(nm), sun = sunlight_->at(nm) * sunHeight;
        return groundAlbedo.at(nm) * (sky + sun) / kPiD;
    });
    result.fluence = std::make_shared<SampledCurve>(
        [&](double nm) { return source_.at(nm) * scalar.at(nm) + 2 * kPiD * result.ground->at(nm); });
    return result;
}

// By luminance.
Distribution2D DaylightSky::tabulate() const {
    std::array<double, SkyBands::kCount> luminance; // of a value of 1 at one band
    for (int band = 0; band < SkyBands::kCount; ++band) {
        const SkyBands one = SkyBands::of([&](double nm) { return nm == SkyBands::wavelength(band) ? 1.0 : 0.0; });
        luminance[static_cast<std::size_t>(band)] =
            luminousIntegral(SampledCurve([&](double nm) { return source_.at(nm) * one.at(nm); }));
    }
    std::vector<double> weights(static_cast<std::size_t>(kSkyColumns) * kSkyRows, luminousIntegral(*totals_.ground));
    for (int row = kSkyRows / 2; row < kSkyRows; ++row)
        for (int column = 0; column < kSkyColumns; ++column) {
            SkyBands mean(0);
            for (const double dr : {0.25, 0.75})
                for (const double dc : {0.25, 0.75}) mean = fma(sky_.at(direction(column + dc, row + dr)), 0.25f, mean);
            double sum = 0;
            for (int band = 0; band < SkyBands::kCount; ++band)
                sum += mean[band] * luminance[static_cast<std::size_t>(band)];
            weights[static_cast<std::size_t>(row * kSkyColumns + column)] = sum;
        }
    return {weights, kSkyColumns};
}

// Of an opaque surface: of either half of the directions, sky and ground, it has the more in sight the more it faces
// it.
double DaylightSky::groundShare(const Receiver& from) const noexcept {
    if (!from.oneSided()) return groundShare_;
    const double up = std::clamp(static_cast<double>(dot(from.n, axes_.z)), -0.9999, 0.9999);
    const double ground = groundShare_ * (1 - up), sky = (1 - groundShare_) * (1 + up);
    return ground / (ground + sky);
}

// What lies behind an opaque surface is mirrored to its front.
std::optional<LightSample> DaylightSky::sample(const Receiver& from, std::uint32_t, Vec2 u, const Wavelengths& lambda,
                                               float) const noexcept {
    const double ground = groundShare(from), v = static_cast<double>(u.y);
    const double row =
        v < ground ? v / ground * groundShare_ : groundShare_ + (v - ground) / (1 - ground) * (1 - groundShare_);
    const CellSample cell = distribution_.sample({u.x, std::min(static_cast<float>(row), kOneMinusEpsilon)});
    const Vec3 local = direction(static_cast<double>(cell.column) + static_cast<double>(cell.offset.x),
                                 static_cast<double>(cell.row) + static_cast<double>(cell.offset.y));
    Vec3 wi = normalize(axes_.toWorld(local));
    if (from.oneSided() && dot(wi, from.n) < 0) wi = mirrored(wi, from.n);
    const float pdf = pdfEscaped(from, wi, 0);
    if (!(pdf > 0)) return std::nullopt;
    return std::optional<LightSample>(std::in_place, wi, Vec3{}, kInfinity, escaped(wi, lambda, 0), pdf);
}

Spectrum DaylightSky::escaped(Vec3 w, const Wavelengths& lambda, float) const noexcept {
    const Vec3 local = axes_.toLocal(w);
    return local.z > 0 ? sky_.at(local).at(lambda) * source_.at(lambda) : totals_.ground->at(lambda);
}

float DaylightSky::pdfEscaped(const Receiver& from, Vec3 w, float) const noexcept {
    const double ground = groundShare(from);
    if (!from.oneSided()) return density(w, ground);
    return dot(w, from.n) < 0 ? 0 : density(w, ground) + density(mirrored(w, from.n), ground);
}

float DaylightSky::density(Vec3 w, double ground) const noexcept {
    const Vec3 local = axes_.toLocal(w);
    const float turn = std::atan2(local.y, local.x) * (0.5f * kInvPi);
    const int column = static_cast<int>((turn < 0 ? turn + 1 : turn) * kSkyColumns);
    const int row = static_cast<int>(0.5f * (local.z + 1) * kSkyRows);
    const double p = distribution_.probability(static_cast<std::size_t>(std::min(column, kSkyColumns - 1)),
                                               static_cast<std::size_t>(std::clamp(row, 0, kSkyRows - 1)));
    if (!(p > 0)) return 0; // a black ground
    const double half = row < kSkyRows / 2 ? ground / groundShare_ : (1 - ground) / (1 - groundShare_);
    return static_cast<float>(p / kCellSolidAngle * half);
}

std::vector<std::unique_ptr<DistantLight>> makeDaylight(const DaylightParams& params, const LightContext& context,
                                                        Diagnostics& diagnostics) {
    const auto place = sunDirection(params, context.zUp, context.span, diagnostics);
    if (!place) return {};
    const Transform toRender = params.transform.at(context.time).then(context.toRender);
    if (!toRender.uniformScale()) {
        diagnostics.error("E0348", context.span, "a sky can be turned, but not stretched");
        return {};
    }
    const Vec3d up = context.zUp ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
    const double height = dot(up, *place);
    const double elevation = std::asin(std::clamp(height, -1.0, 1.0));
    if (elevation < DaylightSky::kLowestSun) {
        Diagnostic& d = diagnostics.error("E0750", context.span, "the sun is too far below the horizon",
                                          fmt::format("{:.4g} deg", elevation * 180 / kPiD));
        d.help =
            "twilight is computed down to -12 deg, the night is not: give a higher `elevation`, or use `light sky`";
        return {};
    }
    const Vec3d zenith = normalize(toRender.vector(up)), sun = normalize(toRender.vector(*place));
    const ConstantCurve albedo(kGroundAlbedo);
    const Curve& ground = params.groundAlbedo ? *params.groundAlbedo : albedo;
    DigestWriter key("daylight");
    key.add(zenith), key.add(sun);
    for (const double v : {elevation, params.turbidity, params.ozone}) key.number(v);
    key.number(params.sun);
    addCurve(key, ground);
    auto sky = std::make_unique<DaylightSky>(*KeptTables::get<DaylightSky>(context.kept, key.digest(), [&] {
        return std::make_shared<const DaylightSky>(Frame::fromNormalTangent(Vec3(zenith), Vec3(sun)), elevation,
                                                   AirParams{params.turbidity, params.ozone}, ground, params.sun);
    }));
    std::unique_ptr<SunLight> disk;
    if (params.sun && elevation > 0)
        disk = std::make_unique<SunLight>(sun, kSunHalfAngle, ScaledCurve{&sky->sunlight(), 1});
    const auto windows = portalCorners(params, context, diagnostics);
    if (!windows) return {};
    std::vector<std::unique_ptr<DistantLight>> lights;
    if (windows->empty() || !context.besideScattering) {
        lights.push_back(std::move(sky));
    } else {
        Portals portals = portalsFor(*sky, *windows, context, key.digest());
        auto room = std::make_unique<WindowLight>(std::move(sky), std::move(portals));
        if (disk) disk->lookThrough(room->portals());
        lights.push_back(std::move(room));
    }
    if (disk) lights.push_back(std::move(disk));
    return lights;
}

} // namespace abbe
