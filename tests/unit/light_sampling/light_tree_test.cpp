// The light tree: its probabilities, and that nothing which may give light is left out.
#include "light_sampling/light_tree.h"
#include "light_sampling/light_tree_builder.h"
#include "support/chi_square.h"
#include "support/cpu_time.h"
#include "support/scene_test.h"
#include "support/statistics.h"

#include <doctest/doctest.h>
#include <optional>

namespace abbe::test {
namespace {

Vec3 randomDirection(Random& random) {
    const float z = 2 * random.uniform() - 1, phi = 2 * kPi * random.uniform(), r = std::sqrt(1 - z * z);
    return {r * std::cos(phi), r * std::sin(phi), z};
}

Vec3 randomPoint(Random& random, float size) {
    return {size * (random.uniform() - 0.5f), size * (random.uniform() - 0.5f), size * (random.uniform() - 0.5f)};
}

// Points, spots, flat and curved emitters, in a room of `size` metres.
std::vector<LightBounds> randomLights(std::size_t count, float size, std::uint64_t seed) {
    Random random(seed);
    std::vector<LightBounds> lights(count);
    for (LightBounds& b : lights) {
        const Vec3 p = randomPoint(random, size);
        const float extent = size * 0.02f * random.uniform();
        b.box.add(p);
        b.power = std::pow(10.f, 3 * random.uniform() - 2) * size * size;
        b.axis = randomDirection(random);
        switch (random.bits() % 4) {
        case 0:
            break; // a point
        case 1:    // a spot
            b.cosNormals = 1;
            b.cosEmission = random.uniform();
            break;
        case 2: // a flat one
            b.cosNormals = 1;
            b.twoSided = random.bits() % 2;
            b.box.add(p + cross(b.axis, randomDirection(random)) * extent);
            break;
        default: // a sphere
            b.box.add(p + Vec3{extent, extent, extent});
        }
    }
    return lights;
}

Receiver randomReceiver(Random& random, float size, int kind) {
    const Vec3 p = randomPoint(random, 1.5f * size);
    if (kind == 0) return {p};
    return {p, randomDirection(random), kind == 2};
}

// Of any glossiness for one receiver of three, sharp enough to leave next to nothing elsewhere; none otherwise.
ScatterView randomView(Random& random, const Receiver& at, int kind) {
    ScatterView view;
    if (!at.surface || kind == 0) return view;
    view.wo = randomDirection(random);
    if (dot(view.wo, at.n) < 0) view.wo = -view.wo;
    view.outline.diffuse = 0;
    view.outline.add({.share = random.uniform(), .alpha2 = std::pow(10.f, -7 * random.uniform())});
    if (kind == 1) return view;
    const float eta = at.twoSided ? 0.6f + random.uniform() : 1;
    view.outline.add({.share = random.uniform(), .alpha2 = std::pow(10.f, -7 * random.uniform()), .eta = eta});
    return view;
}

// Whether light that leaves a point of the bounds along a normal they allow can reach the receiver, in double, for
// corners and the centre of the box and the axis only: a necessary part of what may give light.
bool mayLight(const LightBounds& b, const Receiver& at) {
    for (int i = 0; i < 9; ++i) {
        Vec3 p = b.box.centre();
        if (i < 8)
            p = {i & 1 ? b.box.upper.x : b.box.lower.x, i & 2 ? b.box.upper.y : b.box.lower.y,
                 i & 4 ? b.box.upper.z : b.box.lower.z};
        const Vec3d way = Vec3d(p) - Vec3d(at.p);
        const double d = length(way);
        if (!(d > 0)) return true;
        if (at.oneSided() && !(dot(way, Vec3d(at.n)) > 0)) continue;
        double cosine = -dot(way, Vec3d(b.axis)) / d;
        if (b.twoSided) cosine = std::abs(cosine);
        const double angle = std::acos(std::clamp(cosine, -1.0, 1.0));
        const double reach =
            std::acos(static_cast<double>(b.cosNormals)) + std::acos(static_cast<double>(b.cosEmission));
        if (angle < reach) return true;
    }
    return false;
}

} // namespace

TEST_CASE("light tree: probabilities sum to one, inside nodes and outside, and no light is left out (T3.2)") {
    for (const std::size_t count : {1, 2, 3, 17, 1000}) {
        const auto lights = randomLights(count, 10, count);
        const LightTree tree(lights);
        Random random(2);
        int lit = 0;
        for (int i = 0; i < 100; ++i) {
            const Receiver at = i % 10 == 9 ? Receiver(lights[random.bits() % count].box.lower) // on a light
                                            : randomReceiver(random, 10, i % 3);
            const ScatterView view = randomView(random, at, i / 3 % 3);
            double sum = 0;
            for (std::uint32_t k = 0; k < count; ++k) {
                const float p = tree.probability(k, at, view);
                sum += static_cast<double>(p);
                CHECK_UNARY(p >= 0 && p <= 1);
                if (!mayLight(lights[k], at)) continue;
                ++lit;
                CHECK_UNARY(p > 0);
            }
            CHECK(sum == doctest::Approx(1).epsilon(1e-5));
        }
        CHECK(lit > 20);
    }
}

TEST_CASE("light tree: picks have the probabilities that are stated") {
    const auto lights = randomLights(200, 4, 5);
    const LightTree tree(lights);
    Random random(3);
    for (int kind = 0; kind < 6; ++kind) {
        // 0 to 2: points and surfaces; 3: along a ray; 4 and 5: surfaces with lobes.
        const Receiver at = randomReceiver(random, 4, kind % 3);
        const ScatterView view = randomView(random, at, kind < 4 ? 0 : kind - 3);
        const Ray ray{at.p, randomDirection(random)};
        const RayExtent extent{0.5f, 3};
        const auto probability = [&](std::uint32_t k) {
            return kind == 3 ? tree.probability(k, ray, extent) : tree.probability(k, at, view);
        };
        constexpr int picks = 200000;
        std::vector<double> observed(lights.size(), 0), expected;
        int different = 0;
        for (int i = 0; i < picks; ++i) {
            const auto u = static_cast<double>(random.uniform());
            const auto p = kind == 3 ? tree.pick(u, ray, extent) : tree.pick(u, at, view);
            ++observed[p.light];
            different += p.probability != probability(p.light);
        }
        CHECK(different == 0);
        double sum = 0;
        for (std::uint32_t k = 0; k < lights.size(); ++k) {
            const auto p = static_cast<double>(probability(k));
            expected.push_back(picks * p);
            sum += p;
            if (p == 0) CHECK(observed[k] == 0);
        }
        CHECK(sum == doctest::Approx(1).epsilon(1e-5));
        CHECK(chiSquareTest(observed, expected).pValue > 1e-4);
    }
}

// docs/hard_cases.md, case 36.
TEST_CASE("light tree: no random number leads to a light of probability 0") {
    const auto lights = randomLights(300, 4, 6);
    const LightTree tree(lights);
    Random random(4);
    for (int i = 0; i < 3000; ++i) {
        const Receiver at = randomReceiver(random, 4, 1);
        const ScatterView view = randomView(random, at, i % 3);
        for (const double u : {0.0, 0x1p-53, 0.5, static_cast<double>(kOneMinusEpsilon), 1 - 0x1p-53})
            CHECK_UNARY(tree.pick(u, at, view).probability > 0);
    }
}

// docs/hard_cases.md, case 8.
TEST_CASE("light tree: the scale of the scene does not matter (T3.3)") {
    const auto lights = randomLights(500, 10, 7);
    const LightTree tree(lights);
    for (const float scale : {1e-4f, 0.3f, 1e4f}) {
        auto scaled = lights;
        for (LightBounds& b : scaled) b.box = {b.box.lower * scale, b.box.upper * scale};
        const LightTree other(scaled);
        Random random(5);
        double worst = 0, worstRelative = 0;
        for (int i = 0; i < 60; ++i) {
            Receiver at = randomReceiver(random, 10, i % 3), there = at;
            there.p = at.p * scale;
            ScatterView view;
            if (at.surface && i % 2) {
                view.wo = at.n;
                view.outline.diffuse = 0.3f;
                view.outline.add({.share = 0.7f, .alpha2 = 0.01f});
            }
            for (std::uint32_t k = 0; k < lights.size(); ++k) {
                const auto p = static_cast<double>(tree.probability(k, at, view));
                const auto q = static_cast<double>(other.probability(k, there, view));
                worst = std::max(worst, std::abs(p - q));
                if (p > 1e-4) worstRelative = std::max(worstRelative, std::abs(q / p - 1));
            }
        }
        CHECK(worst < 1e-4);
        CHECK(worstRelative < 2e-3);
    }
}

TEST_CASE("light tree: a render that is to end does not wait for it") {
    const auto lights = randomLights(200'000, 10, 12);
    const auto secondsOf = [&](const StopFlag& stop) {
        return cpuSecondsOf([&] { const LightTree tree(lights, stop); });
    };
    const StopFlag ended{true};
    CHECK(secondsOf(ended) < 0.2 * secondsOf(kNeverStop));
}

// What the choice is for: the variance of an estimate by one light of a thousand, walls apart, relative to its mean².
TEST_CASE("light tree: one light of a thousand tells what all give") {
    const auto lights = randomLights(1000, 10, 12);
    const LightTree tree(lights);
    Random random(13);
    double sum = 0, byPower = 0, power = 0;
    for (const LightBounds& b : lights) power += static_cast<double>(b.power);
    constexpr int receivers = 200;
    for (int i = 0; i < receivers; ++i) {
        const Receiver at = randomReceiver(random, 10, 1);
        double mean = 0, square = 0, other = 0;
        for (std::uint32_t k = 0; k < lights.size(); ++k) {
            const LightBounds& b = lights[k];
            const Vec3 way = b.box.centre() - at.p;
            const float d = std::max(0.1f, length(way));
            float emitted = b.cosNormals > -1 ? -dot(b.axis, way) / d : 1;
            if (b.twoSided) emitted = std::abs(emitted);
            if (!(emitted > b.cosEmission) || !(dot(way, at.n) > 0)) continue;
            const double given = static_cast<double>(b.power * emitted * dot(way, at.n) / (d * d * d));
            mean += given;
            square += given * given / static_cast<double>(tree.probability(k, at));
            other += given * given * power / static_cast<double>(b.power);
        }
        if (!(mean > 0)) continue;
        sum += square / (mean * mean) - 1;
        byPower += other / (mean * mean) - 1;
    }
    MESSAGE("relative variance ", sum / receivers, ", by power ", byPower / receivers);
    CHECK(sum / receivers < 3);
    CHECK(byPower > 4 * sum);
}

// The same for a surface that reflects or refracts roughly, by the values of its Bsdf.
TEST_CASE("light tree: one light of a thousand tells what a glossy surface sends to the eye") {
    const auto lights = randomLights(1000, 10, 12);
    const LightTree tree(lights);
    const auto scene = TestScene::parse(R"(scene 1
camera { from 0 0 5; look-at 0 0 0; fov 40 deg }
light point { position 0 3 0; power 1 W }
shape sphere { radius 1; material conductor { index metal Cu; roughness 0.3 } }
shape sphere { radius 1; material dielectric { ior 1.5; roughness 0.3 } }
shape sphere { radius 1; material openpbr { specular-roughness 0.25; base-color 0.2 } }
shape sphere { radius 1; material layered { roughness 0.2; base diffuse { reflectance 0.3 } } }
)");
    REQUIRE_MESSAGE(!scene.diagnostics().hasErrors(), scene.report());
    const Wavelengths lambda = Wavelengths::sample(0.3f);
    int materials = 0;
    for (const auto& material : scene.scene().materials) {
        Random random(13);
        double told = 0, untold = 0;
        int counted = 0;
        for (int i = 0; i < 200; ++i) {
            Arena arena;
            SurfaceHit hit;
            hit.material = material.get();
            hit.shading = Frame::fromNormal(randomDirection(random));
            hit.ng = hit.shading.z;
            hit.p = randomPoint(random, 10);
            Vec3 eye = randomDirection(random);
            if (dot(eye, hit.ng) < 0) eye = -eye;
            const Bsdf& bsdf = *material->bsdf(hit, lambda, arena);
            if (!bsdf.lobes().has(Lobe::glossy)) break; // the base of the layers
            const Vec3 wo = hit.shading.toLocal(eye);
            const Receiver at(hit.p, hit.shading.z, bsdf.lobes().has(Lobe::transmission));
            const ScatterView view{eye, bsdf.outline(wo)};
            CHECK(view.glossy());
            double mean = 0, with = 0, without = 0;
            for (std::uint32_t k = 0; k < lights.size(); ++k) {
                const LightBounds& b = lights[k];
                const Vec3 way = b.box.centre() - at.p;
                const float d = std::max(0.1f, length(way));
                float emitted = b.cosNormals > -1 ? -dot(b.axis, way) / d : 1;
                if (b.twoSided) emitted = std::abs(emitted);
                if (!(emitted > b.cosEmission)) continue;
                const Vec3 wi = hit.shading.toLocal(normalize(way));
                const auto f = static_cast<double>(abbe::mean(bsdf.eval(wo, wi, Transport::radiance).fcos));
                const double given = f * static_cast<double>(b.power * emitted / (d * d));
                if (!(given > 0)) continue;
                mean += given;
                with += given * given / static_cast<double>(tree.probability(k, at, view));
                without += given * given / static_cast<double>(tree.probability(k, at));
            }
            if (!(mean > 0)) continue;
            ++counted;
            told += with / (mean * mean) - 1;
            untold += without / (mean * mean) - 1;
        }
        if (counted == 0) continue;
        ++materials;
        MESSAGE("relative variance ", told / counted, ", without the lobes ", untold / counted);
        CHECK(counted > 150);
        CHECK(told * 2 < untold);
    }
    CHECK(materials == 4);
}

TEST_CASE("light tree: near lights are preferred to far ones, lights in front to those behind") {
    std::vector<LightBounds> lights(3);
    lights[0].box.add({0, 2, 0});
    lights[1].box.add({0, 20, 0});
    lights[2].box.add({0, -2, 0});
    for (LightBounds& b : lights) b.power = 1;
    const LightTree tree(lights);
    const Receiver floor({0, 0, 0}, {0, 1, 0}, false), both({0, 0, 0}, {0, 1, 0}, true);
    CHECK(tree.probability(0, floor) > 10 * tree.probability(1, floor));
    CHECK(tree.probability(1, floor) > 0.001f);
    CHECK(tree.probability(2, floor) == 0);
    CHECK(tree.probability(2, both) > 0.2f);
    CHECK(tree.probability(2, Receiver(Vec3())) > 0.2f);
}

TEST_CASE("light tree: all lights in one place, on a line, or ever farther away") {
    std::vector<LightBounds> same(5000), line(100), apart(200);
    for (LightBounds& b : same) {
        b.box.add({1, 2, 3});
        b.power = 1;
    }
    for (std::size_t i = 0; i < line.size(); ++i) {
        line[i].box.add({static_cast<float>(i), 0, 0});
        line[i].power = 1;
    }
    for (std::size_t i = 0; i < apart.size(); ++i) {
        apart[i].box.add({std::pow(1.3f, static_cast<float>(i)), 0, 0});
        apart[i].power = 1;
    }
    CHECK(LightTree(same).depth() == 5);
    CHECK(LightTree(line).depth() < 5);
    for (const auto* lights : {&same, &line, &apart}) {
        const LightTree tree(*lights);
        CHECK(tree.depth() < light_tree::Builder::kMaxDepth);
        for (const Vec3 p : {Vec3{0, 1, 0}, Vec3{1, 2, 3}}) {
            double sum = 0;
            for (std::uint32_t k = 0; k < lights->size(); ++k) sum += static_cast<double>(tree.probability(k, p));
            CHECK(sum == doctest::Approx(1).epsilon(1e-5));
        }
    }
    CHECK(LightTree(same).probability(7, Vec3{1, 2, 3}) == doctest::Approx(1 / 5000.).epsilon(0.7));
}

TEST_CASE("light tree: merged cones hold both") {
    Random random(11);
    for (int i = 0; i < 20000; ++i) {
        LightBounds a, b;
        a.axis = randomDirection(random);
        b.axis = i % 5 == 0 ? -a.axis : randomDirection(random);
        a.cosNormals = random.bits() % 3 ? 2 * random.uniform() - 1 : 1;
        b.cosNormals = random.bits() % 3 ? 2 * random.uniform() - 1 : 1;
        a.twoSided = random.bits() % 4 == 0;
        a.power = b.power = 1;
        const LightBounds m = light_tree::merged(a, b);
        for (const LightBounds* part : {&a, &b}) {
            Vec3d side = cross(Vec3d(part->axis), Vec3d(randomDirection(random)));
            const double angle = std::acos(static_cast<double>(part->cosNormals));
            const Vec3d n = Vec3d(part->axis) * std::cos(angle) + normalize(side) * std::sin(angle);
            double cosine = dot(n, Vec3d(m.axis));
            if (m.twoSided) cosine = std::abs(cosine);
            CHECK_UNARY(cosine > static_cast<double>(m.cosNormals) - 1e-5);
        }
        CHECK_UNARY((m.twoSided == a.twoSided && m.power == 2));
    }
}

TEST_CASE("light tree: built in no time, the same every time") {
    const auto lights = randomLights(100000, 100, 8);
    std::optional<LightTree> built;
    const double seconds = cpuSecondsOf([&] { built.emplace(lights); });
    const LightTree& tree = *built;
    MESSAGE("100 000 lights: ", seconds, " s, depth ", tree.depth());
    CHECK(seconds < 20); // 0.4 s on a machine of its own, 6 s under sanitizers on a busy one; not the hour of all pairs
    const LightTree again(lights);
    Random random(9);
    for (int i = 0; i < 200; ++i) {
        const Receiver at = randomReceiver(random, 100, i % 3);
        const auto u = static_cast<double>(random.uniform());
        CHECK_UNARY((tree.pick(u, at).light == again.pick(u, at).light));
    }
}

} // namespace abbe::test
