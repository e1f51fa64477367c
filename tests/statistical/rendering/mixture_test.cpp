// A mixture with a delta lobe: light samples and scattering must share the light between them (docs/hard_cases.md,
// case 39).
#include "support/scene_test.h"
#include "support/scene_test_compare.h"

#include <doctest/doctest.h>

namespace abbe::test {

TEST_CASE("strategies: glass with paint on it, glass inside a sheet of two sides") {
    const TestScene scene = TestScene::parse(
        "scene 1\nfilm { size 24 24; filter box 0.5 }\ncamera { from 0 0.5 4; look-at 0 0 0; fov 40 deg }\n"
        "light sky { radiance 0.3 }\nlight sphere { center 2 3 2; radius 1; radiance 3 }\n"
        "shape plane { center 0 -0.8 0; material two-sided { front diffuse { reflectance 0.6 }; back diffuse } }\n"
        "shape sphere { center -0.6 0 0; radius 0.7; material mix { first dielectric { ior 1.5 }\n"
        "    second diffuse { reflectance rgb 0.7 0.2 0.1 }; amount 40 % } }\n"
        "shape sphere { center 0.8 -0.2 0.3; radius 0.5; material mix { first conductor { index metal Au }\n"
        "    second conductor { index metal Ag; roughness 0.6 }; amount 0.5 } }\n");
    const auto images = renderByEachStrategy(scene, nightly() ? 8192 : 1024);
    for (std::size_t i = 1; i < 3; ++i)
        for (const Channel channel : {Channel::x, Channel::y, Channel::z})
            checkSame(compareImages(images[i].film, images[0].film, channel), 0.004);
    for (const TestImage& image : images) CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
}

TEST_CASE("a lossless mixture in white surroundings cannot be seen") {
    const TestScene scene = TestScene::parse(
        "scene 1\nfilm { size 12 12; filter box 0.5 }\ncamera { from 0 0 4; look-at 0 0 0; fov 25 deg }\n"
        "light sky { radiance 1 }\nshape sphere { material mix { first dielectric { ior glass SF11 }\n"
        "    second diffuse { reflectance 1 }; amount 30 % } }\n");
    const TestImage image = render(scene, nightly() ? 16384 : 2048);
    for (const Channel channel : {Channel::x, Channel::y, Channel::z})
        checkSame(compareExpected(
                      image.film, [](int, int) { return 1.0; }, channel),
                  0.004);
}

} // namespace abbe::test
