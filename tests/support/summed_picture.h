// A picture as the program renders it, in sums that comparisons take.
#pragma once

#include "support/scene_test.h"
#include "verify/agreement.h"

#include <utility>

namespace abbe::test {

struct SummedPicture {
    TileSums sums;
    RenderStatistics statistics;
};

inline SummedPicture renderSummed(const TestScene& test, const RenderSettings& settings, int replicates) {
    const FilmSettings film = filmSettings(test.built().film);
    PixelFilm pixels(film.crop, PixelFilter(film.filter, film.filterRadius), replicates);
    const auto tracer = makePathTracer(test.scene().effects);
    pixels.keepSplatsOf(*tracer, test.scene(), settings);
    RenderStatistics statistics = tracer->render(test.scene(), pixels, settings, {});
    return {TileSums(pixels), std::move(statistics)};
}

} // namespace abbe::test
