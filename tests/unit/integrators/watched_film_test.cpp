#include "film/pixel_film.h"
#include "integrators/watched_film.h"

#include <doctest/doctest.h>

using namespace abbe;

TEST_CASE("watched film: the pixel filter is that of the film that it stands for") {
    const PixelFilm film({0, 0, 2, 2}, PixelFilter(FilterShape::gaussian, 1.5), 1);
    const WatchedFilm watched(film, {});
    CHECK(watched.filterRadius() == 1.5f);
    for (const float offset : {0.f, 0.4f, 1.2f, 1.6f}) CHECK(watched.filterWeight(offset) == film.filterWeight(offset));
    CHECK(watched.filter({0.9f, 0.2f}).offset.x == film.filter({0.9f, 0.2f}).offset.x);
}
