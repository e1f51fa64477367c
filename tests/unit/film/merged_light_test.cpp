// Merged light on the film: counted by rounds, beside samples and light paths, with its bias.
#include "film/layer_planes.h"
#include "film/merged_light.h"
#include "spectrum/color_space.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe::test {
namespace {

const Spectrum kDark(0.f);
const Wavelengths kGreen = Wavelengths::single(555);

PixelFilm filmOf(PixelBounds bounds, int replicates) {
    PixelFilm film(bounds, PixelFilter(FilterShape::box, 0.5), replicates);
    film.keepSplats();
    film.keepMerged();
    return film;
}

void merge(PixelFilm& film, int x, int y, int replicate, double wide, double closer) {
    film.splat(x, y, replicate,
               {{wide, wide, wide}, kDark, kGreen, 1, nullptr, PathComponent::caustic, SplatKind::merged, closer});
}

} // namespace

TEST_CASE("merged light is averaged over rounds, by itself") {
    PixelFilm film = filmOf({0, 0, 2, 1}, 2);
    CHECK(film.takesMerged());
    for (int r = 0; r < 2; ++r) {
        film.add(0, 0, r, Xyz{4, 4, 4}, 4);
        film.splat(0, 0, r, {{30, 30, 30}, kDark, kGreen, 1, nullptr, PathComponent::caustic});
        film.countLightPaths(r, 10);
        film.countRounds(r, 2);
    }
    merge(film, 0, 0, 0, 8, 6);
    merge(film, 0, 0, 1, 16, 14);
    CHECK(film.splatMean(SplatKind::merged, 0, 0, 0, 2).y == doctest::Approx(24.0 / 4));
    CHECK(film.closerMean(0, 0, 0, 2) == doctest::Approx(20.0 / 4));
    CHECK(film.mean(0, 0).y == doctest::Approx(1 + 3 + 6));
    CHECK(film.mean(0, 0, 0, 1).y == doctest::Approx(1 + 3 + 4));
    CHECK(*film.variance(0, 0) == doctest::Approx(4)); // replicates of 8 and 12
    CHECK(film.mean(1, 0).y == 0);
    CHECK(PixelFilm::memoryBytes({0, 0, 10, 10}, 2, true, true) == 20000 + 200 * 64);

    PixelFilm sum = filmOf({0, 0, 2, 1}, 2);
    const FilmPlanes from = film.planes(), to = sum.planes();
    REQUIRE(from.size() == to.size());
    for (int times = 0; times < 2; ++times)
        for (std::size_t i = 0; i < from.size(); ++i) {
            CHECK(from[i]->name() == to[i]->name());
            std::vector<std::byte> bytes;
            from[i]->store(film.bounds(), bytes);
            REQUIRE(to[i]->add(film.bounds(), bytes));
        }
    CHECK(sum.mean(0, 0).y == film.mean(0, 0).y);
    CHECK(sum.splatCount(SplatKind::merged, 0, 2) == 8);
    CHECK(sum.closerMean(0, 0, 0, 2) == film.closerMean(0, 0, 0, 2));
}

TEST_CASE("merged light is part of its group and of the caustics") {
    int light = 0;
    LayerPlan plan;
    plan.groups = {{"one", {"a"}}};
    plan.components = true;
    PixelFilm film = filmOf({0, 0, 1, 1}, 2);
    film.keepLayers(plan, {{&light, "a"}}, rgb::xyz);
    for (int r = 0; r < 2; ++r) {
        film.add(0, 0, r, Xyz{}, 8);
        film.countLightPaths(r, 100);
        film.countRounds(r, 5);
    }
    film.splat(0, 0, 0, {{20, 20, 20}, kDark, kGreen, 1, &light, PathComponent::caustic, SplatKind::merged, 20});
    film.splat(0, 0, 0, {{20, 20, 20}, kDark, kGreen, 1, nullptr, PathComponent::caustic});
    ResolvedImage picture = film.resolve(rgb::xyz.fromXyz(), 1);
    const LayerPlanes layers = layerPlanes(film, picture, {&rgb::xyz, rgb::xyz.fromXyz(), 1, {}});
    const auto at = [&](const std::string& name) {
        for (const NamedPlane& plane : layers.planes)
            if (plane.name == name) return static_cast<double>(plane.values[0]);
        FAIL("no channel ", name);
        return 0.0;
    };
    CHECK(at("group_one.G") == doctest::Approx(2));
    CHECK(at("group_rest.G") == doctest::Approx(0.1));
    CHECK(at("caustic.G") == doctest::Approx(2.1));
    CHECK(layers.unequalSums == 0);
}

TEST_CASE("the bias of merged light by two radii") {
    CHECK_FALSE(MergedLight::of(filmOf({0, 0, 16, 8}, 4)));
    PixelFilm film = filmOf({0, 0, 16, 8}, 4);
    // Two tiles with a light of 10: one in which the narrower disk sees 1 % less, the other with noise alone.
    for (int r = 0; r < 4; ++r) {
        film.countRounds(r, 1);
        for (int y = 0; y < 8; ++y)
            for (int x = 0; x < 16; ++x) merge(film, x, y, r, 10, x < 8 ? 9.9 : r < 2 ? 9.95 : 10.05);
    }
    const auto merged = MergedLight::of(film);
    REQUIRE(merged);
    CHECK(merged->rounds == 4);
    CHECK(merged->share == doctest::Approx(1));
    const double factor = 1 / (1 - std::sqrt(0.5));
    CHECK(merged->bias == doctest::Approx(0.005 * factor));
    // The noise changes its sign between halves, and would count below zero.
    const double a = square(0.01 * factor), b = -square(0.005 * factor);
    CHECK(merged->biasOfTiles == doctest::Approx(std::sqrt((a + b) / 2 + std::hypot(a, b))));
    CHECK(merged->biasOfTiles > 0.01 * factor / std::sqrt(2));
}

} // namespace abbe::test
