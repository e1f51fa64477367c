// Images: the spline, what lies outside, tiles, and reading files through the module.
#include "textures/spline_image.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <functional>
#include <unistd.h>

using namespace abbe;

namespace {

// f at texel centres in texture coordinates, v upwards.
ImagePixels sampled(int width, int height, const std::function<double(double, double)>& f, int channels = 1) {
    ImagePixels image;
    image.width = width;
    image.height = height;
    image.channels = channels;
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (int c = 0; c < channels; ++c)
                image.values.push_back(static_cast<float>((c + 1) * f((x + 0.5) / width, 1 - (y + 0.5) / height)));
    return image;
}

float at(const SplineImage& t, float u, float v) { return t.jet({{}, {u, v}, {u, v}}, 1).value.x; }

struct ImageFileForTest {
    std::filesystem::path path;
    ImageFileForTest(const std::string& name, const std::string& bytes)
        : path(std::filesystem::temp_directory_path() / ("abbe_" + std::to_string(::getpid()) + name)) {
        std::ofstream(path, std::ios::binary) << bytes;
    }
    ~ImageFileForTest() { std::filesystem::remove(path); }
};

} // namespace

TEST_CASE("spline image: linear functions are exact, quadratic ones but for their known blur, with derivatives") {
    const int w = 20, h = 30;
    const SplineImage linear(sampled(
                                 w, h, [](double u, double v) { return 2 * u - 3 * v + 1; }, 3),
                             Wrap::clamp);
    const SplineImage quadratic(sampled(w, h, [](double u, double v) { return u * u + 2 * u * v - v * v; }),
                                Wrap::clamp);
    for (float u = 0.15f; u < 0.85f; u += 0.0173f)
        for (float v = 0.15f; v < 0.85f; v += 0.0231f) {
            const TextureJet a = linear.jet({{}, {u, v}, {}}, 3);
            CHECK(a.value.x == doctest::Approx(2 * u - 3 * v + 1).epsilon(1e-5));
            CHECK(a.value.z == doctest::Approx(3 * (2 * u - 3 * v + 1)).epsilon(1e-5));
            CHECK(a.byUv[0].x == doctest::Approx(2).epsilon(1e-4));
            CHECK(a.byUv[1].y == doctest::Approx(-6).epsilon(1e-4));
            // A cubic B-spline adds a sixth of the second derivative by texels.
            const TextureJet b = quadratic.jet({{}, {u, v}, {}}, 1);
            const double blur = (2.0 / (w * w) - 2.0 / (h * h)) / 6;
            CHECK(std::abs(b.value.x - (u * u + 2 * u * v - v * v + blur)) < 1e-5);
            CHECK(std::abs(b.byUv[0].x - (2 * u + 2 * v)) < 2e-4);
            CHECK(std::abs(b.byUv[1].x - (2 * u - 2 * v)) < 2e-4);
        }
}

TEST_CASE("spline image: curvature is continuous across texels") {
    const SplineImage t(sampled(8, 8, [](double u, double v) { return std::sin(17 * u) * std::cos(23 * v); }),
                        Wrap::periodic);
    float last = 0, worst = 0;
    const float step = 1e-3f;
    for (int i = 0; i < 1000; ++i) {
        const float u = static_cast<float>(i) * step;
        const auto slope = [&](float x) { return t.jet({{}, {x, 0.37f}, {}}, 1).byUv[0].x; };
        const float second = (slope(u + step) - slope(u)) / step;
        if (i > 0) worst = std::max(worst, std::abs(second - last));
        last = second;
    }
    CHECK(worst < 6); // of about 250
}

TEST_CASE("spline image: what lies outside") {
    const auto ramp = [](double u, double) { return u < 0.5 ? 0.0 : 1.0; };
    const SplineImage periodic(sampled(16, 4, ramp), Wrap::periodic), clamp(sampled(16, 4, ramp), Wrap::clamp),
        mirror(sampled(16, 4, ramp), Wrap::mirror), black(sampled(16, 4, ramp), Wrap::black);
    CHECK(at(periodic, 1.25f, 0.5f) == 0);
    CHECK(at(periodic, -0.25f, 0.5f) == doctest::Approx(1));
    CHECK(at(periodic, 3.75f, -7.5f) == doctest::Approx(1));
    CHECK(at(periodic, 0, 0.5f) == doctest::Approx(0.5)); // half of each side
    CHECK(at(clamp, 1.25f, 2) == doctest::Approx(1));
    CHECK(at(clamp, -5, 0.5f) == 0);
    CHECK(at(mirror, 1.25f, 0.5f) == doctest::Approx(1));
    CHECK(at(mirror, -0.75f, 0.5f) == doctest::Approx(1));
    CHECK(at(mirror, 1.75f, 0.5f) == 0);
    CHECK(at(black, 0.75f, 0.5f) == doctest::Approx(1));
    CHECK(at(black, 1.25f, 0.5f) == 0);
    CHECK(at(black, 0.75f, 1.9f) == 0);
    CHECK(at(periodic, 1e6f, 0.5f) == at(periodic, 0, 0.5f));
    CHECK(std::isfinite(at(periodic, NAN, INFINITY)));
}

TEST_CASE("spline image: tiles do not bleed, and the face decides on their border") {
    std::map<int, ImagePixels> tiles;
    tiles.emplace(1001, sampled(8, 8, [](double, double) { return 1.0; }));
    tiles.emplace(1002, sampled(4, 4, [](double, double) { return 2.0; }));
    tiles.emplace(1011, sampled(2, 2, [](double, double) { return 3.0; }));
    const SplineImage t(std::move(tiles));
    CHECK(at(t, 0.99f, 0.5f) == doctest::Approx(1));
    CHECK(at(t, 1.01f, 0.5f) == doctest::Approx(2));
    CHECK(at(t, 0.5f, 1.5f) == doctest::Approx(3));
    CHECK(t.jet({{}, {1, 0.5f}, {0.5f, 0.5f}}, 1).value.x == doctest::Approx(1));
    CHECK(t.jet({{}, {1, 0.5f}, {1.5f, 0.5f}}, 1).value.x == doctest::Approx(2));
    CHECK(t.jet({{}, {0.5f, 1}, {0.5f, 0.5f}}, 1).value.x == doctest::Approx(1));
}

TEST_CASE("image files are read through the module, and faults say why") {
    const ImageFileForTest good(".pgm", std::string("P5 3 2 255\n") + std::string("\x00\x33\x66\x99\xcc\xff", 6));
    const ImagePixels image = readImageFile(good.path.string());
    CHECK(image.width == 3);
    CHECK(image.height == 2);
    REQUIRE(image.values.size() == 6);
    CHECK(image.values[5] == doctest::Approx(1));
    CHECK(image.values[1] == doctest::Approx(0.2).epsilon(0.01));
    const ImageFileForTest noise(".exr", "not an image at all");
    CHECK_THROWS_AS(readImageFile(noise.path.string()), ImageFileError);
    CHECK_THROWS_AS(readImageFile("/nowhere/x.exr"), ImageFileError);
}
