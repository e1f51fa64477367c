// How well tiles of 8×8 pixels of scenes are known.
//   bench_tile_errors [--size WxH] [--samples N] [--ways on|off|both] [--threads N] SCENE…
//     default: the scene's size and samples; --ways both: with its light paths and without
// A tile's error is the standard error of its mean luminance over that mean, from 32 replicates; tiles darker than a
// thousandth of the mean tile are left out of the mean. What no replicate has found is in no error bar: a render
// without light paths that misses a caustic looks better here than it is, and the difference of the means shows it.
#include "base/parallel.h"
#include "support/scene_test.h"
#include "verify/replicate_mean.h"

#include <cstdio>
#include <cstring>
#include <fmt/format.h>

using namespace abbe;

namespace {

struct Options {
    std::optional<Vec2i> size;
    std::uint32_t samples = 0; // 0: the scene's
    bool with = true, without = true;
    std::vector<std::string> scenes;
};

struct TileErrors {
    double mean = 0, beyond = 0, most = 0; // `beyond`: the share of tiles above 5 %
    double picture = 0;                    // mean luminance
};

TileErrors errorsOf(const TileSums& sums) {
    const ReplicateMean whole(sums.whole(), 1);
    const double least = 1e-3 * whole.value / (sums.columns() * sums.rows());
    TileErrors e;
    e.picture = whole.value;
    double tiles = 0;
    for (int row = 0; row < sums.rows(); ++row)
        for (int column = 0; column < sums.columns(); ++column) {
            const ReplicateMean m(sums.at(column, row), 1);
            if (m.value < least) continue;
            const double error = std::sqrt(m.variance) / m.value;
            e.mean += error;
            e.beyond += error > 0.05;
            e.most = std::max(e.most, error);
            ++tiles;
        }
    e.mean /= tiles;
    e.beyond /= tiles;
    return e;
}

void measure(const std::string& file, bool lightPaths, const Options& o) {
    BuildOptions options;
    options.size = o.size;
    const auto scene = test::TestScene::load(file, options);
    RenderSettings settings = scene.settings();
    if (o.samples) settings.samples = o.samples;
    if (!lightPaths) settings.technique.lightPaths = Technique::LightPaths::off;
    const FilmSettings film = filmSettings(scene.built().film);
    PixelFilm pixels(film.crop, PixelFilter(film.filter, film.filterRadius), 32);
    const auto tracer = makePathTracer(scene.scene().effects);
    pixels.keepSplatsOf(*tracer, scene.scene(), settings);
    const RenderStatistics s = tracer->render(scene.scene(), pixels, settings, {});
    const TileErrors e = errorsOf(TileSums(pixels));
    std::printf("%-44s  %3s  %4dx%-4d %5u  %8.1f  %7.4g  %6.2f %%  %6.2f %%  %7.2f %%  %10.4g\n", file.c_str(),
                lightPaths ? "on" : "off", film.crop.width(), film.crop.height(), settings.samples, s.coreSeconds,
                s.lightPlan.share, 100 * e.mean, 100 * e.beyond, 100 * e.most, e.picture);
    std::fflush(stdout);
}

Options read(int argc, char** argv) {
    Options o;
    for (int i = 1; i < argc; ++i) {
        const auto next = [&] { return ++i < argc ? argv[i] : ""; };
        if (!std::strcmp(argv[i], "--size")) {
            Vec2i size{};
            if (std::sscanf(next(), "%dx%d", &size.x, &size.y) != 2 || size.x < 1 || size.y < 1)
                throw std::runtime_error("--size WxH");
            o.size = size;
        } else if (!std::strcmp(argv[i], "--samples"))
            o.samples = static_cast<std::uint32_t>(std::max(1, std::atoi(next())));
        else if (!std::strcmp(argv[i], "--threads"))
            setThreadCount(std::max(1, std::atoi(next())));
        else if (!std::strcmp(argv[i], "--ways")) {
            const std::string ways = next();
            if (ways != "on" && ways != "off" && ways != "both") throw std::runtime_error("--ways on|off|both");
            o.with = ways != "off";
            o.without = ways != "on";
        } else
            o.scenes.emplace_back(argv[i]);
    }
    if (o.scenes.empty()) throw std::runtime_error("bench_tile_errors SCENE…");
    return o;
}

} // namespace

int main(int argc, char** argv) {
    try {
        const Options o = read(argc, argv);
        std::printf(
            "scene                                         light paths  size  samples  core-s  share  error of a "
            "tile  above 5 %%  most  luminance\n");
        for (const std::string& scene : o.scenes) {
            if (o.with) measure(scene, true, o);
            if (o.without) measure(scene, false, o);
        }
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
