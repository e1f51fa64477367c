// Patterns: exact spectra, means over the footprint against brute force, slopes, and extreme places.
#include "math/frame.h"
#include "spectrum/curve.h"
#include "support/statistics.h"
#include "textures/channel_texture.h"
#include "textures/checker_texture.h"
#include "textures/noise_texture.h"
#include "textures/placed_texture.h"
#include "textures/product_texture.h"
#include "textures/ramp_texture.h"
#include "textures/triplanar_texture.h"

#include <doctest/doctest.h>
#include <functional>

using namespace abbe;
using test::Random;

namespace {

const ConstantCurve kDark(0.1), kBright(0.7);

schema::TexturedSpectrum of(const Curve& c) { return {&c, nullptr, {}}; }
schema::TexturedSpectrum of(const Texture& t) { return {nullptr, &t, {}}; }

TextureQuery at(Vec2 uv, Vec3 p = {}) { return {uv, p}; }

CheckerTexture checker(double scale, schema::Dimension d = schema::Dimension::none) {
    CheckerTextureParams p;
    p.even = of(kDark);
    p.odd = of(kBright);
    p.scale.value = scale;
    p.scale.dimension = d;
    return CheckerTexture(p);
}

// The mean over points of the footprint: of the box in uv for half widths, or of a ball.
double meanOverBox(const Texture& t, const TextureQuery& q, Vec2 half, int samples, Random& random) {
    double sum = 0;
    for (int i = 0; i < samples; ++i) {
        const float a = 2 * random.uniform() - 1, b = 2 * random.uniform() - 1;
        sum += static_cast<double>(t.value(at({q.uv.x + a * half.x, q.uv.y + b * half.y})).x);
    }
    return sum / samples;
}

} // namespace

TEST_CASE("checker: squares and cubes, exact values and spectra") {
    const CheckerTexture flat = checker(4);
    CHECK(flat.value(at({0.1f, 0.1f})).x == 0.1f);
    CHECK(flat.value(at({0.3f, 0.1f})).x == 0.7f);
    CHECK(flat.value(at({0.3f, 0.3f})).x == 0.1f);
    CHECK(flat.value(at({-0.1f, 0.1f})).x == 0.7f);
    CHECK(flat.value(at({-0.1f, -0.1f})).x == 0.1f);
    CHECK(flat.needsUv());
    const CheckerTexture solid = checker(0.5, schema::Dimension::length);
    CHECK(!solid.needsUv());
    CHECK(solid.value(at({}, {0.2f, 0.2f, 0.2f})).x == 0.1f);
    CHECK(solid.value(at({}, {0.7f, 0.2f, 0.2f})).x == 0.7f);
    CHECK(solid.value(at({}, {0.7f, 0.7f, 0.2f})).x == 0.1f);
    CHECK(solid.value(at({}, {0.7f, 0.7f, -0.2f})).x == 0.7f);

    const SampledCurve green([](double nm) { return nm < 500 ? 0.1 : 0.6; });
    CheckerTextureParams p;
    p.even = of(green);
    const Wavelengths lambda = Wavelengths::sample(0.37f);
    const Spectrum s = CheckerTexture(p).spectrum(at({0.01f, 0.01f}), lambda), wanted = green.at(lambda);
    for (int i = 0; i < kLanes; ++i) CHECK(s[i] == wanted[i]);
}

TEST_CASE("checker: the mean over the footprint, from a point to far away") {
    const CheckerTexture t = checker(3);
    Random random(2);
    for (int i = 0; i < 60; ++i) {
        TextureQuery q = at({3 * random.uniform(), 3 * random.uniform()});
        const float size = std::exp(6 * random.uniform() - 4.5f);
        q.du = {size, 0.3f * size};
        q.dv = {-0.1f * size, 0.2f * size};
        const Vec2 half{static_cast<float>(boxHalfWidth(q.du.x, q.dv.x)),
                        static_cast<float>(boxHalfWidth(q.du.y, q.dv.y))};
        CHECK(std::abs(static_cast<double>(t.value(q).x) - meanOverBox(t, q, half, 20000, random)) < 0.01);
    }
    TextureQuery far = at({0.2f, 0.1f});
    far.du = {1e4f, 0};
    far.dv = {0, 1e4f};
    CHECK(t.value(far).x == doctest::Approx(0.4).epsilon(1e-4));
    far.du = {1e30f, 0};
    CHECK(t.value(far).x == doctest::Approx(0.4).epsilon(1e-4));
    const CheckerTexture cubes = checker(0.1, schema::Dimension::length);
    TextureQuery q = at({}, {0.02f, 0.3f, 0.7f});
    q.radius = 30;
    CHECK(cubes.value(q).x == doctest::Approx(0.4).epsilon(1e-3));
    // A floor near the side of cubes shows their squares: no part of the footprint is above or below it.
    q = at({}, {0.05f, 0.001f, 0.05f});
    q.normal = {0, 1, 0};
    q.radius = 0.02f;
    CHECK(cubes.value(q).x == doctest::Approx(0.1));
}

TEST_CASE("checker: texture coordinates of a million, and no number at all (cases 45 and 77)") {
    const CheckerTexture t = checker(8);
    // One square is 1/8; floats near 2^19 know a sixteenth.
    for (const float base : {0.f, 524288.f, -524288.f}) {
        CHECK(t.value(at({base + 0.0625f, base + 0.0625f})).x == 0.1f);
        CHECK(t.value(at({base + 0.1875f, base + 0.0625f})).x == 0.7f);
        TextureQuery wide = at({base + 0.0625f, base + 0.0625f});
        wide.du = {1e-4f, 0};
        wide.dv = {0, 1e-4f};
        CHECK(t.value(wide).x == doctest::Approx(0.1));
    }
    for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(), 3e38f}) {
        CHECK(std::isfinite(t.value(at({bad, 0.1f})).x));
        CHECK(std::isfinite(checker(0.1, schema::Dimension::length).value(at({}, {bad, 0, 0})).x));
    }
}

TEST_CASE("ramp: linear between its stops, steps, ends, spectra, and the mean over the footprint") {
    const ConstantCurve zero(0), half(0.5), one(1);
    using Over = RampTexture::Over;
    const RampTexture t({{0, of(zero)}, {0.5, of(one)}, {0.5, of(half)}, {1, of(zero)}}, Over::u);
    CHECK(t.value(at({0.25f, 9})).x == doctest::Approx(0.5));
    CHECK(t.value(at({0.499f, 9})).x == doctest::Approx(0.998));
    CHECK(t.value(at({0.501f, 9})).x == doctest::Approx(0.499));
    CHECK(t.value(at({-3, 9})).x == 0);
    CHECK(t.value(at({7, 9})).x == 0);
    Random random(4);
    for (int i = 0; i < 40; ++i) {
        TextureQuery q = at({2 * random.uniform() - 0.5f, 0});
        q.du = {0.4f * random.uniform(), 0};
        const auto width = static_cast<float>(boxHalfWidth(q.du.x, 0));
        CHECK(std::abs(static_cast<double>(t.value(q).x) - meanOverBox(t, q, {width, 0}, 20000, random)) < 0.01);
    }
    const SampledCurve red([](double nm) { return nm / 1000; }), blue([](double nm) { return 0.9 - nm / 1000; });
    const RampTexture colours({{2, of(red)}, {4, of(blue)}}, Over::y);
    const Wavelengths lambda = Wavelengths::sample(0.21f);
    const Spectrum s = colours.spectrum(at({}, {0, 3.5f, 0}), lambda), a = red.at(lambda), b = blue.at(lambda);
    for (int i = 0; i < kLanes; ++i) CHECK(s[i] == doctest::Approx(0.25f * a[i] + 0.75f * b[i]));
    for (const float bad : {std::numeric_limits<float>::infinity(), std::numeric_limits<float>::quiet_NaN(), -3e38f}) {
        CHECK(std::isfinite(t.value(at({bad, 0})).x));
        CHECK(std::isfinite(colours.value(at({}, {0, bad, 0})).x));
    }
    const RampTexture single({{0.3, of(half)}}, Over::v);
    CHECK(single.value(at({5, 5})).x == 0.5f);
}

TEST_CASE("ramp over another texture, and products: values and slopes") {
    const ConstantCurve low(0.2), high(0.9);
    const NoiseTexture noise({0.5, 3, 2, 0.5, 7});
    const RampTexture over({{0.3, of(low)}, {0.7, of(high)}}, RampTexture::Over::input, {0, &noise, {}});
    const RampTexture along({{-1, of(low)}, {1, of(noise)}}, RampTexture::Over::x);
    ProductTextureParams p;
    p.first = of(over);
    p.second = of(along);
    const ProductTexture product(p);
    Random random(6);
    for (int i = 0; i < 50; ++i) {
        const Vec3d place(random.uniformDouble() - 0.5, random.uniformDouble(), random.uniformDouble());
        const TextureQuery q = at({}, Vec3(place));
        const float n = noise.value(q).x;
        CHECK(over.value(q).x == doctest::Approx(0.2 + 0.7 * std::clamp((n - 0.3) / 0.4, 0.0, 1.0)).epsilon(1e-5));
        CHECK(product.value(q).x == doctest::Approx(over.value(q).x * along.value(q).x));
        for (const Texture* t : {static_cast<const Texture*>(&over), static_cast<const Texture*>(&along),
                                 static_cast<const Texture*>(&product)}) {
            const TextureJet j = t->jet({place, {}, {}}, 1);
            CHECK(j.value.x == doctest::Approx(t->value(q).x).epsilon(1e-5));
            const double h = 1e-3;
            const auto value = [&](double x) {
                return static_cast<double>(t->jet({{x, place.y, place.z}, {}, {}}, 1).value.x);
            };
            const double slope = (value(place.x + h) - value(place.x - h)) / (2 * h);
            CHECK(std::abs(slope - static_cast<double>(j.byPosition[0].x)) < 0.03 + 0.02 * std::abs(slope));
        }
    }
}

TEST_CASE("ramp: a number as its input is the place that is looked up, everywhere") {
    const ConstantCurve zero(0), one(1);
    RampTextureParams p;
    p.stops = {{0, of(zero)}, {1, of(one)}};
    p.input = {0.25, nullptr, Span{FileId{0}, 1, 5}};
    Diagnostics diagnostics;
    const auto t = makeRampTexture(p, diagnostics);
    REQUIRE(t);
    CHECK(!t->needsUv());
    CHECK(t->value(at({0.75f, 0.5f})).x == doctest::Approx(0.25));
    CHECK(t->jet({{0.75, 0, 0}, {0.75f, 0.5f}, {}}, 1).value.x == doctest::Approx(0.25));
    p.input = {};
    CHECK(makeRampTexture(p, diagnostics)->value(at({0.75f, 0.5f})).x == doctest::Approx(0.75));
}

TEST_CASE("noise: the mean over the footprint is what averaging gives, and nothing is left far away") {
    const NoiseTexture noise({0.1, 5, 2, 0.6, 3});
    Random random(8);
    for (const float radius : {0.005f, 0.02f, 0.05f}) {
        double filtered = 0, unfiltered = 0, variance = 0;
        const int places = 150;
        for (int i = 0; i < places; ++i) {
            const Vec3 p{10 * random.uniform(), 10 * random.uniform(), 10 * random.uniform()};
            const Vec3 x = normalize(Vec3{random.uniform(), random.uniform(), random.uniform()});
            const Frame frame = Frame::fromNormal(x);
            double mean = 0;
            const int n = 400;
            for (int k = 0; k < n; ++k) {
                const float r = radius * std::sqrt(random.uniform()), phi = 2 * kPi * random.uniform();
                mean += static_cast<double>(
                            noise.value(at({}, p + frame.x * (r * std::cos(phi)) + frame.y * (r * std::sin(phi)))).x) /
                        n;
            }
            TextureQuery q = at({}, p);
            const double point = static_cast<double>(noise.value(q).x);
            q.radius = radius;
            filtered += square(static_cast<double>(noise.value(q).x) - mean) / places;
            unfiltered += square(point - mean) / places;
            variance += square(mean - 0.5) / places;
        }
        MESSAGE("radius " << radius << ": rms " << std::sqrt(filtered) << ", unfiltered " << std::sqrt(unfiltered)
                          << ", of the mean itself " << std::sqrt(variance));
        CHECK(filtered < 0.3 * unfiltered);
    }
    TextureQuery far = at({}, {0.31f, 0.2f, 0.7f});
    far.radius = 5;
    CHECK(noise.value(far).x == 0.5f);
    const TextureQuery point = at({}, {0.31f, 0.2f, 0.7f});
    CHECK(noise.value(point) == noise.jet({Vec3d(point.position), {}, {}}, 3).value);
    CHECK(noise.spectrum(point, Wavelengths::single(550))[0] == noise.value(point).x);
}

TEST_CASE("triplanar: each side shows the whole pattern, blends sum to one, scale is in metres") {
    const ConstantCurve zero(0), one(1), half(0.5);
    const RampTexture u({{0, of(zero)}, {1, of(one)}}, RampTexture::Over::u);
    TriplanarTextureParams p;
    p.map = of(u);
    p.scale = 2;
    const TriplanarTexture t(p);
    CHECK(!t.needsUv());
    TextureQuery q = at({}, {0.5f, 1.2f, 0.8f});
    q.normal = {0, 0, 1};
    CHECK(t.value(q).x == doctest::Approx(0.25)); // x / scale
    q.normal = {0, 1, 0};
    CHECK(t.value(q).x == doctest::Approx(0.25));
    q.normal = {-1, 0, 0};
    CHECK(t.value(q).x == doctest::Approx(0.4)); // z / scale
    p.map = of(half);
    const TriplanarTexture even(p);
    Random random(9);
    for (int i = 0; i < 100; ++i) {
        q.normal = normalize(Vec3{random.uniform(), random.uniform(), random.uniform()} - Vec3{0.5f, 0.5f, 0.5f});
        CHECK(even.value(q).x == doctest::Approx(0.5));
    }
    // The footprint goes along: 100 m across, a checker of 1/8 · 2 m is grey.
    const CheckerTexture squares = checker(8);
    p.map = of(squares);
    q.radius = 100;
    CHECK(TriplanarTexture(p).value(q).x == doctest::Approx(0.4).epsilon(1e-2));
    Diagnostics diagnostics;
    CHECK(TriplanarTexture(p).prepare(TextureUse::number, {}, diagnostics));
    CHECK(!TriplanarTexture(p).prepare(TextureUse::heights, {}, diagnostics));
    CHECK(diagnostics.all()[0].code == "E0736");
}

TEST_CASE("a coloured spectrum that is asked for a number is taken at 550 nm, with a warning") {
    const SampledCurve green([](double nm) { return nm < 500 ? 0.1 : 0.6; });
    CheckerTextureParams p;
    p.even = of(green);
    CheckerTexture t(p);
    Diagnostics diagnostics;
    CHECK(t.prepare(TextureUse::reflectance, {}, diagnostics));
    CHECK(diagnostics.all().empty());
    CHECK(t.prepare(TextureUse::number, {}, diagnostics));
    CHECK(diagnostics.all().at(0).code == "W0730");
    CHECK(t.value(at({0.01f, 0.01f})).x == doctest::Approx(green.at(550.0)));
}

namespace {

// Three linear functions of u and v, which change with the place as well.
class Ramps final : public Texture {
  public:
    int channels() const override { return 3; }
    bool needsUv() const override { return true; }
    TextureJet jet(const TexturePoint& p, int) const noexcept override {
        TextureJet j;
        j.value = {p.uv.x, 2 * p.uv.y, static_cast<float>(3 * p.position.x)};
        j.byUv = {Vec3(1, 0, 0), Vec3(0, 2, 0)};
        j.byPosition[0] = {0, 0, 3};
        return j;
    }
};

} // namespace

TEST_CASE("placed: coordinates are scaled, turned and moved, slopes by the chain rule") {
    const Ramps ramps;
    PlacedTextureParams p;
    p.map = of(ramps);
    p.scale = {2, 3};
    p.rotate = kPiD / 6;
    p.offset = {0.25, -0.5};
    const PlacedTexture texture(p);
    const double c = std::cos(p.rotate), s = std::sin(p.rotate), u = 0.3, v = 0.7;
    const double x = c * 2 * u - s * 3 * v + 0.25, y = s * 2 * u + c * 3 * v - 0.5;
    const Vec3 value = texture.value(at({0.3f, 0.7f}, {5, 0, 0}));
    CHECK(value.x == doctest::Approx(x));
    CHECK(value.y == doctest::Approx(2 * y));
    CHECK(value.z == doctest::Approx(15));
    const TextureJet j = texture.jet({{5, 0, 0}, {0.3f, 0.7f}, {}}, 3);
    CHECK(j.value == value);
    CHECK(j.byUv[0].x == doctest::Approx(2 * c));
    CHECK(j.byUv[0].y == doctest::Approx(2 * 2 * s));
    CHECK(j.byUv[1].x == doctest::Approx(-3 * s));
    CHECK(j.byUv[1].y == doctest::Approx(2 * 3 * c));
    CHECK(j.byPosition[0] == Vec3(0, 0, 3));
}

TEST_CASE("placed: the mean over a footprint is that of the texture over the footprint's image") {
    const CheckerTexture squares = checker(1);
    PlacedTextureParams p;
    p.map = of(squares);
    p.scale = {3, 0.5};
    p.rotate = 0.4;
    const PlacedTexture texture(p);
    // Of a circle: an ellipse with half axes 3 r and 0.5 r, turned like the picture.
    TextureQuery q = at({0.37f, 0.81f}), image = q;
    q.du = {0.2f, 0};
    q.dv = {0, 0.2f};
    const double c = std::cos(0.4), s = std::sin(0.4);
    const auto single = [](double a, double b) { return Vec2{static_cast<float>(a), static_cast<float>(b)}; };
    image.uv = single(c * 3 * 0.37 - s * 0.5 * 0.81, s * 3 * 0.37 + c * 0.5 * 0.81);
    image.du = single(c * 0.6, s * 0.6);
    image.dv = single(-s * 0.1, c * 0.1);
    CHECK(texture.value(q).x == doctest::Approx(squares.value(image).x).epsilon(1e-4));
    // Conjugate half diameters that are not at right angles span the same ellipse.
    TextureQuery slanted = q;
    slanted.du = {0.2f * std::cos(1.f), 0.2f * std::sin(1.f)};
    slanted.dv = {-0.2f * std::sin(1.f), 0.2f * std::cos(1.f)};
    CHECK(texture.value(slanted).x == doctest::Approx(texture.value(q).x).epsilon(1e-4));
}

TEST_CASE("channel: one of three, with its slopes; of a single channel that one") {
    const Ramps ramps;
    const TextureQuery q = at({0.3f, 0.7f}, {0.1f, 0, 0});
    const float expected[] = {0.3f, 1.4f, 0.3f};
    for (const ColorChannel taken : {ColorChannel::red, ColorChannel::green, ColorChannel::blue}) {
        const ChannelTexture texture(ramps, taken);
        const auto i = static_cast<std::size_t>(taken);
        CHECK(texture.channels() == 1);
        CHECK(texture.value(q).x == doctest::Approx(expected[i]));
        const TextureJet j = texture.jet({{0.1, 0, 0}, {0.3f, 0.7f}, {}}, 1);
        CHECK(j.value.x == doctest::Approx(expected[i]));
        CHECK(j.byUv[0].x == (i == 0 ? 1.f : 0.f));
        CHECK(j.byUv[1].x == (i == 1 ? 2.f : 0.f));
        CHECK(j.byPosition[0].x == (i == 2 ? 3.f : 0.f));
        const ChannelTexture again(texture, ColorChannel::blue);
        CHECK(again.value(q).x == texture.value(q).x);
        CHECK(again.jet({{0.1, 0, 0}, {0.3f, 0.7f}, {}}, 1).value.x == j.value.x);
    }
}
