#include "lights/ies_light.h"

#include "base/check.h"
#include "lights/amount.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

using schema::Dimension;
using schema::FieldType;

// The angle in the part of the circle that the table has.
double mirrored(double about, PlaneSymmetry symmetry) {
    const double turn = 2 * kPiD, half = kPiD, quarter = kPiD / 2;
    double phi = std::fmod(about, turn);
    if (phi < 0) phi += turn;
    switch (symmetry) {
    case PlaneSymmetry::axial:
        return 0;
    case PlaneSymmetry::quarter:
        phi = phi > half ? turn - phi : phi;
        return phi > quarter ? half - phi : phi;
    case PlaneSymmetry::half:
        return phi > half ? turn - phi : phi;
    case PlaneSymmetry::across:
        return phi < quarter ? half - phi : phi > half + quarter ? turn + half - phi : phi;
    default:
        return phi;
    }
}

struct Place {
    std::size_t index = 0;
    double fraction = 0;
};
Place placeAmong(const std::vector<double>& nodes, double x) {
    if (nodes.size() < 2) return {};
    const auto next = std::upper_bound(nodes.begin() + 1, nodes.end() - 1, x);
    const auto i = static_cast<std::size_t>(next - nodes.begin()) - 1;
    return {i, std::clamp((x - nodes[i]) / (nodes[i + 1] - nodes[i]), 0.0, 1.0)};
}

// ∫ f sin θ dθ from a to b of the f that is linear between fa and fb.
double coneIntegral(double a, double b, double fa, double fb) {
    const double slope = (fb - fa) / (b - a), constant = fa - slope * a;
    const auto antiderivative = [&](double t) {
        return -constant * std::cos(t) + slope * (std::sin(t) - t * std::cos(t));
    };
    return antiderivative(b) - antiderivative(a);
}

} // namespace

schema::TypeInfo iesLightType() {
    schema::TypeInfo type{.kind = schema::Kind::light,
                          .name = "ies",
                          .doc = "A point that emits as a photometric file (IES LM-63, type C) says, by direction. "
                                 "Without `power`: as much as the file says.",
                          .example = "light ies \"lamp.ies\" { position 0 2.5 0; color blackbody 3000 K }",
                          .fields = {}};
    type.fields.push_back(schema::field(FieldType::file, "file", &IesLightParams::file)
                              .argument(0)
                              .required()
                              .doc("IES file.")
                              .example("file \"lamp.ies\"")
                              .synonyms({"filename", "profile"}));
    type.fields.push_back(schema::field(FieldType::vector3, "position", &IesLightParams::position)
                              .unit({Dimension::length})
                              .byDefault("0 0 0")
                              .doc("Where the light is.")
                              .example("position 0 2.5 0")
                              .synonyms({"from", "center", "location"}));
    type.fields.push_back(schema::field(FieldType::vector3, "look-at", &IesLightParams::lookAt)
                              .unit({Dimension::length})
                              .group("axis")
                              .doc("A point on the axis, from which the file's vertical angles count.")
                              .example("look-at 0 0 0")
                              .synonyms({"to", "target"}));
    type.fields.push_back(schema::field(FieldType::vector3, "toward", &IesLightParams::toward)
                              .group("axis")
                              .doc("Direction of the axis, of any length. Without `look-at`: down.")
                              .example("toward 1 -1 0")
                              .synonyms({"direction", "axis"}));
    type.fields.push_back(schema::field(FieldType::quantity, "turn", &IesLightParams::turn)
                              .unit({Dimension::angle})
                              .byDefault("0 deg")
                              .range(-2 * kPiD, 2 * kPiD)
                              .doc("Turns the light about its axis. At 0 the file's plane of 0 deg lies towards +x.")
                              .example("turn 90 deg")
                              .synonyms({"rotation", "roll"}));
    addAmountFields<IesLightParams>(type.fields, AmountField::power);
    type.fields.push_back(schema::field(FieldType::transform, "transform", &IesLightParams::transform)
                              .doc("Places the light: steps from top to bottom, as applied to it.")
                              .example("transform { translate 0 2 0 }")
                              .synonyms({"to-world", "matrix"}));
    return type;
}

IesProfile::IesProfile(IntensityTable table) : table_(std::move(table)) {
    ABBE_CHECK(table_.vertical.size() >= 2 && !table_.horizontal.empty());
    ABBE_CHECK(table_.candela.size() == table_.vertical.size() * table_.horizontal.size());
    lumens_ = integrate();
}

double IesProfile::candela(double fromAxis, double about) const noexcept {
    // Angles of a file are decimal degrees: the ends are met up to rounding.
    constexpr double rounding = 1e-6;
    if (fromAxis < table_.vertical.front() - rounding || fromAxis > table_.vertical.back() + rounding) return 0;
    const Place v = placeAmong(table_.vertical, fromAxis);
    const Place h = placeAmong(table_.horizontal, mirrored(about, table_.symmetry));
    const auto alongPlane = [&](std::size_t plane) {
        return std::lerp(table_.at(plane, v.index), table_.at(plane, v.index + 1), v.fraction);
    };
    if (table_.horizontal.size() == 1) return alongPlane(0);
    return std::lerp(alongPlane(h.index), alongPlane(h.index + 1), h.fraction);
}

double IesProfile::integrate() const {
    std::vector<double> planes;
    for (std::size_t h = 0; h < table_.horizontal.size(); ++h) {
        double sum = 0;
        for (std::size_t v = 0; v + 1 < table_.vertical.size(); ++v)
            sum += coneIntegral(table_.vertical[v], table_.vertical[v + 1], table_.at(h, v), table_.at(h, v + 1));
        planes.push_back(sum);
    }
    if (planes.size() == 1) return 2 * kPiD * planes[0];
    double sum = 0;
    for (std::size_t h = 0; h + 1 < planes.size(); ++h)
        sum += 0.5 * (planes[h] + planes[h + 1]) * (table_.horizontal[h + 1] - table_.horizontal[h]);
    return sum * 2 * kPiD / (table_.horizontal.back() - table_.horizontal.front());
}

IesLight::IesLight(Vec3 position, const Frame& axes, IesProfile profile, ScaledCurve perCandela)
    : position_(position), axes_(axes), profile_(std::move(profile)), perCandela_(perCandela), directions_(density()),
      largestPdf_(largestDensity()), power_(profile_.lumens() * radiantIntegral(*perCandela.curve) * perCandela.scale),
      visiblePower_(profile_.lumens() * visibleIntegral(*perCandela.curve) * perCandela.scale) {}

std::optional<LightSample> IesLight::sample(const Receiver& from, std::uint32_t, Vec2, const Wavelengths& lambda,
                                            float) const noexcept {
    const Vec3 offset = position_ - from.p;
    const float d2 = lengthSquared(offset);
    if (!(d2 >= std::numeric_limits<float>::min())) return std::nullopt; // at the light: no direction
    const float distance = std::sqrt(d2);
    const Vec3 wi = offset / distance;
    const Angles at = angles(-wi);
    const float candela = static_cast<float>(profile_.candela(at.fromAxis, at.about));
    if (!(candela > 0)) return std::nullopt;
    return std::optional<LightSample>(std::in_place, wi, position_, distance, perCandela_.at(lambda) * (candela / d2),
                                      1.f, true);
}

IesLight::Angles IesLight::angles(Vec3 w) const noexcept {
    const Vec3d local(axes_.toLocal(w));
    // y points the other way round for one who looks along the axis.
    return {std::atan2(std::hypot(local.x, local.y), local.z), std::atan2(-local.y, local.x)};
}

namespace {

// Cells of directions; within one the density is even per solid angle.
constexpr int kIesRows = 90, kIesColumns = 24;

double rowEdge(std::size_t row) { return kPiD * static_cast<double>(row) / kIesRows; }
// 2 sin a sin b for cos(a - b) - cos(a + b): nothing cancels near the axis.
double cellSolidAngle(std::size_t row) {
    return 2 * kPiD / kIesColumns * 2 * std::sin((rowEdge(row) + rowEdge(row + 1)) / 2) *
           std::sin(kPiD / (2 * kIesRows));
}

} // namespace

// The mean of three by three points of each cell. Where these see nothing there may be a little light all the same: a
// hundredth of the mean goes everywhere.
Distribution2D IesLight::density() const {
    constexpr int points = 3;
    const double floor = 0.01 * profile_.lumens() / (4 * kPiD);
    std::vector<double> weights;
    for (std::size_t row = 0; row < kIesRows; ++row)
        for (int column = 0; column < kIesColumns; ++column) {
            double sum = 0;
            for (int i = 0; i < points; ++i)
                for (int j = 0; j < points; ++j)
                    sum += profile_.candela(std::lerp(rowEdge(row), rowEdge(row + 1), (i + 0.5) / points),
                                            2 * kPiD * (column + (j + 0.5) / points) / kIesColumns - kPiD);
            weights.push_back((sum / (points * points) + floor) * cellSolidAngle(row));
        }
    return {weights, kIesColumns};
}

float IesLight::largestDensity() const {
    double largest = 0;
    for (std::size_t row = 0; row < kIesRows; ++row)
        for (std::size_t column = 0; column < kIesColumns; ++column)
            largest = std::max(largest, directions_.probability(column, row) / cellSolidAngle(row));
    return static_cast<float>(largest);
}

Vec3 IesLight::sampleDirection(const LightOrigin&, Vec2 u) const noexcept {
    const CellSample cell = directions_.sample(u);
    const double upper = rowEdge(cell.row), lower = rowEdge(cell.row + 1), share = static_cast<double>(cell.offset.y);
    // Even in the cosine: sin² of half the angle is linear in it, and does not cancel near the axis.
    const double half2 = std::lerp(square(std::sin(upper / 2)), square(std::sin(lower / 2)), share);
    const double sine = 2 * std::sqrt(half2 * (1 - half2)), cosine = 1 - 2 * half2;
    const double about = 2 * kPiD * (cell.column + static_cast<double>(cell.offset.x)) / kIesColumns - kPiD;
    const Vec3 local(Vec3d{sine * std::cos(about), -sine * std::sin(about), cosine});
    return normalize(axes_.toWorld(local));
}

float IesLight::pdfDirection(const LightOrigin&, Vec3 w) const noexcept {
    const Angles at = angles(w);
    const auto cell = [](double share, int count) {
        return static_cast<std::size_t>(std::clamp(static_cast<int>(share * count), 0, count - 1));
    };
    const std::size_t row = cell(at.fromAxis / kPiD, kIesRows), column = cell(at.about / (2 * kPiD) + 0.5, kIesColumns);
    return static_cast<float>(directions_.probability(column, row) / cellSolidAngle(row));
}

Spectrum IesLight::leaving(const LightOrigin&, Vec3 w, const Wavelengths& lambda) const noexcept {
    const Angles at = angles(w);
    return perCandela_.at(lambda) * static_cast<float>(profile_.candela(at.fromAxis, at.about));
}

std::unique_ptr<PlacedLight> makeIesLight(const IesLightParams& params, IntensityTable table,
                                          const LightContext& context, Diagnostics& diagnostics) {
    const Transform toRender = params.transform.at(context.time).then(context.toRender);
    const Vec3d down = context.zUp ? Vec3d{0, 0, -1} : Vec3d{0, -1, 0};
    const Vec3d local = params.lookAt ? *params.lookAt - params.position : params.toward.value_or(down);
    const double norm = length(local);
    if (!(norm > 0 && std::isfinite(norm)) || !(length(toRender.vector(local)) > 0)) {
        diagnostics.error("E0344", context.span, "the axis of the light has no direction",
                          params.lookAt ? "`look-at` is `position`" : "`toward` is zero");
        return nullptr;
    }
    IesProfile profile(std::move(table));
    if (!(profile.lumens() > 0)) {
        if (params.power) {
            diagnostics.error("E0751", params.power->span, "no factor gives this light a power: its file is dark",
                              "its intensities are all 0");
            return nullptr;
        }
        diagnostics.warning("W0750", params.file.span, "this photometric file is dark; the light is left out",
                            "its intensities are all 0");
        return nullptr;
    }
    AmountParams amount = params;
    if (!amount.power) amount.power = schema::Quantity{profile.lumens(), Dimension::luminousFlux, context.span};
    const auto perCandela =
        absoluteSpectrum(amount, *context.defaultColor, {.power = profile.lumens(), .range = kIntensityRange},
                         context.span, diagnostics);
    if (!perCandela) return nullptr;
    // The frame turns about the axis with the light's own x, as far as the axis allows.
    const Vec3d axis = local * (1 / norm);
    const Frame upright = Frame::fromNormalTangent(Vec3(axis), {1, 0, 0});
    const Vec3d x = Vec3d(upright.x) * std::cos(params.turn) - Vec3d(upright.y) * std::sin(params.turn);
    const Vec3d z = normalize(toRender.vector(axis));
    Frame axes = Frame::fromNormalTangent(Vec3(z), Vec3(toRender.vector(x)));
    if (toRender.determinant() < 0) axes.y = -axes.y; // a mirrored light
    return std::make_unique<IesLight>(Vec3(toRender.point(params.position)), axes, std::move(profile), *perCandela);
}

} // namespace abbe
