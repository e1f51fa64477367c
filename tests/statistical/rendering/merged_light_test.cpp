// Merged light against closed forms, sharp enough to see a fault of one per cent. All light of these pictures is
// merged, but for one: their glass stands in instances, over which chains are not followed, and the eye sees all
// through it. It is even where it is gathered, so that disks of any size blur nothing; and a sphere within a chord r of
// a point has the area π r² of a flat disk.
#include "caustics/manifold/manifold_plan.h"
#include "caustics/merging/merge_plan.h"
#include "spectrum/curve.h"
#include "spectrum/named_spectra.h"
#include "spectrum/sensor.h"
#include "support/quadrature.h"
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// What cd and lx count of a flat spectrum of 1 per nm.
constexpr double kMergedLuminousScale = kLuminousEfficacy * kYIntegral;
constexpr double kMergedReflectance = 0.5, kMergedIndex = 1.5;
constexpr int kMergedReplicates = 16;
// Of the picture's mean: one per cent is five standard errors or more, and passes in one run of some hundred.
constexpr double kLevel = 1e-3;
const double kResolution = nightly() ? 0.002 : 0.003;

// Share of unpolarized light that an interface to an index n times as large reflects.
double fresnel(double cosine, double n) {
    const double beyond = std::sqrt(1 - (1 - square(cosine)) / square(n));
    const double s = (cosine - n * beyond) / (cosine + n * beyond), p = (n * cosine - beyond) / (n * cosine + beyond);
    return (square(s) + square(p)) / 2;
}

// `rounds`: of merging, in all replicates together. `film`: its size, and a crop. `exact`: Y of every pixel. `shared`:
// manifold sampling has some of it.
void compare(const std::string& name, const std::string& film, const std::string& text, double exact,
             std::uint32_t rounds, bool shared = false) {
    const TestScene scene = TestScene::parse("scene 1\nfilm { filter box 0.5; size " + film + " }\n" + text);
    RenderSettings settings = scene.settings();
    settings.samples = nightly() ? 8 * rounds : rounds / 2;
    settings.technique.merging = Technique::Merging::always;
    if (shared) settings.technique.lightPaths = Technique::LightPaths::always;
    const TestImage image = renderAsProgram(scene, settings, kMergedReplicates);
    const ImageComparison c = compareExpected(image.film, [&](int, int) { return exact; });
    const RenderStatistics& s = image.statistics;
    MESSAGE(fmt::format("{}: {:+.3f} ± {:.3f} %, {} rounds, {:.1f} s", name, 100 * c.difference, 100 * c.error,
                        s.rounds, s.coreSeconds));
    INFO(c.text());
    CHECK(c.same());
    CHECK(c.wholeP > kLevel);
    CHECK(c.error < kResolution);
    if (!shared) CHECK(s.rounds == settings.samples); // fewer would be coarser, not wrong
    CHECK(s.caustics.of<ManifoldFindings>().used == shared);
    CHECK(s.caustics.of<MergeFindings>().used);
    CHECK(s.cappedPaths == 0);
}

// An integrating sphere of radius 1 around a shell of glass, and in its hollow a light in the middle and the eye. Light
// from the walls is even and comes back to them in full, but for what meets the light. So the eye sees the radiance of
// the walls in every direction, whatever the glass makes of it: a closed room without absorption is in equilibrium.
struct Shell {
    double outer, inner;
    double eye; // from the middle

    std::string scene(const std::string& light, bool followed = false) const {
        const std::string glass =
            fmt::format("    shape sphere {{ radius {}; material dielectric {{ ior {}; priority 1 }} }}\n"
                        "    shape sphere {{ radius {}; material dielectric {{ ior 1; priority 2 }} }}\n",
                        outer, kMergedIndex, inner);
        return fmt::format("camera spherical {{ from 0 {} 0 }}\n"
                           "shape sphere {{ radius 1; material diffuse {{ reflectance {} }} }}\n",
                           eye, kMergedReflectance) +
               (followed ? glass : "object shell {\n" + glass + "}\ninstance shell\n") + light;
    }
    // Share of the light of an even ball of radius a in the middle that gets out, and of light from outside towards
    // that ball that gets in. What is reflected comes back to the ball: it keeps its distance from the middle.
    double transmittance(double a) const {
        return integrate(
            [&](double part) { // of the ball's disk, in area
                const double b2 = part * square(a);
                const double ri = fresnel(std::sqrt(1 - b2 / square(inner)), kMergedIndex);
                const double ro = fresnel(std::sqrt(1 - b2 / square(outer)), kMergedIndex);
                return (1 - ri) * (1 - ro) / (1 - ri * ro); // with all that goes to and fro in the glass
            },
            0, 1, 8);
    }
};

} // namespace

TEST_CASE("merged light: a point in an integrating sphere") {
    // Irradiance of the walls: Φ / (4π (1 - ρ)). Nothing else than merging finds any of it.
    const Shell shell{0.5, 0.4, 0.3};
    compare("point", "40 32; crop 0 4 40 28",
            shell.scene(fmt::format("light point {{ color 1; intensity {} cd }}\n", kMergedLuminousScale)),
            kMergedReflectance / kPiD / (1 - kMergedReflectance), 128);
}

TEST_CASE("merged light: a ball that camera paths meet, in an integrating sphere") {
    // Camera paths would find all of it, too. A ball of radius a and radiance 1 brings π a² τ to each m² of wall, and
    // takes ρ a² τ of what comes from there. The crop leaves out what sees the ball, also by reflection.
    const double a = 0.5;
    const Shell shell{0.9, 0.85, 0.75};
    const double brought = square(a) * shell.transmittance(a);
    compare("ball", "40 32; crop 0 8 40 24", shell.scene(fmt::format("light sphere {{ radius {}; radiance 1 }}\n", a)),
            kMergedReflectance * brought / (1 - kMergedReflectance + kMergedReflectance * brought), 192);
}

// In the middle of the ball's disk its image, were all of the ball like there, is 0.03 sr, at the rim nothing.
TEST_CASE("merged light: a ball of which manifold sampling has the rim and merging the middle") {
    const double a = 0.05;
    const Shell shell{0.5, 0.4, 0.3};
    const double brought = square(a) * shell.transmittance(a);
    compare("rim and middle", "40 32; crop 0 4 40 28",
            shell.scene(fmt::format("light sphere {{ radius {}; radiance 1 }}\n", a), true),
            kMergedReflectance * brought / (1 - kMergedReflectance + kMergedReflectance * brought), 1024, true);
}

TEST_CASE("merged light: the sun through one glass, seen through another") {
    // A floor under two level interfaces beside each other. ρ/π · E cos θ · T(θ) · T(θ') / n'², θ of the sun and θ' of
    // the eye; where glass disperses, in the mean over all wavelengths. No third interface: max-depth 3.
    const double sun = 50 * kPiD / 180, eye = 35 * kPiD / 180;
    const char* const none = nullptr;
    struct Case {
        const char *lit, *seen; // glass; null: kIndex
        std::uint32_t rounds;
    };
    const auto ior = [](const char* glass) {
        return glass ? std::string("glass ") + glass : fmt::format("{}", kMergedIndex);
    };
    const auto index = [](const char* glass, double nm) {
        return glass ? indexCurve(*findGlass(glass))->at(nm) : kMergedIndex;
    };
    std::vector<Case> cases{{nullptr, nullptr, 128}};
    if (nightly()) // one wavelength a round: these are noisy
        for (const auto& [lit, seen] : {std::pair{"SF11", none}, {none, "SF11"}, {"SF11", "SF11"}})
            cases.push_back({lit, seen, 192});
    for (const Case& c : cases) {
        const SampledCurve radiance([&](double nm) {
            const double n1 = index(c.lit, nm), n2 = index(c.seen, nm);
            return kMergedReflectance / kPiD * std::cos(sun) * (1 - fresnel(std::cos(sun), n1)) *
                   (1 - fresnel(std::cos(eye), n2)) / square(n2);
        });
        const auto pane = [&](const char* glass, int side) {
            return fmt::format("    shape quad {{ points {0} 0 0.4  {1} 0 0.4  {1} 0 -0.4  {0} 0 -0.4\n"
                               "        material dielectric {{ ior {2} }} }}\n",
                               side < 0 ? -0.8 : 0, side < 0 ? 0 : 0.8, ior(glass));
        };
        compare(fmt::format("{} and {}", ior(c.lit), ior(c.seen)), "32 32",
                fmt::format("render {{ max-depth 3 }}\n"
                            "camera orthographic {{ from {} 2 0; look-at 0.2 0 0; width 0.25; up 0 0 -1 }}\n"
                            "shape quad {{ points -0.3 -0.5 0.3  0.3 -0.5 0.3  0.3 -0.5 -0.3  -0.3 -0.5 -0.3\n"
                            "    material diffuse {{ reflectance {} }} }}\n"
                            "object panes {{\n{}{}}}\ninstance panes\n"
                            "light sun {{ toward {} {} 0; irradiance {} lx; color 1; angular-diameter 0 deg }}\n",
                            0.2 + 2 * std::tan(eye), kMergedReflectance, pane(c.lit, -1), pane(c.seen, 1),
                            std::sin(sun), -std::cos(sun), kMergedLuminousScale),
                integrate(radiance).y, c.rounds);
    }
}

TEST_CASE("merged light: the sun in haze under glass, seen through it") {
    // The glass keeps the sun from all of the haze but by way of itself. From straight above, so that the tube in which
    // it is gathered stays within the haze. Scattered once, at depths y up to H: T(0)/n² · E cos θ T(θ)/cos θ' · σ_s
    // p(-cos θ') ∫ exp(-σ_t y (1 + 1/cos θ')) dy.
    const double sun = 50 * kPiD / 180, extinction = 3, albedo = 0.9, g = 0.3, height = 0.4;
    const double in = std::sqrt(1 - square(std::sin(sun) / kMergedIndex)); // cos θ'
    const double phase = (1 - square(g)) / (4 * kPiD * std::pow(1 + square(g) + 2 * g * in, 1.5));
    const double slope = extinction * (1 + 1 / in);
    const double scattered = extinction * albedo * phase * (1 - std::exp(-slope * height)) / slope;
    const double arriving = std::cos(sun) * (1 - fresnel(std::cos(sun), kMergedIndex)) / in;
    compare("haze", "32 32",
            fmt::format("render {{ max-depth 3 }}\n"
                        "camera orthographic {{ from 0 2 0; look-at 0 0 0; width 0.25; up 0 0 -1 }}\n"
                        "object pane {{ shape quad {{ points -1.1 0 0.25  0.3 0 0.25  0.3 0 -0.25  -1.1 0 -0.25\n"
                        "    material dielectric {{ ior {} }} }} }}\ninstance pane\n"
                        "shape box {{ min -0.45 {} -0.2; max 0.3 -0.1 0.2; material boundary\n"
                        "    interior homogeneous {{ extinction {} per-m; albedo {}; phase henyey-greenstein {} }} }}\n"
                        "light sun {{ toward {} {} 0; irradiance {} lx; color 1; angular-diameter 0 deg }}\n",
                        kMergedIndex, -0.1 - height, extinction, albedo, g, std::sin(sun), -std::cos(sun),
                        kMergedLuminousScale),
            arriving * scattered * (1 - fresnel(1, kMergedIndex)) / square(kMergedIndex), 256);
}

} // namespace abbe::test
