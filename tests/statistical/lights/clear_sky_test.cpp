// The computed sky against random walks through the same air.
#include "lights/clear_sky.h"
#include "support/sky_walk.h"

#include <cstdlib>
#include <doctest/doctest.h>

namespace abbe::test {
namespace {

struct SkyCase {
    double turbidity, elevation, albedo;
    double most; // relative error in any direction, beyond what the walks leave unknown
    double mean; // of all directions and wavelengths
};

} // namespace

TEST_CASE("the sky is that of random walks through air and haze") {
    const char* nightly = std::getenv("ABBE_NIGHTLY");
    const int paths = nightly && *nightly == '1' ? 100000 : 3000;
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
