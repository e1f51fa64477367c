// Environment images: orientation, interpolation, sampling against what is looked up.
#include "lights/environment_light.h"
#include "spectrum/curve.h"
#include "spectrum/sensor.h"
#include "support/chi_square.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe {
namespace {

// Red light above 600 nm, green between 500 and 600, blue below: (1, 1, 1) is 1 everywhere.
class Bands final : public RgbRadiance {
  public:
    Spectrum at(Vec3 rgb, const Wavelengths& w) const noexcept override {
        return select(w.nm.v > 600.f, Spectrum(rgb.x), select(w.nm.v > 500.f, Spectrum(rgb.y), Spectrum(rgb.z)));
    }
};

EnvironmentImage image(int width, int height, Vec3 fill = {}) {
    EnvironmentImage result{width, height, {}};
    for (int i = 0; i < width * height; ++i) result.rgb.insert(result.rgb.end(), {fill.x, fill.y, fill.z});
    return result;
}
void set(EnvironmentImage& im, int column, int row, Vec3 v) {
    float* p = im.rgb.data() + 3 * (row * im.width + column);
    p[0] = v.x, p[1] = v.y, p[2] = v.z;
}
EnvironmentImage noise(int width, int height) {
    EnvironmentImage result = image(width, height);
    test::Random random(7);
    for (float& v : result.rgb) v = square(random.uniform()) * (random.uniform() < 0.1f ? 20.f : 1.f);
    return result;
}
EnvironmentLight light(EnvironmentImage im, const Transform& t = {}, bool compensated = false, double scale = 1) {
    return {std::move(im), std::make_unique<Bands>(), scale, t, compensated};
}

TEST_CASE("the middle of the image is towards -z, its right half towards +x, its top overhead") {
    const Wavelengths red = Wavelengths::single(650);
    const auto value = [&](int column, int row, Vec3 w, const LightContext& context) {
        EnvironmentImage im = image(8, 4);
        set(im, column, row, {1, 0, 0});
        set(im, column - 1, row, {1, 0, 0});
        set(im, column, row - (row > 0), {1, 0, 0});
        set(im, column - 1, row - (row > 0), {1, 0, 0});
        Diagnostics diagnostics;
        return makeEnvironmentLight({}, im, std::make_unique<Bands>(), false, context, diagnostics)
            ->escaped(w, red, 0)[0];
    };
    const LightContext yUp{};
    LightContext zUp;
    zUp.zUp = true;
    CHECK(value(4, 2, {0, 0, -1}, yUp) == doctest::Approx(1));
    CHECK(value(4, 2, {0, 0, 1}, yUp) == doctest::Approx(0));
    CHECK(value(6, 2, {1, 0, 0}, yUp) == doctest::Approx(1));
    CHECK(value(6, 2, {-1, 0, 0}, yUp) == doctest::Approx(0));
    CHECK(value(4, 2, {0, 1, 0}, zUp) == doctest::Approx(1));
    CHECK(value(6, 2, {1, 0, 0}, zUp) == doctest::Approx(1));
    EnvironmentImage top = image(8, 4);
    for (int column = 0; column < 8; ++column) set(top, column, 0, {1, 0, 0});
    CHECK(light(top).escaped({0, 1, 0}, red, 0)[0] == doctest::Approx(1));
    CHECK(light(top).escaped({0, -1, 0}, red, 0)[0] == 0);
}

// Hard case 33.
TEST_CASE("there is no seam, and the poles are finite") {
    const EnvironmentLight sky = light(noise(16, 8));
    const Wavelengths w = Wavelengths::sample(0.4f);
    const float a = sky.escaped(normalize(Vec3{1e-6f, 0.2f, 1}), w, 0)[2];
    const float b = sky.escaped(normalize(Vec3{-1e-6f, 0.2f, 1}), w, 0)[2];
    CHECK(a == doctest::Approx(b).epsilon(1e-4));
    for (const Vec3 pole : {Vec3{0, 1, 0}, Vec3{0, -1, 0}, Vec3{1e-20f, 1, -1e-20f}, Vec3{-0.f, -1, -0.f}}) {
        CHECK(isFinite(sky.escaped(pole, w, 0)[0]));
        CHECK(sky.pdfEscaped(Vec3{}, pole, 0) > 0);
        CHECK(sky.pdfEscaped(Vec3{}, pole, 0) < 100);
    }
}

TEST_CASE("a constant image gives π L, for any way of sampling") {
    for (const bool compensated : {false, true}) {
        const EnvironmentLight sky = light(image(16, 8, {2, 2, 2}), {}, compensated, 0.5);
        const Wavelengths w = Wavelengths::sample(0.1f);
        test::Moments irradiance;
        test::Random random(5);
        for (int i = 0; i < 200000; ++i) {
            const auto s = sky.sample(Vec3(), 0, {random.uniform(), random.uniform()}, w, 0);
            irradiance.add(s->radiance[4] * std::max(s->wi.y, 0.f) / s->pdfSolidAngle);
        }
        CHECK(test::meanTest(irradiance, kPiD) > 1e-4);
        CHECK(irradiance.standardError() < 0.01);
    }
}

TEST_CASE("what is sampled is what is looked up") {
    const Transform turn = Transform::rotate({1, 2, 3}, 1.1).then(Transform::scale({2, -2, 2}));
    for (const bool compensated : {false, true}) {
        const EnvironmentLight sky = light(noise(32, 16), turn, compensated);
        const Wavelengths w = Wavelengths::sample(0.7f);
        test::Random random(6);
        int borders = 0;
        for (int i = 0; i < 20000; ++i) {
            const auto s = sky.sample(Vec3(), 0, {random.uniform(), random.uniform()}, w, 0);
            REQUIRE(s);
            CHECK(s->pdfSolidAngle > 0);
            CHECK(std::isinf(s->distance));
            CHECK(length(s->wi) == doctest::Approx(1).epsilon(1e-5));
            CHECK(s->radiance[1] == sky.escaped(s->wi, w, 0)[1]);
            borders += std::abs(sky.pdfEscaped(Vec3{}, s->wi, 0) / s->pdfSolidAngle - 1) > 1e-5f;
        }
        CHECK(borders < 5); // directions that round into the next cell
    }
}

// ∫ pdf over the middles of a fine grid in azimuth and cosine.
double integralOfPdf(const EnvironmentLight& sky) {
    constexpr int n = 1024;
    double sum = 0;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const double theta = kPiD * (i + 0.5) / n, phi = 2 * kPiD * (j + 0.5) / n;
            const Vec3 w{static_cast<float>(std::sin(theta) * std::cos(phi)), static_cast<float>(std::cos(theta)),
                         static_cast<float>(std::sin(theta) * std::sin(phi))};
            sum +=
                sky.pdfEscaped(Vec3{}, w, 0) * (std::cos(kPiD * i / n) - std::cos(kPiD * (i + 1) / n)) * 2 * kPiD / n;
        }
    return sum;
}

TEST_CASE("the density integrates to 1") {
    for (const bool compensated : {false, true})
        CHECK(integralOfPdf(light(noise(16, 8), Transform::rotate({0, 1, 0}, 0.3), compensated)) ==
              doctest::Approx(1).epsilon(2e-3));
}

TEST_CASE("sampling without compensation misses no light: the mean is right for seven rotations") {
    // All light in a few texels, one of them at a pole: neighbours that only get light by interpolation count too.
    EnvironmentImage im = image(16, 8);
    set(im, 3, 4, {1, 0.5f, 0});
    set(im, 15, 2, {0, 0, 4});
    set(im, 7, 0, {2, 2, 2});
    const Wavelengths w = Wavelengths::single(550);
    const EnvironmentLight upright = light(im);
    double reference = 0;
    for (int i = 0; i < 2000; ++i)
        for (int j = 0; j < 1000; ++j) {
            const double theta = kPiD * (j + 0.5) / 1000, phi = 2 * kPiD * (i + 0.5) / 2000;
            const Vec3 d{static_cast<float>(std::sin(theta) * std::cos(phi)), static_cast<float>(std::cos(theta)),
                         static_cast<float>(std::sin(theta) * std::sin(phi))};
            reference += upright.escaped(d, w, 0)[0] * std::sin(theta) * kPiD / 1000 * 2 * kPiD / 2000;
        }
    for (int turn = 0; turn < 7; ++turn) {
        const EnvironmentLight sky = light(im, Transform::rotate({1, 1.0 * turn, -1}, 0.9 * turn));
        test::Moments total;
        test::Random random(static_cast<std::uint64_t>(turn) + 20);
        for (int i = 0; i < 100000; ++i) {
            const auto s = sky.sample(Vec3(), 0, {random.uniform(), random.uniform()}, w, 0);
            total.add(s->radiance[0] / s->pdfSolidAngle);
        }
        CHECK(test::meanTest(total, reference) > 1e-4);
    }
}

TEST_CASE("compensation samples only what exceeds the mean, in proportion") {
    EnvironmentImage im = image(16, 8, {1, 1, 1});
    for (int dy = 0; dy < 3; ++dy)
        for (int dx = 0; dx < 3; ++dx) set(im, 9 + dx, 3 + dy, {101, 101, 101});
    const EnvironmentLight sky = light(im, {}, true);
    CHECK(sky.pdfEscaped(Vec3{}, {0, 1, 0}, 0) == 0);
    test::Random random(8);
    int bright = 0; // the others are in halves of cells that reach just beyond the bright texels
    for (int i = 0; i < 1000; ++i)
        bright +=
            sky.sample(Vec3(), 0, {random.uniform(), random.uniform()}, Wavelengths::single(550), 0)->radiance[0] > 1;
    CHECK(bright > 970);
}

TEST_CASE("a black image has no power") {
    EnvironmentLight sky = light(image(4, 2));
    Bounds3 bounds;
    bounds.add(Vec3{-1, -1, -1});
    bounds.add(Vec3{1, 1, 1});
    sky.commit(bounds);
    CHECK(sky.power() == 0);
    CHECK(light(image(4, 2, {1, 1, 1})).power() == doctest::Approx(4 * kPiD * 470 * kPiD).epsilon(1e-3));
}

TEST_CASE("images of one texel, or one row") {
    const Wavelengths w = Wavelengths::single(550);
    for (const auto& [width, height] : {std::pair{1, 1}, {1, 5}, {7, 1}, {2, 2}}) {
        const EnvironmentLight sky = light(image(width, height, {3, 3, 3}), {}, true);
        test::Random random(9);
        for (int i = 0; i < 1000; ++i) {
            const auto s = sky.sample(Vec3(), 0, {random.uniform(), random.uniform()}, w, 0);
            CHECK(s->radiance[0] == 3);
            CHECK(s->pdfSolidAngle == doctest::Approx(1 / (4 * kPiD)).epsilon(0.3));
        }
    }
}

TEST_CASE("a sun of 1e9 in the image leaves the rest its probability") {
    EnvironmentImage im = image(64, 32, {1, 1, 1});
    set(im, 20, 10, {1e9f, 1e9f, 1e9f});
    const EnvironmentLight sky = light(im);
    const float overhead = sky.pdfEscaped(Vec3{}, {0, 1, 0}, 0), below = sky.pdfEscaped(Vec3{}, {0, -1, 0}, 0);
    CHECK(overhead > 0);
    CHECK(overhead == doctest::Approx(below).epsilon(1e-6));
    CHECK(sky.sample(Vec3(), 0, {0.5f, 0.5f}, Wavelengths::single(550), 0)->radiance[0] > 1e8f);
}

TEST_CASE("broken images are reported") {
    const auto codes = [](EnvironmentImage im) {
        Diagnostics diagnostics;
        const bool good = checkEnvironmentImage(im, 1, {}, diagnostics);
        CHECK(good == !diagnostics.hasErrors());
        return diagnostics.all().empty() ? "" : diagnostics.all()[0].code;
    };
    CHECK(codes(image(0, 0)) == "E0440");
    CHECK(codes({2, 1, {1, 2, 3}}) == "E0440");
    CHECK(codes({1, 1, {1, NAN, 3}}) == "E0441");
    CHECK(codes({1, 1, {1, HUGE_VALF, 3}}) == "E0441");
    CHECK(codes({1, 1, {1, -2, 3}}) == "W0440");
    CHECK(codes({2, 1, {1, 1, 1, 1, 1e38f, 1}}) == "E0349");
    CHECK(codes({2, 1, {1, 1, 1, 1, 1e13f, 1}}) == "E0349");
    CHECK(codes({2, 1, {1, 1, 1, 1, 1e11f, 1}}) == "");
    CHECK(codes(image(2, 1, {1e-20f, 0, 1e-30f})) == "E0349");
    CHECK(codes(image(2, 1, {0, 0, 0})) == "");
    CHECK(codes(image(2, 1, {1, 1, 1})) == "");
    Diagnostics diagnostics;
    EnvironmentLightParams stretched;
    stretched.transform = Transform::scale({1, 2, 1});
    CHECK(makeEnvironmentLight(stretched, image(2, 1), std::make_unique<Bands>(), false, {}, diagnostics) == nullptr);
    CHECK(diagnostics.all()[0].code == "E0348");
}

TEST_CASE("amounts: luminance of a white texel, and stops") {
    EnvironmentLightParams p;
    p.luminance = schema::Quantity{1000, schema::Dimension::luminance, {}};
    p.exposure = 2;
    Diagnostics diagnostics;
    const auto sky = makeEnvironmentLight(p, image(2, 1, {1, 1, 1}), std::make_unique<Bands>(), false, {}, diagnostics);
    const SampledCurve radiance([&](double nm) {
        return sky->escaped({1, 0, 0}, Wavelengths::single(static_cast<float>(nm)), 0)[0];
    });
    CHECK(luminousIntegral(radiance) == doctest::Approx(4000).epsilon(1e-4));
}

} // namespace
} // namespace abbe
