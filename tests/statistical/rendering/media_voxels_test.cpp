// Voxels from files: every strategy makes the same image of them, grey and coloured, from outside and from within.
#include "support/made_volumes.h"
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// A smoke of some height, its foot at the origin, with a light that scattering finds too.
struct SmokeScene {
    std::string file;                  // in quotes
    double height = 0, extinction = 0; // m; at density 1, 1/m

    std::string text(bool coloured, bool inside) const {
        const double h = height;
        return fmt::format(
            "scene 1\nfilm {{ size 16 16; filter box 0.5 }}\n"
            "camera {{ from {} {} {}; look-at 0 {} 0; fov 40 deg }}\n"
            "light sky {{ radiance table 400 1  700 0.5 }}\n"
            "shape sphere {{ center {} {} {}; radius {}; emission 3; material diffuse {{ reflectance 0 }} }}\n"
            "volume vdb {} {{ extinction {}; albedo 0.9; phase henyey-greenstein 0.3 }}\n",
            inside ? 0.02 * h : 0.5 * h, 0.4 * h, inside ? 0.03 * h : 1.2 * h, 0.5 * h, 0.6 * h, 1.1 * h, 0.4 * h,
            0.35 * h, file,
            coloured ? fmt::format("table 400 {} 700 {} per-m", 2 * extinction, 0.25 * extinction)
                     : fmt::format("{} per-m", extinction));
    }
};

void checkStrategies(const SmokeScene& smoke, std::uint32_t samples, double resolution) {
    for (const bool coloured : {false, true})
        for (const bool inside : {false, true}) {
            INFO(coloured << " " << inside);
            const auto images = renderByEachStrategy(TestScene::parse(smoke.text(coloured, inside)), samples);
            for (const TestImage& image : images) {
                CHECK(image.statistics.cappedPaths == 0);
                CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
            }
            const std::string kernel = coloured ? "all" : "absorption+textures+interfaces+media";
            CHECK(images[0].statistics.kernel == kernel);
            for (const Channel channel : {Channel::x, Channel::y, Channel::z})
                for (const std::size_t other : {1u, 2u})
                    checkSame(compareImages(images[0].film, images[other].film, channel), resolution);
        }
}

} // namespace

TEST_CASE("voxels: strategies agree on a smoke made here") {
    const MadeVolumes volumes("media_voxels");
    checkStrategies({volumes.make("smoke", 40), 6, 1.2}, nightly() ? 4096 : 1024, 0.006);
}

TEST_CASE("voxels: strategies agree on a smoke from elsewhere") {
    const std::string file = ABBE_SOURCE_DIR "/../shared/data/vdb/smoke.vdb";
    if (!std::filesystem::exists(file)) return;
    checkStrategies({'"' + file + '"', 90, 0.06}, nightly() ? 8192 : 1024, 0.003);
}

TEST_CASE("voxels: a cloud of albedo 0.99995 needs no limit of depth") {
    const MadeVolumes volumes("media_voxels");
    TestScene scene = TestScene::parse(
        fmt::format("scene 1\nfilm {{ size 16 16; filter box 0.5 }}\n"
                    "camera {{ from 0 300 1500; look-at 0 230 0; fov 14 deg }}\n"
                    "light sky {{ radiance 1 }}\n"
                    "volume vdb {} {{ extinction {} per-m; albedo 0.99995; phase henyey-greenstein 0.85 }}\n",
                    volumes.make("cumulus", nightly() ? 200 : 48), nightly() ? 1 : 0.4));
    RenderSettings settings = scene.settings();
    settings.samples = nightly() ? 512 : 64;
    const TestImage both = render(scene, settings);
    settings.technique.strategy = Strategy::bsdfOnly;
    ++settings.seed;
    const TestImage scattered = render(scene, settings);
    checkSame(compareImages(both.film, scattered.film), 0.03);
    CHECK(both.statistics.cappedPaths + scattered.statistics.cappedPaths == 0);
    const double meanPath =
        static_cast<double>(scattered.statistics.vertices) / static_cast<double>(scattered.statistics.paths);
    INFO("mean number of vertices " << meanPath);
    CHECK(meanPath > (nightly() ? 100 : 30));
    // In an even white sky a cloud that loses nothing cannot be seen; this one loses 5e-5 at each vertex.
    const Estimate light = scattered.film.image();
    CHECK(light.mean < 1 + 4 * std::sqrt(light.variance));
    CHECK(light.mean > 1 - 5e-5 * 2 * meanPath - 4 * std::sqrt(light.variance));
}

} // namespace abbe::test
