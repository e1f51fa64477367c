// Skies through windows: the image with portals is that without, and has less noise; turned environments.
#include "support/environment_file.h"
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fmt/format.h>
#include <unistd.h>

namespace abbe::test {
namespace {

// A bright blue sky with a sun of a few texels, and a dark ground.
std::string skyFile(int width, int height) {
    const auto path = std::filesystem::temp_directory_path() / fmt::format("abbe_portal_{}.exr", getpid());
    writeEnvironment(path.string(), width, height, [&](int x, int y) -> std::array<float, 3> {
        if (std::abs(x - width / 2) < 2 && std::abs(y - height / 4) < 2) return {900, 800, 600};
        if (y < height / 2) return {0.6f, 0.8f, 1.2f + 0.01f * static_cast<float>(x)};
        return {0.1f, 0.1f, 0.05f};
    });
    return path.string();
}

// A room of 5 by 3 by 6 metres with a window of 2 by 1.2 in one wall.
std::string room(const std::string& environment) {
    const auto quad = [](const char* points) {
        return fmt::format("shape quad {{ points {}; material diffuse {{ reflectance 0.5 }} }}\n", points);
    };
    return "scene 1\nfilm { size 16 12; filter box 0.5 }\ncamera { from -1.8 1.7 2.6; look-at 0.8 0.6 -1; fov 60 deg "
           "}\n" +
           environment + quad("-2.5 0 3  2.5 0 3  2.5 0 -3  -2.5 0 -3") +
           quad("-2.5 3 -3  2.5 3 -3  2.5 3 3  -2.5 3 3") + quad("-2.5 0 3  -2.5 0 -3  -2.5 3 -3  -2.5 3 3") +
           quad("2.5 0 -3  2.5 0 3  2.5 3 3  2.5 3 -3") + quad("2.5 0 3  -2.5 0 3  -2.5 3 3  2.5 3 3") +
           quad("-2.5 0 -3  2.5 0 -3  2.5 1 -3  -2.5 1 -3") + quad("-2.5 2.2 -3  2.5 2.2 -3  2.5 3 -3  -2.5 3 -3") +
           quad("-2.5 1 -3  -1 1 -3  -1 2.2 -3  -2.5 2.2 -3") + quad("1 1 -3  2.5 1 -3  2.5 2.2 -3  1 2.2 -3");
}

const char* const kStated = "render { guiding off; windows stated }\n";

double meanVariance(const RecordingFilm& film) {
    double sum = 0;
    const PixelBounds b = film.bounds();
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x) sum += film.pixel(x, y).variance;
    return sum;
}

// With numbers that are independent of each other: how soon stratified ones converge depends on the sky, the strategy
// and their count.
TestImage renderIndependent(const TestScene& scene, std::uint32_t samples, std::uint64_t seed) {
    RenderSettings settings = scene.settings();
    settings.samples = samples;
    settings.seed = seed;
    settings.technique.numbers = Technique::Numbers::random;
    return render(scene, settings);
}

// The same image, and the variance of a sample less by more than that factor. Returns the image without windows.
TestImage checkWindows(const TestScene& with, const TestScene& without, double least) {
    const TestImage a = renderIndependent(with, nightly() ? 8192 : 1024, 3);
    TestImage b = renderIndependent(without, nightly() ? 32768 : 4096, 4);
    for (const Channel channel : {Channel::x, Channel::y, Channel::z})
        checkSame(compareImages(a.film, b.film, channel), 0.05);
    const double gain = 4 * meanVariance(b.film) / meanVariance(a.film);
    MESSAGE("variance of looking at the whole sky over that with windows, at equal samples: " << gain);
    CHECK(gain > least);
    return b;
}

} // namespace

TEST_CASE("a room lit through a window: the same image with portals, and less noise") {
    const std::string file = skyFile(64, 32);
    const std::string portal = "portals { - -1 1 -3; - 1 1 -3; - 1 2.2 -3; - -1 2.2 -3 } ";
    const TestScene with = TestScene::parse(room("light environment \"" + file + "\" { " + portal + "}\n"));
    const TestScene without = TestScene::parse(room("light environment \"" + file + "\"\n" + kStated));
    const TestImage b = checkWindows(with, without, 2);
    // Half of the window alone, and one that is no window: still the same image.
    const std::string odd = "portals { - -1 1 -3; - 0 1 -3; - 0 2.2 -3; - -1 2.2 -3; "
                            "- 2.5 0 -1; - 2.5 0 1; - 2.5 1 1; - 2.5 1 -1 } ";
    const TestScene partly = TestScene::parse(room("light environment \"" + file + "\" { " + odd + "}\n"));
    const TestImage c = render(partly, nightly() ? 32768 : 4096, 5);
    checkSame(compareImages(c.film, b.film, Channel::y), 0.05);
    std::filesystem::remove(file);
}

TEST_CASE("a room lit by a clear day through a window: the same image with portals, and less noise") {
    const char* const day = "light daylight { elevation 35 deg; azimuth 10 deg; ";
    const TestScene with =
        TestScene::parse(room(std::string(day) + "portals { - -1 1 -3; - 1 1 -3; - 1 2.2 -3; - -1 2.2 -3 } }\n"));
    const TestScene without = TestScene::parse(room(std::string(day) + "}\n" + kStated));
    checkWindows(with, without, 1.5);
}

TEST_CASE("windows are found: the same image as by looking at the whole sky, and less noise") {
    const std::string sky = "light sky { luminance 3000 nits }\n";
    const TestScene found = TestScene::parse(room(sky + "render { guiding off; windows automatic }\n"));
    const TestScene whole = TestScene::parse(room(sky + kStated));
    checkWindows(found, whole, 1.3);
}

// Hard case 33: the pole and the seam of the image may lie anywhere.
TEST_CASE("an environment turned seven ways lights a turned scene alike") {
    const std::string file = skyFile(48, 24);
    const char* turns[] = {"rotate x 0 deg",   "rotate x 90 deg",  "rotate z 90 deg", "rotate y 180 deg",
                           "rotate x 180 deg", "rotate z -90 deg", "rotate x 37 deg"};
    std::vector<TestImage> images;
    for (const char* turn : turns)
        images.push_back(render(
            TestScene::parse(fmt::format("scene 1\nfilm {{ size 12 12; filter box 0.5 }}\n"
                                         "camera {{ transform {{ translate 0 0 4; {0} }}; fov 20 deg }}\n"
                                         "light environment \"{1}\" {{ transform {{ {0} }} }}\n"
                                         "shape sphere {{ radius 0.5; material diffuse {{ reflectance 0.7 }} }}\n",
                                         turn, file)),
            1024, 7 + images.size()));
    for (std::size_t i = 1; i < images.size(); ++i) {
        CAPTURE(turns[i]);
        for (const Channel channel : {Channel::x, Channel::y, Channel::z})
            checkSame(compareImages(images[i].film, images[0].film, channel), 0.02);
    }
    std::filesystem::remove(file);
}

} // namespace abbe::test
