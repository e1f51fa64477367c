// The spectrum behind a prism, scenes/check/prism-spectrum.scene: where it lies and which colours it has.
#include "caustics/light_tracing/light_path_plan.h"
#include "support/prism_spectrum.h"
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// Of the scene.
constexpr double kFrom = 140, kTo = 280, kPrismReflectance = 1e-5;
constexpr int kPixels = 28;
constexpr int kRows = 8; // as far as the screen: all alike, as the prism is ten times as long

std::vector<Xyz> expected(double diameter, int fine = 24) {
    PrismSpectrumScene scene;
    scene.diameter = diameter * kPiD / 180;
    auto pixels = PrismSpectrum(scene).pixels(kFrom, kTo, kPixels, fine);
    for (Xyz& p : pixels) p = p * (kPrismReflectance / kPiD);
    return pixels;
}
double value(Xyz v, Channel c) { return c == Channel::x ? v.x : c == Channel::y ? v.y : v.z; }

// Sum, and place in mm, of what a channel shows in all pixels together.
struct Profile {
    double sum = 0, place = 0;
};
template <typename F> Profile profile(F&& pixel) {
    Profile p;
    for (int i = 0; i < kPixels; ++i) {
        const double v = pixel(i);
        p.sum += v;
        p.place += v * (kFrom + (i + 0.5) * (kTo - kFrom) / kPixels);
    }
    p.place /= p.sum;
    return p;
}

// Each replicate is a picture of its own, so that places and shares, which are ratios, get errors from their spread.
// `resolution`: of the places, mm.
void compare(double diameter, std::uint32_t samples, double resolution) {
    BuildOptions options;
    options.size = Vec2i{kPixels, kRows};
    const auto scene =
        TestScene::load("scenes/check/prism-spectrum.scene", options, {fmt::format("sun-diameter={} deg", diameter)});
    RenderSettings settings = scene.settings();
    settings.samples = samples;
    settings.maxDepth = 4; // screen, two faces and the base: what three faces reflect inside is not in the quadrature
    const int replicates = 32;
    const TestImage image = renderAsProgram(scene, settings, replicates);
    const auto exact = expected(diameter);
    std::string text;
    std::array<Moments, 3> sums, places;
    std::array<Profile, 3> right;
    for (const Channel c : {Channel::x, Channel::y, Channel::z}) {
        const auto i = static_cast<std::size_t>(c);
        right[i] = profile([&](int p) { return value(exact[static_cast<std::size_t>(p)], c); });
        for (int r = 0; r < replicates; ++r) {
            const Profile p = profile([&](int x) { return image.film.replicateMean(x, 0, r, c); });
            sums[i].add(p.sum);
            // Linear in the picture, where a quotient would be biased: 0 where the place is right.
            places[i].add(p.sum / right[i].sum * (p.place - right[i].place));
        }
        text += fmt::format(" {}: {:.2f} mm {:+.3f} ± {:.3f}, amount {:+.2f} ± {:.2f} %;", "XYZ"[i], right[i].place,
                            places[i].mean(), places[i].standardError(), 100 * (sums[i].mean() / right[i].sum - 1),
                            100 * sums[i].standardError() / right[i].sum);
    }
    MESSAGE("disk of " << diameter << " deg:" << text);
    for (std::size_t i = 0; i < 3; ++i) {
        INFO(std::string(1, "XYZ"[i]));
        CHECK(meanTest(sums[i], right[i].sum) > sidak(kImageLevel, 6));
        CHECK(studentTwoSided(places[i].mean() / places[i].standardError(), replicates - 1) > sidak(kImageLevel, 6));
        CHECK(places[i].standardError() < resolution);
    }
    double brightest = 0;
    for (const Xyz& v : exact) brightest = std::max({brightest, v.x, v.y, v.z});
    // The colour of each pixel, and how bright it is.
    for (int x = 0; x < kPixels; ++x)
        for (const Channel c : {Channel::x, Channel::y, Channel::z}) {
            const double v = value(exact[static_cast<std::size_t>(x)], c);
            const Estimate e = image.film.tile({x, 0, x + 1, kRows}, c);
            if (v == 0) CHECK(e.mean == 0);
            if (v < 0.01 * brightest) continue; // too few paths to have a spread
            INFO("pixel " << x << " " << std::string(1, "XYZ"[static_cast<std::size_t>(c)]) << ": " << e.mean << " ± "
                          << std::sqrt(e.variance) << " for " << v);
            CHECK(studentTwoSided((e.mean - v) / std::sqrt(e.variance), e.degrees) > sidak(kImageLevel, 3 * kPixels));
        }
    CHECK(image.statistics.cappedPaths == 0);
    CHECK(image.statistics.lightPaths > 0);
    CHECK(std::isfinite(image.statistics.caustics.of<LightPathFindings>().gain));
}

} // namespace

TEST_CASE("quadrature behind a prism: sodium light at least deviation, by hand") {
    // scenes/prism/README.md: index 1.78446; deviations of 75.43°, 66.31° and 64.75°, of which the light rose 30°. It
    // is a stripe between the images of the top and of the foot of the second face.
    const PrismSpectrum prism({});
    CHECK(prism.index(589.3) == doctest::Approx(1.78446).epsilon(1e-5));
    const double turn = -3.17 * kPiD / 180, r = 20 / std::sqrt(3.0);
    const auto falls = [&](double corner, double deviation) {
        const double angle = turn + corner * kPiD / 180, down = (deviation - 30) * kPiD / 180;
        return r * std::cos(angle) + (180 + r * std::sin(angle)) / std::tan(down);
    };
    const Vec3d way{std::cos(kPiD / 6), 0.5, 0};
    for (const auto& [nm, deviation] : {std::pair{400.0, 75.43}, std::pair{589.3, 66.31}, std::pair{700.0, 64.75}}) {
        const auto stripe = prism.stripe(way, prism.index(nm));
        REQUIRE(stripe);
        CHECK(stripe->to == doctest::Approx(falls(90, deviation)).epsilon(3e-4));
        // Rays that rise in the glass, of violet, leave the foot of the second face dark; others fill it.
        if (nm > 500) CHECK(stripe->from == doctest::Approx(falls(-30, deviation)).epsilon(3e-3));
    }
    // The base is tilted by the turn; it mirrors light to 30° + 2 · 3.17° below the horizon.
    const auto white = prism.mirrored(way, prism.index(589.3));
    REQUIRE(white);
    CHECK(white->to == doctest::Approx(falls(-30, 66.34)).epsilon(1e-6));
}

TEST_CASE("quadrature behind a prism: power is kept") {
    // What falls on the screen is what enters and is not reflected: stripe × irradiance = width of the beam × T.
    const PrismSpectrum prism({});
    const double n = 1.78446, i = 63.1605 * kPiD / 180, t = std::asin(std::sin(i) / n);
    const double rs = std::sin(i - t) / std::sin(i + t), rp = std::tan(i - t) / std::tan(i + t);
    const double through = 1 - (rs * rs + rp * rp) / 2;
    const auto stripe = prism.stripe({std::cos(kPiD / 6), 0.5, 0}, n);
    REQUIRE(stripe);
    CHECK((stripe->to - stripe->from) * stripe->value ==
          doctest::Approx(20 * std::cos(i) * through * through).epsilon(2e-3));
}

TEST_CASE("quadrature behind a prism: twice as fine is the same to 0.1 %") {
    for (const double diameter : {5.0, 0.53}) {
        const auto coarse = expected(diameter), fine = expected(diameter, 48);
        double whole = 0;
        for (const Xyz& p : fine) whole += p.y / kPixels;
        for (std::size_t i = 0; i < coarse.size(); ++i)
            for (const Channel c : {Channel::x, Channel::y, Channel::z})
                CHECK(std::abs(value(coarse[i], c) - value(fine[i], c)) < 1e-3 * std::max(whole, value(fine[i], c)));
    }
}

TEST_CASE("the spectrum behind a prism: place and colour") {
    if (nightly()) compare(5, 1u << 18, 0.2);
    compare(0.53, nightly() ? 1u << 18 : 1u << 13, nightly() ? 0.2 : 1);
}

} // namespace abbe::test
