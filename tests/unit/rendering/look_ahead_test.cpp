#include "light_sampling/light_sampler.h"
#include "path_tracing/path_kernels.h"
#include "render/render_state.h"
#include "rendering/look_ahead.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>
#include <numeric>

namespace abbe::test {

TEST_CASE("blocks of light paths are foretold to cost as much as a tile does") {
    const auto scene = TestScene::parse(R"(scene 1
render { samples 8 }
film { size 40 40 }
camera { from 0 1 4; look-at 0 0 0; fov 40 deg }
shape plane { material diffuse { reflectance 0.7 } }
light sky { luminance 100 nits }
)");
    REQUIRE(scene.report() == "");
    const RenderSettings settings = scene.settings();
    const LightSampler lights(scene.scene().lights, settings.technique.lightChoice);
    const PathContext context{scene.scene(), lights, settings};
    const RecordingFilm film(scene.built().film, 2);
    const auto costs = [&](std::size_t blocks) {
        const RenderState state(film.bounds(), 0, blocks);
        return lookAhead(context, kernelFor({}).render, film, state, [] { return false; }).tileCosts;
    };
    const std::vector<double> without = costs(0), with = costs(4);
    REQUIRE(without.size() == 9);
    REQUIRE(with.size() == 13);
    CHECK(std::equal(without.begin(), without.end(), with.begin()));
    const double mean = std::accumulate(without.begin(), without.end(), 0.0) / 9;
    CHECK(mean > 0);
    for (std::size_t i = 9; i < 13; ++i) CHECK(with[i] == doctest::Approx(mean));
}

} // namespace abbe::test
