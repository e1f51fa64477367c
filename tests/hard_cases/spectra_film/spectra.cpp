// Spectra: cases 46 to 51 of docs/hard_cases.md.
#include "film/pixel_film.h"
#include "hard_cases/hard_case.h"
#include "media/homogeneous.h"
#include "spectrum/dispersion.h"
#include "spectrum/emission_curves.h"
#include "spectrum/rgb_upsampling.h"
#include "spectrum/wavelength_density.h"
#include "support/media.h"
#include "support/scene_test.h"
#include "transport/medium_tracker.h"

using namespace abbe;
using namespace abbe::test;

TEST_CASE("case 46: tables that end inside 360–830 nm; wavelength density 0") {
    HardCase c;
    c.doctor();
    double worst = 0, least = 1;
    for (const double centre : {360.0, 470.0, 632.8, 830.0}) {
        std::vector<double> power;
        const auto line = lineCurve(centre);
        for (int i = 0; i < WavelengthDensity::kNodes; ++i) power.push_back(line->at(360.0 + i));
        const WavelengthDensity density = WavelengthDensity::following(power);
        double sum = 0;
        for (int i = 0; i < 470; ++i) sum += 0.5 * (density.pdf(360 + i) + density.pdf(361 + i));
        worst = std::max(worst, std::abs(sum - 1));
        for (int i = 0; i <= 4700; ++i) least = std::min(least, density.pdf(360 + 0.1 * i));
    }
    c.measured("error of the integral of densities that follow a laser's line", worst, 1e-6);
    c.atLeast("least density anywhere", least, 1e-8);
    const auto line = lineCurve(632.8);
    c.naive("density in proportion to the line, at 500 nm", line->at(500.0));
}

// A chromatic medium whose extinction at one end is a million times that at the other.
TEST_CASE("case 47: densities of all wavelengths but one vanish") {
    HardCase c;
    int bad = 0;
    const auto run = [&](const SlopeCurve& extinction, double distance, std::uint64_t seed, Spectrum& beta,
                         Spectrum& density) {
        const SlopeCurve albedo(1, 1);
        const HomogeneousMedium medium(opticsOf(extinction, albedo));
        const Medium* const list[] = {&medium};
        MediumTracker tracker(list);
        RandomStream random(seed);
        beta = density = Spectrum(1.f);
        const TrackedWeights weights{&beta, &density};
        return tracker
            .follow({{}, {0, 0, 1}}, static_cast<float>(distance), {}, Wavelengths::sample(0.3f), random, weights)
            .medium;
    };
    for (std::uint64_t seed = 1; seed < 3000; ++seed) {
        Spectrum beta, density;
        run({1e-3, 1e3}, 1, seed, beta, density);
        float largest = 0;
        for (int lane = 0; lane < kLanes; ++lane) {
            bad += !std::isfinite(beta[lane]) || !(density[lane] >= 0);
            largest = std::max(largest, density[lane]);
        }
        bad += !(std::abs(largest - 1) < 1e-5f);
    }
    c.measured("weights that are not finite, or all 0, optical depths from 1e-3 to 1e3", bad, 0);
    const volatile float thin = std::exp(-1e4f), thick = std::exp(-2e4f);
    c.naive("ratio of two transmittances of depths 1e4 and 2e4", static_cast<double>(thick / thin));
    // What comes through in each lane: the mean of beta over density is its transmittance.
    const SlopeCurve steep(0.1, 4);
    const Wavelengths lambda = Wavelengths::sample(0.3f);
    std::array<Moments, kLanes> through;
    for (std::uint64_t seed = 1; seed < 60000; ++seed) {
        Spectrum beta, density;
        const bool scattered = run(steep, 1, seed, beta, density) != nullptr;
        // The sum of all lanes' balance heuristic with lane 0 as the hero.
        for (int lane = 0; lane < kLanes; ++lane)
            through[static_cast<std::size_t>(lane)].add(scattered ? 0 : static_cast<double>(beta[lane] / density[0]));
    }
    double worst = 0;
    for (int lane = 0; lane < kLanes; ++lane) {
        const Moments& m = through[static_cast<std::size_t>(lane)];
        worst = std::max(worst, std::abs(m.mean() - std::exp(-steep.at(static_cast<double>(lambda.nm[lane])))) /
                                    m.standardError());
    }
    c.measured("largest error of a lane's transmittance, in standard errors", worst, 4);
}

TEST_CASE("case 48: refractive index of 0 or a resonance") {
    HardCase c;
    int accepted = 0;
    for (const char* index : {"0", "0.1", "11", "-1.5", "table 400 1.5 500 0 600 1.5", "1e400"}) {
        const TestScene scene =
            TestScene::parse(std::string("scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\n"
                                         "light sky { radiance 1 }\nshape sphere { material dielectric { ior ") +
                             index + " } }\n");
        accepted += !scene.diagnostics().hasErrors();
    }
    Random random(48);
    int bad = 0, usable = 0;
    for (int i = 0; i < 5000; ++i) { // formulas with resonances anywhere
        std::array<double, 7> k;
        for (double& x : k) x = 2 * random.uniformDouble() - (i % 2 ? 1 : 0);
        const Dispersion d{static_cast<DispersionFormula>(1 + i % 2), k};
        const auto curve = makeIndexCurve(d);
        if (!usableIndex(*curve)) continue;
        ++usable;
        for (double nm = 360; nm <= 830; nm += 1) bad += !(curve->at(nm) > 0.2 && curve->at(nm) < 10);
    }
    CHECK(usable > 50);
    c.measured("of six impossible indices, those that are accepted", accepted, 0);
    c.measured("of 5000 random formulas, indices outside of 0.2 … 10 in those taken for usable", bad, 0);
    const volatile float zero = 0;
    c.naive("Snell's sine with an index of 0", static_cast<double>(zero / zero));
}

TEST_CASE("case 49: saturated colours, exact black and white") {
    HardCase c;
    c.doctor();
    // White is where the polynomial is infinite; a large number has a square that is.
    const volatile float x = 1e20f;
    c.naive("error of white by the sigmoid in single precision",
            static_cast<double>(std::abs(1 - (0.5f + x / (2 * std::sqrt(1 + x * x))))));
}

TEST_CASE("case 50: lights with lines") {
    HardCase c;
    c.doctor();
    double worst = 0;
    for (const double centre : {400.5, 546.07, 589.3, 612.999, 700.0}) {
        const double nm[] = {centre - 0.15, centre, centre + 0.15}, v[] = {0, 20, 0};
        const SampledCurve curve = SampledCurve::fromEmissionPoints(nm, v);
        double sum = 0;
        for (int i = 360; i < 830; ++i) sum += 0.5 * (curve.at(static_cast<double>(i)) + curve.at(i + 1.0));
        worst = std::max(worst, std::abs(sum / 3 - 1));
    }
    c.measured("relative error of the power of lines 0.3 nm wide", worst, 1e-3);
    double points = 0;
    for (double nm = 360; nm <= 830; nm += 5) points += 5 * std::max(0.0, 20 * (1 - std::abs(nm - 546.07) / 0.15));
    c.naive("the line at 546.07 nm by its values every 5 nm", std::abs(points / 3 - 1));
}

// Pixels of a dark saturated patch: noise takes a component below 0 every other time.
TEST_CASE("case 51: negative RGB from noise or saturated colours") {
    HardCase c;
    PixelFilm film({0, 0, 64, 64}, {FilterShape::box, 0.5}, 1);
    Random random(51);
    const Xyz dark{1e-4, 0.5e-4, 4e-4};
    for (int i = 0; i < 64 * 64; ++i) {
        const auto noise = [&] { return 6e-4 * (random.uniformDouble() - 0.5); };
        const Xyz sample{dark.x + noise(), dark.y + noise(), dark.z + noise()};
        film.add(i % 64, i / 64, 0, sample, 1);
    }
    const auto image = film.resolve(rgb::rec709.fromXyz(), 1);
    Moments kept, clamped;
    int negative = 0;
    for (const float g : image.g) {
        kept.add(static_cast<double>(g));
        clamped.add(static_cast<double>(std::max(g, 0.f)));
        negative += g < 0;
    }
    CHECK(negative > 500);
    const double exact = toRgb(dark, rgb::rec709).y;
    c.measured("mean of a dark patch against its value, in standard errors",
               std::abs(kept.mean() - exact) / kept.standardError(), 3);
    c.naive("with negative values set to 0", std::abs(clamped.mean() - exact) / kept.standardError());
}
