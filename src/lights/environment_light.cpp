#include "lights/environment_light.h"

#include "base/check.h"
#include "lights/light_context.h"
#include "math/warp.h"
#include "spectrum/curve.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>

namespace abbe {

namespace {

using schema::Dimension;
using schema::FieldType;

// What a triple emits as a curve, for the integrals of setup.
SampledCurve emittedCurve(const RgbRadiance& upsampling, Vec3 rgb) {
    return SampledCurve([&](double nm) { return upsampling.at(rgb, Wavelengths::single(static_cast<float>(nm)))[0]; });
}

// Weight of each channel in the sampling density: its luminance, and never so little that a saturated texel could be
// missed.
Vec3d channelWeights(const RgbRadiance& upsampling) {
    const auto weight = [&](Vec3 rgb) { return std::max(integrate(emittedCurve(upsampling, rgb)).y, 0.02); };
    return {weight({1, 0, 0}), weight({0, 1, 0}), weight({0, 0, 1})};
}

Frame imageAxes(const Transform& toRender) {
    const auto axis = [&](Vec3d v) { return Vec3(normalize(toRender.vector(v))); };
    return {axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1})};
}

std::vector<double> rowCosines(int rows) {
    std::vector<double> result(static_cast<std::size_t>(rows) + 1);
    for (int row = 0; row <= rows; ++row) result[static_cast<std::size_t>(row)] = std::cos(kPiD * row / rows);
    return result;
}

} // namespace

schema::TypeInfo environmentLightType() {
    schema::TypeInfo type{.kind = schema::Kind::light,
                          .name = "environment",
                          .doc =
                              "Light from a latitude-longitude image all around: its middle lies towards -z (+y in a "
                              "z-up scene), its right half towards +x, its top row overhead.",
                          .example = "light environment \"studio.exr\" { exposure 0.5 stops }",
                          .fields = {}};
    type.fields.push_back(
        schema::field(FieldType::file, "image", &EnvironmentLightParams::image)
            .argument(0)
            .required()
            .key({"space",
                  {},
                  "colour space of the pixels; without it, that of the file's chromaticities, else lin_rec709_scene"})
            .doc("The image: linear values in an EXR or Radiance HDR file.")
            .example("image \"studio.exr\"")
            .synonyms({"file", "filename", "map", "texture"}));
    type.fields.push_back(schema::field(FieldType::quantity, "luminance", &EnvironmentLightParams::luminance)
                              .unit({Dimension::luminance})
                              .range(0, std::numeric_limits<float>::max())
                              .doc("Luminance of a white pixel (1 1 1). Default: 72 983 nits, which renders as 1.")
                              .example("luminance 10000 nits")
                              .synonyms({"scale", "intensity", "strength"}));
    type.fields.push_back(schema::field(FieldType::quantity, "exposure", &EnvironmentLightParams::exposure)
                              .unit({Dimension::stops})
                              .byDefault("0 stops")
                              .range(-100, 100)
                              .doc("Brightens or darkens the image; each stop doubles it.")
                              .example("exposure 0.5 stops")
                              .synonyms({"ev", "gain"}));
    type.fields.push_back(portalsField<EnvironmentLightParams>());
    type.fields.push_back(distantVisibleField<EnvironmentLightParams>());
    type.fields.push_back(schema::field(FieldType::transform, "transform", &EnvironmentLightParams::transform)
                              .doc("Turns the image; moving it has no effect.")
                              .example("transform { rotate y 25 deg }")
                              .synonyms({"to-world", "rotation"}));
    return type;
}

EnvironmentTables::EnvironmentTables(EnvironmentImage texels, std::unique_ptr<const RgbRadiance> radiance,
                                     bool compensated)
    : image(std::move(texels)), upsampling(std::move(radiance)), rowCosine(rowCosines(image.height)),
      channelWeights_(channelWeights(*upsampling)), distribution(density(compensated)) {
    const Vec3d total = integratedRadiance();
    if (const double most = maxComponent(total); most > 0) {
        powerShape = std::make_unique<SampledCurve>(emittedCurve(*upsampling, Vec3(total / most)));
        fluence = most * radiantIntegral(*powerShape);
    }
}

EnvironmentLight::EnvironmentLight(EnvironmentImage image, std::unique_ptr<const RgbRadiance> upsampling, double scale,
                                   const Transform& toRender, bool compensated)
    : EnvironmentLight(std::make_shared<const EnvironmentTables>(std::move(image), std::move(upsampling), compensated),
                       scale, toRender) {}

EnvironmentLight::EnvironmentLight(std::shared_ptr<const EnvironmentTables> tables, double scale,
                                   const Transform& toRender)
    : tables_(std::move(tables)), scale_(static_cast<float>(scale)), axes_(imageAxes(toRender)),
      fluence_(tables_->fluence * scale), power_(0) {
    commit(Bounds3{});
}

void EnvironmentLight::commit(const Bounds3& bounds) { power_ = fluence_ * sceneDiskArea(bounds); }

Vec3 EnvironmentTables::texel(int column, int row) const noexcept {
    const int wrapped = column < 0 ? column + image.width : column >= image.width ? column - image.width : column;
    const int clamped = std::clamp(row, 0, image.height - 1);
    const float* p = image.rgb.data() + 3 * (static_cast<std::size_t>(clamped) * static_cast<std::size_t>(image.width) +
                                             static_cast<std::size_t>(wrapped));
    return {p[0], p[1], p[2]};
}

double EnvironmentTables::cellSolidAngle(int row) const noexcept {
    const auto r = static_cast<std::size_t>(row);
    return 2 * kPiD / image.width * (rowCosine[r] - rowCosine[r + 1]);
}

Vec3d EnvironmentTables::cellMean(int column, int row) const noexcept {
    // The mean of bilinear interpolation over a cell takes 6/8 of its own texel and 1/8 of each neighbour, per axis.
    // (That sin θ varies over the cell is left out: this is for densities only.)
    constexpr double kShare[3] = {0.125, 0.75, 0.125};
    Vec3d mean;
    for (int dy = -1; dy <= 1; ++dy)
        for (int dx = -1; dx <= 1; ++dx)
            mean += Vec3d(texel(column + dx, row + dy)) * (kShare[dx + 1] * kShare[dy + 1]);
    return mean;
}

Distribution2D EnvironmentTables::density(bool compensated) {
    std::vector<double> luminance;
    luminance.reserve(image.rgb.size() / 3);
    double total = 0;
    for (int row = 0; row < image.height; ++row)
        for (int column = 0; column < image.width; ++column) {
            luminance.push_back(dot(cellMean(column, row), channelWeights_));
            total += luminance.back() * cellSolidAngle(row);
        }
    const auto weights = [&](double threshold) {
        std::vector<double> result(luminance.size());
        for (std::size_t i = 0; i < result.size(); ++i) {
            const int row = static_cast<int>(i / static_cast<std::size_t>(image.width));
            result[i] = std::max(0.0, luminance[i] - threshold) * cellSolidAngle(row);
        }
        return result;
    };
    // BSDF sampling already covers the mean well, so that only what exceeds it is worth aiming at [Karlik2019, eq. 14].
    // An even image has no excess but rounding: it keeps its plain density.
    const std::vector<double> excess = weights(total / (4 * kPiD));
    const double sum = std::accumulate(excess.begin(), excess.end(), 0.0);
    even = sum <= 1e-6 * total;
    if (compensated && !even) {
        dimShare = 1 - sum / total;
        return {excess, static_cast<std::size_t>(image.width)};
    }
    return {weights(0), static_cast<std::size_t>(image.width)};
}

Vec3d EnvironmentTables::integratedRadiance() const {
    Vec3d total;
    for (int row = 0; row < image.height; ++row) {
        Vec3d rowSum;
        for (int column = 0; column < image.width; ++column) rowSum += cellMean(column, row);
        total += rowSum * cellSolidAngle(row);
    }
    return total;
}

Vec2 EnvironmentLight::imagePoint(Vec3 local) const noexcept {
    const float u = 0.5f + std::atan2(local.x, -local.z) * (0.5f * kInvPi);
    const float v = std::atan2(std::sqrt(local.x * local.x + local.z * local.z), local.y) * kInvPi;
    return {u * static_cast<float>(tables_->image.width), v * static_cast<float>(tables_->image.height)};
}

Vec3 EnvironmentLight::lookup(Vec2 point) const noexcept {
    const float x = point.x - 0.5f, y = point.y - 0.5f; // texel centres at whole numbers
    const float x0 = std::floor(x), y0 = std::floor(y);
    const float fx = x - x0, fy = y - y0;
    const int column = static_cast<int>(x0), row = static_cast<int>(y0);
    const auto mix = [](Vec3 a, Vec3 b, float t) { return a + (b - a) * t; };
    const Vec3 upper = mix(tables_->texel(column, row), tables_->texel(column + 1, row), fx);
    const Vec3 lower = mix(tables_->texel(column, row + 1), tables_->texel(column + 1, row + 1), fx);
    return mix(upper, lower, fy);
}

std::optional<LightSample> EnvironmentLight::sample(const Receiver&, std::uint32_t, Vec2 u, const Wavelengths& lambda,
                                                    float) const noexcept {
    return sampleImage(u, lambda);
}

LightSample EnvironmentLight::sampleImage(Vec2 u, const Wavelengths& lambda) const noexcept {
    const CellSample cell = tables_->distribution.sample(u);
    // Uniform in the cosine within the cell, so that its density is constant even at the poles.
    const double cosTheta =
        lerp(tables_->rowCosine[cell.row], tables_->rowCosine[cell.row + 1], static_cast<double>(cell.offset.y));
    const float sinTheta = static_cast<float>(safeSqrt((1 - cosTheta) * (1 + cosTheta)));
    const float turn =
        (static_cast<float>(cell.column) + cell.offset.x) / static_cast<float>(tables_->image.width) - 0.5f;
    const float phi = 2 * kPi * turn;
    const Vec3 local{sinTheta * std::sin(phi), static_cast<float>(cosTheta), -sinTheta * std::cos(phi)};
    const Vec3 wi = normalize(axes_.toWorld(local));
    const double pdf = cell.probability / tables_->cellSolidAngle(static_cast<int>(cell.row));
    return {wi, Vec3{}, kInfinity, escaped(wi, lambda, 0), static_cast<float>(pdf)};
}

// Radiance is at most the excess over its mean, which distribution_ follows, and that mean: so this mixture follows the
// light to within the smaller share, and all of it.
std::optional<LightSample> EnvironmentLight::sampleDistant(Vec2 u, const Wavelengths& lambda, float) const noexcept {
    const float dim = static_cast<float>(tables_->dimShare);
    const bool even = u.x < dim;
    u.x = std::min(even ? u.x / dim : (u.x - dim) / (1 - dim), kOneMinusEpsilon);
    const Vec3 w = even ? squareToSphere(u) : sampleImage(u, lambda).wi;
    return std::optional<LightSample>(std::in_place, w, Vec3{}, kInfinity, escaped(w, lambda, 0), pdfDistant(w, 0));
}

float EnvironmentLight::pdfDistant(Vec3 w, float) const noexcept {
    const float dim = static_cast<float>(tables_->dimShare);
    return dim * kSpherePdf + (1 - dim) * pdfImage(w);
}

Spectrum EnvironmentLight::escaped(Vec3 w, const Wavelengths& lambda, float) const noexcept {
    return tables_->upsampling->at(lookup(imagePoint(axes_.toLocal(w))), lambda) * scale_;
}

float EnvironmentLight::pdfEscaped(const Receiver&, Vec3 w, float) const noexcept { return pdfImage(w); }

float EnvironmentLight::pdfImage(Vec3 w) const noexcept {
    const Vec2 point = imagePoint(axes_.toLocal(w));
    const int column = std::clamp(static_cast<int>(point.x), 0, tables_->image.width - 1);
    const int row = std::clamp(static_cast<int>(point.y), 0, tables_->image.height - 1);
    const double p = tables_->distribution.probability(static_cast<std::size_t>(column), static_cast<std::size_t>(row));
    return static_cast<float>(p / tables_->cellSolidAngle(row));
}

// Of the brightest pixel: dark ones may be as dark as they like. A triple of 1 has a radiance of about 1.
bool checkBrightestPixel(const EnvironmentImage& image, double scale, Span span, Diagnostics& diagnostics) {
    const auto brightest = std::ranges::max_element(image.rgb);
    const double most = static_cast<double>(*brightest) * scale;
    if (kSkyRadiance.holds(most)) return true;
    const auto pixel = (brightest - image.rgb.begin()) / 3;
    Diagnostic& d = reportBeyondRange(
        most, kSkyRadiance, "environment image", span,
        fmt::format("pixel {},{} is {:.3g}", pixel % image.width, pixel / image.width, *brightest), diagnostics);
    d.notes.push_back(fmt::format("times `luminance` and `exposure` that comes to {:.3g}; between {:g} and {:g} can be "
                                  "calculated with",
                                  most, kSkyRadiance.least, kSkyRadiance.most));
    d.help = "`exposure` brightens or darkens the image; a single odd pixel is mended in the program that wrote it";
    return false;
}

bool checkEnvironmentImage(EnvironmentImage& image, double scale, Span span, Diagnostics& diagnostics) {
    const std::size_t count =
        static_cast<std::size_t>(std::max(image.width, 0)) * static_cast<std::size_t>(std::max(image.height, 0));
    if (count == 0 || image.rgb.size() != 3 * count) {
        diagnostics.error("E0440", span, "the environment image is empty");
        return false;
    }
    std::size_t broken = 0, negative = 0;
    for (float& v : image.rgb) {
        if (!std::isfinite(v)) ++broken;
        if (v < 0) {
            ++negative;
            v = 0;
        }
    }
    if (broken > 0) {
        diagnostics.error("E0441", span,
                          fmt::format("the environment image has {} values that are not finite", broken));
        return false;
    }
    if (negative > 0)
        diagnostics.warning("W0440", span,
                            fmt::format("{} negative values of the environment image are taken as 0", negative));
    return checkBrightestPixel(image, scale, span, diagnostics);
}

double environmentScale(const EnvironmentLightParams& params) {
    const double luminance = params.luminance ? params.luminance->value : kUnitLuminance;
    return luminance / kUnitLuminance * std::exp2(params.exposure);
}

std::unique_ptr<DistantLight> makeEnvironmentLight(const EnvironmentLightParams& params,
                                                   std::shared_ptr<const EnvironmentTables> tables, const Digest& image,
                                                   const LightContext& context, Diagnostics& diagnostics) {
    const Transform upright = context.zUp ? Transform::rotate({1, 0, 0}, kPiD / 2) : Transform{};
    const Transform toRender = upright.then(params.transform.at(context.time)).then(context.toRender);
    if (!toRender.uniformScale()) {
        diagnostics.error("E0348", context.span, "an environment can be turned, but not stretched");
        return nullptr;
    }
    DigestWriter key("environment");
    key.add(image), key.add(toRender);
    key.number(environmentScale(params));
    return throughWindows(std::make_unique<EnvironmentLight>(std::move(tables), environmentScale(params), toRender),
                          params, context, key.digest(), diagnostics);
}

std::unique_ptr<DistantLight> makeEnvironmentLight(const EnvironmentLightParams& params, EnvironmentImage image,
                                                   std::unique_ptr<const RgbRadiance> upsampling, bool compensated,
                                                   const LightContext& context, Diagnostics& diagnostics) {
    if (!checkEnvironmentImage(image, environmentScale(params), context.span, diagnostics)) return nullptr;
    auto tables = std::make_shared<const EnvironmentTables>(std::move(image), std::move(upsampling), compensated);
    return makeEnvironmentLight(params, std::move(tables), {}, context, diagnostics);
}

} // namespace abbe
