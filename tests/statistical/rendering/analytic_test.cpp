// Rendered radiance against closed forms. Y is in units of constant spectral radiance: a radiance of 1 at every
// wavelength has Y = 1 (spectrum/sensor.h).
#include "spectrum/sensor.h"
#include "support/ggx_reference.h"
#include "support/quadrature.h"
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// What lm, lx and cd count of a flat spectrum of radiance (irradiance, intensity) 1 per nm.
constexpr double kLuminousScale = kLuminousEfficacy * kYIntegral;

constexpr const char* kAnalyticHeader = "scene 1\nfilm { size 16 16; filter box 0.5 }\n";

// Mean of f(point, direction from the eye) over a pixel, by a grid of rays through the scene's own camera; world space.
template <typename F> std::function<double(int, int)> overPixel(const TestScene& scene, F f, int grid = 16) {
    return [&scene, f, grid](int px, int py) {
        double sum = 0;
        for (int i = 0; i < grid * grid; ++i) {
            const Vec2 film{static_cast<float>(px + (i % grid + 0.5) / grid),
                            static_cast<float>(py + (i / grid + 0.5) / grid)};
            const CameraRay eye = scene.scene().camera->ray({film, {0.5f, 0.5f}, 0});
            SurfaceHit hit;
            REQUIRE(scene.scene().intersector->intersect(eye.ray, hit));
            sum += f(Vec3d(hit.p) + scene.scene().origin, Vec3d(eye.ray.direction));
        }
        return sum / (grid * grid);
    };
}

// Lambert's formula: irradiance at p with normal +y of a polygon of radiance 1 above the horizon.
double polygonIrradiance(const std::vector<Vec3d>& corners, Vec3d p) {
    double sum = 0;
    for (std::size_t i = 0; i < corners.size(); ++i) {
        const Vec3d a = normalize(corners[i] - p), b = normalize(corners[(i + 1) % corners.size()] - p);
        const Vec3d c = cross(a, b);
        sum += std::atan2(length(c), dot(a, b)) * c.y / length(c);
    }
    return std::abs(sum) / 2;
}

} // namespace

TEST_CASE("a light inside a matte sphere: all light that is not direct is even") {
    // Between any two patches of a sphere the form factor is the same, so after one reflection irradiance is uniform:
    // ρ Φ / (4 π R² (1 - ρ)), wherever the light is.
    const double rho = 0.6, radius = 2, intensity = 3;
    const Vec3d light{0.5, -0.25, 0.75};
    const auto scene = TestScene::parse(
        kAnalyticHeader + fmt::format("camera {{ from 0 0 1; look-at 0.3 0.2 -1; fov 70 deg }}\n"
                                      "shape sphere {{ radius {}; material diffuse {{ reflectance {} }} }}\n"
                                      "light point {{ position {} {} {}; color 1; intensity {} cd }}\n",
                                      radius, rho, light.x, light.y, light.z, intensity * kLuminousScale));
    const double even = rho * 4 * kPiD * intensity / (4 * kPiD * square(radius) * (1 - rho));
    const auto expected = overPixel(scene, [&](Vec3d p, Vec3d) {
        const Vec3d to = light - p;
        const double direct = intensity * -dot(to, p) / radius / std::pow(length(to), 3);
        return rho / kPiD * (direct + even);
    });
    const TestImage image = render(scene, 2048);
    checkSame(compareExpected(image.film, expected), 0.001);
    CHECK(image.statistics.cappedPaths == 0);
}

TEST_CASE("a quad light over a floor: Lambert's formula") {
    const auto scene = TestScene::parse(std::string(kAnalyticHeader) +
                                        "camera { from 0 1.5 6; look-at 0 0 1; fov 25 deg }\n"
                                        "shape quad { size 40 40; material diffuse { reflectance 0.7 };"
                                        "             transform { rotate x -90 deg } }\n"
                                        "light quad { points -1 2 -1  1.5 2 -1  1.5 2 0.5  -1 2 0.5; radiance 5 }\n");
    // The eye is below the light and sees the floor alone.
    const std::vector<Vec3d> corners = {{-1, 2, -1}, {1.5, 2, -1}, {1.5, 2, 0.5}, {-1, 2, 0.5}};
    const auto expected = overPixel(scene, [&](Vec3d p, Vec3d) {
        return std::abs(p.y) < 1e-3 ? 0.7 / kPiD * 5 * polygonIrradiance(corners, p) : -1;
    });
    RenderSettings settings = scene.settings();
    settings.samples = 1024;
    // One scattering is what the formula describes.
    settings.maxDepth = 1;
    for (const auto strategy :
         {Technique::Strategy::mis, Technique::Strategy::lightsOnly, Technique::Strategy::bsdfOnly}) {
        settings.technique.strategy = strategy;
        const TestImage image = render(scene, settings);
        int onLight = 0;
        const auto masked = [&](int x, int y) {
            const double v = expected(x, y);
            onLight += v < 0;
            return v;
        };
        const bool bsdf = strategy == Technique::Strategy::bsdfOnly;
        checkSame(compareExpected(image.film, masked), bsdf ? 0.01 : 0.001);
        CHECK(onLight == 0);
    }
}

TEST_CASE("sphere and disk lights over a floor") {
    const std::string floor = "camera { from 0 3 6; look-at 0 0 0; fov 30 deg }\n"
                              "shape plane { material diffuse { reflectance 0.5 } }\n";
    SUBCASE("sphere: π L (r/d)² cos θ") {
        const auto scene =
            TestScene::parse(kAnalyticHeader + floor + "light sphere { center 1 4 -1; radius 0.8; radiance 9 }");
        const auto expected = overPixel(scene, [](Vec3d p, Vec3d) {
            const Vec3d to = Vec3d{1, 4, -1} - p;
            return 0.5 * 9 * square(0.8) * to.y / std::pow(length(to), 3);
        });
        RenderSettings settings = scene.settings();
        settings.samples = 512;
        settings.maxDepth = 1;
        checkSame(compareExpected(render(scene, settings).film, expected), 0.001);
    }
    SUBCASE("disk parallel to the floor") {
        const auto scene = TestScene::parse(kAnalyticHeader + floor +
                                            "light disk { center 1 4 -1; normal 0 -1 0; radius 0.8; radiance 9 }");
        // Form factor of a disk at height h, its axis at distance a [Howell2010, B-13].
        const auto expected = overPixel(scene, [](Vec3d p, Vec3d) {
            const double a2 = square(p.x - 1) + square(p.z + 1), h2 = 16, r2 = square(0.8);
            const double s = a2 + h2 + r2;
            return 0.5 * 9 * 0.5 * (1 - (a2 + h2 - r2) / std::sqrt(s * s - 4 * r2 * a2));
        });
        RenderSettings settings = scene.settings();
        settings.samples = 512;
        settings.maxDepth = 1;
        checkSame(compareExpected(render(scene, settings).film, expected), 0.001);
    }
}

TEST_CASE("sky and sun over a plane: ρ L and ρ E cos θ / π") {
    const std::string floor = "camera { from 0 3 0.5; look-at 0 0 0; fov 60 deg }\n"
                              "shape plane { material diffuse { reflectance 0.4 } }\n";
    SUBCASE("sky") {
        for (const auto strategy : {Strategy::mis, Strategy::lightsOnly, Strategy::bsdfOnly}) {
            BuildOptions options;
            options.strategy = strategy;
            const auto scene = TestScene::parse(kAnalyticHeader + floor + "light sky { radiance 2.5 }", options);
            checkSame(compareExpected(render(scene, 512).film, [](int, int) { return 0.4 * 2.5; }), 0.001);
        }
    }
    SUBCASE("sun") {
        for (const char* diameter : {"0.53", "20", "0"}) {
            const auto scene = TestScene::parse(
                kAnalyticHeader + floor +
                fmt::format("light sun {{ elevation 40 deg; azimuth 30 deg; irradiance 1e5 lx; color 1; "
                            "angular-diameter {} deg }}",
                            diameter));
            const double expected = 0.4 * 1e5 / kLuminousScale * std::sin(40 * kPiD / 180) / kPiD;
            checkSame(compareExpected(render(scene, 256).film, [&](int, int) { return expected; }), 0.001);
        }
    }
}

TEST_CASE("a mirror 100 km away shows the sky times its Fresnel reflectance") {
    const auto scene = TestScene::parse(std::string(kAnalyticHeader) +
                                        "camera { from 0 0 0; look-at 0 0 -1; fov 0.1 deg }\n"
                                        "material metal conductor { index { n 1.3; k 2.2 } }\n"
                                        "shape quad { size 1e3 1e3; material metal;"
                                        "             transform { rotate y 50 deg; translate 0 0 -1e5 } }\n"
                                        "light sky { radiance 2 }\n");
    const auto expected = overPixel(scene, [](Vec3d p, Vec3d direction) {
        CHECK(p.z < -9.9e4);
        const double a = 50 * kPiD / 180;
        const double cosine = std::abs(direction.x * std::sin(a) + direction.z * std::cos(a));
        return 2 * referenceFresnel(cosine, 1.3, 2.2);
    });
    checkSame(compareExpected(render(scene, 128).film, expected), 0.001);
}

TEST_CASE("an absorbing slab of glass in an even sky: every order of reflection inside") {
    // R + (1 - R)² a / (1 - R a): reflected, and out on either side after any number of passes that leave a share a.
    for (const double sigma : {0.0, 0.7, 4.0}) {
        const auto scene = TestScene::parse(
            std::string(kAnalyticHeader) + "camera { from 0 0 5; look-at 0 0 0; fov 3 deg }\n" +
            fmt::format("material glass dielectric {{ ior 1.6; absorption {} }}\n", sigma) +
            "shape mesh { material glass\n"
            "  points { - -9 -9 -0.5; - 9 -9 -0.5; - 9 9 -0.5; - -9 9 -0.5; - -9 -9 0.5; - 9 -9 0.5; - 9 9 0.5;"
            "           - -9 9 0.5 }\n"
            "  faces { - 3 2 1 0; - 4 5 6 7; - 0 1 5 4; - 1 2 6 5; - 2 3 7 6; - 3 0 4 7 } }\n"
            "light sky { radiance 1 }\n");
        const auto expected = overPixel(scene, [&](Vec3d, Vec3d direction) {
            const double c = -direction.z, inside = std::sqrt(1 - (1 - c * c) / square(1.6));
            const double r = referenceFresnel(c, 1.6), a = std::exp(-sigma / inside);
            return r + square(1 - r) * a / (1 - r * a);
        });
        checkSame(compareExpected(render(scene, 4096).film, expected), 0.002);
    }
}

} // namespace abbe::test
