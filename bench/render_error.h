// The error of renders, as the benchmarks of efficiency measure it.
#pragma once

#include "film/pixel_film.h"
#include "rendering/path_tracer.h"
#include "scene/build.h"
#include "spectrum/color_space.h"

#include <algorithm>
#include <functional>
#include <vector>

namespace abbe {

struct MeasuredRender {
    std::vector<double> rgb; // linear Rec.709, pixel by pixel
    RenderStatistics statistics;
};

inline MeasuredRender measuredRender(const BuiltScene& built, const RenderSettings& how, int replicates) {
    const FilmSettings settings = filmSettings(built.film);
    PixelFilm film(settings.crop, PixelFilter(settings.filter, settings.filterRadius), replicates);
    MeasuredRender result;
    const auto integrator = makePathTracer(built.scene.effects);
    film.keepSplatsOf(*integrator, built.scene, how);
    result.statistics = integrator->render(built.scene, film, how, {});
    const PixelBounds b = film.bounds();
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x) {
            const Vec3d c = toRgb(film.mean(x, y), rgb::rec709);
            result.rgb.insert(result.rgb.end(), {c.x, c.y, c.z});
        }
    return result;
}

// relMSE: the mean of (x - r)² / (r² + 0.01) over pixels and linear Rec.709 channels on images scaled to a mean of
// 0.25; of all pixels, and without the worst 0.1 % of them, which on scenes with rare bright paths are most of it.
struct RelativeError {
    double all = 0, trimmed = 0;
};

// From two renders of different seeds and a reference of many more samples: half of (a - b)² is the error without the
// reference's noise, which only reaches the denominator.
inline RelativeError relativeError(const MeasuredRender& a, const MeasuredRender& b, const MeasuredRender& reference) {
    double mean = 0;
    for (const double v : reference.rgb) mean += v;
    const double scale = 0.25 * static_cast<double>(reference.rgb.size()) / mean;
    std::vector<double> pixels(reference.rgb.size() / 3, 0.0);
    for (std::size_t i = 0; i < reference.rgb.size(); ++i)
        pixels[i / 3] += 0.5 / 3 * square(scale * (a.rgb[i] - b.rgb[i])) / (square(scale * reference.rgb[i]) + 0.01);
    std::sort(pixels.begin(), pixels.end(), std::greater());
    const std::size_t worst = pixels.size() / 1000;
    RelativeError error;
    for (std::size_t i = 0; i < pixels.size(); ++i) {
        error.all += pixels[i] / static_cast<double>(pixels.size());
        if (i >= worst) error.trimmed += pixels[i] / static_cast<double>(pixels.size() - worst);
    }
    return error;
}

} // namespace abbe
