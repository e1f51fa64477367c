// Russian roulette moves variance, never the mean: paths that always live against paths that live rarely.
#include "support/scene_test_compare.h"
#include "support/scene_test_paths.h"

#include <doctest/doctest.h>

namespace abbe::test {

TEST_CASE("roulette: the mean does not depend on it") {
    const auto scene = TestScene::parse(R"(scene 1
film { size 32 32; filter box 0.5 }
camera { from 0 0 0.9; look-at 0 0 -1; fov 80 deg }
shape mesh { material diffuse { reflectance rgb 0.8 0.5 0.3 }
    points { - -1 -1 -1; - 1 -1 -1; - 1 1 -1; - -1 1 -1; - -1 -1 1; - 1 -1 1; - 1 1 1; - -1 1 1 }
    faces { - 0 1 2 3; - 7 6 5 4; - 4 5 1 0; - 5 6 2 1; - 6 7 3 2; - 7 4 0 3 } }
shape sphere { center 0.3 -0.5 -0.3; radius 0.4; material dielectric { ior 1.5; roughness 0.3 } }
light sphere { center 0 0.6 -0.2; radius 0.25; radiance 10 }
)");
    // Few bounces keep the variance finite when paths live far more rarely than their throughput says.
    constexpr std::uint32_t depth = 8;
    const std::uint32_t factor = nightly() ? 8 : 1;
    const auto image = [&](float scale, std::uint32_t samples, std::uint64_t seed) {
        return renderPaths<0>(scene,
                              {.samples = samples * factor, .seed = seed, .maxDepth = depth, .rouletteScale = scale});
    };
    const RecordingFilm always = image(1e9f, 64, 1), rarely = image(0.3f, 128, 2), usually = image(1, 64, 3);
    RenderSettings settings = scene.settings();
    settings.samples = 512 * factor;
    settings.seed = 4;
    settings.maxDepth = depth;
    const TestImage renderer = render(scene, settings);
    checkSame(compareImages(rarely, always), 0.005);
    checkSame(compareImages(usually, always), 0.003);
    checkSame(compareImages(renderer.film, always), 0.003);
}

TEST_CASE("roulette: nor on that of shadow rays in media, which the renderer asks for, and single paths do not") {
    const auto scene = TestScene::parse(R"(scene 1
film { size 24 24; filter box 0.5 }
camera { from 0 0 4; look-at 0 0 0; fov 36 deg }
light sky { luminance 4000 nits }
light sun { elevation 40 deg; azimuth 110 deg; irradiance 30 klx }
shape sphere { radius 1; material boundary; interior homogeneous { extinction 8; albedo 0.99; phase henyey-greenstein 0.6 } }
)");
    constexpr EffectBits media =
        (Effects(Effect::absorption) | Effect::textures | Effect::interfaces | Effect::media).bits();
    const std::uint32_t factor = nightly() ? 8 : 1, depth = 32;
    const RecordingFilm always =
        renderPaths<media>(scene, {.samples = 64 * factor, .seed = 1, .maxDepth = depth, .rouletteScale = 1e9});
    RenderSettings settings = scene.settings();
    settings.samples = 512 * factor;
    settings.seed = 4;
    settings.maxDepth = depth;
    const TestImage renderer = render(scene, settings);
    checkSame(compareImages(renderer.film, always), 0.003);
}

} // namespace abbe::test
