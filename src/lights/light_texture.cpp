#include "lights/light_texture.h"

#include "math/warp.h"
#include "render/surface_input.h"
#include "spectrum/sensor.h"

#include <array>
#include <cmath>

namespace abbe {

namespace {

constexpr float kCellAxis = 0.57735027f; // half axis of the ellipse as wide as a cell of 1: equal variance
constexpr int kSpacePoints = 8;    // where a texture that needs no texture coordinates is looked up for one that does
constexpr int kGrid = 64;          // cells of a chart, each way
constexpr int kPoints = 4096;      // over all parts of a shape without one, or one for each
constexpr double kContrast = 0.02; // least variance of the luminance over its squared mean that pays for a chart
constexpr float kChartShare = 0.5f;

// Factors are taken at every fifth nanometre and linear in between.
constexpr int kStep = 5, kBands = 95, kSets = (kBands + kLanes - 1) / kLanes;

// Of a cell of the chart.
Vec2 placeIn(int column, int row, float x, float y) {
    return {(static_cast<float>(column) + x) / kGrid, (static_cast<float>(row) + y) / kGrid};
}

int bandOf(int set, int lane) { return std::min(set * kLanes + lane, kBands - 1); }

float solidAngle(double pdfArea, Vec3 d, Vec3 ng) {
    const float d2 = lengthSquared(d), projected = std::abs(dot(d, ng));
    if (!(d2 > 0) || !(projected > 0)) return 0;
    const float pdf = static_cast<float>(pdfArea) * d2 * std::sqrt(d2) / projected;
    return std::isfinite(pdf) ? pdf : 0;
}

} // namespace

// The mean factor at each band, and the light that goes with it.
struct LightTexture::Survey {
    explicit Survey(const Curve& light) : sums(kBands, 0) {
        for (int set = 0; set < kSets; ++set)
            for (int lane = 0; lane < kLanes; ++lane)
                wavelengths[set].v[lane] = kMinWavelength + static_cast<float>(kStep * bandOf(set, lane));
        // What a band stands for: the visible light under its hat (Light::visiblePower).
        for (int nm = 0; nm < SampledCurve::kSize; ++nm) {
            const Wavelengths at = Wavelengths::single(kMinWavelength + static_cast<float>(nm));
            const double visible =
                light.at(static_cast<double>(kMinWavelength) + nm) * (static_cast<double>(ybar(at)[0]) + 0.05);
            const double share = static_cast<double>(nm % kStep) / kStep;
            const auto band = static_cast<std::size_t>(nm / kStep);
            weights[band] += visible * (1 - share);
            if (share > 0) weights[band + 1] += visible * share;
        }
    }

    // Takes `area` of the surface to be as it is at the query; its visible light per area.
    double add(const Texture& texture, const TextureQuery& query, double over) {
        double visible = 0;
        for (int set = 0; set < kSets; ++set) {
            const Spectrum f = texture.lightFactor(query, Wavelengths::at(wavelengths[set], Spectrum(1.f)));
            for (int lane = 0; lane < kLanes && set * kLanes + lane < kBands; ++lane) {
                const auto band = static_cast<std::size_t>(bandOf(set, lane));
                const auto value = static_cast<double>(f[lane]);
                sums[band] += over * value;
                visible += weights[band] * value;
            }
        }
        area += over;
        return visible;
    }

    double factor(double nm) const {
        if (!(area > 0)) return 1;
        const double x = (nm - static_cast<double>(kMinWavelength)) / kStep;
        const auto band = static_cast<std::size_t>(std::clamp(x, 0.0, static_cast<double>(kBands - 2)));
        return std::lerp(sums[band], sums[band + 1], x - static_cast<double>(band)) / area;
    }

    std::array<Spectrum, kSets> wavelengths;
    std::array<double, kBands> weights{};
    std::vector<double> sums;
    double area = 0;
};

LightTexture::LightTexture(const Shape& shape, const Texture& texture, const Transform& toOwn, const Curve& light,
                           bool open)
    : shape_(shape), sampling_(shape), texture_(texture), own_(toOwn), spectrum_([](double) { return 1.0; }) {
    const Bounds3 box = shape.bounds();
    nearness_ = 1e-3f * box.radius() + 0x1p-18f * maxComponent(max(abs(box.lower), abs(box.upper)));
    for (std::uint32_t i = 0; i < sampling_->emitterParts(); ++i)
        shares_.push_back(sampling_->emitterPart(i).area / shape.area());
    Survey survey(light);
    if (open && !surveyChart(survey)) surveyParts(survey);
    spectrum_ = SampledCurve([&](double nm) { return light.at(nm) * survey.factor(nm); });
}

// The hit of a ray onto a point, as the intersector completes it.
std::optional<SurfaceHit> LightTexture::hitAt(Vec3 p, Vec3 ng, std::uint32_t part) const noexcept {
    const Ray ray = rayOnto(p, ng, nearness_);
    const auto raw = sampling_->locate(p, part, ray);
    if (!raw) return std::nullopt;
    SurfaceHit hit;
    shape_.surface(*raw, ray, hit);
    hit.shape = &shape_;
    hit.part = raw->part;
    hit.element = raw->primitive;
    hit.barycentric = {raw->u, raw->v};
    hit.local = hit.p;
    shape_.parametrize(*raw, ray, hit);
    own_.complete(hit);
    return hit;
}

bool LightTexture::surveyChart(Survey& survey) {
    if (sampling_->emitterParts() > 1 || !sampling_->uvPoint({0.5f, 0.5f})) return false;
    std::vector<double> cells;
    double sum = 0;
    for (int row = 0; row < kGrid; ++row)
        for (int column = 0; column < kGrid; ++column) {
            cells.push_back(surveyCell(survey, column, row));
            sum += cells.back();
        }
    double squares = 0; // of the luminance over its mean
    for (int row = 0; row < kGrid && sum > 0; ++row)
        for (int column = 0; column < kGrid; ++column) {
            const double area = cellArea(column, row);
            if (area > 0) squares += square(cells[static_cast<std::size_t>(row * kGrid + column)] / sum) / area;
        }
    if (squares * survey.area > 1 + kContrast) chart_.emplace(cells, kGrid);
    return true;
}

double LightTexture::cellArea(int column, int row) const {
    const auto middle = sampling_->uvPoint(placeIn(column, row, 0.5f, 0.5f));
    return middle ? static_cast<double>(middle->area) / (kGrid * kGrid) : 0;
}

// The visible light of a cell: patterns over texture coordinates averaged over it, patterns in space at points in it,
// that do not fall in step with the grid. These cannot be averaged: over a ball they are not what they are over the
// surface.
double LightTexture::surveyCell(Survey& survey, int column, int row) const {
    const int points = texture_.needsUv() ? 1 : kSpacePoints;
    const double area = cellArea(column, row) / points;
    double visible = 0;
    for (int k = 0; k < points; ++k) {
        const double i = (row * kGrid + column) * points + k; // of an R₂ sequence [Roberts2018]
        const auto point =
            sampling_->uvPoint(placeIn(column, row, static_cast<float>(std::fmod(0.5 + 0.7548776662466927 * i, 1.0)),
                                       static_cast<float>(std::fmod(0.5 + 0.5698402909980532 * i, 1.0))));
        const auto hit = point ? hitAt(point->p, point->ng, 0) : std::nullopt;
        if (!hit) continue;
        TextureQuery query(*hit);
        query.uv = placeIn(column, row, 0.5f, 0.5f);
        query.du = {kCellAxis / kGrid, 0};
        query.dv = {0, kCellAxis / kGrid};
        visible += area * survey.add(texture_, query, area);
    }
    return visible;
}

// Parts keep a hundredth of what they would have without the texture: lookups may have missed something.
void LightTexture::surveyParts(Survey& survey) {
    constexpr double kLeast = 0.01;
    const auto count = static_cast<std::uint32_t>(shares_.size());
    const int all = kPoints * (texture_.needsUv() ? 1 : kSpacePoints);
    const int points = std::max(1, all / static_cast<int>(std::min<std::uint32_t>(count, kPoints)));
    std::vector<double> visible;
    double total = 0;
    for (std::uint32_t part = 0; part < count; ++part) {
        visible.push_back(surveyPart(survey, part, points));
        total += visible.back();
    }
    if (count == 1) return;
    for (std::uint32_t part = 0; part < count; ++part)
        shares_[part] = total > 0 ? (1 - kLeast) * visible[part] / total + kLeast * shares_[part] : 0;
}

// The visible light of a part. Seen from far away, from all directions alike, every point of a surface is hit in
// proportion to a quarter of its area if it is convex, or a half; a flat part may as well be seen from its front.
double LightTexture::surveyPart(Survey& survey, std::uint32_t part, int points) const {
    constexpr std::array<double, 4> kSteps{0.8566748838545029, 0.7338918566271260, 0.6287067210378087,
                                           0.5385972572236101}; // of an R₄ sequence [Roberts2018]
    const EmitterPart p = sampling_->emitterPart(part);
    const Vec3 centre = p.box.centre();
    const float far = 100 * std::max(p.box.radius(), nearness_);
    struct Seen {
        SurfaceHit hit;
        double weight;
    };
    std::vector<Seen> seen;
    double weights = 0;
    for (int i = 0; i < points; ++i) {
        std::array<float, 4> u;
        for (std::size_t k = 0; k < u.size(); ++k)
            u[k] = std::min(static_cast<float>(std::fmod(0.5 + kSteps[k] * i, 1.0)), kOneMinusEpsilon);
        const Vec3 from = centre + (p.cosNormals > 0.99f ? p.axis : squareToSphere({u[0], u[1]})) * far;
        const auto s = sampling_->sample(from, part, {u[2], u[3]});
        if (!s || !(s->pdfSolidAngle > 0)) continue;
        const auto hit = hitAt(s->p, s->ng, part);
        if (!hit) continue;
        seen.push_back({*hit, static_cast<double>(lengthSquared(s->p - from) / s->pdfSolidAngle)});
        weights += seen.back().weight;
    }
    double visible = 0;
    for (Seen& one : seen) {
        const double area = p.area * one.weight / weights;
        one.hit.arrival = -one.hit.ng;
        one.hit.footprint = static_cast<float>(std::sqrt(area / kPiD));
        TextureQuery query(one.hit);
        query.radius = 0; // as in surveyChart
        visible += area * survey.add(texture_, query, area);
    }
    return visible;
}

double LightTexture::pdfChartArea(Vec2 uv) const noexcept {
    const auto cell = [](float x) { return static_cast<std::size_t>(std::clamp(x * kGrid, 0.f, kGrid - 1.f)); };
    const auto point = sampling_->uvPoint(uv);
    if (!point || !(point->area > 0)) return 0;
    return chart_->probability(cell(uv.x), cell(uv.y)) * (kGrid * kGrid) / static_cast<double>(point->area);
}

float LightTexture::pdfChart(Vec3 from, Vec3 p, Vec3 ng, Vec2 uv) const noexcept {
    return solidAngle(pdfChartArea(uv), p - from, ng);
}

float LightTexture::pdfMixed(std::uint32_t part, Vec3 ng, Vec2 uv) const noexcept {
    const float even = sampling_->pdfPoint(part, ng);
    if (!chart_) return even;
    return kChartShare * static_cast<float>(pdfChartArea(uv)) + (1 - kChartShare) * even;
}

// The density is that of the point's own texture coordinates, on whichever side of a cell's border they round to: as
// pdfPoint() will find them.
std::optional<ShapePoint> LightTexture::samplePoint(std::uint32_t part, Vec2 u, const Wavelengths& lambda,
                                                    Spectrum& factor) const noexcept {
    std::optional<ShapePoint> s;
    if (chart_ && u.x < kChartShare) {
        const CellSample cell = chart_->sample({u.x / kChartShare, u.y});
        const auto point = sampling_->uvPoint({(static_cast<float>(cell.column) + cell.offset.x) / kGrid,
                                               (static_cast<float>(cell.row) + cell.offset.y) / kGrid});
        if (!point || !(point->area > 0)) return std::nullopt;
        s = ShapePoint{.p = point->p, .pError = point->pError, .ng = point->ng};
    } else {
        if (chart_) u.x = std::min((u.x - kChartShare) / (1 - kChartShare), kOneMinusEpsilon);
        s = sampling_->samplePoint(part, u);
    }
    if (!s) return s;
    const auto hit = hitAt(s->p, s->ng, part);
    if (!hit) return std::nullopt;
    factor = at(*hit, lambda);
    s->pdfArea = pdfMixed(part, s->ng, hit->uv);
    return s;
}

float LightTexture::pdfPoint(std::uint32_t part, Vec3 p, Vec3 ng) const noexcept {
    if (!chart_) return sampling_->pdfPoint(part, ng);
    const auto hit = hitAt(p, ng, part);
    return hit ? pdfMixed(part, ng, hit->uv) : 0;
}

std::optional<ShapeSample> LightTexture::sample(const Receiver& from, std::uint32_t part, Vec2 u,
                                                const Wavelengths& lambda, Spectrum& factor) const noexcept {
    if (chart_ && u.x < kChartShare) {
        const CellSample cell = chart_->sample({u.x / kChartShare, u.y});
        const Vec2 uv{(static_cast<float>(cell.column) + cell.offset.x) / kGrid,
                      (static_cast<float>(cell.row) + cell.offset.y) / kGrid};
        const auto point = sampling_->uvPoint(uv);
        if (!point || !(point->area > 0)) return std::nullopt;
        const auto hit = hitAt(point->p, point->ng, part);
        if (!hit) return std::nullopt;
        factor = at(*hit, lambda);
        const double pdfArea = cell.probability * (kGrid * kGrid) / static_cast<double>(point->area);
        const float pdf = kChartShare * solidAngle(pdfArea, point->p - from.p, point->ng) +
                          (1 - kChartShare) * sampling_->pdfSolidAngle(from, *hit);
        if (!(pdf > 0)) return std::nullopt;
        return std::optional<ShapeSample>(std::in_place, point->p, point->pError, point->ng, pdf);
    }
    if (chart_) u.x = std::min((u.x - kChartShare) / (1 - kChartShare), kOneMinusEpsilon);
    auto s = sampling_->sample(from, part, u);
    if (!s) return s;
    const auto hit = hitAt(s->p, s->ng, part);
    if (!hit) return std::nullopt;
    factor = at(*hit, lambda);
    if (chart_)
        s->pdfSolidAngle = kChartShare * pdfChart(from.p, s->p, s->ng, hit->uv) + (1 - kChartShare) * s->pdfSolidAngle;
    return s;
}

float LightTexture::pdfSolidAngle(const Receiver& from, const SurfaceHit& hit) const noexcept {
    const float shape = sampling_->pdfSolidAngle(from, hit);
    if (!chart_) return shape;
    return kChartShare * pdfChart(from.p, hit.p, hit.ng, hit.uv) + (1 - kChartShare) * shape;
}

} // namespace abbe
