// Lights with pictures and patterns: how much light they give, where their samples go, and that what is sampled is what
// is met.
#include "math/warp.h"
#include "render/intersector.h"
#include "spectrum/sensor.h"
#include "support/chi_square.h"
#include "support/scene_test.h"

#include <array>
#include <cmath>
#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// A light near the origin.
TestScene litScene(const std::string& text) {
    return TestScene::parse("scene 1\nfilm { size 16 16 }\ncamera { }\n" + text + "\n");
}

const std::string kShapes[] = {
    "light quad { size 60 30 cm; ",
    "light quad { points 0 0 0  1 0 0  1.2 1 0  0 0.7 0; ",
    "light quad { size 60 30 cm; two-sided on; transform { scale -1 2 1; rotate y 30 deg }; ",
    "light disk { radius 20 cm; normal 1 2 3; ",
    "light sphere { radius 10 cm; ",
    "light sphere { transform { scale 1 2 0.5 }; radius 10 cm; ",
    "light mesh { points { - 0 0 0; - 1 0 0; - 0 1 0; - 0 0 1 }; faces { - 0 2 1; - 0 1 3; - 1 2 3; - 0 3 2 }; "};
const std::string kTextures[] = {
    "texture checker { even rgb 1 0.3 0.1; odd 0; scale 6 }",
    "texture checker { even 1; odd rgb 0.05 0.1 0.4; scale 7 cm }",
    "texture product { first noise { scale 5 cm; seed 4 }; second ramp { over x; stop -0.1 rgb 1 0.2 0.1; stop 0.1 "
    "rgb 0.1 0.2 1 } }"};

// Images and checkers over uv need texture coordinates; cubes must not end where a flat shape lies.
bool possible(const std::string& shape, const std::string& texture) {
    const bool mesh = shape.find("mesh") != std::string::npos, flat = shape.find("rotate") != std::string::npos;
    return !(mesh && texture.find("scale 6 ") != std::string::npos) &&
           !(flat && texture.find("7 cm") != std::string::npos);
}

// What crosses a sphere of radius 40 about the origin, in lumens and watts.
struct TexturedFlux {
    double lumens = 0, watts = 0;
};
const SurfaceLight& surfaceOf(const Light& light) { return dynamic_cast<const SurfaceLight&>(light); }

TexturedFlux fluxOf(const Light& light, int samples = 60000) {
    constexpr float radius = 40;
    // An R₅ sequence: far more even than random points.
    constexpr std::array<double, 5> kSteps{0.8812714616335696, 0.7766393890897682, 0.6844301295853426,
                                           0.6031687406857282, 0.5315553977157913};
    TexturedFlux flux;
    for (int i = 0; i < samples; ++i) {
        std::array<float, 5> u;
        for (std::size_t k = 0; k < 5; ++k)
            u[k] = std::min(static_cast<float>(std::fmod(0.5 + kSteps[k] * i, 1.0)), kOneMinusEpsilon);
        const Vec3 n = squareToSphere({u[0], u[1]});
        const Wavelengths lambda = Wavelengths::sample(u[2]);
        for (std::uint32_t part = 0; part < light.parts(); ++part) {
            const auto s = light.sample(n * radius, part, {u[3], u[4]}, lambda, 0);
            if (!s) continue;
            const Spectrum crossing = s->radiance * (-dot(s->wi, n) * 4 * kPi * radius * radius / s->pdfSolidAngle);
            flux.lumens += kLuminousEfficacy * kYIntegral * toXyz(crossing, lambda).y / samples;
            flux.watts += static_cast<double>(mean(crossing / lambda.pdf)) / samples;
        }
    }
    return flux;
}

// A hundredth would be seen.
void agrees(double got, double expected) { CHECK(got == doctest::Approx(expected).epsilon(0.006)); }

} // namespace

TEST_CASE("a light with a texture, of 1 klm or 10 W, sends out 1 klm or 10 W") {
    for (const std::string& shape : kShapes)
        for (const std::string& texture : kTextures) {
            if (!possible(shape, texture)) continue;
            for (const char* color : {"", "color blackbody 2700 K; "}) {
                if (*color && !nightly() && &shape != kShapes) continue;
                const std::string text = shape + color + texture;
                CAPTURE(text);
                const TestScene luminous = litScene(text + "; power 1 klm }");
                agrees(fluxOf(*luminous.scene().lights.at(0)).lumens, 1000);
                if (&texture != kTextures && !nightly()) continue;
                const TestScene radiant = litScene(text + "; power 10 W }");
                agrees(fluxOf(*radiant.scene().lights.at(0)).watts, 10);
                CHECK(radiant.scene().lights.at(0)->power() == doctest::Approx(10).epsilon(1e-4));
            }
        }
}

TEST_CASE("a screen with a picture sends out the light that was asked for") {
    const std::string picture = "texture image \"scenes/textures/textures.png\"; size 2 1; ";
    agrees(fluxOf(*litScene("light quad { " + picture + "power 1 klm }").scene().lights.at(0)).lumens, 1000);
    agrees(fluxOf(*litScene("light quad { " + picture + "power 10 W; color blackbody 2700 K }").scene().lights.at(0))
               .watts,
           10);
}

TEST_CASE("luminance and radiance are those where the texture is white") {
    // Half of the area is white: half of the flux of a plain one, π L A.
    const TestScene half =
        litScene("light quad { size 2 1; luminance 100 nits; texture checker { even 1; odd 0; scale 2 } }");
    agrees(fluxOf(*half.scene().lights.at(0)).lumens, 100 * kPiD);
    const TestScene absolute = litScene("light quad { size 2 1; radiance checker { even 0.5; odd 0; scale 2 } }");
    agrees(fluxOf(*absolute.scene().lights.at(0)).watts, 0.25 * 470 * kPiD * 2);
    const TestScene shape = litScene("shape quad { size 2 1; emission checker { even 0.5; odd 0.1; scale 2 } }");
    agrees(fluxOf(*shape.scene().lights.at(0)).watts, 0.3 * 470 * kPiD * 2);
    const TestScene material = litScene("shape quad { size 2 1; material openpbr { emission-luminance 100 nits; "
                                        "emission-color checker { even 1; odd 0; scale 2 } } }");
    agrees(fluxOf(*material.scene().lights.at(0)).lumens, 100 * kPiD);
    // A colour where it is one: its flux is that of the plain light of that colour.
    const auto lumens = [](const std::string& text) { return fluxOf(*litScene(text).scene().lights.at(0)).lumens; };
    const double plain = lumens("light quad { radiance rgb 1 0.5 0.2 }"),
                 white = lumens("light quad { radiance rgb 1 1 1 }");
    const double filtered = lumens("light quad { luminance 10 nits; texture ramp { stop 0 rgb 1 0.5 0.2 } }");
    const double unfiltered = lumens("light quad { luminance 10 nits; texture ramp { stop 0 1 } }");
    CHECK(filtered / unfiltered == doctest::Approx(plain / white).epsilon(0.005));
}

TEST_CASE("samples of a light with a texture are met as they are, with the density that they were made with") {
    std::uint64_t seed = 40;
    for (const std::string& shape : kShapes)
        for (const std::string& texture : kTextures) {
            if (!possible(shape, texture)) continue;
            CAPTURE(shape);
            CAPTURE(texture);
            const TestScene test = litScene(shape + texture + "; radiance 1 }");
            const Light& light = *test.scene().lights.at(0);
            Random random(++seed);
            int met = 0, different = 0;
            for (int i = 0; i < 3000; ++i) {
                const Vec3 to = squareToSphere({random.uniform(), random.uniform()});
                const Receiver from = i % 2 ? Receiver(to * (0.7f + 2 * random.uniform()))
                                            : Receiver(to * (0.7f + 2 * random.uniform()), -to, false);
                const auto part = static_cast<std::uint32_t>(random.uniform() * static_cast<float>(light.parts()));
                const Wavelengths lambda = Wavelengths::sample(random.uniform());
                const auto s = light.sample(from, part, {random.uniform(), random.uniform()}, lambda, 0);
                if (!s) continue;
                CHECK(std::isfinite(s->pdfSolidAngle));
                SurfaceHit hit;
                Ray ray;
                ray.origin = from.p;
                ray.direction = s->wi;
                if (!test.scene().intersector->intersect(ray, hit) || light.partOf(hit) != part) continue;
                if (std::abs(hit.distance - s->distance) > 1e-3f * s->distance) continue; // behind its own front
                ++met;
                const float pdf = surfaceOf(light).pdfSolidAngle(from, hit, 0);
                const Spectrum emitted = surfaceOf(light).emitted(hit, -s->wi, lambda);
                different += std::abs(pdf / s->pdfSolidAngle - 1) > 5e-3f ||
                             std::abs(sum(emitted) - sum(s->radiance)) > 0.01f * sum(s->radiance) + 1e-3f;
            }
            CHECK(met > 300);
            CHECK(different <= met / 150); // on the borders of squares and cells
        }
}

TEST_CASE("points on a screen follow their density: χ² over its texture coordinates") {
    // 2 by 1 in the plane z = 0, bright in one corner and black in another.
    const char* const text =
        "light quad { size 2 1; radiance 1; texture product { first ramp { over u; stop 0.3 0; stop "
        "1 1 }; second checker { even 1; odd 0.02; scale 4 } } }";
    const TestScene test = litScene(text);
    const Light& light = *test.scene().lights.at(0);
    const Vec3 origin(test.scene().origin); // render space lies about it
    std::uint64_t seed = 90;
    for (const Receiver& from : {Receiver(Vec3{0.2f, 0.1f, 0.4f} - origin), Receiver(Vec3{3, 1, 5} - origin),
                                 Receiver(Vec3{-0.5f, -1.5f, 0.2f} - origin, Vec3{0, 1, 0}, false)}) {
        constexpr int kColumns = 24, kRows = 12, kFine = 6;
        const int samples = chiSquareSamples();
        std::vector<double> observed(kColumns * kRows, 0), expected(kColumns * kRows, 0);
        Random random(++seed);
        int lost = 0;
        for (int i = 0; i < samples; ++i) {
            const auto s = light.sample(from, 0, {random.uniform(), random.uniform()}, Wavelengths::single(550), 0);
            if (!s) {
                ++lost;
                continue;
            }
            const Vec3 p = from.p + s->wi * s->distance + origin;
            const int column = std::clamp(static_cast<int>((p.x + 1) / 2 * kColumns), 0, kColumns - 1);
            const int row = std::clamp(static_cast<int>((p.y + 0.5f) * kRows), 0, kRows - 1);
            observed[static_cast<std::size_t>(row * kColumns + column)] += 1;
        }
        double total = 0;
        for (int y = 0; y < kRows * kFine; ++y)
            for (int x = 0; x < kColumns * kFine; ++x) {
                SurfaceHit hit;
                hit.uv = {(static_cast<float>(x) + 0.5f) / (kColumns * kFine),
                          (static_cast<float>(y) + 0.5f) / (kRows * kFine)};
                hit.p = Vec3{2 * hit.uv.x - 1, hit.uv.y - 0.5f, 0} - origin;
                hit.ng = {0, 0, 1};
                const Vec3 d = hit.p - from.p;
                const double perArea =
                    static_cast<double>(surfaceOf(light).pdfSolidAngle(from, hit, 0) * std::abs(d.z)) /
                    std::pow(static_cast<double>(length(d)), 3);
                const double share = perArea * 2 / (kColumns * kRows * kFine * kFine);
                total += share;
                expected[static_cast<std::size_t>(y / kFine * kColumns + x / kFine)] += share * samples;
            }
        CHECK(total == doctest::Approx(1 - static_cast<double>(lost) / samples).epsilon(0.01));
        const ChiSquareResult result = chiSquareTest(observed, expected);
        CAPTURE(result.statistic);
        CAPTURE(result.degrees);
        CHECK(result.pValue > 1e-4);
    }
}

TEST_CASE("a light that is black nearly everywhere is found by its samples; one that is black is left out (case 35)") {
    const char* const spot = "light quad { size 2 1; power 100 lm; texture ramp { over u; stop 0.96 0; stop 0.97 1 } }";
    const TestScene test = litScene(spot);
    const Light& light = *test.scene().lights.at(0);
    Random random(3);
    int lit = 0;
    for (int i = 0; i < 1000; ++i) {
        const auto s =
            light.sample(Vec3{0, 0, 5}, 0, {random.uniform(), random.uniform()}, Wavelengths::single(550), 0);
        lit += s && s->radiance[0] > 0;
    }
    CHECK(lit > 450); // by the shape alone: some 35
    for (const char* amount : {"power 1 klm", "luminance 10 nits", "radiance 1"}) {
        const TestScene black = litScene(fmt::format(
            "light quad {{ {}; texture checker {{ even 0; odd 0 }} }}\nlight point {{ position 0 0 5; power 1 lm }}",
            amount));
        CHECK(black.report().find("4:1: warning[W0740]") != std::string::npos);
        CHECK(black.scene().lights.at(0)->power() == 0);
        const TestImage image = render(black, 8);
        CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
    }
    CHECK(litScene("light quad { radiance checker { }; texture noise { } }").report().find("E0755") !=
          std::string::npos);
    CHECK(litScene("light mesh { points { - 0 2 0; - 1 2 0; - 0 2 1 }; faces { - 0 1 2 }; radiance checker { } }")
              .report()
              .find("E0733") != std::string::npos);
}

TEST_CASE("polygons of a light are chosen by the light of their texture, and none is forgotten") {
    const TestScene test = litScene(
        "light mesh { points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 1 0; - 0 0 2; - 1 0 2; - 1 1 2; - 0 1 2 }; "
        "faces { - 0 1 2; - 0 2 3; - 4 5 6 7 }; luminance 100 nits; texture ramp { over z; stop 0.9 0.1; stop 1 1 } }");
    const Light& light = *test.scene().lights.at(0);
    REQUIRE(light.parts() == 3);
    double total = 0;
    for (std::uint32_t part = 0; part < 3; ++part) total += static_cast<double>(light.bounds(part)->power);
    CHECK(total == doctest::Approx(light.visiblePower()).epsilon(1e-3));
    CHECK(static_cast<double>(light.bounds(2)->power) / total == doctest::Approx(10 / 11.0).epsilon(0.02));
    const TestScene dark = litScene(
        "light mesh { points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 1 0; - 0 0 2; - 1 0 2; - 1 1 2; - 0 1 2 }; "
        "faces { - 0 1 2; - 0 2 3; - 4 5 6 7 }; luminance 100 nits; texture ramp { over z; stop 0.9 0; stop 1 1 } }");
    CHECK(dark.scene().lights.at(0)->bounds(0)->power > 0);
}

} // namespace abbe::test
