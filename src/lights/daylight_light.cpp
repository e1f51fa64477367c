#include "lights/daylight_light.h"

#include "lights/amount.h"
#include "lights/scene_disk.h"
#include "lights/solar_spectrum.h"
#include "lights/sun_light.h"

#include <fmt/format.h>

namespace abbe {

namespace {

using schema::FieldType;

constexpr int kSkyColumns = 256, kSkyRows = 256; // the horizon lies between two rows
constexpr double kCellSolidAngle = 4 * kPiD / (kSkyColumns * kSkyRows);
constexpr double kGroundAlbedo = 0.2;
constexpr double kSunHalfAngle = 0.265 * kPiD / 180;

double rowHeight(double row) { return 2 * row / kSkyRows - 1; }

Vec3 direction(double column, double row) {
    const double z = rowHeight(row), r = safeSqrt((1 - z) * (1 + z)), phi = 2 * kPiD * column / kSkyColumns;
    return Vec3(Vec3d{r * std::cos(phi), r * std::sin(phi), z});
}

} // namespace

schema::TypeInfo daylightType() {
    schema::TypeInfo type{.kind = schema::Kind::light,
                          .name = "daylight",
                          .doc = "Sun and sky of a clear or hazy day in absolute units, and the light from the ground "
                                 "below the horizon.",
                          .example = "light daylight { elevation 40 deg; azimuth 200 deg; turbidity 3 }",
                          .fields = sunPlaceFields<DaylightParams>()};
    type.fields.push_back(schema::field(FieldType::number, "turbidity", &DaylightParams::turbidity)
                              .byDefault("3")
                              .range(2, 10)
                              .doc("How hazy the air is: 2 very clear, 3 clear, 6 warm and moist, 10 slightly hazy.")
                              .example("turbidity 2.5")
                              .synonyms({"haze"}));
    type.fields.push_back(schema::field(FieldType::spectrum, "ground-albedo", &DaylightParams::groundAlbedo)
                              .byDefault("0.2")
                              .role(schema::SpectrumRole::albedo)
                              .doc("Share of the light that the ground far away reflects, seen below the horizon.")
                              .example("ground-albedo 0.3")
                              .synonyms({"ground_albedo", "albedo"}));
    type.fields.push_back(schema::field(FieldType::toggle, "sun", &DaylightParams::sun)
                              .byDefault("on")
                              .doc("Whether the disk of the sun shines; the sky stays as it is without.")
                              .example("sun off")
                              .synonyms({"sun-disk", "sun_disc"}));
    type.fields.push_back(schema::field(FieldType::transform, "transform", &DaylightParams::transform)
                              .doc("Turns the light; moving it has no effect.")
                              .example("transform { rotate y 30 deg }")
                              .synonyms({"to-world", "matrix"}));
    return type;
}

DaylightModel::DaylightModel(Vec3 sun, double turbidity)
    : sun_(sun),
      sky_(std::acos(std::min(static_cast<double>(sun.z), 1.0)), turbidity), luminous_{luminousIntegral(basis_.s0),
                                                                                       luminousIntegral(basis_.s1),
                                                                                       luminousIntegral(basis_.s2)} {}

PreethamSky::Value DaylightModel::at(Vec3 w) const noexcept {
    // The angle from its chord: nothing cancels beside the sun.
    const double fromSun = 2 * std::asin(std::min(0.5 * static_cast<double>(length(w - sun_)), 1.0));
    return sky_.at(w.z, fromSun);
}

DaylightModel::Mix DaylightModel::mix(Vec3 w) const noexcept {
    const PreethamSky::Value v = at(w);
    const DaylightWeights m = daylightWeights(v.chromaticity);
    const double s0 = v.luminance / (luminous_[0] + m.m1 * luminous_[1] + m.m2 * luminous_[2]);
    return {s0, s0 * m.m1, s0 * m.m2};
}

// At the ends of the spectrum the basis can fall below 0 for the bluest skies.
Spectrum DaylightModel::radiance(Vec3 w, const Wavelengths& lambda) const noexcept {
    const Mix m = mix(w);
    const Spectrum s = basis_.s0.at(lambda) * static_cast<float>(m.s0) +
                       basis_.s1.at(lambda) * static_cast<float>(m.s1) +
                       basis_.s2.at(lambda) * static_cast<float>(m.s2);
    return max(s, Spectrum(0.f));
}

SampledCurve DaylightModel::curve(const Mix& m) const {
    return SampledCurve([&](double nm) {
        return std::max(m.s0 * basis_.s0.at(nm) + m.s1 * basis_.s1.at(nm) + m.s2 * basis_.s2.at(nm), 0.0);
    });
}

DaylightSky::DaylightSky(const Frame& axes, Vec3 sun, double turbidity, const Curve& groundAlbedo,
                         std::unique_ptr<const Curve> sunlight, bool sunOnGround)
    : axes_(axes), model_(axes.toLocal(sun), turbidity), sunlight_(std::move(sunlight)),
      totals_(totals(model_, groundAlbedo, sunOnGround ? sunlight_.get() : nullptr, axes.toLocal(sun).z)),
      distribution_(density()), radiant_(radiantIntegral(*totals_.fluence)) {
    commit(Bounds3{});
}

void DaylightSky::commit(const Bounds3& bounds) { power_ = radiant_ * sceneDiskArea(bounds); }

DaylightSky::Totals DaylightSky::totals(const DaylightModel& model, const Curve& groundAlbedo, const Curve* sunlight,
                                        double sunHeight) {
    DaylightModel::Mix scalar, horizontal; // ∫ L dω, ∫ L cos θ dω
    for (int row = kSkyRows / 2; row < kSkyRows; ++row)
        for (int column = 0; column < kSkyColumns; ++column) {
            const DaylightModel::Mix m = model.mix(direction(column + 0.5, row + 0.5));
            const double height = rowHeight(row + 0.5) * kCellSolidAngle;
            scalar = {scalar.s0 + m.s0 * kCellSolidAngle, scalar.s1 + m.s1 * kCellSolidAngle,
                      scalar.s2 + m.s2 * kCellSolidAngle};
            horizontal = {horizontal.s0 + m.s0 * height, horizontal.s1 + m.s1 * height, horizontal.s2 + m.s2 * height};
        }
    const SampledCurve onGround = model.curve(horizontal), sky = model.curve(scalar);
    Totals result;
    result.ground = std::make_unique<SampledCurve>([&](double nm) {
        const double direct = sunlight ? sunlight->at(nm) * sunHeight : 0;
        return groundAlbedo.at(nm) * (onGround.at(nm) + direct) / kPiD;
    });
    result.fluence =
        std::make_unique<SampledCurve>([&](double nm) { return sky.at(nm) + 2 * kPiD * result.ground->at(nm); });
    return result;
}

Distribution2D DaylightSky::density() const {
    std::vector<double> weights(static_cast<std::size_t>(kSkyColumns) * kSkyRows, luminousIntegral(*totals_.ground));
    for (int row = kSkyRows / 2; row < kSkyRows; ++row)
        for (int column = 0; column < kSkyColumns; ++column) {
            double sum = 0;
            for (const double dr : {0.25, 0.75})
                for (const double dc : {0.25, 0.75}) sum += model_.luminance(direction(column + dc, row + dr)) / 4;
            weights[static_cast<std::size_t>(row * kSkyColumns + column)] = sum;
        }
    return {weights, kSkyColumns};
}

std::optional<LightSample> DaylightSky::sample(const Receiver&, std::uint32_t, Vec2 u, const Wavelengths& lambda,
                                               float) const noexcept {
    const CellSample cell = distribution_.sample(u);
    const Vec3 local = direction(static_cast<double>(cell.column) + static_cast<double>(cell.offset.x),
                                 static_cast<double>(cell.row) + static_cast<double>(cell.offset.y));
    const Vec3 wi = normalize(axes_.toWorld(local));
    return std::optional<LightSample>(std::in_place, wi, Vec3{}, kInfinity, escaped(wi, lambda, 0),
                                      static_cast<float>(cell.probability / kCellSolidAngle));
}

Spectrum DaylightSky::escaped(Vec3 w, const Wavelengths& lambda, float) const noexcept {
    const Vec3 local = axes_.toLocal(w);
    return local.z > 0 ? model_.radiance(local, lambda) : totals_.ground->at(lambda);
}

float DaylightSky::pdfEscaped(const Receiver&, Vec3 w, float) const noexcept {
    const Vec3 local = axes_.toLocal(w);
    const float turn = std::atan2(local.y, local.x) * (0.5f * kInvPi);
    const int column = static_cast<int>((turn < 0 ? turn + 1 : turn) * kSkyColumns);
    const int row = static_cast<int>(0.5f * (local.z + 1) * kSkyRows);
    const double p = distribution_.probability(static_cast<std::size_t>(std::min(column, kSkyColumns - 1)),
                                               static_cast<std::size_t>(std::clamp(row, 0, kSkyRows - 1)));
    return static_cast<float>(p / kCellSolidAngle);
}

std::vector<std::unique_ptr<Light>> makeDaylight(const DaylightParams& params, const LightContext& context,
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
    if (!(height > 0)) {
        Diagnostic& d = diagnostics.error("E0750", context.span, "the sun is not above the horizon",
                                          fmt::format("{:.4g} deg", std::asin(height) * 180 / kPiD));
        d.help = "the model has no twilight and no night: give an `elevation` above 0 deg, or use `light sky`";
        return {};
    }
    const Vec3d zenith = normalize(toRender.vector(up)), sun = normalize(toRender.vector(*place));
    auto sunlight = std::make_unique<SampledCurve>(solarIrradiance(std::acos(std::min(height, 1.0)), params.turbidity));
    const ConstantCurve albedo(kGroundAlbedo);
    auto sky = std::make_unique<DaylightSky>(Frame::fromNormal(Vec3(zenith)), Vec3(sun), params.turbidity,
                                             params.groundAlbedo ? *params.groundAlbedo : albedo, std::move(sunlight),
                                             params.sun);
    std::unique_ptr<Light> disk;
    if (params.sun) disk = std::make_unique<SunLight>(sun, kSunHalfAngle, ScaledCurve{&sky->sunlight(), 1});
    std::vector<std::unique_ptr<Light>> lights;
    lights.push_back(std::move(sky));
    if (disk) lights.push_back(std::move(disk));
    return lights;
}

} // namespace abbe
