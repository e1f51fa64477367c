// The computed sky against random walks through the same air.
#include "lights/clear_sky.h"
#include "media/mie_spheres.h"
#include "support/nightly.h"
#include "support/sky_walk.h"

#include <complex>
#include <cstdlib>
#include <doctest/doctest.h>

namespace abbe::test {
namespace {

struct SkyCase {
    double turbidity, elevation, albedo;
    double most; // relative error in any direction, beyond what the walks leave unknown
    double mean; // of all directions and wavelengths
};

// Lognormal in number, of [Hess1998]; soluble particles as moist air has swollen them.
struct AerosolComponent {
    double number, median, spread; // per cm³, m, the exponential of the standard deviation of the logarithm
    std::complex<double> index;    // at 550 nm
};
constexpr double kMost = 7.5e-6; // m: larger ones fall out

// Radii that stand for equal shares of the cross-section, whose distribution is lognormal too.
std::vector<double> equalShares(const AerosolComponent& c) {
    const double log = std::log(c.spread), median = c.median * std::exp(2 * log * log);
    constexpr int count = 120;
    std::vector<double> radii;
    for (int i = 0; i < count; ++i) {
        double below = -8, above = 8; // the quantile of the normal distribution by bisection
        for (int k = 0; k < 50; ++k) {
            const double middle = (below + above) / 2;
            (0.5 * std::erfc(-middle / std::sqrt(2.0)) < (i + 0.5) / count ? below : above) = middle;
        }
        radii.push_back(std::min(median * std::exp(log * below), kMost));
    }
    return radii;
}

} // namespace

// Water-soluble, insoluble, soot: "continental average" at a humidity of 80 %.
TEST_CASE("aerosol scatters as Lorenz-Mie theory has it of continental air") {
    const AerosolComponent components[] = {{7000, 0.0306e-6, 2.24, {1.40, 0.0022}},
                                           {0.4, 0.471e-6, 2.51, {1.53, 0.008}},
                                           {8300, 0.0118e-6, 2.0, {1.75, 0.44}}};
    constexpr int steps = 720;
    std::vector<double> angles, intensity(steps + 1);
    for (int i = 0; i <= steps; ++i) angles.push_back(kPiD * i / steps);
    double scattering = 0, extinction = 0;
    for (const AerosolComponent& c : components) {
        const double area = c.number * square(c.median) * std::exp(2 * square(std::log(c.spread)));
        const MieScattering m = mieScattering(equalShares(c), 550e-9, c.index, angles);
        for (std::size_t i = 0; i < intensity.size(); ++i) intensity[i] += area * m.intensity[i];
        scattering += area * m.scattering;
        extinction += area * m.extinction;
    }
    CHECK(scattering / extinction == doctest::Approx(0.925).epsilon(0.005));
    double mean = 0, all = 0;
    for (std::size_t i = 0; i < steps; ++i) {
        const double middle = (angles[i] + angles[i + 1]) / 2;
        const double share = (intensity[i] + intensity[i + 1]) / 2 * std::sin(middle);
        all += share;
        mean += share * std::cos(middle);
    }
    CHECK(mean / all == doctest::Approx(0.703).epsilon(0.01));
    const double scale = 1 / (all * 2 * kPiD * kPiD / steps);
    for (std::size_t i = 8; i <= steps; i += 8) { // from 2°
        CAPTURE(angles[i] * 180 / kPiD);
        const auto lobes = static_cast<double>(aerosolPhase(static_cast<float>(std::cos(angles[i]))));
        CHECK(std::abs(std::log(lobes / (intensity[i] * scale))) < std::log(4.0 / 3));
    }
}

TEST_CASE("the sky is that of random walks through air and haze") {
    const int paths = test::nightly() ? 100000 : 2000;
    // Pure air is exact; the more haze, the more is lost of the shape of what it scatters twice.
    for (const SkyCase& c : {SkyCase{1, 60, 0.2, 0.02, 0.01},
                             {1, 20, 0.8, 0.03, 0.01},
                             {2.5, 60, 0.2, 0.06, 0.02},
                             {2.5, 20, 0.2, 0.06, 0.02},
                             {2.5, 5, 0.2, 0.08, 0.03},
                             {6, 30, 0.2, 0.12, 0.04}}) {
        const ClearSky sky({c.turbidity, 300}, c.elevation * kPiD / 180, SkyBands(static_cast<float>(c.albedo)));
        Random random(7);
        double sum = 0;
        int count = 0;
        for (const int band : {2, 6, 10}) {
            const double nm = SkyBands::wavelength(band);
            const SkyWalk walk(nm, {c.turbidity, 300}, c.elevation * kPiD / 180, c.albedo);
            for (const Vec3d& w : {Vec3d(0, 0, 1), normalize(Vec3d(0.5, 0.5, 0.7)), normalize(Vec3d(-0.8, 0.1, 0.4)),
                                   normalize(Vec3d(-0.3, 1, 0.1))}) {
                const double value = sky.at(Vec3(w))[band] * ClearSky::scale(nm);
                const Moments walks = walk.radiance(w, paths, random);
                CAPTURE(c.turbidity);
                CAPTURE(c.elevation);
                CAPTURE(nm);
                CAPTURE(w.z);
                CHECK(std::abs(value - walks.mean()) < c.most * walks.mean() + 4 * walks.standardError());
                sum += value / walks.mean() - 1;
                ++count;
            }
        }
        MESSAGE("turbidity " << c.turbidity << ", sun at " << c.elevation << "°: " << 100 * sum / count
                             << " % off in the mean");
        CHECK(std::abs(sum / count) < c.mean);
    }
}

} // namespace abbe::test
