#include "doctor/numeric_check.h"
#include "geometry/round_shapes.h"
#include "geometry/spherical_sampling.h"
#include "math/distribution.h"
#include "math/hash.h"
#include "math/warp.h"

#include <vector>

namespace abbe::doctor {

namespace {

struct Wide { // long double, for references
    long double x, y, z;
};
long double dot(const Wide& a, const Wide& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
Wide operator-(const Wide& a, const Wide& b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }
Wide cross(const Wide& a, const Wide& b) {
    return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
Wide widen(Vec3d v) { return {v.x, v.y, v.z}; }

// [VanOosterom1983] from edges, not normalised.
double triangleInLongDouble(Vec3d p, Vec3d q, Vec3d r) {
    const Wide a = widen(p), b = widen(q), c = widen(r);
    const long double la = std::sqrt(dot(a, a)), lb = std::sqrt(dot(b, b)), lc = std::sqrt(dot(c, c));
    const long double volume = std::abs(dot(a, cross(b - a, c - a)));
    const long double below = la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb;
    return static_cast<double>(2 * std::atan2(volume, below));
}

} // namespace

double coneSolidAngleError() {
    double worst = 0;
    for (int i = 0; i <= 4000; ++i) {
        const double theta = 1e-7 * std::pow(kPiD / 2 / 1e-7, i / 4000.0);
        const float sine = static_cast<float>(std::sin(theta));
        const double angle = std::asin(static_cast<double>(sine)), expected = 2 * square(std::sin(angle / 2));
        worst = std::max(worst, std::abs(static_cast<double>(oneMinusCos(sine)) / expected - 1));
        if (theta > 1.2) continue; // too near for the sphere below, whose place is rounded
        const Sphere sphere(Vec3d(0, 0, 4), 4 * std::sin(theta));
        const auto sample = sphere.sample(Vec3(), 0, {0.3f, 0.6f});
        const double density = 1 / (4 * kPiD * square(std::sin(theta / 2)));
        worst = std::max(worst, sample ? std::abs(static_cast<double>(sample->pdfSolidAngle) / density - 1) : 1.0);
    }
    return worst;
}

double triangleSolidAngleError() {
    RandomStream random(3);
    const auto corner = [&](double size) {
        const auto u = [&] { return static_cast<double>(random.uniform()) - 0.5; };
        const double x = u(), y = u(), z = u();
        return normalize(Vec3d(0.3, -0.2, 1.5)) + Vec3d(x, y, z) * size;
    };
    double worst = 0;
    for (const double size : {1e-3, 1e-2, 0.1, 0.5, 1.0})
        for (int i = 0; i < 20000; ++i) {
            const Vec3d a = corner(size), b = corner(size), c = corner(size);
            const double expected = triangleInLongDouble(a, b, c);
            if (expected < 1e-3 * size * size) continue; // a sliver seen edge-on has none to speak of
            worst = std::max(worst, std::abs(SphericalTriangle(a, b, c).solidAngle() / expected - 1));
        }
    return worst;
}

double emptyBinsDrawn() {
    const std::vector<std::vector<double>> tables = {
        {0, 0, 1, 0}, {1, 0, 0}, {0, 1e-30, 0, 1e30, 0}, {1e-300, 0, 0}, {0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0.1, 0}};
    double drawn = 0;
    for (const auto& weights : tables) {
        const Distribution1D table(weights);
        const auto bad = [&](float u) {
            const BinSample s = table.sample(u);
            return !(weights[s.index] > 0 && s.probability > 0 && s.offset >= 0 && s.offset < 1);
        };
        for (std::uint32_t i = 0; i < 1u << 24; ++i) drawn += bad(static_cast<float>(i) * 0x1p-24f);
        drawn += bad(0x1p-149f) + bad(0x1p-60f);
    }
    return drawn;
}

double darkBinError() {
    std::vector<double> weights(100000, 1);
    weights[10] = 1e9;
    const Distribution1D table(weights);
    const double expected = 1 / (1e9 + 99999);
    double worst = 0;
    for (std::size_t i = 0; i < weights.size(); ++i)
        if (i != 10) worst = std::max(worst, std::abs(table.probability(i) / expected - 1));
    return worst;
}

} // namespace abbe::doctor
