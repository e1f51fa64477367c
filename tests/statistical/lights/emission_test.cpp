// Paths that start at lights carry all of their power, and bring to a surface what sampling the light from there
// brings.
#include "math/warp.h"
#include "support/emission_cases.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

// A small disk that light falls on.
struct Patch {
    Vec3 centre, n;
    float radius;
    double area() const { return kPiD * square(static_cast<double>(radius)); }
    Vec3 point(Vec2 u) const {
        const Vec2 q = squareToDisk(u) * radius;
        const Frame frame = Frame::fromNormal(n);
        return centre + frame.x * q.x + frame.y * q.y;
    }
    // Whether the ray arrives on its front.
    bool struckBy(const Ray& ray) const {
        const float slope = dot(ray.direction, n), t = dot(centre - ray.origin, n) / slope;
        return slope < 0 && t > 0 && lengthSquared(ray.origin + ray.direction * t - centre) < square(radius);
    }
};

Patch patchFor(const EmissionCase& emitter, Vec3 origin) {
    if (emitter.distant) return {Vec3{0.3f, -0.2f, 0.4f} - origin, normalize(Vec3{0.3f, 1, 0.2f}), 0.4f};
    return {kAhead * 1.3f - origin, normalize(Vec3{0.1f, -0.3f, 0} - kAhead), 0.4f};
}

// W/m² on the patch, by next-event estimation from its points.
Moments asked(const Light& light, const Patch& patch, int samples, std::uint64_t seed) {
    Moments result;
    Random random(seed);
    for (int i = 0; i < samples; ++i) {
        const Vec3 from = patch.point({random.uniform(), random.uniform()});
        const Wavelengths lambda = Wavelengths::sample(random.uniform());
        const float time = random.uniform();
        double sum = 0;
        for (std::uint32_t part = 0; part < light.parts(); ++part) {
            const auto s = light.sample(Receiver(from), part, {random.uniform(), random.uniform()}, lambda, time);
            if (s) sum += watts(s->radiance * (std::max(0.f, dot(patch.n, s->wi)) / s->pdfSolidAngle), lambda);
        }
        result.add(sum);
    }
    return result;
}

// The same from directions that are drawn evenly, for lights far away that are not sampled as a whole.
Moments looked(const Light& light, const Patch& patch, int samples, std::uint64_t seed) {
    Moments result;
    Random random(seed);
    for (int i = 0; i < samples; ++i) {
        const Wavelengths lambda = Wavelengths::sample(random.uniform());
        const Vec3 w = squareToSphere({random.uniform(), random.uniform()});
        const Spectrum arriving = light.asDistant()->escaped(w, lambda, random.uniform());
        result.add(watts(arriving * (std::max(0.f, dot(patch.n, w)) / kSpherePdf), lambda));
    }
    return result;
}

// The same by counting what strikes it.
Moments struck(const AimedEmission& emission, const Patch& patch, int samples, std::uint64_t seed) {
    Moments result;
    Random random(seed);
    for (int i = 0; i < samples; ++i) {
        const Wavelengths lambda = Wavelengths::sample(random.uniform());
        const auto ray = emission.sample(emissionNumbers(random), lambda, random.uniform());
        result.add(ray && patch.struckBy(ray->ray) ? watts(ray->beta, lambda) / patch.area() : 0);
    }
    return result;
}

struct Aim {
    std::string name;
    EmissionPlan plan;
    double error; // that is small enough to tell: relative, of the mean
};

// At the patch, beside it, and at everything that must not matter: balls that overlap, hold the light, lie behind it or
// are hardly there.
std::vector<Aim> aimsAt(const Patch& patch) {
    const AimTarget at{patch.centre, 1.1f * patch.radius};
    const Vec3 side = Frame::fromNormal(patch.n).x;
    const AimTarget beside{patch.centre + side * 1.2f, 0.5f};
    EmissionPlan mixed;
    mixed.targets = {at,
                     {patch.centre + side * 0.3f, 0.4f},
                     {patch.centre - kAhead * 1.3f, 0.9f},
                     {patch.centre - kAhead * 3, 0.2f},
                     {patch.centre + kAhead * 100, 1e-5f}};
    mixed.aim = {2, 1, 1, 0.5, 0.2};
    mixed.uniformShare = 0.1f;
    return {{"nothing", {}, 0.04},
            {"the patch", {.targets = {at}, .usefulness = {}, .aim = {}}, 0.012},
            {"beside it", {.targets = {beside}, .usefulness = {}, .aim = {}}, 0.08},
            {"many", mixed, 0.025}};
}

} // namespace

TEST_CASE("emission: paths of light carry the power of their light") {
    std::uint64_t seed = 100;
    for (const EmissionCase& emitter : emissionCases()) {
        CAPTURE(emitter.text);
        const TestScene test = emissionScene(emitter);
        const Light& light = *test.scene().lights.at(0);
        REQUIRE(light.paths() == (emitter.distant ? LightPaths::distant : LightPaths::placed));
        if (!emitter.keepsPower) continue;
        const AimedEmission emission(test.scene().lights, test.scene().intersector->bounds(), {});
        Moments power;
        Random random(++seed);
        const int samples = nightly() ? 2000000 : 200000;
        for (int i = 0; i < samples; ++i) {
            const Wavelengths lambda = Wavelengths::sample(random.uniform());
            const auto ray = emission.sample(emissionNumbers(random), lambda, random.uniform());
            power.add(ray ? watts(ray->beta, lambda) : 0);
        }
        const double expected = light.power() * emitter.powerFactor;
        CAPTURE(power.mean());
        CAPTURE(expected);
        CAPTURE(power.standardError());
        CHECK(std::abs(power.mean() - expected) < 3.5 * power.standardError() + emitter.powerError * expected);
        CHECK(power.standardError() < 0.01 * expected);
    }
}

TEST_CASE("emission: what strikes a surface is what next-event estimation finds, aimed or not") {
    std::uint64_t seed = 500;
    const int samples = nightly() ? 1000000 : 150000;
    for (const EmissionCase& emitter : emissionCases()) {
        CAPTURE(emitter.text);
        const TestScene test = emissionScene(emitter);
        const Scene& scene = test.scene();
        const Patch patch = patchFor(emitter, Vec3(scene.origin));
        const Light& light = *scene.lights.at(0);
        const Moments expected =
            emitter.sampledWhole ? asked(light, patch, samples, ++seed) : looked(light, patch, 4 * samples, ++seed);
        CAPTURE(expected.mean());
        CAPTURE(expected.standardError());
        REQUIRE(expected.mean() > 0);
        for (const Aim& aim : aimsAt(patch)) {
            CAPTURE(aim.name);
            const AimedEmission emission(scene.lights, scene.intersector->bounds(), aim.plan);
            const Moments got = struck(emission, patch, samples, ++seed);
            CAPTURE(got.mean());
            CAPTURE(got.standardError());
            CHECK(sameMeanTest(got, expected) > 1e-5); // of some 140
            CHECK(got.standardError() < aim.error * expected.mean());
        }
    }
}

TEST_CASE("emission: a collimated beam strikes what it is asked to light, and no more") {
    const EmissionCase emitter{"light beam { toward 0.2 0.1 1; radius 0.9; color blackbody 2700 K; power 10 W }"};
    const TestScene test = emissionScene(emitter);
    const Scene& scene = test.scene();
    const Light& light = *scene.lights.at(0);
    const Patch patch = patchFor(emitter, Vec3(scene.origin));
    constexpr int samples = 100000;
    const Moments expected = asked(light, patch, samples, 700);
    const double across = std::abs(static_cast<double>(dot(patch.n, kAhead)));
    CAPTURE(expected.mean());
    CAPTURE(expected.standardError());
    CHECK(expected.standardError() < 2e-3 * expected.mean());
    const double even = 10 / (kPiD * 0.81) * across; // the patch lies within
    CHECK(std::abs(expected.mean() - even) < 3.5 * expected.standardError());
    std::uint64_t seed = 700;
    for (const Aim& aim : aimsAt(patch)) {
        CAPTURE(aim.name);
        const AimedEmission emission(scene.lights, scene.intersector->bounds(), aim.plan);
        CHECK(sameMeanTest(struck(emission, patch, samples, ++seed), expected) > 1e-4);
    }
}

TEST_CASE("emission: lights are drawn by power and usefulness, and none is lost") {
    const TestScene test =
        TestScene::parse("scene 1\ncamera { from 0 0 9; shutter 1 s }\nshape box { size 3 3 3 }\n"
                         "light point { position 0.5 0 0; power 10 W }\nlight quad { size 0.2 0.2; power 3 W }\n"
                         "light sphere { radius 0.1; power 1 W }\nlight sun { toward 0 -1 0; irradiance 1 lx }\n");
    const Scene& scene = test.scene();
    double all = 0;
    for (const auto& light : scene.lights) all += light->power();
    EmissionPlan plan{
        .targets = {{Vec3{0, 0, 1} - Vec3(scene.origin), 0.3f}, {Vec3{0, 1, 0} - Vec3(scene.origin), 0.2f}},
        .usefulness = {1, 0.1, 5, 2},
        .aim = {1, 1, 0, 0, 3, 1, 0, 1}};
    const AimedEmission emission(scene.lights, scene.intersector->bounds(), plan);
    Moments power;
    Random random(9);
    for (int i = 0; i < 300000; ++i) {
        const Wavelengths lambda = Wavelengths::sample(random.uniform());
        const auto ray = emission.sample(emissionNumbers(random), lambda, 0);
        power.add(ray ? watts(ray->beta, lambda) : 0);
    }
    CAPTURE(power.mean());
    CAPTURE(power.standardError());
    CHECK(std::abs(power.mean() - all) < 4 * power.standardError());
    const auto pick = [&](std::size_t i) {
        const Light* light = scene.lights[i].get();
        return i < 3 ? emission.density(light, 0, {}, {0, 0, 1}, {0, 0, 1}, 0).pick
                     : emission.density(light, {}, {0, 0, 1}, 0).pick;
    };
    const auto useful = [&](std::size_t i) { return scene.lights[i]->visiblePower() * plan.usefulness[i]; };
    double sum = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        sum += pick(i);
        CHECK(pick(i) / pick(0) == doctest::Approx(useful(i) / useful(0)).epsilon(1e-9));
    }
    CHECK(sum == doctest::Approx(1).epsilon(1e-12));
}

TEST_CASE("emission: what shines in a volume starts no path") {
    struct Dark final : Light {
        LightOutput output() const override { return {.power = 1, .visiblePower = 1}; }
        std::optional<LightSample> sample(const Receiver&, std::uint32_t, Vec2, const Wavelengths&,
                                          float) const noexcept override {
            return std::nullopt;
        }
    };
    std::vector<std::unique_ptr<const Light>> lights;
    lights.push_back(std::make_unique<Dark>());
    const AimedEmission emission(lights, Bounds3{}, {});
    CHECK(emission.empty());
    CHECK(emission.density(lights[0].get(), 0, {}, {0, 0, 1}, {0, 0, 1}, 0).total() == 0);
    CHECK(emission.density(lights[0].get(), {}, {0, 0, 1}, 0).total() == 0);
}

} // namespace abbe::test
