// Where paths of light start and go: samples against densities, and densities found from either end of a path.
#include "support/chi_square.h"
#include "support/emission_cases.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

const Wavelengths kAt = Wavelengths::single(550);

// Cells of even solid angle over all directions.
constexpr int kHeights = 24, kTurns = 48;

// Points of a cell each way over which its density is summed. That has edges, and a cell with a corner of a cone that
// no point sees must not get more than a few counts.
int pointsPerCell() { return nightly() ? 56 : 28; }

Vec3 directionOf(double height, double turn) {
    const double z = 2 * height / kHeights - 1, r = safeSqrt(1 - z * z), phi = 2 * kPiD * turn / kTurns;
    return Vec3(Vec3d{r * std::cos(phi), r * std::sin(phi), z});
}

std::size_t cellOf(Vec3 w) {
    const int height = std::clamp(static_cast<int>((static_cast<double>(w.z) + 1) / 2 * kHeights), 0, kHeights - 1);
    const double turn = std::atan2(static_cast<double>(w.y), static_cast<double>(w.x)) / (2 * kPiD);
    return static_cast<std::size_t>(height * kTurns +
                                    std::clamp(static_cast<int>((turn < 0 ? turn + 1 : turn) * kTurns), 0, kTurns - 1));
}

// Counts of directions against the integral of their density over each cell.
template <typename Sample, typename Pdf> ChiSquareResult directionTest(Sample&& sample, Pdf&& pdf) {
    const int samples = chiSquareSamples();
    std::vector<double> observed(kHeights * kTurns, 0), expected(kHeights * kTurns, 0);
    for (int i = 0; i < samples; ++i)
        if (const std::optional<Vec3> w = sample()) observed[cellOf(*w)] += 1;
    const int fine = pointsPerCell();
    for (int i = 0; i < kHeights * fine; ++i)
        for (int j = 0; j < kTurns * fine; ++j)
            expected[static_cast<std::size_t>(i / fine * kTurns + j / fine)] +=
                pdf(directionOf((i + 0.5) / fine, (j + 0.5) / fine)) * samples * 4 * kPiD /
                (kHeights * kTurns * fine * fine);
    // Directions on a border may round to the other side, where nothing may be expected.
    for (double& e : expected) e += 1e-3;
    return chiSquareTest(observed, expected);
}

// Three balls in front of the light, two of them overlapping, one behind it and one around it.
EmissionPlan someTargets(Vec3 origin) {
    EmissionPlan plan;
    const Vec3 side = Frame::fromNormal(kAhead).x;
    plan.targets = {{kAhead * 2 - origin, 0.8f},
                    {kAhead * 2 + side * 0.7f - origin, 0.6f},
                    {kAhead + side * 1.5f - origin, 0.4f},
                    {kAhead * -2 - origin, 0.5f},
                    {kAhead * 0.1f - origin, 1.2f}};
    plan.aim = {3, 2, 1, 1, 0.5};
    plan.parts.resize(5);
    for (int i = 0; i < 16; ++i) plan.parts[0].push_back(i % 5 == 0 ? 3 : 1);
    for (int i = 0; i < 256; ++i) plan.parts[1].push_back(i / 16 > 10 ? 2 : 0.5);
    plan.parts[4] = {1, 2, 3, 4};
    return plan;
}

// Of the paths that start at one point of a light.
ChiSquareResult mixtureTest(const Light& light, const AimedEmission& emission, Random& random) {
    EmissionNumbers fixed = emissionNumbers(random);
    constexpr float time = 0.4f;
    std::optional<EmittedRay> some;
    const auto draw = [&] {
        fixed.aim = random.uniform();
        fixed.direction = {random.uniform(), random.uniform()};
        return emission.sample(fixed, kAt, time);
    };
    while (!some) some = draw();
    const auto origin = light.asPlaced()->sampleOrigin(some->part, fixed.position, kAt, time);
    return directionTest(
        [&] {
            const auto ray = draw();
            return ray ? std::optional(ray->ray.direction) : std::nullopt;
        },
        [&](Vec3 w) {
            if (!anyNonZero(light.asPlaced()->leaving(*origin, w, kAt))) return 0.0;
            return emission.density(&light, some->part, origin->p, origin->n, w, time).direction;
        });
}

// Of the places across one direction of a light far away.
ChiSquareResult diskTest(const Light& light, const AimedEmission& emission, Vec3 centre, Random& random) {
    constexpr int cells = 40;
    constexpr double half = 3; // m: the scene's disk has 2.6
    EmissionNumbers fixed = emissionNumbers(random);
    std::optional<EmittedRay> some;
    while (!some) {
        fixed.direction = {random.uniform(), random.uniform()};
        some = emission.sample(fixed, kAt, 0);
    }
    const Vec3 w = some->ray.direction;
    const Frame frame = Frame::fromNormal(w);
    const int samples = chiSquareSamples();
    std::vector<double> observed(cells * cells, 0), expected(cells * cells, 0);
    const auto cell = [](float x) {
        return std::clamp(static_cast<int>((static_cast<double>(x) / half + 1) / 2 * cells), 0, cells - 1);
    };
    for (int i = 0; i < samples; ++i) {
        fixed.aim = random.uniform();
        fixed.position = {random.uniform(), random.uniform()};
        const Vec3 local = frame.toLocal(emission.sample(fixed, kAt, 0)->ray.origin - centre);
        observed[static_cast<std::size_t>(cell(local.y) * cells + cell(local.x))] += 1;
    }
    const int fine = pointsPerCell();
    for (int i = 0; i < cells * fine; ++i)
        for (int j = 0; j < cells * fine; ++j) {
            const auto at = [fine](int k) { return static_cast<float>(((k + 0.5) / (cells * fine) * 2 - 1) * half); };
            const Vec3 p = centre + frame.x * at(j) + frame.y * at(i);
            expected[static_cast<std::size_t>(i / fine * cells + j / fine)] +=
                emission.density(&light, p, w, 0).position * samples * square(2 * half / (cells * fine));
        }
    for (double& e : expected) e += 1e-3;
    return chiSquareTest(observed, expected);
}

} // namespace

TEST_CASE("emission: directions of every light follow its own density") {
    Random random(31);
    for (const EmissionCase& emitter : emissionCases()) {
        CAPTURE(emitter.text);
        const TestScene test = emissionScene(emitter);
        const Light& light = *test.scene().lights.at(0);
        ChiSquareResult result;
        if (emitter.distant) {
            if (light.asDistant()->sampleDistant({0.5f, 0.5f}, kAt, 0)->delta || emitter.text.size() < 40)
                continue; // half a degree
            result = directionTest(
                [&] {
                    return std::optional(
                        light.asDistant()->sampleDistant({random.uniform(), random.uniform()}, kAt, 0.4f).value().wi);
                },
                [&](Vec3 w) { return static_cast<double>(light.asDistant()->pdfDistant(w, 0.4f)); });
        } else {
            const auto origin = light.asPlaced()->sampleOrigin(0, {0.37f, 0.61f}, kAt, 0.4f);
            REQUIRE(origin);
            result = directionTest(
                [&] {
                    return std::optional(
                        light.asPlaced()->sampleDirection(*origin, {random.uniform(), random.uniform()}));
                },
                [&](Vec3 w) { return static_cast<double>(light.asPlaced()->pdfDirection(*origin, w)); });
        }
        CAPTURE(result.statistic);
        CAPTURE(result.degrees);
        CHECK(result.pValue > 1e-5);
    }
}

TEST_CASE("emission: aimed directions and places follow the density of the whole mixture") {
    Random random(32);
    for (const EmissionCase& emitter : emissionCases()) {
        CAPTURE(emitter.text);
        const TestScene test = emissionScene(emitter);
        const Scene& scene = test.scene();
        const AimedEmission emission(scene.lights, scene.intersector->bounds(), someTargets(Vec3(scene.origin)));
        const Light& light = *scene.lights.at(0);
        const ChiSquareResult result = emitter.distant
                                           ? diskTest(light, emission, scene.intersector->bounds().centre(), random)
                                           : mixtureTest(light, emission, random);
        CAPTURE(result.statistic);
        CAPTURE(result.degrees);
        CHECK(result.pValue > 1e-5);
    }
}

// The first vertex on a tilted wall: its density per area there, as weights compare it with that of paths from the eye.
TEST_CASE("emission: where paths arrive follows the density per area of the wall") {
    constexpr int cells = 16;
    constexpr double half = 0.8; // m
    Random random(34);
    for (const EmissionCase& emitter : emissionCases()) {
        CAPTURE(emitter.text);
        const TestScene test = emissionScene(emitter);
        const Scene& scene = test.scene();
        const AimedEmission emission(scene.lights, scene.intersector->bounds(), someTargets(Vec3(scene.origin)));
        const Light& light = *scene.lights.at(0);
        constexpr float time = 0.7f;
        EmissionNumbers fixed = emissionNumbers(random);
        const auto draw = [&] {
            fixed.aim = random.uniform();
            (emitter.distant ? fixed.position : fixed.direction) = {random.uniform(), random.uniform()};
            return emission.sample(fixed, kAt, time);
        };
        std::optional<EmittedRay> some;
        // From a point that faces the wall.
        while (!(some = draw()) || (lengthSquared(some->n) > 0 && dot(some->n, kAhead) < 0.3f))
            fixed = emissionNumbers(random);
        // Aslant to what comes from far away, or before a light.
        const Vec3 towards = emitter.distant ? some->ray.direction : kAhead;
        const Vec3 facing = normalize(towards + Frame::fromNormal(towards).x * 0.8f);
        const Vec3 centre = (emitter.distant ? Vec3{} : kAhead * 1.4f) - Vec3(scene.origin);
        const Frame frame = Frame::fromNormal(facing);
        std::vector<double> observed(cells * cells, 0), expected(cells * cells, 0);
        const int samples = chiSquareSamples();
        for (int i = 0; i < samples; ++i) {
            const auto ray = draw();
            if (!ray) continue;
            const float t = dot(centre - ray->ray.origin, facing) / dot(ray->ray.direction, facing);
            const Vec3 local = frame.toLocal(ray->ray.origin + ray->ray.direction * t - centre);
            const auto cell = [](float x) {
                return static_cast<int>(std::floor((static_cast<double>(x) / half + 1) / 2 * cells));
            };
            const int row = cell(local.y), column = cell(local.x);
            if (t > 0 && row >= 0 && row < cells && column >= 0 && column < cells)
                observed[static_cast<std::size_t>(row * cells + column)] += 1;
        }
        std::optional<LightOrigin> origin;
        if (!emitter.distant) origin = light.asPlaced()->sampleOrigin(some->part, fixed.position, kAt, time);
        const int fine = pointsPerCell();
        for (int i = 0; i < cells * fine; ++i)
            for (int j = 0; j < cells * fine; ++j) {
                const auto at = [fine](int k) {
                    return static_cast<float>(((k + 0.5) / (cells * fine) * 2 - 1) * half);
                };
                const Vec3 p = centre + frame.x * at(j) + frame.y * at(i);
                const Vec3 way = emitter.distant ? some->ray.direction : p - origin->p, w = normalize(way);
                if (!emitter.distant && !anyNonZero(light.asPlaced()->leaving(*origin, w, kAt))) continue;
                const EmissionDensity d = emitter.distant
                                              ? emission.density(&light, p, w, time)
                                              : emission.density(&light, some->part, origin->p, origin->n, w, time);
                expected[static_cast<std::size_t>(i / fine * cells + j / fine)] +=
                    d.arriving(static_cast<double>(dot(w, facing)), static_cast<double>(lengthSquared(way))) * samples *
                    square(2 * half / (cells * fine));
            }
        for (double& e : expected) e += 1e-3;
        const ChiSquareResult result = chiSquareTest(observed, expected);
        CAPTURE(result.statistic);
        CAPTURE(result.degrees);
        CHECK(result.degrees > 100);
        CHECK(result.pValue > 1e-5);
    }
}

TEST_CASE("emission: a path that is found from its other end has the density with which it was made") {
    Random random(33);
    for (const EmissionCase& emitter : emissionCases()) {
        CAPTURE(emitter.text);
        const TestScene test = emissionScene(emitter);
        const Scene& scene = test.scene();
        const AimedEmission emission(scene.lights, scene.intersector->bounds(), someTargets(Vec3(scene.origin)));
        const Light& light = *scene.lights.at(0);
        int made = 0, different = 0, met = 0, metDifferent = 0;
        for (int i = 0; i < 4000; ++i) {
            const EmissionNumbers u = emissionNumbers(random);
            const float time = random.uniform();
            const auto made_ = emission.sample(u, kAt, time);
            if (!made_) continue;
            const EmittedRay& ray = *made_;
            const Vec3 w = ray.ray.direction;
            const auto differs = [&](const EmissionDensity& d, double tolerance) {
                return std::abs(d.pick - ray.density.pick) > 1e-9 * ray.density.pick ||
                       std::abs(d.position - ray.density.position) > tolerance * ray.density.position ||
                       std::abs(d.direction - ray.density.direction) > tolerance * ray.density.direction;
            };
            ++made;
            if (emitter.distant) {
                different += differs(emission.density(&light, ray.ray.origin + w * 2, w, time), 1e-5);
                continue;
            }
            const auto origin = light.asPlaced()->sampleOrigin(ray.part, u.position, kAt, time);
            different += differs(emission.density(&light, ray.part, origin->p, origin->n, w, time), 1e-5);
            if (ray.deltaPosition) continue;
            // The light as a ray meets it, and as a sample for a receiver names it.
            Ray back{.origin = ray.ray.origin + w * 0.02f, .direction = -w, .tMax = 1, .time = time};
            SurfaceHit hit;
            if (!scene.intersector->intersect(back, hit) || hit.light != &light || light.partOf(hit) != ray.part)
                continue;
            ++met;
            metDifferent += differs(emission.density(&light, light.partOf(hit), hit.p, hit.ng, w, time), 2e-3);
            const auto s = light.sample(Receiver(back.origin), ray.part, u.position, kAt, time);
            if (!s) continue;
            const EmissionDensity asked = emission.density(&light, ray.part, s->p, s->n, -s->wi, time);
            const EmissionDensity exact =
                emission.density(&light, ray.part, back.origin + s->wi * s->distance, s->n, -s->wi, time);
            CHECK(length(s->n) == doctest::Approx(1).epsilon(1e-5));
            metDifferent += std::abs(asked.total() - exact.total()) > 2e-3 * exact.total();
        }
        CAPTURE(made);
        CAPTURE(met);
        CHECK(made > 1500);
        CHECK(different <= made / 500); // at the edges of cones and cells
        const bool body =
            !emitter.distant && !light.hasNoSurface() && !light.asPlaced()->sampleOrigin(0, {}, kAt, 0)->point();
        CHECK((!body || met > made / 2));
        CHECK(metDifferent <= met / 50);
    }
}

} // namespace abbe::test
