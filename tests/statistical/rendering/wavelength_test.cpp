// Eight wavelengths to a path against one: images of dispersive glass, by brute force over single wavelengths with a
// kernel that knows nothing of dispersion.
#include "support/scene_test_compare.h"
#include "support/scene_test_paths.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// A flint sphere before emitting stripes, in a dim sky: colours arise at the edges that the sphere displaces.
TestScene stripes(const std::string& glass) {
    std::string text = "scene 1\nfilm { size 32 32; filter box 0.5 }\n"
                       "camera { from 0 0 4; look-at 0 0 0; fov 32 deg }\n"
                       "light sky { radiance 0.1 }\n";
    for (int i = 0; i < 5; ++i)
        text += fmt::format("light quad {{ points {0} -3 -3  {1} -3 -3  {1} 3 -3  {0} 3 -3; radiance {2} }}\n",
                            -2.5 + i, -2 + i, i % 2 ? "table 400 2  500 1.5  700 0.5" : "table 400 0.3  700 2");
    return TestScene::parse(text + "shape sphere { material dielectric { " + glass + " } }\n");
}

void checkWavelengths(const std::string& glass) {
    INFO(std::string(glass));
    const TestScene scene = stripes(glass);
    const TestImage hero = render(scene, nightly() ? 8192 : 1024, 3);
    CHECK(hero.statistics.kernel == "absorption+dispersion");
    constexpr EffectBits kAbsorptionOnly = static_cast<EffectBits>(Effect::absorption);
    const RecordingFilm single = renderPaths<kAbsorptionOnly>(
        scene, {.samples = nightly() ? 2048u : 256u, .seed = 77, .wavelengths = oneWavelength});
    for (const Channel channel : {Channel::x, Channel::y, Channel::z})
        checkSame(compareImages(hero.film, single, channel), 0.002);
}

} // namespace

TEST_CASE("hero wavelengths: polished flint") { checkWavelengths("ior glass SF11"); }

// The widths of the microfacets' slopes span those where the lobes of the eight wavelengths are apart and where they
// overlap; roughness is the root of α.
TEST_CASE("hero wavelengths: rough flint, α = 0.01") { checkWavelengths("ior glass SF11; roughness 0.1"); }
TEST_CASE("hero wavelengths: rough flint, α = 0.05") { checkWavelengths("ior glass SF11; roughness 0.2236"); }
TEST_CASE("hero wavelengths: rough flint, α = 0.2") { checkWavelengths("ior glass SF11; roughness 0.4472"); }
TEST_CASE("hero wavelengths: rough flint that absorbs") {
    checkWavelengths("ior glass SF11; roughness 0.3; absorption table 400 3  550 0.2  700 1");
}

TEST_CASE("hero wavelengths: strong dispersion, where some wavelengths are totally reflected and others leave") {
    checkWavelengths("ior cauchy 1.3 0.06; roughness 0.15");
    checkWavelengths("ior cauchy 1.3 0.06");
}

} // namespace abbe::test
