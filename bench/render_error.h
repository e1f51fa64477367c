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
    int width = 0;           // pixels
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
    result.width = b.x1 - b.x0;
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x) {
            const Vec3d c = toRgb(film.mean(x, y), rgb::rec709);
            result.rgb.insert(result.rgb.end(), {c.x, c.y, c.z});
        }
    return result;
}

// Of luminance, and of what is left of linear Rec.709 without it: the mean over pixels of half of (a - b)² over
// Y² + 0.01 of the reference, on images scaled to a mean Y of 0.25. At most 10 for a pixel.
struct ColorError {
    double luminance = 0, chroma = 0;
};

// Of means over blocks of side × side pixels: what an eye sees from further away.
inline ColorError colorError(const MeasuredRender& a, const MeasuredRender& b, const MeasuredRender& reference,
                             int side) {
    const auto blocks = [&](const MeasuredRender& image) {
        const int height = static_cast<int>(image.rgb.size() / 3) / image.width;
        std::vector<Vec3d> means;
        for (int y = 0; y + side <= height; y += side)
            for (int x = 0; x + side <= image.width; x += side) {
                Vec3d sum;
                for (int i = 0; i < side * side; ++i) {
                    const auto at = static_cast<std::size_t>(3 * ((y + i / side) * image.width + x + i % side));
                    sum += Vec3d{image.rgb[at], image.rgb[at + 1], image.rgb[at + 2]};
                }
                means.push_back(sum / (side * side));
            }
        return means;
    };
    const auto luminance = [](const Vec3d& c) { return 0.2126 * c.x + 0.7152 * c.y + 0.0722 * c.z; };
    const std::vector<Vec3d> all[] = {blocks(a), blocks(b), blocks(reference)};
    double mean = 0;
    for (const Vec3d& c : all[2]) mean += luminance(c) / static_cast<double>(all[2].size());
    ColorError error;
    for (std::size_t i = 0; i < all[2].size(); ++i) {
        const Vec3d difference = (all[0][i] - all[1][i]) * (0.25 / mean);
        const double y = luminance(difference), least = square(luminance(all[2][i]) * 0.25 / mean) + 0.01;
        const Vec3d chroma = difference - Vec3d{y, y, y};
        error.luminance += std::min(10.0, 0.5 * y * y / least) / static_cast<double>(all[2].size());
        error.chroma += std::min(10.0, 0.5 / 3 * dot(chroma, chroma) / least) / static_cast<double>(all[2].size());
    }
    return error;
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
