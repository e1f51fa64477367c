// Paths of light that are sent to what lies badly: finite, and not one watt more or less.
#include "support/emission_cases.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

TestScene scene(const std::string& lights) {
    return TestScene::parse("scene 1\ncamera { from 0 0 9; shutter 1 s }\nshape box { size 3 3 3 }\n" + lights + "\n");
}

const char* const kLights[] = {
    "light point { position 0 0 0; power 10 W }",
    "light spot { position 0 0 0; toward 0 0 1; angle 0.1 deg; power 10 W }",
    "light quad { size 0.5 0.5; power 10 W }",
    "light quad { size 0.5 0.5; two-sided on; power 10 W }",
    "light sphere { radius 0.001; power 10 W }",
    "light sky { radiance 1 }",
    "light sun { toward 0 -1 0 }",
    "light sun { toward 0 -1 0; angular-diameter 0 deg }",
};

} // namespace

TEST_CASE("aimed emission: targets around, at, behind and far from a light, of any size") {
    const Vec3 origin(scene(kLights[0]).scene().origin);
    const std::vector<std::vector<AimTarget>> targets = {
        {{Vec3{0, 0, 0} - origin, 1}},
        {{Vec3{0, 0, 0} - origin, 1e-20f}},
        {{Vec3{0, 0, 1} - origin, 1e-30f}},
        {{Vec3{0, 0, 1} - origin, 1}},
        {{Vec3{0, 0, 1} - origin, 1e-7f}},
        {{Vec3{0, 0, -1} - origin, 0.5f}},
        {{Vec3{0, 0, 1e6f} - origin, 1}},
        {{Vec3{1, 0, 0} - origin, 1e-3f}},
        {{Vec3{0, 0, 1} - origin, 1e20f}},
        {{Vec3{0, 0, 1e15f} - origin, 1e10f}},
        {{Vec3{0, 0, 1} - origin, 0.5f}, {Vec3{0, 0, 1} - origin, 0.5f}},
    };
    std::uint64_t seed = 1;
    for (const char* emitter : kLights) {
        CAPTURE(emitter);
        const TestScene test = scene(emitter);
        const Light& light = *test.scene().lights.at(0);
        for (std::size_t i = 0; i < targets.size(); ++i) {
            CAPTURE(i);
            EmissionPlan plan;
            plan.targets = targets[i];
            const AimedEmission emission(test.scene().lights, test.scene().intersector->bounds(), plan);
            Random random(++seed);
            Moments power;
            int finite = 0;
            constexpr int samples = 20000;
            for (int k = 0; k < samples; ++k) {
                EmissionNumbers u = emissionNumbers(random);
                if (k < 16) { // the corners of all squares
                    u.position = {k & 1 ? kOneMinusEpsilon : 0.f, k & 2 ? kOneMinusEpsilon : 0.f};
                    u.direction = {k & 4 ? kOneMinusEpsilon : 0.f, k & 8 ? kOneMinusEpsilon : 0.f};
                }
                const Wavelengths lambda = Wavelengths::sample(random.uniform());
                const auto ray = emission.sample(u, lambda, 0);
                power.add(ray ? static_cast<double>(mean(ray->beta / lambda.pdf)) : 0);
                finite +=
                    !ray || (isFinite(ray->ray.origin) && isFinite(ray->ray.direction) && isFinite(ray->beta[0]) &&
                             ray->beta[0] >= 0 && std::abs(length(ray->ray.direction) - 1) < 1e-5f);
            }
            CHECK(finite == samples);
            // Far targets from far away widen what is counted as the scene.
            if (light.paths() == LightPaths::distant && length(targets[i][0].centre + origin) > 100) continue;
            CAPTURE(power.mean());
            CAPTURE(power.standardError());
            CHECK(std::abs(power.mean() - light.power()) < 4.5 * power.standardError() + 1e-3 * light.power());
        }
    }
}

TEST_CASE("aimed emission: a beam that is narrower than its target is not spread, a wide one is aimed") {
    for (const double degrees : {0.1, 5.0, 120.0}) {
        CAPTURE(degrees);
        const TestScene test =
            scene("light spot { toward 0.1 0 1; angle " + std::to_string(degrees) + " deg; power 10 W }");
        const Light& light = *test.scene().lights.at(0);
        const EmissionPlan plan{
            .targets = {{Vec3{0, 0, 2} - Vec3(test.scene().origin), 0.5f}}, .usefulness = {}, .aim = {}};
        const AimedEmission emission(test.scene().lights, test.scene().intersector->bounds(), plan);
        Random random(5);
        int aimed = 0, lit = 0;
        constexpr int samples = 1000;
        for (int i = 0; i < samples; ++i) {
            const auto ray = emission.sample(emissionNumbers(random), Wavelengths::single(550), 0);
            if (!ray) continue;
            ++lit;
            aimed += ray->target == 0;
            const LightOrigin origin = light.asPlaced()->originAt(0, {}, {}, 0);
            CHECK(light.asPlaced()->pdfDirection(origin, ray->ray.direction) <= origin.largest);
        }
        CHECK(lit == samples);
        CHECK(aimed > (degrees > 100 ? 0.7 * samples : -1));
        CHECK(aimed <= (degrees > 100 ? 0.8 * samples : 0));
    }
}

// Half of a ball of light looks away from what it is aimed at.
TEST_CASE("aimed emission: no path is aimed at what is behind the surface that it starts from") {
    const TestScene test = scene("light sphere { radius 0.1; power 10 W }");
    EmissionPlan plan;
    plan.targets = {{Vec3{0, 0, 1} - Vec3(test.scene().origin), 0.2f}};
    const AimedEmission emission(test.scene().lights, test.scene().intersector->bounds(), plan);
    Random random(5);
    int aimed = 0, unaimed = 0;
    constexpr int kPaths = 20000;
    for (int i = 0; i < kPaths; ++i) {
        const auto ray = emission.sample(emissionNumbers(random), Wavelengths::single(550), 0);
        if (!ray) continue;
        (ray->target == EmittedRay::kNoTarget ? unaimed : aimed)++;
    }
    CHECK(unaimed < 1.1 * static_cast<double>(plan.uniformShare) * kPaths);
    CHECK(aimed > 0.3 * kPaths);
    CHECK(aimed < 0.6 * kPaths);
}

TEST_CASE("aimed emission: light from far away is not counted before the place where its paths start") {
    const TestScene test = scene("light sun { toward 0 -1 0 }");
    const Light& sun = *test.scene().lights.at(0);
    const Vec3 origin(test.scene().origin);
    const AimedEmission emission(test.scene().lights, test.scene().intersector->bounds(), {});
    const Vec3 down{0, -1, 0};
    CHECK(emission.density(&sun, Vec3{0, 0, 0} - origin, down, 0).total() > 0);
    CHECK(emission.density(&sun, Vec3{0, -1000, 0} - origin, down, 0).total() > 0); // a floor without an end
    CHECK(emission.density(&sun, Vec3{0, 1000, 0} - origin, down, 0).total() == 0); // a roof without one
    CHECK(emission.density(&sun, Vec3{100, 0, 0} - origin, down, 0).total() == 0);  // a floor beside the scene
    Random random(2);
    for (int i = 0; i < 100; ++i) {
        const auto ray = emission.sample(emissionNumbers(random), Wavelengths::single(550), 0);
        REQUIRE(ray);
        const Bounds3 box = test.scene().intersector->bounds();
        CHECK(dot(ray->ray.origin - box.centre(), ray->ray.direction) < -0.999f * box.radius());
        CHECK(emission.density(&sun, ray->ray.origin + ray->ray.direction * 1e-4f, ray->ray.direction, 0).total() > 0);
    }
}

TEST_CASE("aimed emission: a light that is of no use, a row that aims at nothing and a scene without lights") {
    const TestScene test = scene("light point { power 10 W }\nlight point { position 1 0 0; power 1 W }");
    const auto& lights = test.scene().lights;
    const Bounds3 bounds = test.scene().intersector->bounds();
    const AimTarget target{Vec3{0, 1, 0} - Vec3(test.scene().origin), 0.2f};
    const AimedEmission one(lights, bounds, {.targets = {target}, .usefulness = {0, 1}, .aim = {1, 0}});
    CHECK(one.density(lights[0].get(), 0, {}, {}, {0, 0, 1}, 0).pick == 0);
    CHECK(one.density(lights[1].get(), 0, {}, {}, {0, 0, 1}, 0).pick == 1);
    Random random(3);
    for (int i = 0; i < 1000; ++i) {
        const auto ray = one.sample(emissionNumbers(random), Wavelengths::single(550), 0);
        REQUIRE(ray);
        CHECK(ray->light == lights[1].get());
        CHECK(ray->target == EmittedRay::kNoTarget);
        CHECK(ray->density.direction == doctest::Approx(1 / (4 * kPiD)).epsilon(1e-6));
    }
    CHECK(AimedEmission(lights, bounds, {.targets = {}, .usefulness = {0, 0}, .aim = {}}).empty());
    CHECK(AimedEmission({}, bounds, {}).empty());
}

} // namespace abbe::test
