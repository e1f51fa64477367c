// Light over delta interfaces to a point: against closed forms, and derivatives against differences.
#include "caustics/manifold/caster_candidates.h"
#include "caustics/manifold/chain_tracer.h"
#include "caustics/manifold/manifold_sampler.h"
#include "support/manifold_cases.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

constexpr double kWater = 1.33;

// Snell's law and the horizontal way of a ray that leaves a point at height h above water at the angle θ and ends at
// depth z; and its derivative by θ.
struct PoolRay {
    double sine, cosine, cosineBelow, way, derivative;
    PoolRay(double theta, double h, double z) {
        sine = std::sin(theta), cosine = std::cos(theta);
        const double below = sine / kWater;
        cosineBelow = std::sqrt(1 - below * below);
        way = h * sine / cosine + z * below / cosineBelow;
        derivative = h / square(cosine) + z * cosine / kWater / (cosineBelow * square(cosineBelow));
    }
};

// For light of intensity 1 at height h, what arrives at depth z and the horizontal distance x on a surface that faces
// the ray: dΩ over the area across it.
double poolIrradiance(double x, double h, double z) {
    double lower = 0, upper = 0.5 * kPiD;
    for (int i = 0; i < 200; ++i) {
        const double middle = 0.5 * (lower + upper);
        (PoolRay(middle, h, z).way < x ? lower : upper) = middle;
    }
    const PoolRay ray(lower, h, z);
    const double horizontal = x > 0 ? ray.sine / (x * ray.derivative) : 1 / square(h + z / kWater);
    return (1 - dielectricReflectance(ray.cosine, kWater)) * horizontal / ray.cosineBelow;
}

} // namespace

TEST_CASE("signatures are numbered one to one") {
    for (std::size_t i = 0; i < ManifoldKinds::kCount; ++i) {
        const ChainSignature s = ManifoldKinds::ofIndex(i);
        CHECK(ManifoldKinds::indexOf(s) == i);
        ChainSignature again;
        for (int k = 0; k < s.length(); ++k) again.add(s[k]);
        CHECK(again == s);
    }
    CHECK(ManifoldKinds::indexOf(ChainSignature::of("R")) == 0);
    CHECK(ChainSignature::of("TR")[0] == ChainEvent::transmission);
    CHECK(ManifoldKinds::indexOf(ChainSignature::of("TTT")) == 13);
}

TEST_CASE("a light in a plane mirror of glass") {
    const ManifoldCase test(
        "shape quad { size 8 8; transform { rotate y 180 deg; translate 0 0 2 }; material dielectric { ior 1.5 } }\n"
        "light point { position 1 0.5 0; power 12.566 W }\n");
    for (const Vec3 p : {Vec3{0, 0, 0}, Vec3{-0.7f, 0.3f, 1.2f}}) {
        const Vec3d image{1, 0.5, 4}, way = image - Vec3d(p);
        const double cosine = way.z / length(way);
        const double expected = dielectricReflectance(cosine, 1.5) / lengthSquared(way);
        const ManifoldMean m = test.mean(p, "R", 4000);
        CHECK(std::abs(m.value.mean() - expected) < 4 * m.value.standardError());
        CHECK(m.value.standardError() < 0.04 * expected);
        CHECK(length(m.wi - normalize(Vec3(way))) < 1e-6f);
        // There is one solution: all that is random is how often it is counted.
        const double times = m.last / expected;
        CHECK(times > 0.5);
        CHECK(std::abs(times - std::round(times)) < 2e-5 * times);
    }
}

TEST_CASE("a light above water, seen from the ground of a pool") {
    const ManifoldCase test(
        "shape plane { material dielectric { ior 1.33 } }\nlight point { position 0 1.5 0; power 12.566 W }\n");
    for (const float x : {0.f, 0.4f, 2.f, 6.f}) {
        const double expected = poolIrradiance(static_cast<double>(x), 1.5, 1.2);
        const ManifoldMean m = test.mean({x, -1.2f, 0}, "T", 3000);
        CAPTURE(x);
        CHECK(std::abs(m.value.mean() - expected) < 4 * m.value.standardError() + 2e-5 * expected);
        CHECK(m.value.standardError() < 0.1 * expected);
        CHECK(m.wi.y > 0);
    }
}

TEST_CASE("a sun through water: refraction narrows its beam and its disk") {
    for (const char* sun : {"light sun { elevation 40 deg; irradiance 1 W-per-m2; angular-diameter 0 deg }",
                            "light sun { elevation 40 deg; irradiance 1 W-per-m2; angular-diameter 0.53 deg }"}) {
        const ManifoldCase test(std::string("shape plane { material dielectric { ior 1.33 } }\n") + sun);
        const double sine = std::cos(40 * kPiD / 180), cosine = std::sin(40 * kPiD / 180);
        const double below = std::sqrt(1 - square(sine / kWater));
        const double expected = (1 - dielectricReflectance(cosine, kWater)) * cosine / below;
        const ManifoldMean m = test.mean({0.3f, -2, 0.1f}, "T", 20000);
        CAPTURE(sun);
        CHECK(std::abs(m.value.mean() - expected) < 4 * m.value.standardError() + 1e-4 * expected);
        CHECK(m.value.standardError() < 0.04 * expected);
        CHECK(m.wi.y == doctest::Approx(below).epsilon(5e-3));
    }
}

TEST_CASE("a pane that absorbs: the way inside counts, and the light is as far away as it is") {
    const ManifoldCase test(
        "shape box { size 6 6 0.4; center 0 0 1; material dielectric { ior 1.5; absorption 0.8 } }\n"
        "light point { position 0.9 0 2; power 12.566 W }\n");
    // Both faces bend alike; h is the way outside of the glass, z inside, measured across.
    double lower = 0, upper = 0.5 * kPiD;
    for (int i = 0; i < 200; ++i) {
        const double s = std::sin(0.5 * (lower + upper)), t = s / 1.5;
        const double way = 1.6 * s / std::sqrt(1 - s * s) + 0.4 * t / std::sqrt(1 - t * t);
        (way < 0.9 ? lower : upper) = 0.5 * (lower + upper);
    }
    const double sine = std::sin(lower), cosine = std::cos(lower), inside = std::sqrt(1 - square(sine / 1.5));
    const double derivative = 1.6 / square(cosine) + 0.4 * cosine / 1.5 / (inside * square(inside));
    const double expected = square(1 - dielectricReflectance(cosine, 1.5)) * std::exp(-0.8 * 0.4 / inside) * sine /
                            (0.9 * derivative * cosine);
    const ManifoldMean m = test.mean({0, 0, 0}, "TT", 4000);
    CHECK(std::abs(m.value.mean() - expected) < 4 * m.value.standardError() + 2e-5 * expected);
    CHECK(m.value.standardError() < 0.04 * expected);
}

TEST_CASE("the Jacobian of a chain agrees with differences") {
    struct Case {
        const char *shape, *signature;
        Vec3 towards; // where the first direction points to
    };
    const Case cases[] = {
        {"shape sphere { center 0 0 3; radius 1; material dielectric { ior 1.5 } }", "TT", {0.3f, 0.2f, 3}},
        {"shape sphere { center 0 0 3; radius 1; material dielectric { ior 1.5 } }", "R", {0.3f, 0.2f, 2}},
        {"shape sphere { center 0 0 3; radius 1; material dielectric { ior 1.5 } }", "TRT", {0.5f, 0.2f, 3}},
        {"shape sphere { center 0 0 3; radius 1; transform { scale 1 0.7 1.2 }; material dielectric { ior 1.5 } }",
         "TT",
         {0.3f, 0.2f, 3}},
        {"shape torus { major-radius 1; minor-radius 0.4; transform { rotate x 90 deg; translate 0 0 3 }; material "
         "conductor { index metal Au } }",
         "R",
         {0.9f, 0.2f, 3}},
    };
    for (const Case& c : cases) {
        CAPTURE(c.shape);
        CAPTURE(c.signature);
        const ManifoldCase test(std::string(c.shape) + "\nlight point { position 0 9 0; power 1 W }\n");
        REQUIRE(test.scene.report() == "");
        const auto signature = ChainSignature::of(c.signature);
        const ChainStart start = test.start({0, 0, 0});
        LightTarget target;
        target.light = test.scene.scene().lights.at(0).get();
        const Wavelengths lambda = Wavelengths::sample(0.3f);
        ChainTracer tracer(test.scene.scene(), test.sampler->followed(), start, target, lambda);
        SpecularChain chain;
        const Vec3d d = normalize(Vec3d(c.towards));
        const Shape* const shape = test.sampler->plan().casters[0].shape;
        REQUIRE(tracer.trace(d, signature, shape, chain));
        for (const bool distant : {false, true}) {
            CAPTURE(distant);
            target.distant = distant;
            // A target that this very chain leads to.
            target.origin.p = Vec3(chain.last().p + chain.last().out * 2.5);
            target.direction = Vec3(chain.last().out);
            ChainSolver solver(tracer, 0.5);
            const SpecularChain* const solved = solver.solve(d, signature, shape);
            REQUIRE(solved);
            const SpecularChain solution = *solved;
            CHECK(length(solution.direction - d) < 1e-5);
            const auto [x, y] = tangentsOf(solution.direction);
            constexpr double h = 1e-5;
            for (int i = 0; i < 2; ++i) {
                const Vec3d axis = i == 0 ? x : y;
                SpecularChain after, before;
                REQUIRE(tracer.trace(normalize(solution.direction + axis * h), signature, shape, after));
                REQUIRE(tracer.trace(normalize(solution.direction - axis * h), signature, shape, before));
                const Vec2d seen = (after.miss - before.miss) * (0.5 / h);
                const double size = std::sqrt(square(seen.x) + square(seen.y));
                CHECK(std::abs(seen.x - solution.jacobian[0][i]) < 1e-6 * size);
                CHECK(std::abs(seen.y - solution.jacobian[1][i]) < 1e-6 * size);
            }
        }
    }
}

TEST_CASE("fog along the way dims every leg of a chain") {
    const ManifoldCase test("shape sphere { center 0 3 0; radius 1; material dielectric { ior 1.5 } }\n"
                            "light point { position 0.3 9 0; power 12.566 W }\n"
                            "volume atmosphere { extinction 0.2 per-m; albedo 0.5 }\n");
    REQUIRE(test.scene.report() == "");
    const Scene& scene = test.scene.scene();
    const ChainStart start = test.start({0.1f, 0, 0});
    const Wavelengths lambda = Wavelengths::sample(0.3f);
    const auto target = LightTarget::sample(*scene.lights.at(0), 0, 1, {0.5f, 0.5f}, lambda, 0);
    MediumTracker media(scene.openMedia);
    ManifoldCounts counts;
    RandomStream clear(5), foggy(5);
    const ManifoldChoice choice{0, ChainSignature::of("TT"), 1};
    int found = 0;
    for (int i = 0; i < 50; ++i) {
        foggy = clear; // a constant density takes no random numbers
        const auto a = test.sampler->estimate(start, *target, choice, lambda, clear, counts);
        const auto b = test.sampler->estimate(start, *target, choice, lambda, foggy, counts, &media);
        CHECK(a.has_value() == b.has_value());
        if (!a || !b) continue;
        ChainTracer tracer(scene, test.sampler->followed(), start, *target, lambda);
        SpecularChain chain;
        REQUIRE(tracer.trace(Vec3d(a->wi), choice.signature, test.sampler->plan().casters[0].shape, chain));
        const double way = length(chain.vertices[0].p - Vec3d(start.receiver.p)) +
                           length(chain.vertices[1].p - chain.vertices[0].p) +
                           length(Vec3d(target->origin.p) - chain.vertices[1].p);
        CHECK(b->irradiance[0] == doctest::Approx(a->irradiance[0] * std::exp(-0.2 * way)).epsilon(1e-4));
        ++found;
    }
    CHECK(found > 10);
}

TEST_CASE("the same numbers give the same bits") {
    const ManifoldCase test("shape sphere { center 0 3 0; radius 1; material dielectric { ior glass BK7 } }\n"
                            "light sphere { center 0 9 0; radius 0.1; power 100 W }\n");
    ManifoldCounts counts[2];
    std::vector<float> light[2];
    for (int run = 0; run < 2; ++run)
        for (std::uint64_t seed = 0; seed < 2000; ++seed) {
            RandomStream random(seed);
            const auto s =
                test.sampler->sample(test.start({0.3f, 0, 0}), Wavelengths::sample(0.2f), random, counts[run]);
            light[run].push_back(s ? s->irradiance[0] : 0);
        }
    CHECK(light[0] == light[1]);
    CHECK(counts[0].rays == counts[1].rays);
    CHECK(counts[0].found > 40);
}

} // namespace abbe::test
