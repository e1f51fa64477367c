// Weights between two ways to find light, at densities of any size; wavelengths that repeat in the lanes; words.
#include "rendering/render_params.h"
#include "transport/loop_technique.h"
#include "transport/sampler.h"

#include <doctest/doctest.h>
#include <limits>
#include <set>

namespace abbe::test {

TEST_CASE("technique: weights from either side sum to 1, however extreme the densities") {
    constexpr float kLargest = std::numeric_limits<float>::max(), kLeast = std::numeric_limits<float>::denorm_min();
    const float densities[] = {kLeast, 1e-38f, 1e-20f, 0.3f, 1, 7, 1e20f, kLargest};
    using W = Technique::Weights;
    for (const auto weights : {W::balance, W::power, W::equal, W::lights, W::scattering}) {
        const LoopTechnique how(Technique{.weights = weights});
        for (const float a : densities)
            for (const float b : densities) {
                // Whether the other can find it at all is lost where the ratio is too small for a number.
                if (weights == Technique::Weights::equal && !(a / b > 0 && b / a > 0)) continue;
                const float one = 1 / (1 + how.odds(b / a, true)), other = 1 / (1 + how.odds(a / b, false));
                INFO("densities " << a << " and " << b);
                CHECK(one + other == doctest::Approx(1).epsilon(1e-6));
                if (weights == Technique::Weights::power && a > 1e3f * b) CHECK(one > 0.999f);
                // Favour moves weights by up to a factor, never to 0: tails stay those of the balance heuristic.
                if (weights == W::lights && a / b > 1e-3f && b / a > 1e-3f) CHECK(one > 1 / (1 + b / a));
                if (weights == W::scattering && a / b > 1e-3f && b / a > 1e-3f)
                    CHECK(one * LoopTechnique::kFavour > 1 / (1 + b / a));
                if (weights == W::scattering && b / a > 1e-3f && a / b > 1e-3f) CHECK(one < 1 / (1 + b / a));
            }
        CHECK(how.odds(0, true) == 0); // found in one way only: all of it counts
        CHECK(how.odds(0, false) == 0);
    }
    const LoopTechnique lights(Technique{.strategy = Technique::Strategy::lightsOnly});
    CHECK(1 / (1 + lights.odds(0.1f, false)) == 0);
    CHECK(1 / (1 + lights.odds(0.1f, true)) == 1);
    CHECK(1 / (1 + lights.odds(0, false)) == 1);
}

TEST_CASE("technique: fewer wavelengths are even rotations of the hero") {
    const Wavelengths eight = Wavelengths::sample(0.37f);
    for (const int n : {1, 2, 4, 8}) {
        const Wavelengths w = LoopTechnique::repeated(eight, n);
        std::set<float> different;
        for (int i = 0; i < kLanes; ++i) {
            different.insert(w.nm[i]);
            const Wavelengths one = Wavelengths::sample(0.37f + static_cast<float>(i % n) / static_cast<float>(n));
            CHECK(w.nm[i] == doctest::Approx(eight.nm[i % n * (kLanes / n)]));
            CHECK(w.pdf[i] == doctest::Approx(eight.pdf[i % n * (kLanes / n)]));
            if (0.37 + static_cast<double>(i % n) / n < 1) CHECK(w.nm[i] == doctest::Approx(one.nm[0]).epsilon(1e-5));
        }
        CHECK(different.size() == static_cast<std::size_t>(n));
        CHECK(w.nm[0] == eight.nm[0]);
    }
}

TEST_CASE("technique: strata of a whole replicate in places, directions and choices; the next samples begin anew") {
    for (const std::uint32_t n : {4u, 16u, 25u}) {
        Sampler s;
        s.startPixel(99, Technique::Numbers::stratified, true, n);
        for (const std::uint32_t block : {0u, 3u}) {
            std::set<std::uint32_t> film, bsdf, wavelength, lobe, late;
            const auto columns = static_cast<std::uint32_t>(std::sqrt(static_cast<double>(n)));
            const auto cell = [&](Vec2 u) {
                const auto side = static_cast<float>(columns);
                return static_cast<std::uint32_t>(u.x * side) * 100 + static_cast<std::uint32_t>(u.y * side);
            };
            for (std::uint32_t i = block * n; i < (block + 1) * n; ++i) {
                s.start(i);
                film.insert(cell(s.film()));
                bsdf.insert(cell(s.vertex(1).bsdf));
                wavelength.insert(static_cast<std::uint32_t>(s.wavelength() * n));
                lobe.insert(static_cast<std::uint32_t>(s.vertex(2).lobe * static_cast<float>(n)));
                late.insert(cell(s.vertex(7).light));
            }
            INFO("strata " << n << ", block " << block);
            CHECK(film.size() == n);
            CHECK(bsdf.size() == n);
            CHECK(wavelength.size() == n);
            CHECK(lobe.size() == n);
            CHECK(late.size() == n);
        }
    }
}

TEST_CASE("technique: every word says what it says") {
    for (const auto& [name, value] : properties({})) CHECK_FALSE(value.empty());
    CHECK(properties({}).size() == 11);
    CHECK(word(Technique::Numbers::random) == "random");
    CHECK(word(Technique::Strategy::lightsOnly) == "lights");
    CHECK(word(Technique::Strategy::bsdfOnly) == "bsdf");
    CHECK(word(Technique::Weights::scattering) == "scattering");
    CHECK(word(Technique::Directions::mixed) == "mixed");
    CHECK(word(Technique::LightChoice::uniform) == "uniform");
    CHECK(word(Technique::Roulette::off) == "off");
    CHECK(word(Technique::LightPaths::alone) == "alone");
    CHECK(word(Technique::Merging::always) == "always");
}

} // namespace abbe::test
