#include "spectrum/wavelength_density.h"

#include "base/check.h"
#include "spectrum/color_space.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

constexpr int kCells = WavelengthDensity::kNodes - 1;
constexpr double kLightShare = 0.9;
constexpr double kShownShare = 0.5;
// Weights of single lanes stay bounded where the eye sees next to nothing.
constexpr double kLeastSensitivity = 1e-3; // of the largest
constexpr double kWorthATable = 0.7;       // half the variance

double nanometres(int node) { return static_cast<double>(kMinWavelength) + node; }

std::vector<double> sensitivity() {
    std::vector<double> norms;
    double most = 0;
    for (int i = 0; i <= kCells; ++i) {
        const Wavelengths w = Wavelengths::single(static_cast<float>(nanometres(i)));
        norms.push_back(length(toRgb(Xyz{xbar(w)[0], ybar(w)[0], zbar(w)[0]}, rgb::ap0)));
        most = std::max(most, norms.back());
    }
    for (double& n : norms) n = std::max(n, kLeastSensitivity * most);
    return norms;
}

// What surfaces and several bounces make of a spectrum: even, with edges, narrow, and the fourth power of a red. None
// is black: what is left of a light that a surface swallows must not decide.
double reflectance(int kind, double nm) {
    const double red = 1 / (1 + std::exp((590 - nm) / 12));
    switch (kind) {
    case 0:
        return 1;
    case 1:
        return nm < 580 ? 0.05 : 0.9;
    case 2:
        return nm < 500 ? 0.9 : 0.05;
    case 3:
        return nm > 500 && nm < 580 ? 0.8 : 0.05;
    case 4:
        return 0.02 + 0.88 * red * red * red * red;
    default:
        return 0.1 + 0.8 * std::exp(-0.5 * std::pow((nm - 540) / 30, 2));
    }
}
constexpr int kReflectances = 6;

using Nodes = std::array<float, WavelengthDensity::kNodes>;

const std::array<Nodes, kReflectances>& reflectances() {
    static const auto tables = [] {
        std::array<Nodes, kReflectances> result;
        for (int kind = 0; kind < kReflectances; ++kind)
            for (int i = 0; i <= kCells; ++i)
                result[static_cast<std::size_t>(kind)][static_cast<std::size_t>(i)] =
                    static_cast<float>(reflectance(kind, nanometres(i)));
        return result;
    }();
    return tables;
}

// As SampledCurve reads it: linear between the nodes.
Spectrum lookup(const Nodes& nodes, const Wavelengths& w) { return interpolate(nodes.data(), w.cell, w.fraction); }

// To an integral of 1, linear between the nodes.
void normalize(std::span<double> density) {
    double total = 0;
    for (std::size_t i = 0; i < kCells; ++i) total += 0.5 * (density[i] + density[i + 1]);
    for (double& d : density) d /= total;
}

// Variance of a vector over its squared mean.
class RelativeVariance {
  public:
    void add(Vec3d v) {
        ++count_;
        sum_ += v;
        squares_ += dot(v, v);
    }
    double value() const {
        const Vec3d mean = sum_ * (1 / count_);
        const double square = dot(mean, mean);
        return square > 0 ? std::max(0.0, squares_ / count_ / square - 1) : std::numeric_limits<double>::infinity();
    }

  private:
    Vec3d sum_;
    double squares_ = 0, count_ = 0;
};

} // namespace

WavelengthDensity WavelengthDensity::following(std::span<const double> power, std::optional<Shown> shown) {
    ABBE_CHECK(power.size() == kNodes);
    double mean = 0;
    for (const double p : power) mean += p / kNodes;
    ABBE_CHECK(mean > 0 && std::isfinite(mean));
    std::vector<double> weight = sensitivity();
    for (std::size_t i = 0; i < kNodes; ++i) weight[i] *= kLightShare * power[i] / mean + (1 - kLightShare);
    normalize(weight);
    if (shown) {
        std::vector<double> even(kNodes, 0.0);
        for (int i = 0; i < kNodes; ++i)
            if (nanometres(i) > shown->first - 1 && nanometres(i) < shown->last + 1)
                even[static_cast<std::size_t>(i)] = 1;
        normalize(even);
        for (std::size_t i = 0; i < kNodes; ++i) weight[i] = std::lerp(weight[i], even[i], kShownShare);
    }
    WavelengthDensity result;
    result.table_ = tableOf(weight);
    return result;
}

std::shared_ptr<const WavelengthDensity::Table> WavelengthDensity::tableOf(std::span<const double> density) {
    auto table = std::make_shared<Table>();
    double below = 0;
    for (std::size_t i = 0; i < kNodes; ++i) {
        table->density[i] = density[i];
        table->rounded[i] = static_cast<float>(density[i]);
        table->cumulative[i] = below;
        if (i + 1 < kNodes) below += 0.5 * (density[i] + density[i + 1]);
    }
    table->cumulative.back() = 1;
    for (std::size_t i = 0; i < table->guide.size(); ++i) {
        const auto above = std::upper_bound(table->cumulative.begin(), table->cumulative.end() - 1,
                                            static_cast<double>(i) / static_cast<double>(table->guide.size() - 1));
        table->guide[i] = static_cast<std::uint16_t>(above - table->cumulative.begin() - 1);
    }
    return table;
}

WavelengthDensity WavelengthDensity::bestFor(std::span<const double> power, std::optional<Shown> shown) {
    if (std::all_of(power.begin(), power.end(), [](double p) { return p == 0; })) return {};
    WavelengthDensity table = following(power, shown);
    const WavelengthDensity smooth;
    return table.noise(power) < kWorthATable * smooth.noise(power) ? table : smooth;
}

Wavelengths WavelengthDensity::tabulated(double u) const {
    const Table& t = *table_;
    Spectrum nm;
    for (int lane = 0; lane < kLanes; ++lane) {
        double q = u + 0.125 * lane;
        q = q >= 1 ? q - 1 : q;
        std::size_t i = t.guide[static_cast<std::size_t>(q * static_cast<double>(t.guide.size() - 1))];
        while (i + 1 < kCells && t.cumulative[i + 1] <= q) ++i;
        // Within the cell a t + (b - a) t² / 2 = r, in the form that survives a = b.
        const double a = t.density[i], b = t.density[i + 1], r = q - t.cumulative[i];
        const double x = 2 * r / (a + std::sqrt(std::max(a * a + 2 * (b - a) * r, 0.0)));
        nm.v[lane] = static_cast<float>(nanometres(static_cast<int>(i)) + std::min(x, 1.0));
    }
    Wavelengths w = Wavelengths::at(min(nm, Spectrum(kMaxWavelength)), Spectrum(1.f));
    // At the wavelength as it was rounded, so that light and density are read at the same place.
    w.pdf = interpolate(t.rounded.data(), w.cell, w.fraction);
    return w;
}

double WavelengthDensity::pdf(double nm) const {
    const double x = std::clamp(nm - static_cast<double>(kMinWavelength), 0.0, static_cast<double>(kCells));
    if (!table_) return 0.0039398042 / std::pow(std::cosh(0.0072 * (nm - 538)), 2);
    const auto i = std::min(static_cast<std::size_t>(x), static_cast<std::size_t>(kCells) - 1);
    return std::lerp(table_->density[i], table_->density[i + 1], x - static_cast<double>(i));
}

double WavelengthDensity::noise(std::span<const double> power) const {
    ABBE_CHECK(power.size() == kNodes);
    // At 2048 quantiles: four in a nanometre, in the mean.
    constexpr int samples = 256;
    const double most = *std::max_element(power.begin(), power.end());
    if (!(most > 0)) return 0;
    std::array<Nodes, kReflectances> reflected = reflectances();
    for (std::size_t i = 0; i < kNodes; ++i) {
        const auto p = static_cast<float>(power[i] / most);
        for (Nodes& nodes : reflected) nodes[i] *= p;
    }
    const Vec3d byX = toRgb(Xyz{1, 0, 0}, rgb::ap0), byY = toRgb(Xyz{0, 1, 0}, rgb::ap0),
                byZ = toRgb(Xyz{0, 0, 1}, rgb::ap0);
    std::array<RelativeVariance, kReflectances> variance;
    for (int s = 0; s < samples; ++s) {
        // The rotations make the set of wavelengths periodic.
        const Wavelengths w = sample((s + 0.5) / (kLanes * samples));
        // What light of 1 in a lane adds to each channel, up to a factor.
        const Spectrum x = xbar(w) / w.pdf, y = ybar(w) / w.pdf, z = zbar(w) / w.pdf;
        const auto channel = [&](double fx, double fy, double fz) {
            return x * static_cast<float>(fx) + y * static_cast<float>(fy) + z * static_cast<float>(fz);
        };
        const Spectrum r = channel(byX.x, byY.x, byZ.x), g = channel(byX.y, byY.y, byZ.y),
                       b = channel(byX.z, byY.z, byZ.z);
        for (std::size_t k = 0; k < kReflectances; ++k) {
            const Spectrum light = lookup(reflected[k], w);
            variance[k].add(Vec3d(Vec3{sum(light * r), sum(light * g), sum(light * b)}));
        }
    }
    double total = 0;
    for (const RelativeVariance& v : variance) total += v.value();
    return std::sqrt(total / kReflectances);
}

} // namespace abbe
