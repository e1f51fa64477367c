// Phase functions: what is sampled is what is evaluated.
#include "media/phase_functions.h"
#include "support/phase_check.h"

namespace abbe::test {

TEST_CASE("Henyey-Greenstein: density 1 over the sphere, mean cosine g, sampled exactly") {
    for (const double g : {-0.999, -0.98, -0.5, -1e-4, 0.0, 1e-4, 2e-3, 0.3, 0.85, 0.98, 0.999}) {
        INFO(g);
        checkPhase(HenyeyGreenstein(g), {std::abs(g) > 0.99 ? 0.002 : 0.05, 2e-3, g});
    }
}

TEST_CASE("Draine: Rayleigh and Henyey-Greenstein as limits, and between") {
    checkPhase(Draine(0, 1), {});
    for (const float c : {-1.f, -0.3f, 0.f, 0.7f, 1.f}) {
        CHECK(Draine(0, 1).value(c) == doctest::Approx(3 / (16 * kPiD) * (1 + c * c)).epsilon(1e-5));
        CHECK(Draine(0.6, 0).value(c) == doctest::Approx(HenyeyGreenstein(0.6).value(c)).epsilon(1e-4));
    }
    // The mean of Draine's own paper: g (1 + α (3 + 2 g²) / 5) / (1 + α (1 + 2 g²) / 3).
    for (const double g : {-0.7, 0.02, 0.4, 0.9})
        for (const double alpha : {0.0, 0.5, 1.0, 20.0}) {
            INFO(g);
            INFO(alpha);
            checkPhase(Draine(g, alpha),
                       {0.05, 1e-3, g * (1 + alpha * (3 + 2 * g * g) / 5) / (1 + alpha * (1 + 2 * g * g) / 3)});
        }
}

namespace {

std::vector<double> radians(std::vector<double> degrees) {
    for (double& d : degrees) d *= kPiD / 180;
    return degrees;
}

} // namespace

TEST_CASE("a table: normalised, linear in the cosine, sampled exactly") {
    // 1 + cos²: a table of Rayleigh's function.
    std::vector<double> angles, values;
    for (int i = 0; i <= 360; ++i) {
        angles.push_back(i * kPiD / 360);
        values.push_back(17 * (1 + square(std::cos(angles.back()))));
    }
    const TabulatedPhase rayleigh(angles, values);
    checkPhase(rayleigh, {});
    for (const float c : {-1.f, -0.3f, 0.f, 0.7f, 1.f})
        CHECK(rayleigh.value(c) / Draine(0, 1).value(c) == doctest::Approx(1).epsilon(1e-4));
    // Halfway between the cosines of two angles: the mean of their values.
    const TabulatedPhase two(radians({0, 180}), std::vector<double>{3, 1});
    CHECK(4 * kPiD * two.value(0) == doctest::Approx(1));
    CHECK(4 * kPiD * two.value(1) == doctest::Approx(1.5));
    checkPhase(two, {0.05, 1e-3, 1.0 / 6});
}

TEST_CASE("a table with a narrow peak, one with nothing but a ring, and one with steps") {
    // Mean cosines by hand: ∫ c p dc of the triangles.
    checkPhase(TabulatedPhase(radians({0, 0.5, 3, 180}), std::vector<double>{1e5, 2e3, 1, 1}), [] {
        const auto t = [](double degrees) { return 1 - std::cos(degrees * kPiD / 180); };
        const double nodes[] = {0, t(0.5), t(3), 2}, values[] = {1e5, 2e3, 1, 1};
        double mass = 0, moment = 0;
        for (int i = 0; i < 3; ++i) {
            const double w = nodes[i + 1] - nodes[i], a = values[i], b = values[i + 1];
            mass += w * (a + b) / 2;
            moment += w * ((1 - nodes[i]) * (a + b) / 2 - w * (a + 2 * b) / 6);
        }
        return PhaseClaims{0.004, 2e-3, moment / mass};
    }());
    checkPhase(TabulatedPhase(radians({0, 60, 90, 120, 180}), std::vector<double>{0, 0, 1, 0, 0}), {});
    checkPhase(TabulatedPhase(radians({0, 89.9, 90.1, 180}), std::vector<double>{0, 0, 1, 1}), {0.05, 2e-3, -0.5});
}

TEST_CASE("a table finer than cosines in single precision keeps its integral") {
    std::vector<double> angles, values;
    for (int i = 0; i < 40; ++i) {
        angles.push_back(i * 1e-4);
        values.push_back(1e9 * std::exp(-i));
    }
    angles.insert(angles.end(), {1, kPiD - 1e-5, kPiD});
    values.insert(values.end(), {1, 1, 50});
    const AngularGrid grid(angles);
    double area = 0;
    for (std::size_t i = 0; i + 1 < angles.size(); ++i)
        area += kPiD * (values[i] + values[i + 1]) * (std::cos(angles[i]) - std::cos(angles[i + 1]));
    CHECK(grid.integral(grid.atNodes(values)) == doctest::Approx(area).epsilon(1e-6));
    CHECK(grid.nodes().size() < angles.size());
    // One wide cell with a spike that no cosine can tell.
    const AngularGrid spike(radians({0, 1e-3, 180}));
    CHECK(spike.nodes().size() == 2);
    const std::vector<double> spikeValues{1e6, 1, 1};
    CHECK(spike.integral(spike.atNodes(spikeValues)) == doctest::Approx(4 * kPiD).epsilon(1e-3));
}

TEST_CASE("a mix: the weighted mean, sampled exactly by one number") {
    const auto forward = std::make_shared<HenyeyGreenstein>(0.9), backward = std::make_shared<HenyeyGreenstein>(-0.5);
    const auto rayleigh = std::make_shared<Draine>(0, 1);
    const MixedPhase mix({{forward, 7}, {rayleigh, 0}, {backward, 2}, {rayleigh, 1}});
    checkPhase(mix, {0.05, 1e-3, 0.7 * 0.9 - 0.2 * 0.5});
    CHECK(!mix.spectral());
    for (const float c : {-1.f, 0.2f, 1.f})
        CHECK(mix.value(c) ==
              doctest::Approx(0.7 * forward->value(c) + 0.2 * backward->value(c) + 0.1 * rayleigh->value(c)));
    const MixedPhase nested({{std::make_shared<MixedPhase>(mix), 1}, {forward, 3}});
    checkPhase(nested, {0.05, 1e-3, 0.25 * (0.7 * 0.9 - 0.2 * 0.5) + 0.75 * 0.9});
    checkPhase(MixedPhase({{forward, 1e-3}, {backward, 1}}), {0.05, 1e-3, (0.9e-3 - 0.5) / 1.001});
}

} // namespace abbe::test
