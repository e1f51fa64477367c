// Where lights are sampled: cases 30 to 34 of docs/hard_cases.md.
#include "geometry/flat_shapes.h"
#include "geometry/mesh.h"
#include "geometry/round_shapes.h"
#include "hard_cases/hard_case.h"
#include "lights/environment_light.h"
#include "math/distribution.h"
#include "math/hash.h"
#include "math/warp.h"
#include "support/chi_square.h"
#include "unit/geometry/test_meshes.h"

using namespace abbe;
using namespace abbe::test;

namespace {

class Grey final : public RgbRadiance {
  public:
    Spectrum at(Vec3 rgb, const Wavelengths&) const noexcept override { return Spectrum(rgb.y); }
};

EnvironmentLight environment(int width, int height, const std::function<float(int, int)>& value,
                             const Transform& t = {}) {
    EnvironmentImage image{width, height, {}};
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) image.rgb.insert(image.rgb.end(), 3, value(x, y));
    return {std::move(image), std::make_unique<Grey>(), 1, t, false};
}

float hashed(int x, int y) {
    return unitFloat(mix32(static_cast<std::uint32_t>(x * 1000 + y))) *
           (mix32(static_cast<std::uint32_t>(y * 77 + x)) % 10 ? 1.f : 20.f);
}

} // namespace

TEST_CASE("case 30: lights of tiny solid angle") {
    HardCase c;
    c.doctor();
    const float theta = 1e-4f;
    const double exact = 2 * square(std::sin(static_cast<double>(theta) / 2));
    c.naive("1 - cos θ at 1e-4 rad", std::abs(static_cast<double>(1 - std::cos(theta)) / exact - 1));
}

TEST_CASE("case 31: small triangles and rectangles seen from afar") {
    HardCase c;
    c.doctor();
    Random random(3);
    double worst = 0; // Girard: the sum of the angles less π
    for (int i = 0; i < 1000; ++i) {
        const auto corner = [&] {
            return normalize(Vec3(0.3f, -0.2f, 1.5f) +
                             Vec3(random.uniform(), random.uniform(), random.uniform()) * 0.01f);
        };
        const Vec3 a = corner(), b = corner(), p = corner();
        const auto angle = [](Vec3 x, Vec3 y) {
            return std::acos(std::clamp(-dot(normalize(x), normalize(y)), -1.f, 1.f));
        };
        const Vec3 ab = cross(a, b), bp = cross(b, p), pa = cross(p, a);
        const float area = angle(ab, bp) + angle(bp, pa) + angle(pa, ab) - kPi;
        const Vec3d da(a), e = Vec3d(b) - da, f = Vec3d(p) - da;
        const double exact = 2 * std::atan2(std::abs(dot(da, cross(e, f))),
                                            1 + dot(da, Vec3d(b)) + dot(Vec3d(b), Vec3d(p)) + dot(Vec3d(p), da));
        if (exact > 1e-6) worst = std::max(worst, std::abs(static_cast<double>(area) / exact - 1));
    }
    c.naive("sum of the angles less π in single precision, 0.01 in size", worst);
}

// E[1/p] over the samples of a light is the solid angle that it fills, wherever the point lies.
TEST_CASE("case 32: on, behind, inside or at a corner of a light") {
    HardCase c;
    const Sphere sphere(Vec3d(0, 0, 0), 1);
    const Quad quad({-1, 0, -1}, {1, 0, -1}, {1, 0, 1}, {-1, 0, 1});
    MeshData m;
    m.positions = {{-1, 0, -1}, {1, 0, -1}, {0, 0, 1}};
    m.triangles = {{0, 1, 2}};
    const Mesh triangle(m);
    int bad = 0;
    double worst = 0;
    Random random(8);
    for (const Shape* shape : std::initializer_list<const Shape*>{&sphere, &quad, &triangle})
        for (const Vec3 from : {Vec3{0, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 1.0000001f, 0}, Vec3{1, 0, 0}, Vec3{-1, 0, -1},
                                Vec3{1, 0, -1}, Vec3{0, 0, 1}, Vec3{0, 1e-20f, 0}, Vec3{0.5f, 1e-6f, -0.5f},
                                Vec3{0, 0.5f, 0}, Vec3{3, 0, 0}, Vec3{0, 1e6f, 0}, Vec3{0, 2, 0.5f}}) {
            double solidAngle = 0, plain = 0;
            constexpr int kSamples = 20000;
            for (int i = 0; i < kSamples; ++i) {
                const auto s = shape->sampling()->sample(Receiver(from), 0,
                                                         {random.uniform(), (static_cast<float>(i) + 0.5f) / kSamples});
                if (!s) continue;
                bad += !isFinite(s->p) || !(s->pdfSolidAngle > 0) || !std::isfinite(s->pdfSolidAngle);
                solidAngle += 1 / (kSamples * static_cast<double>(s->pdfSolidAngle));
            }
            static_cast<void>(plain);
            // Known from outside by more than rounding: what the sphere fills, and the rectangle below its middle.
            const double d = static_cast<double>(length(from));
            double exact = 0;
            if (shape == &sphere && d > 1.5) exact = 2 * kPiD * (1 - std::sqrt(1 - 1 / (d * d)));
            if (shape == &sphere && d > 1e3) exact = kPiD / (d * d);
            if (shape == &quad && from.x == 0 && from.z == 0 && from.y == 0.5f)
                exact = 4 * std::asin(1 / (1 + square(static_cast<double>(from.y))));
            if (exact > 0) worst = std::max(worst, std::abs(solidAngle / exact - 1));
        }
    c.measured("samples without a place or a density, from 13 points on, in, at and around three lights", bad, 0);
    c.naive("cosine of the cone from a point inside of a sphere", [] {
        const volatile float sine = 1 / 0.5f;
        return static_cast<double>(std::sqrt(1 - sine * sine));
    }());
    c.measured("largest relative error of the solid angle where it is known", worst, 1e-2);
}

TEST_CASE("case 33: poles and seam of an environment") {
    HardCase c;
    int bad = 0;
    const EnvironmentLight sky = environment(16, 8, hashed);
    const Wavelengths w = Wavelengths::sample(0.4f);
    for (const Vec3 pole : {Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{1e-20f, 1, -1e-20f}, Vec3{-0.f, -1, -0.f}}) {
        const float pdf = sky.pdfEscaped(Vec3{}, pole, 0);
        bad += !std::isfinite(sky.escaped(pole, w, 0)[0]) || !(pdf > 0 && pdf < 100);
    }
    const float before = sky.escaped(normalize(Vec3{1e-6f, 0.2f, 1}), w, 0)[2],
                after = sky.escaped(normalize(Vec3{-1e-6f, 0.2f, 1}), w, 0)[2];
    bad += !(std::abs(before / after - 1) < 1e-4f);
    c.measured("densities and values at poles and seam that are not finite or jump", bad, 0);
    const volatile float sine = std::sin(0.f);
    c.naive("density over the sine at the pole", static_cast<double>(1 / (2 * kPi * kPi * sine)));
    // Fluence of the environment turned seven ways, by its own samples.
    std::vector<Moments> turns;
    for (int k = 0; k < 7; ++k) {
        const EnvironmentLight turned = environment(16, 8, hashed, Transform::rotate({1, 2, 3.0 - k}, 0.9 * k));
        Random random(10 + static_cast<std::uint64_t>(k));
        Moments& m = turns.emplace_back();
        for (int i = 0; i < 100000; ++i)
            if (const auto s = turned.sample(Receiver(Vec3{}), 0, {random.uniform(), random.uniform()}, w, 0))
                m.add(static_cast<double>(s->radiance[0] / s->pdfSolidAngle));
    }
    double worst = 0;
    for (const Moments& m : turns)
        worst = std::max(worst, std::abs(m.mean() - turns[0].mean()) /
                                    std::hypot(m.standardError(), turns[0].standardError()));
    c.measured("largest difference of the mean, turned seven ways, in standard errors", worst, 3);
}

TEST_CASE("case 34: a sun of 1e9 in an environment") {
    HardCase c;
    c.doctor();
    // As a table in single precision would have them.
    float sum = 0, previous = 0;
    double worst = 0;
    for (int i = 0; i < 100000; ++i) {
        sum += i == 10 ? 1e9f : 1.f;
        const float p = (sum - previous) / 1.0001e9f;
        if (i > 10) worst = std::max(worst, std::abs(static_cast<double>(p) * (1e9 + 99999) - 1));
        previous = sum;
    }
    c.naive("cumulative weights in single precision", worst);
    // The grid's rows and columns: what is drawn against what is said, the sun left out of the count.
    std::vector<double> weights(64 * 32);
    for (int i = 0; i < 64 * 32; ++i)
        weights[static_cast<std::size_t>(i)] = static_cast<double>(hashed(i % 64, i / 64)) + 0.01;
    weights[500] = 1e9;
    const Distribution2D grid(weights, 64);
    std::vector<double> observed(weights.size(), 0), expected;
    double dark = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) dark += i == 500 ? 0 : grid.probability(i % 64, i / 64);
    double told = 0;
    for (std::size_t i = 0; i < weights.size(); ++i) told += i == 500 ? 0 : weights[i] / (1e9 * dark);
    c.measured("error of the share of all dark cells of a grid", std::abs(told - 1), 1e-5);
    weights[500] = 1; // χ² of the same sampler without the sun, whose 1e9 draws nobody can count
    const Distribution2D even(weights, 64);
    Random random(4);
    constexpr int kSamples = 200000;
    double total = 0;
    for (const double x : weights) total += x;
    for (const double x : weights) expected.push_back(x / total * kSamples);
    for (int i = 0; i < kSamples; ++i) {
        const auto s = even.sample({random.uniform(), random.uniform()});
        ++observed[static_cast<std::size_t>(s.row) * 64 + static_cast<std::size_t>(s.column)];
    }
    c.atLeast("p of χ² of the cells drawn", chiSquareTest(observed, expected).pValue, 1e-4);
}
