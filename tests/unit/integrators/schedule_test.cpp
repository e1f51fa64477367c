// Passes, Russian roulette's reference, and the choice of a light.
#include "film/pixel_film.h"
#include "integrators/light_sampler.h"
#include "integrators/pass_schedule.h"
#include "integrators/roulette.h"
#include "support/chi_square.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

PixelFilm filmOf(int width, int height, const std::function<double(int, int)>& luminance) {
    PixelFilm film({0, 0, width, height}, PixelFilter(FilterShape::box, 0.5), 1);
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) film.add(x, y, 0, Xyz{0, 4 * luminance(x, y), 0}, 4);
    return film;
}

class TestLight final : public Light {
  public:
    explicit TestLight(double power, bool infinite = false) : power_(power), infinite_(infinite) {}
    double power() const override { return power_; }
    bool infinite() const override { return infinite_; }
    std::optional<LightSample> sample(const Receiver&, std::uint32_t, Vec2, const Wavelengths&,
                                      float) const noexcept override {
        return std::nullopt;
    }
    Spectrum emitted(const SurfaceHit&, Vec3, const Wavelengths&) const noexcept override { return {}; }
    float pdfSolidAngle(const Receiver&, const SurfaceHit&, float) const noexcept override { return 0; }
    Spectrum escaped(Vec3, const Wavelengths&, float) const noexcept override { return {}; }
    float pdfEscaped(const Receiver&, Vec3, float) const noexcept override { return 0; }

  private:
    double power_;
    bool infinite_;
};

std::vector<std::unique_ptr<const Light>> lightsOf(std::initializer_list<double> powers) {
    std::vector<std::unique_ptr<const Light>> lights;
    for (const double p : powers) lights.push_back(std::make_unique<TestLight>(p, lights.size() == 1));
    return lights;
}

} // namespace

TEST_CASE("passes end at powers of two and at quarters between them, whatever the goal") {
    std::vector<std::uint32_t> ends;
    for (std::uint32_t end = 0; end < 128;) {
        end = passEnd(end);
        ends.push_back(end);
    }
    CHECK(ends == std::vector<std::uint32_t>{2, 4, 8, 16, 20, 24, 28, 32, 40, 48, 56, 64, 80, 96, 112, 128});
    // Up to the last sample that the renderer can count: strictly forwards, by a quarter at most, through every power.
    std::uint64_t first = 16, power = 32;
    while (first < 1u << 31) {
        const std::uint32_t end = passEnd(static_cast<std::uint32_t>(first));
        REQUIRE(end > first);
        CHECK(end - first <= first / 4);
        if (end >= power) {
            CHECK(end == power);
            power *= 2;
        }
        first = end;
    }
}

TEST_CASE("roulette's reference is renewed at powers of two up to 256") {
    std::vector<std::uint32_t> renewed;
    for (std::uint32_t n = 1; n <= 2048; ++n)
        if (renewsRoulette(n)) renewed.push_back(n);
    CHECK(renewed == std::vector<std::uint32_t>{1, 2, 4, 8, 16, 32, 64, 128, 256});
}

TEST_CASE("roulette: survival follows the throughput between the floor and certainty") {
    CHECK(RouletteReference::survival(0.5f, 1) == 0.5f);
    CHECK(RouletteReference::survival(0.5f, 0.5f) == 0.25f);
    CHECK(RouletteReference::survival(3, 1) == 1);
    CHECK(RouletteReference::survival(0, 1) == RouletteReference::kFloor);
    CHECK(RouletteReference::survival(1e-30f, 1e-30f) == RouletteReference::kFloor);
    CHECK(RouletteReference::survival(kInfinity, 1) == 1);
    CHECK(RouletteReference::kFloor == 0.05f);
}

TEST_CASE("roulette: the reference of an even image is the threshold everywhere") {
    RouletteReference reference({0, 0, 9, 7});
    const float before = reference.scale(3, 3);
    CHECK(before == doctest::Approx(1 / RouletteReference::kThreshold));
    reference.update(filmOf(9, 7, [](int, int) { return 0.0; })); // nothing seen yet
    CHECK(reference.scale(3, 3) == before);
    reference.update(filmOf(9, 7, [](int, int) { return 5.0; }));
    for (int y = 0; y < 7; ++y)
        for (int x = 0; x < 9; ++x) CHECK(reference.scale(x, y) == doctest::Approx(1 / RouletteReference::kThreshold));
}

TEST_CASE("roulette: bright pixels need brighter paths, and dark ones count as the median") {
    // A tenth of the image is 100 times as bright as the rest.
    const auto luminance = [](int x, int) { return x < 3 ? 100.0 : 1.0; };
    RouletteReference reference({0, 0, 30, 10});
    reference.update(filmOf(30, 10, luminance));
    const double average = 10.9, t = RouletteReference::kThreshold;
    CHECK(reference.scale(0, 5) == doctest::Approx(average / (t * 100)));
    CHECK(reference.scale(20, 5) == doctest::Approx(average / t));
    CHECK(reference.scale(2, 5) == doctest::Approx(average / (t * (3 * 100 + 2) / 5.0))); // 5 pixels wide
    // Black pixels beside lit ones.
    reference.update(filmOf(30, 10, [](int x, int) { return x < 10 ? 0.0 : 2.0; }));
    CHECK(reference.scale(0, 0) == doctest::Approx(2.0 * 20 / 30 / (t * 2)));
    // Even where more than half is black, survival stays defined.
    reference.update(filmOf(30, 10, [](int x, int) { return x < 25 ? 0.0 : 2.0; }));
    for (int x = 0; x < 30; ++x) CHECK_UNARY(reference.scale(x, 0) > 0 && std::isfinite(reference.scale(x, 0)));
}

TEST_CASE("roulette: a crop is indexed from its own corner") {
    PixelFilm film({100, 50, 110, 60}, PixelFilter(FilterShape::box, 0.5), 1);
    for (int y = 50; y < 60; ++y)
        for (int x = 100; x < 110; ++x) film.add(x, y, 0, Xyz{0, x < 105 ? 1.0 : 3.0, 0}, 1);
    RouletteReference reference(film.bounds());
    reference.update(film);
    CHECK(reference.scale(100, 50) ==
          doctest::Approx(2 / (RouletteReference::kThreshold * 2.2))); // the median, at the edge
    CHECK(reference.scale(109, 59) == doctest::Approx(2 / (RouletteReference::kThreshold * 3)));
}

TEST_CASE("light choice: probabilities sum to one, and are those of the picks") {
    for (const auto& powers :
         {std::initializer_list<double>{1}, {3, 1}, {0, 0, 0}, {1000, 1, 0, 20, 5, 5, 1e-9, 300}}) {
        const auto lights = lightsOf(powers);
        const LightSampler sampler(lights);
        double sum = 0, total = 0;
        for (const double p : powers) total += p;
        for (const auto& light : lights) {
            const double p = sampler.probability(light.get(), 0, Vec3());
            const double n = static_cast<double>(lights.size());
            CHECK(p == doctest::Approx(0.5 / n + 0.5 * (total > 0 ? light->power() / total : 1 / n)));
            CHECK(p > 0); // a light without power by the books may still shine
            sum += p;
        }
        CHECK(sum == doctest::Approx(1).epsilon(1e-6));
        CHECK(sampler.needsChoice() == (lights.size() > 1));
        CHECK(sampler.infinite().size() == (lights.size() > 1 ? 1 : 0));

        constexpr int picks = 200000;
        std::vector<double> observed(lights.size(), 0), expected;
        Random random(7);
        for (int i = 0; i < picks; ++i) {
            const PickedLight picked = sampler.pick(random.uniform(), Vec3());
            CHECK_UNARY(picked.probability == sampler.probability(picked.light, picked.part, Vec3()));
            for (std::size_t k = 0; k < lights.size(); ++k) observed[k] += lights[k].get() == picked.light;
        }
        for (const auto& light : lights)
            expected.push_back(picks * static_cast<double>(sampler.probability(light.get(), 0, Vec3())));
        if (lights.size() > 1) CHECK(chiSquareTest(observed, expected).pValue > 1e-4);
        CHECK(sampler.pick(0, Vec3()).light == lights.front().get());
        CHECK(sampler.pick(kOneMinusEpsilon, Vec3()).light == lights.back().get());
    }
}

TEST_CASE("light choice: lights of other scenes, and no lights at all") {
    const auto lights = lightsOf({1, 2}), others = lightsOf({1});
    CHECK(LightSampler(lights).probability(others.front().get(), 0, Vec3()) == 0);
    CHECK(LightSampler({}).empty());
}

} // namespace abbe::test
