// What deforms while the shutter is open shows the mean of all the pictures in which it stands still.
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

constexpr const char* kHeader = "scene 1\nfilm { size 24 24; filter box 0.5 }\nlight sky { radiance 1 }\n"
                                "light sun { toward 0.3 -1 -0.6; irradiance 1 W-per-m2; color illuminant D65 }\n"
                                "camera { from 0 0.6 3; look-at 0 0 0; fov 45 deg; shutter 1 s }\n"
                                "shape floor quad { points { - -4 -0.7 4; - 4 -0.7 4; - 4 -0.7 -4; - -4 -0.7 -4 } }\n";

// A sheet of 6 x 6 points that waves: four times, the last at 1 s.
constexpr int kSide = 6;
constexpr double kTimes[] = {0, 0.25, 0.5, 1};
std::vector<Vec3d> sheet(int key) {
    std::vector<Vec3d> points;
    for (int j = 0; j < kSide; ++j)
        for (int i = 0; i < kSide; ++i) {
            const double u = 2.0 * i / (kSide - 1) - 1, v = 2.0 * j / (kSide - 1) - 1;
            points.push_back(
                {0.8 * u + 0.15 * key, 0.8 * v + 0.25 * std::sin(2 * u + 1.7 * key), 0.4 * std::cos(3 * u + key)});
        }
    return points;
}

std::vector<Vec3d> sheetAt(double time) {
    int key = 0;
    while (key < 2 && time > kTimes[key + 1]) ++key;
    const double f = (time - kTimes[key]) / (kTimes[key + 1] - kTimes[key]);
    std::vector<Vec3d> a = sheet(key);
    const std::vector<Vec3d> b = sheet(key + 1);
    for (std::size_t i = 0; i < a.size(); ++i) a[i] = a[i] * (1 - f) + b[i] * f;
    return a;
}

std::string pointsText(const std::vector<Vec3d>& points) {
    std::string text = "points {";
    for (const Vec3d p : points) text += fmt::format(" - {} {} {};", p.x, p.y, p.z);
    return text + " }";
}

std::string shape(const std::string& type, const std::string& body) {
    std::string faces;
    for (int j = 0; j + 1 < kSide; ++j)
        for (int i = 0; i + 1 < kSide; ++i) {
            const int a = j * kSide + i;
            faces += fmt::format(" - {} {} {} {};", a, a + 1, a + 1 + kSide, a + kSide);
        }
    return fmt::format("shape {} {{ faces {{{} }}\n{}\nmaterial diffuse {{ reflectance 0.3 }} }}\n", type, faces, body);
}

TestScene sceneOf(const std::string& body) {
    auto scene = TestScene::parse(kHeader + body);
    REQUIRE(scene.report() == "");
    return scene;
}

void checkMeanOfStills(const std::string& type, const std::string& more) {
    std::string keys;
    for (int k = 0; k < 4; ++k) keys += fmt::format("at {} s {{ {} }}\n", kTimes[k], pointsText(sheet(k)));
    const auto moving = sceneOf(shape(type, more + keys));
    const TestImage image = render(moving, 2048, 1);
    CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});

    constexpr int stills = 48;
    std::vector<TestImage> frames;
    for (int k = 0; k < stills; ++k)
        frames.push_back(render(sceneOf(shape(type, more + pointsText(sheetAt((k + 0.5) / stills)))), 64, 100 + k));
    const auto meanOfStills = [&](PixelBounds tile) {
        Estimate sum{0, 0, 0};
        double squares = 0;
        for (const TestImage& frame : frames) {
            const Estimate e = frame.film.tile(tile);
            sum.mean += e.mean / stills;
            sum.variance += e.variance / (stills * stills);
            squares += square(e.variance / (stills * stills)) / e.degrees;
        }
        sum.degrees = squares > 0 ? square(sum.variance) / squares : 1;
        return sum;
    };
    checkSame(compareTiles(
                  image.film.bounds(), 6, [&](PixelBounds tile) { return image.film.tile(tile); }, meanOfStills),
              0.003);
}

} // namespace

TEST_CASE("a mesh with four keys shows the mean of its still pictures") { checkMeanOfStills("mesh", ""); }

TEST_CASE("a subdivision surface with four keys shows the mean of its still pictures") {
    checkMeanOfStills("subdivision", "dicing 2\n");
}

} // namespace abbe::test
