#include "lights/clear_sky.h"

#include "lights/clear_air.h"
#include "math/vec.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <utility>
#include <vector>

namespace abbe {

// Light that air and ground have scattered, everywhere in a spherical atmosphere around one place.

// Radiance at a point is kept as its moments over the sphere of directions, ∫ L b_i dω with the basis below: all that
// scattering by phase functions without higher moments asks for.
class ScatteredLight {
  public:
    static constexpr std::size_t kMoments = 6;
    using Moments = std::array<SkyBands, kMoments>;

    // Spherical harmonics up to the second degree, so scaled that Σ_i b_i(v) b_i(w) of one degree is P_l(v·w). x of the
    // unit direction points to the sun's side, z to the zenith; nothing depends on the sign of y.
    static std::array<float, kMoments> basis(float x, float z);
    static constexpr std::size_t kMomentDegree[kMoments] = {0, 1, 1, 2, 2, 2};

    // `sunZenith`: rad, at the place. Per unit of the sun's irradiance outside of the air. The air is only read here.
    ScatteredLight(const ClearAir&, double sunZenith, const SkyBands& groundAlbedo);

    // What is scattered once more, not counting sunlight, per km and sr: the coefficients of the basis in a shell,
    // where the sun stands at an angle (rad) from the zenith.
    Moments source(int shell, double sunZenith) const;

    int iterations() const { return iterations_; }

  private:
    struct Place; // among the angles of the sun
    struct Way;
    static constexpr int kLevels = ClearAir::kShells + 1;
    Place place(double sunZenith) const;
    std::size_t index(int level, int angle) const {
        return static_cast<std::size_t>(level) * static_cast<std::size_t>(angles_) + static_cast<std::size_t>(angle);
    }
    double angle(int i) const { return first_ + i * step_; }

    void findSource(const ClearAir&, int shell);
    void gather(const ClearAir&, int level, const SkyBands& groundAlbedo);
    SkyBands radiance(const Way&, double x, double z, int angle, const SkyBands& groundAlbedo) const;

    double first_, step_; // angles of the sun from the zenith, rad
    int angles_;
    int iterations_ = 0;           // until another changes nothing
    std::vector<Moments> field_;   // at the boundaries of shells, of scattered light
    std::vector<Moments> direct_;  // in shells, of sunlight
    std::vector<Moments> sources_; // in shells
    std::vector<SkyBands> ground_; // irradiance of the ground by scattered light
    std::vector<SkyBands> sunlit_; // and by the sun
};

// ∫ e^-σt dt from 0 to the length, km, with an extinction σ in 1/km.
SkyBands lengthSeen(const SkyBands& extinction, double length);

namespace {

constexpr double kSkyDegree = kPiD / 180;
// Light reaches a place from where the sun stands up to so much higher or lower. Near the horizon its light changes
// fast.
constexpr double kSunSpan = 10 * kSkyDegree, kLowSun = 88 * kSkyDegree;
constexpr double kCoarseStep = 2.5 * kSkyDegree, kFineStep = 1 * kSkyDegree;
constexpr int kMaxIterations = 24;
constexpr double kConverged = 1e-3; // relative change of an iteration

// Directions: Gauss–Legendre in the cosine over each hemisphere, even in azimuth over one half of the circle.
struct CosineNode {
    double cosine, weight;
};
constexpr CosineNode kCosines[] = {{0.0694318442, 0.1739274226},  {0.3300094782, 0.3260725774},
                                   {0.6699905218, 0.3260725774},  {0.9305681558, 0.1739274226},
                                   {-0.0694318442, 0.1739274226}, {-0.3300094782, 0.3260725774},
                                   {-0.6699905218, 0.3260725774}, {-0.9305681558, 0.1739274226}};
constexpr int kAzimuths = 4;

// ∫ e^-σt dt over a length: (1 - e^-σl) / σ, by its series where the difference would lose its digits.
Spectrum lengthSeen(Spectrum extinction, float length) {
    const Spectrum depth = extinction * length;
    const Spectrum series = fma(depth, fma(depth, Spectrum(1 / 6.f), Spectrum(-0.5f)), Spectrum(1.f)) * length;
    return select(depth.v < 0.02f, series, (Spectrum(1.f) - exp(-depth)) / max(extinction, Spectrum(1e-30f)));
}

} // namespace

SkyBands lengthSeen(const SkyBands& extinction, double length) {
    return {lengthSeen(extinction.low, static_cast<float>(length)),
            lengthSeen(extinction.high, static_cast<float>(length))};
}

std::array<float, ScatteredLight::kMoments> ScatteredLight::basis(float x, float z) {
    constexpr float root3 = 1.7320508f;
    const float y2 = std::max(0.f, 1 - x * x - z * z);
    return {1, z, x, 1.5f * z * z - 0.5f, root3 * x * z, 0.5f * root3 * (x * x - y2)};
}

struct ScatteredLight::Place {
    int angle;
    float fraction;
};

ScatteredLight::Place ScatteredLight::place(double sunZenith) const {
    const double x = std::clamp((sunZenith - first_) / step_, 0.0, angles_ - 1.0);
    const int i = std::min(static_cast<int>(x), angles_ - 2);
    return {i, static_cast<float>(x - i)};
}

// What lies along a ray in a direction that makes one angle with the vertical, whatever its azimuth.
struct ScatteredLight::Way {
    struct Part {
        int shell;
        float t, r, z; // of its middle: the distance, the radius, the ray's direction against the vertical there
        SkyBands seen; // length, less what is taken on the way here
    };
    std::vector<Part> parts;
    double r = 0; // where it starts
    bool ground = false;
    float groundDistance = 0;
    SkyBands groundSeen; // share that arrives from the ground

    void trace(const ClearAir& air, int level, double cosine) {
        parts.clear();
        r = air.radius(level);
        SkyBands passed(1);
        double end = 0;
        const auto add = [&](int shell, double t0, double t1) {
            const SkyBands& extinction = air.at(shell).extinction;
            const double t = (t0 + t1) / 2, there = std::sqrt(r * r + t * t + 2 * r * t * cosine);
            parts.push_back({shell, static_cast<float>(t), static_cast<float>(there),
                             static_cast<float>((r * cosine + t) / there), passed * lengthSeen(extinction, t1 - t0)});
            passed = passed * exp(extinction * static_cast<float>(t0 - t1));
            end = t1;
        };
        // On the ground a ray that goes down has come to its end.
        ground = cosine < 0 && level == 0 ? true : air.walk(r, cosine < 0 ? level - 1 : level, cosine, add);
        groundDistance = static_cast<float>(end);
        groundSeen = passed;
    }
};

ScatteredLight::ScatteredLight(const ClearAir& air, double sunZenith, const SkyBands& groundAlbedo)
    : first_(std::max(0.0, sunZenith - kSunSpan)), step_(sunZenith > kLowSun ? kFineStep : kCoarseStep),
      angles_(static_cast<int>(std::ceil((sunZenith + kSunSpan - first_) / step_)) + 1),
      field_(static_cast<std::size_t>(kLevels * angles_)), direct_(field_.size()), sources_(field_.size()) {
    for (int shell = 0; shell < ClearAir::kShells; ++shell)
        for (int i = 0; i < angles_; ++i) {
            const double r = (air.radius(shell) + air.radius(shell + 1)) / 2, c = std::cos(angle(i));
            const SkyBands light = air.sunlight(r, shell, c);
            const auto b = basis(static_cast<float>(std::sin(angle(i))), static_cast<float>(c));
            for (std::size_t k = 0; k < kMoments; ++k) direct_[index(shell, i)][k] = light * b[k];
        }
    for (int i = 0; i < angles_; ++i) {
        const double c = std::cos(angle(i));
        sunlit_.push_back(air.sunlight(ClearAir::kGroundRadius, 0, c) * static_cast<float>(std::max(c, 0.0)));
        ground_.push_back(SkyBands(0));
    }
    for (Moments& m : field_) m.fill(SkyBands(0));
    const auto findSources = [&] {
        for (int shell = 0; shell < ClearAir::kShells; ++shell) findSource(air, shell);
    };
    findSources();
    for (double change = 1; change > kConverged && iterations_ < kMaxIterations; ++iterations_) {
        const std::vector<Moments> before(field_.begin(), field_.begin() + angles_);
        // Down and up in turn; each level at once lights the next: half the iterations.
        for (int i = 0; i < kLevels; ++i) gather(air, iterations_ % 2 == 0 ? kLevels - 1 - i : i, groundAlbedo);
        change = 0;
        for (std::size_t i = 0; i < before.size(); ++i) {
            const SkyBands now = field_[i][0], ratio = (now - before[i][0]) / (now + SkyBands(1e-30f));
            change = std::max({change, double(maxLane(abs(ratio.low))), double(maxLane(abs(ratio.high)))});
        }
    }
    for (Moments& m : direct_) m.fill(SkyBands(0)); // what is scattered for the first time is not meant by source()
    findSources();
}

void ScatteredLight::findSource(const ClearAir& air, int shell) {
    for (int i = 0; i < angles_; ++i)
        for (std::size_t k = 0; k < kMoments; ++k) {
            const std::size_t l = kMomentDegree[k];
            const SkyBands light =
                direct_[index(shell, i)][k] + (field_[index(shell, i)][k] + field_[index(shell + 1, i)][k]) * 0.5f;
            sources_[index(shell, i)][k] = air.at(shell).scatterings[l] * light *
                                           static_cast<float>((2 * static_cast<double>(l) + 1) / (4 * kPiD));
        }
}

void ScatteredLight::gather(const ClearAir& air, int level, const SkyBands& groundAlbedo) {
    Moments none;
    none.fill(SkyBands(0));
    std::vector<Moments> field(static_cast<std::size_t>(angles_), none);
    std::vector<SkyBands> ground(field.size(), SkyBands(0));
    Way way;
    for (const auto& [cosine, weight] : kCosines) {
        way.trace(air, level, cosine);
        const double solidAngle = 2 * kPiD / kAzimuths * weight;
        for (int a = 0; a < kAzimuths; ++a) {
            const double x = std::sqrt(1 - cosine * cosine) * std::cos((a + 0.5) / kAzimuths * kPiD);
            const auto b = basis(static_cast<float>(x), static_cast<float>(cosine));
            for (std::size_t i = 0; i < field.size(); ++i) {
                const SkyBands light =
                    radiance(way, x, cosine, static_cast<int>(i), groundAlbedo) * static_cast<float>(solidAngle);
                for (std::size_t k = 0; k < kMoments; ++k) field[i][k] = fma(light, b[k], field[i][k]);
                if (cosine > 0) ground[i] += light * static_cast<float>(cosine);
            }
        }
    }
    std::copy(field.begin(), field.end(), field_.begin() + static_cast<std::ptrdiff_t>(index(level, 0)));
    if (level == 0) ground_ = std::move(ground);
    if (level > 0) findSource(air, level - 1);
    if (level < ClearAir::kShells) findSource(air, level);
}

// Along the way the zenith turns, and the sun's angle from it with it.
SkyBands ScatteredLight::radiance(const Way& way, double x, double z, int angle, const SkyBands& groundAlbedo) const {
    const float cosSun = static_cast<float>(std::cos(this->angle(angle)));
    const float sinSun = static_cast<float>(std::sin(this->angle(angle)));
    const float fromSun = static_cast<float>(x) * sinSun + static_cast<float>(z) * cosSun; // cosine
    const auto sunCosine = [&](float t, float r) {
        return std::clamp((static_cast<float>(way.r) * cosSun + t * fromSun) / r, -1.f, 1.f);
    };
    SkyBands total(0);
    for (const Way::Part& part : way.parts) {
        const float c = sunCosine(part.t, part.r), s = safeSqrt(1 - c * c);
        const auto b = basis((fromSun - part.z * c) / std::max(s, 1e-4f), part.z);
        const Place at = place(static_cast<double>(std::acos(c)));
        const Moments& m0 = sources_[index(part.shell, at.angle)];
        const Moments& m1 = sources_[index(part.shell, at.angle + 1)];
        SkyBands j0(0), j1(0);
        for (std::size_t k = 0; k < kMoments; ++k) {
            j0 = fma(m0[k], b[k], j0);
            j1 = fma(m1[k], b[k], j1);
        }
        total = fma(part.seen, fma(j1 - j0, at.fraction, j0), total);
    }
    if (!way.ground) return total;
    const Place at = place(static_cast<double>(std::acos(sunCosine(way.groundDistance, ClearAir::kGroundRadius))));
    const auto lit = [&](int i) { return sunlit_[static_cast<std::size_t>(i)] + ground_[static_cast<std::size_t>(i)]; };
    const SkyBands irradiance = fma(lit(at.angle + 1) - lit(at.angle), at.fraction, lit(at.angle));
    return fma(groundAlbedo * way.groundSeen * kInvPi, irradiance, total);
}

ScatteredLight::Moments ScatteredLight::source(int shell, double sunZenith) const {
    const Place at = place(sunZenith);
    Moments result;
    for (std::size_t k = 0; k < kMoments; ++k) {
        const auto light = [&](int i) { return sources_[index(shell, i)][k]; };
        result[k] = fma(light(at.angle + 1) - light(at.angle), at.fraction, light(at.angle));
    }
    return result;
}

namespace {
constexpr double kScalePower = 2.5; // between that of aerosol, 1.3, and of molecules, 4
constexpr int kPartsOfShell = 3;
} // namespace

double ClearSky::scale(double nm) { return std::pow(550 / nm, kScalePower); }

ClearSky::ClearSky(const AirParams& params, double sunElevation, const SkyBands& groundAlbedo)
    : sun_(std::cos(sunElevation), 0, std::sin(sunElevation)) {
    const ClearAir air(params);
    const ScatteredLight scattered(air, kPiD / 2 - sunElevation, groundAlbedo);
    const SkyBands unscaled = SkyBands::of([](double nm) { return 1 / scale(nm); });
    nodes_.reserve(static_cast<std::size_t>((kRows + 1) * (kColumns + 1)));
    for (int row = 0; row <= kRows; ++row)
        for (int column = 0; column <= kColumns; ++column) {
            Node n = look(air, scattered, square(row / double(kRows)) * kPiD / 2, column * kPiD / kColumns);
            nodes_.push_back({n.smooth * unscaled, n.haze * unscaled});
        }
}

ClearSky::Node ClearSky::look(const ClearAir& air, const ScatteredLight& scattered, double elevation,
                              double azimuth) const {
    const double z = std::sin(elevation), x = std::cos(elevation) * std::cos(azimuth);
    const double fromSun = x * sun_.x + z * sun_.z, r = ClearAir::kGroundRadius; // cosine
    const float rayleigh = rayleighPhase(static_cast<float>(fromSun));
    Node result{SkyBands(0), SkyBands(0)};
    SkyBands passed(1);
    air.walk(r, 0, z, [&](int shell, double start, double end) {
        const ClearAir::Coefficients& c = air.at(shell);
        const double length = (end - start) / kPartsOfShell;
        const SkyBands seenEach = lengthSeen(c.extinction, length),
                       passedEach = exp(c.extinction * static_cast<float>(-length));
        for (int i = 0; i < kPartsOfShell; ++i) {
            const double t = start + (i + 0.5) * length, there = std::sqrt(r * r + t * t + 2 * r * t * z);
            const double sunCosine = std::clamp((r * sun_.z + t * fromSun) / there, -1.0, 1.0);
            const double up = (r * z + t) / there, sine = std::max(safeSqrt(1 - square(sunCosine)), 1e-6);
            const SkyBands seen = passed * seenEach, sunlight = air.sunlight(there, shell, sunCosine);
            const auto b =
                ScatteredLight::basis(static_cast<float>((fromSun - up * sunCosine) / sine), static_cast<float>(up));
            const auto source = scattered.source(shell, std::acos(sunCosine));
            SkyBands more = c.rayleigh * sunlight * rayleigh;
            for (std::size_t k = 0; k < source.size(); ++k) more = fma(source[k], b[k], more);
            result.smooth = fma(seen, more, result.smooth);
            result.haze = fma(seen, c.aerosol * sunlight, result.haze);
            passed = passed * passedEach;
        }
    });
    return result;
}

SkyBands ClearSky::at(Vec3 w) const noexcept {
    const float fromSun = w.x * static_cast<float>(sun_.x) + w.z * static_cast<float>(sun_.z);
    const float row = std::sqrt(std::asin(std::clamp(w.z, 0.f, 1.f)) * (2 * kInvPi)) * kRows;
    const float column = std::atan2(std::abs(w.y), w.x) * (kInvPi * kColumns);
    const int i = std::min(static_cast<int>(row), kRows - 1), j = std::min(static_cast<int>(column), kColumns - 1);
    const float v = row - static_cast<float>(i), u = column - static_cast<float>(j);
    const Node &n00 = node(i, j), &n01 = node(i, j + 1), &n10 = node(i + 1, j), &n11 = node(i + 1, j + 1);
    const float haze = aerosolPhase(fromSun);
    const auto value = [haze](const Node& n, float weight, const SkyBands& sum) {
        return fma(fma(n.haze, haze, n.smooth), weight, sum);
    };
    return value(n00, (1 - v) * (1 - u),
                 value(n01, (1 - v) * u, value(n10, v * (1 - u), value(n11, v * u, SkyBands(0)))));
}

namespace {

constexpr double kWater = 2; // cm

// Irradiance by the sun outside of the atmosphere, W·m⁻²·nm⁻¹, from 360 to 830 nm in steps of 5 nm: means of
// [ASTMG173] under the hats of linear interpolation.
constexpr double kSolarFirst = 360, kSolarStep = 5;
constexpr double kSolarIrradiance[] = {
    0.953, 1.131, 1.183, 1.093, 1.137, 0.968, 1.116, 1.054, 1.562, 1.718, 1.700, 1.755, 1.727, 1.703, 1.482, 1.706,
    1.799, 1.916, 2.024, 2.022, 2.041, 2.015, 1.992, 2.033, 2.052, 1.905, 1.908, 1.963, 1.909, 1.925, 1.929, 1.824,
    1.806, 1.866, 1.894, 1.886, 1.843, 1.869, 1.865, 1.858, 1.822, 1.833, 1.833, 1.843, 1.834, 1.826, 1.761, 1.788,
    1.761, 1.758, 1.729, 1.688, 1.696, 1.670, 1.663, 1.643, 1.630, 1.608, 1.578, 1.503, 1.533, 1.556, 1.533, 1.508,
    1.493, 1.467, 1.468, 1.444, 1.420, 1.413, 1.394, 1.366, 1.346, 1.346, 1.322, 1.317, 1.283, 1.287, 1.275, 1.269,
    1.255, 1.235, 1.214, 1.208, 1.197, 1.187, 1.168, 1.141, 1.138, 1.123, 1.113, 1.108, 1.078, 1.072, 1.059};

using AbsorptionPoint = std::pair<double, double>;
// Absorption coefficients: water vapour in 1/cm, mixed gases in 1/km [Iqbal1983, after Leckner].
constexpr AbsorptionPoint kWaterAbsorption[] = {
    {689, 0},       {690, 0.016},   {700, 0.024},  {710, 0.0125}, {720, 1},     {730, 0.87}, {740, 0.061}, {750, 0.001},
    {760, 0.00001}, {770, 0.00001}, {780, 0.0006}, {790, 0.0175}, {800, 0.036}, {810, 0.33}, {820, 1.53},  {830, 0.66}};
constexpr AbsorptionPoint kGasAbsorption[] = {{759, 0}, {760, 3}, {770, 0.21}, {771, 0}};

template <std::size_t N> double absorption(const AbsorptionPoint (&table)[N], double nm) {
    if (nm <= table[0].first) return table[0].second;
    for (std::size_t i = 1; i < N; ++i)
        if (nm <= table[i].first)
            return std::lerp(table[i - 1].second, table[i].second,
                             (nm - table[i - 1].first) / (table[i].first - table[i - 1].first));
    return table[N - 1].second;
}

} // namespace

double relativeAirMass(double zenithAngle) {
    return 1 / (std::cos(zenithAngle) + 0.15 * std::pow(93.885 - zenithAngle * 180 / kPiD, -1.253));
}

double solarIrradianceInSpace(double nm) {
    const double x = std::clamp((nm - kSolarFirst) / kSolarStep, 0.0, std::size(kSolarIrradiance) - 1.0);
    const auto i = std::min(static_cast<std::size_t>(x), std::size(kSolarIrradiance) - 2);
    return std::lerp(kSolarIrradiance[i], kSolarIrradiance[i + 1], x - static_cast<double>(i));
}

double gasTransmittance(double nm, double airMass) {
    const double gas = absorption(kGasAbsorption, nm) * airMass,
                 water = absorption(kWaterAbsorption, nm) * kWater * airMass;
    return std::exp(-1.41 * gas / std::pow(1 + 118.93 * gas, 0.45) -
                    0.2385 * water / std::pow(1 + 20.07 * water, 0.45));
}

SampledCurve solarIrradiance(double zenithAngle, const AirParams& params) {
    const double cosine = std::cos(zenithAngle);
    if (!(cosine > 0)) return SampledCurve([](double) { return 0; });
    const AirMasses m = ClearAir(params).airMasses(cosine);
    const double airMass = relativeAirMass(zenithAngle);
    return SampledCurve([&](double nm) {
        const double depth = m.molecules * rayleighDepth(nm) + m.aerosol * aerosolDepth(nm, params.turbidity) +
                             m.ozone * ozoneDepth(nm, params.ozone);
        return solarIrradianceInSpace(nm) * gasTransmittance(nm, airMass) * std::exp(-depth);
    });
}

} // namespace abbe
