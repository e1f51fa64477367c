// Real units: what comes out of a light of 1 klm is 1 klm, whatever its shape and its spectrum; the same in watts.
#include "lights/amount.h"
#include "spectrum/curve.h"
#include "support/quadrature.h"
#include "support/scene_test.h"

#include <cmath>
#include <doctest/doctest.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

namespace abbe::test {
namespace {

struct Flux {
    double lumens = 0, watts = 0;
};

// What crosses a sphere of radius 60 about the origin, seen from its inside: lights are small against it, so that 3 by
// 3 points of them suffice. The spectrum is the same in all directions; its integrals need one of them.
Flux fluxOf(const TestScene& test) {
    const Light& light = *test.scene().lights.at(0);
    constexpr float radius = 60;
    constexpr int rows = 200, columns = 200, points = 3;
    const Wavelengths at = test.scene().wavelengths.sample(0.05f); // also where the light is a line
    double crossing = 0;
    std::optional<Flux> perUnit; // of the sum over the lanes
    for (int r = 0; r < rows; ++r)
        for (int c = 0; c < columns; ++c) {
            const double z = 2 * (r + 0.5) / rows - 1, s = std::sqrt(1 - z * z), phi = 2 * kPiD * (c + 0.31) / columns;
            const Vec3 n(Vec3d{s * std::cos(phi), z, s * std::sin(phi)}), from = n * radius;
            double here = 0;
            for (std::uint32_t part = 0; part < light.parts(); ++part)
                for (int i = 0; i < points * points; ++i) {
                    const Vec2 u{(static_cast<float>(i % points) + 0.5f) / points,
                                 (static_cast<float>(i / points) + 0.5f) / points};
                    const auto sample = light.sample(from, part, u, at, 0);
                    if (!sample) continue;
                    here += static_cast<double>(sum(sample->radiance) * -dot(sample->wi, n) / sample->pdfSolidAngle);
                    if (perUnit) continue;
                    const SampledCurve curve([&](double nm) {
                        const Wavelengths one = Wavelengths::single(static_cast<float>(nm));
                        return static_cast<double>(light.sample(from, part, u, one, 0)->radiance[0]);
                    });
                    const auto total = static_cast<double>(sum(sample->radiance));
                    if (total > 0) perUnit = Flux{luminousIntegral(curve) / total, radiantIntegral(curve) / total};
                }
            crossing += here / (points * points) * 4 * kPiD * square(static_cast<double>(radius)) / (rows * columns);
        }
    if (!perUnit) return {};
    return {crossing * perUnit->lumens, crossing * perUnit->watts};
}

// A light that shines down as a cosine does, a little brighter in one plane, to be scaled by its `power`.
std::string iesFile() {
    const auto path = std::filesystem::temp_directory_path() / fmt::format("abbe_flux_{}.ies", getpid());
    std::ofstream file(path);
    file << "IESNA:LM-63-1995\nTILT=NONE\n1 -1 1 91 3 1 2 0 0 0\n1 1 10\n";
    for (int v = 0; v <= 90; ++v) file << v << (v % 10 == 9 ? "\n" : " ");
    file << "\n0 90 180\n";
    for (int h = 0; h < 3; ++h)
        for (int v = 0; v <= 90; ++v) file << (1 + 0.2 * h) * 300 * std::cos(v * kPiD / 180) << '\n';
    return path.string();
}

} // namespace

TEST_CASE("a light of 1 klm sends out 1 klm, and one of 10 W sends out 10 W") {
    const std::string ies = iesFile();
    const std::string shapes[] = {
        "light point { ",
        "light spot { toward 1 -2 0.5; angle 100 deg; inner-angle 40 deg; ",
        "light quad { size 60 30 cm; ",
        "light quad { points 0 0 0  1 0 0  1.2 1 0  0 0.7 0; two-sided on; ",
        "light disk { radius 20 cm; normal 1 2 3; ",
        "light sphere { radius 10 cm; ",
        "light sphere { transform { scale 1 2 0.5 }; radius 10 cm; ",
        "light mesh { points { - 0 0 0; - 1 0 0; - 0 1 0; - 0 0 1 }; faces { - 0 2 1; - 0 1 3; - 1 2 3; - 0 3 2 }; ",
        fmt::format("light ies \"{}\" {{ toward 1 -1 0; turn 30 deg; ", ies)};
    const std::string colors[] = {"", "color blackbody 2700 K", "color illuminant FL11", "color line 632.8",
                                  "color table 400 0  500 1  700 0.2"};
    for (const std::string& shape : shapes)
        for (const std::string& color : colors) {
            CAPTURE(shape);
            CAPTURE(color);
            const std::string end = color + " }\ncamera { }\n";
            const TestScene luminous = TestScene::parse("scene 1\n" + shape + "power 1 klm; " + end);
            const TestScene radiant = TestScene::parse("scene 1\n" + shape + "power 10 W; " + end);
            CHECK(fluxOf(luminous).lumens == doctest::Approx(1000).epsilon(1e-3));
            CHECK(fluxOf(radiant).watts == doctest::Approx(10).epsilon(1e-3));
            CHECK(radiant.scene().lights.at(0)->power() == doctest::Approx(10).epsilon(1e-5));
        }
    std::filesystem::remove(ies);
}

TEST_CASE("without `power` a photometric file says how bright its light is") {
    const std::string ies = iesFile();
    const TestScene scene =
        TestScene::parse(fmt::format("scene 1\ncamera {{ }}\nlight ies \"{}\" {{ color illuminant A }}\n", ies));
    // Planes of 1, 1.2, 1.4 and 1.2 times 300 π.
    CHECK(fluxOf(scene).lumens == doctest::Approx(1.2 * 300 * kPiD).epsilon(1e-3));
    std::filesystem::remove(ies);
}

TEST_CASE("amounts that make no light are reported where they stand") {
    const auto report = [](const std::string& light) {
        return TestScene::parse("scene 1\ncamera { }\nlight point { power 1 W }\n" + light + "\n").report();
    };
    CHECK(report("light point { power 0 lm }").find("4:1: warning[W0740]") != std::string::npos);
    CHECK(report("light quad { luminance 0 nits }").find("4:1: warning[W0740]") != std::string::npos);
    CHECK(report("light sky { radiance 0 }").find("4:1: warning[W0740]") != std::string::npos);
    CHECK(report("light point { power 800 lm; color table 400 0  700 0 }").find("4:15: error[E0343]") !=
          std::string::npos);
    CHECK(report("light point { power 1 lm }").empty());
}

} // namespace abbe::test
