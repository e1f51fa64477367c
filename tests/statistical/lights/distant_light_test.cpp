// Directions of distant lights against their densities, and their light on a surface against quadrature.
#include "lights/environment_light.h"
#include "lights/sky_light.h"
#include "lights/sun_light.h"
#include "math/warp.h"
#include "spectrum/curve.h"
#include "support/chi_square.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe {
namespace {

const ConstantCurve kDistantUnit(1);
const Wavelengths kDistantAt = Wavelengths::single(550);

class Grey final : public RgbRadiance {
  public:
    Spectrum at(Vec3 rgb, const Wavelengths&) const noexcept override { return Spectrum(rgb.y); }
};

EnvironmentImage noise(int width, int height) {
    EnvironmentImage image{width, height, {}};
    test::Random random(3);
    for (int i = 0; i < width * height; ++i) {
        const float v = random.uniform() < 0.05f ? 30 * random.uniform() : square(random.uniform());
        image.rgb.insert(image.rgb.end(), {v, v, v});
    }
    return image;
}

// χ² over the texels of an image, each cut in four: the density is constant in each part, which its middle tells.
test::ChiSquareResult imageTest(const DistantLight& light, const Transform& turn, int width, int height,
                                std::uint64_t seed, const Receiver& from = Vec3{}) {
    const int columns = 2 * width, rows = 2 * height, samples = test::chiSquareSamples();
    const auto solidAngle = [&](int r) {
        return 2 * kPiD / columns * (std::cos(kPiD * r / rows) - std::cos(kPiD * (r + 1) / rows));
    };
    std::vector<double> expected, observed(static_cast<std::size_t>(columns * rows));
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const double theta = kPiD * (r + 0.5) / rows, phi = 2 * kPiD * (c + 0.5) / columns - kPiD;
            const Vec3d local{std::sin(theta) * std::sin(phi), std::cos(theta), -std::sin(theta) * std::cos(phi)};
            expected.push_back(light.pdfEscaped(from, Vec3(turn.vector(local)), 0) * solidAngle(r) * samples);
        }
    const Transform back = turn.inverse().value();
    test::Random random(seed);
    for (int i = 0; i < samples; ++i) {
        const auto s = light.sample(from, 0, {random.uniform(), random.uniform()}, kDistantAt, 0);
        if (!s) continue;
        const Vec3d w = back.vector(Vec3d(s->wi));
        const double phi = std::atan2(w.x, -w.z), theta = std::atan2(std::hypot(w.x, w.z), w.y);
        const int c = std::clamp(static_cast<int>((phi / (2 * kPiD) + 0.5) * columns), 0, columns - 1);
        const int r = std::clamp(static_cast<int>(theta / kPiD * rows), 0, rows - 1);
        ++observed[static_cast<std::size_t>(r * columns + c)];
    }
    // Directions on a border may round to the other side, where nothing may be expected.
    for (double& e : expected) e += 1e-3;
    return test::chiSquareTest(observed, expected);
}

TEST_CASE("environment images: directions follow the density") {
    for (const bool compensated : {false, true}) {
        const Transform turn = Transform::rotate({3, 1, 2}, 0.8);
        const EnvironmentLight light(noise(24, 12), std::make_unique<Grey>(), 1, turn, compensated);
        CHECK(imageTest(light, turn, 24, 12, 5).pValue > 1e-4);
    }
}

TEST_CASE("sky: directions are uniform, and by the cosine over an opaque surface") {
    const SkyLight sky({&kDistantUnit, 1});
    CHECK(imageTest(sky, {}, 16, 8, 6).pValue > 1e-4);
    CHECK(imageTest(sky, {}, 16, 8, 6, {{}, {0, 1, 0}, true}).pValue > 1e-4); // it lets light through
    // Small cells, whose middles tell the density.
    CHECK(imageTest(sky, {}, 96, 48, 6, {{}, {0, 1, 0}, false}).pValue > 1e-4);
    CHECK(imageTest(sky, {}, 96, 48, 6, {{}, {1, 0, 0}, false}).pValue > 1e-4);
}

TEST_CASE("sky: no noise is left on an opaque surface without neighbours") {
    const SkyLight sky({&kDistantUnit, 2});
    for (const Vec3 n : {Vec3{0, 1, 0}, Vec3{0, 0, -1}, normalize(Vec3{0.3f, -1, 2})}) {
        test::Random random(4);
        test::Moments m;
        for (int i = 0; i < 10000; ++i) {
            const auto s = sky.sample({{}, n, false}, 0, {random.uniform(), random.uniform()}, kDistantAt, 0);
            REQUIRE(s);
            CHECK(s->pdfSolidAngle == sky.pdfEscaped({{}, n, false}, s->wi, 0));
            m.add(s->radiance[0] * dot(n, s->wi) / s->pdfSolidAngle);
        }
        CHECK(m.mean() == doctest::Approx(2 * kPiD).epsilon(1e-4));
        CHECK(m.variance() < 1e-6);
    }
    CHECK(sky.pdfEscaped({{}, {0, 1, 0}, false}, {0, -1, 0}, 0) == 0);
}

TEST_CASE("sun: directions are uniform over the disk") {
    for (const double half : {1e-3, 0.2, 1.5}) {
        const SunLight sun({0, 0, 1}, half, {&kDistantUnit, 1});
        constexpr int n = 16;
        const int samples = test::chiSquareSamples();
        std::vector<double> observed(n * n), expected(n * n, static_cast<double>(samples) / (n * n));
        test::Random random(7);
        int outside = 0;
        for (int i = 0; i < samples; ++i) {
            const auto s = sun.sample(Vec3(), 0, {random.uniform(), random.uniform()}, kDistantAt, 0);
            outside += sun.pdfEscaped(Vec3{}, s->wi, 0) == 0;
            const Vec3d w = normalize(Vec3d(s->wi));
            const double sine = std::hypot(w.x, w.y), h = sine * sine / (1 + w.z); // 1 - cos
            const int r = std::min(static_cast<int>(h / (2 * square(std::sin(half / 2))) * n), n - 1);
            const int c = static_cast<int>((std::atan2(w.y, w.x) / (2 * kPiD) + 0.5) * n) % n;
            ++observed[static_cast<std::size_t>(r * n + c)];
        }
        CHECK(test::chiSquareTest(observed, expected).pValue > 1e-4);
        CHECK(outside < samples / 1000);
    }
}

// By sampling the light.
test::Moments irradiance(const DistantLight& light, Vec3 n, std::uint64_t seed) {
    test::Moments result;
    test::Random random(seed);
    for (int i = 0; i < 400000; ++i) {
        const auto s = light.sample(Vec3(), 0, {random.uniform(), random.uniform()}, kDistantAt, 0);
        result.add(s->radiance[0] * std::max(0.f, dot(n, s->wi)) / s->pdfSolidAngle);
    }
    return result;
}

TEST_CASE("irradiance: π L of the sky, what was stated of the sun") {
    const test::Moments sky = irradiance(SkyLight({&kDistantUnit, 2}), normalize(Vec3{1, 2, -1}), 8);
    CHECK(test::meanTest(sky, 2 * kPiD) > 1e-4);
    CHECK(sky.standardError() < 0.0025 * 2 * kPiD); // a factor of 1.01 would be seen
    for (const double half : {0.004, 0.5, 1.5}) {
        const SunLight sun({0, 1, 0}, half, {&kDistantUnit, 7});
        const test::Moments facing = irradiance(sun, {0, 1, 0}, 9);
        CHECK(test::meanTest(facing, 7) > 1e-4);
        CHECK(facing.standardError() < 0.0025 * 7);
    }
    // All of a small disk above the horizon: the cosine of its middle.
    const SunLight low({3, 1, 0}, 0.2, {&kDistantUnit, 7});
    CHECK(test::meanTest(irradiance(low, {0, 1, 0}, 10), 7 / std::sqrt(10.0)) > 1e-4);
}

TEST_CASE("irradiance of an image, sampled without compensation, is that of escaped()") {
    const EnvironmentLight light(noise(24, 12), std::make_unique<Grey>(), 3, Transform::rotate({1, 0, 2}, 2), false);
    const Vec3 n = normalize(Vec3{-1, 3, 0.5f});
    test::Moments uniform;
    test::Random random(11);
    for (int i = 0; i < 1000000; ++i) {
        const Vec3 w = squareToSphere({random.uniform(), random.uniform()});
        uniform.add(light.escaped(w, kDistantAt, 0)[0] * std::max(0.f, dot(n, w)) / kSpherePdf);
    }
    CHECK(test::sameMeanTest(irradiance(light, n, 12), uniform) > 1e-4);
}

} // namespace
} // namespace abbe
