// Newton's method over polished interfaces, where it is worst: caustics themselves, grazing light, rings.
#include "caustics/manifold/chain_tracer.h"
#include "hard_cases/hard_case.h"
#include "support/manifold_cases.h"

namespace abbe::test {
namespace {

// Energy of estimates over a floor, and what of it came from those whose trials were capped.
struct FloorLight {
    double energy = 0, capped = 0;
    std::uint64_t notFinite = 0, found = 0;
};

FloorLight overFloor(const ManifoldCase& test, int estimates) {
    FloorLight result;
    ManifoldCounts counts;
    RandomStream random(4);
    const Wavelengths lambda = Wavelengths::sample(0.3f);
    for (int i = 0; i < estimates; ++i) {
        const Vec3 p{3 * random.uniform() - 1.5f, 0, 3 * random.uniform() - 1.5f};
        const auto s = test.sampler->sample(test.start(p), lambda, random, counts);
        if (!s) continue;
        const auto value = static_cast<double>(mean(s->irradiance));
        result.notFinite += !(value >= 0 && std::isfinite(value)) || !(lengthSquared(s->wi) < 1.001f);
        result.energy += value;
        if (s->capped) result.capped += value;
    }
    result.found = counts.found;
    return result;
}

const char* const kBallAndRing = "shape sphere { center 0 2 0; radius 0.5; material dielectric { ior 1.5 } }\n"
                                 "shape torus { major-radius 1; minor-radius 0.3; transform { translate 0 0.6 0 }; "
                                 "material dielectric { ior 1.5 } }\n"
                                 "light sphere { center 1 6 0; radius 0.02; radiance 1 }\n";

} // namespace

TEST_CASE("case 72: specular manifolds: a determinant of 0, total reflection, endless trials") {
    HardCase result;
    constexpr int estimates = 80'000;
    const FloorLight light = overFloor(ManifoldCase(kBallAndRing, 0.2f), estimates);
    CHECK(light.found > 1000);
    result.measured("under a ball and a ring of glass, share of the light whose trials were capped",
                    light.capped / light.energy, 1e-3);
    const FloorLight few = overFloor(ManifoldCase(kBallAndRing, 0.2f, 16), estimates);
    result.naive("a cap of 16 trials", few.capped / few.energy);
    result.measured("estimates that are not finite or negative", static_cast<double>(light.notFinite), 0);

    // On the axis of a ball whose light is parallel there is a circle of solutions: the determinant is 0 on it.
    const ManifoldCase axis("shape sphere { center 0 2 0; radius 1; material dielectric { ior 1.5 } }\n"
                            "light sun { toward 0 -1 0; angular-diameter 0 deg }\n");
    const ChainStart start = axis.start({0, 0.75f, 0});
    const Wavelengths lambda = Wavelengths::sample(0.3f);
    const auto target = LightTarget::sample(*axis.scene.scene().lights.at(0), 0, 1, {0.5f, 0.5f}, lambda, 0);
    REQUIRE(target);
    ChainTracer tracer(axis.scene.scene(), axis.sampler->followed(), start, *target, lambda);
    ChainSolver solver(tracer, 1);
    const SpecularCaster& ball = axis.sampler->plan().casters[0];
    RandomStream random(9);
    double steepest = 0;
    int solved = 0, notFinite = 0;
    for (int i = 0; i < 4000; ++i) {
        const float sine = 0.6f * random.uniform(), phi = 2 * kPi * random.uniform();
        const Vec3d d =
            normalize(Vec3d(static_cast<double>(sine * std::cos(phi)), 1, static_cast<double>(sine * std::sin(phi))));
        for (const char* events : {"TT", "TRT", "TRR", "RTT", "RR"}) { // the last two start as no ray can go on
            const SpecularChain* const chain = solver.solve(d, ChainSignature::of(events), ball.shape);
            if (!chain) continue;
            ++solved;
            const double geometry = 1 / std::abs(chain->determinant());
            notFinite += !std::isfinite(geometry) || !std::isfinite(static_cast<float>(geometry));
            steepest = std::max(steepest, geometry);
        }
    }
    CHECK(solved > 100);
    CHECK(steepest > 1e6); // they do lie there
    result.measured("solutions next to a determinant of 0 whose density is not finite", notFinite, 0);
}

} // namespace abbe::test
