// How well tiles of 8×8 pixels of scenes and of finished pictures are known.
//   bench_tile_errors [--size WxH] [--samples N] [--ways on|off|both] [--threads N] SCENE…
//     default: the scene's size and samples; --ways both: with its light paths and without
//   bench_tile_errors [--of N] [--worst K] PICTURE.exr…
//     --of N: predicted for N samples, errors by 1/√samples; without it those of the picture
//     --worst K: also the K tiles with the largest errors, and how much of their variance is that of one pixel
// A tile's error is the standard error of its mean luminance over that mean; tiles darker than a thousandth of the mean
// tile are left out. Scenes are rendered with 32 replicates, which tell it. Pictures tell the variance of each pixel;
// those of a tile are added: no two pixels share a splat, but several splats of one light path may fall into one tile,
// which the sum does not know. What no replicate has found is in no error bar: a render without light paths that misses
// a caustic looks better here than it is, and the difference of the means shows it.
#include "base/parallel.h"
#include "caustics/light_tracing/light_path_plan.h"
#include "io/exr_reader.h"
#include "io/image.h"
#include "support/scene_test.h"
#include "verify/tile_sums.h"

#include <cstdio>
#include <cstring>
#include <fmt/format.h>

using namespace abbe;

namespace {

struct Options {
    std::optional<Vec2i> size;
    std::uint32_t samples = 0; // 0: the scene's
    double predicted = 0;      // of pictures; 0: their own
    std::size_t worst = 0;     // tiles of pictures to be listed
    bool with = true, without = true;
    std::vector<std::string> scenes;
};

struct Tile {
    double mean = 0, variance = 0; // of its luminance; of that mean
    int x = 0, y = 0;              // its first pixel
    double largest = 0;            // variance of one pixel, as part of that of the tile

    double error() const { return std::sqrt(variance) / mean; }
};

struct TileErrors {
    double mean = 0, beyond = 0; // `beyond`: the share of tiles above 5 %
    double most = 0;             // the largest, of the tile at `x`, `y`
    int x = 0, y = 0;
    double picture = 0; // sum of the tiles' luminance
};

TileErrors errorsOf(const std::vector<Tile>& tiles) {
    TileErrors e;
    for (const Tile& t : tiles) e.picture += t.mean;
    const double least = 1e-3 * e.picture / static_cast<double>(tiles.size());
    double counted = 0;
    for (const Tile& t : tiles) {
        if (t.mean < least) continue;
        const double error = t.error();
        e.mean += error;
        e.beyond += error > 0.05;
        ++counted;
        if (error <= e.most) continue;
        e.most = error;
        e.x = t.x;
        e.y = t.y;
    }
    e.mean /= counted;
    e.beyond /= counted;
    return e;
}

std::vector<Tile> tilesOf(const TileSums& sums) {
    std::vector<Tile> tiles;
    for (int row = 0; row < sums.rows(); ++row)
        for (int column = 0; column < sums.columns(); ++column) {
            const ReplicateMean m(sums.at(column, row), 1);
            const PixelBounds b = sums.bounds(column, row);
            tiles.push_back({m.value, m.variance, b.x0, b.y0, 0});
        }
    return tiles;
}

double samplesOf(const std::string& picture) {
    for (const ImageAttribute& a : readExrInfo(picture).attributes)
        if (a.name == "abbe.samples") return std::get<int>(a.value);
    throw std::runtime_error(picture + " does not tell its samples");
}

std::vector<Tile> tilesOf(const std::string& picture, double predicted) {
    const double factor = predicted > 0 ? samplesOf(picture) / predicted : 1;
    const RgbImage image = readImage(picture);
    const std::vector<float> variance = readExrChannel(picture, "variance.Y");
    const RgbSpace space = image.chromaticities ? image.chromaticities->space() : rgb::rec709;
    const int columns = (image.width() + 7) / 8, rows = (image.height() + 7) / 8;
    std::vector<Tile> tiles(static_cast<std::size_t>(columns * rows));
    for (int y = 0; y < image.height(); ++y)
        for (int x = 0; x < image.width(); ++x) {
            Tile& t = tiles[static_cast<std::size_t>(y / 8 * columns + x / 8)];
            if (x % 8 == 0 && y % 8 == 0) t = {0, 0, image.window.x0 + x, image.window.y0 + y, 0};
            const auto i = static_cast<std::size_t>(y * image.width() + x);
            t.mean += toXyz({image.rgb[3 * i], image.rgb[3 * i + 1], image.rgb[3 * i + 2]}, space).y;
            const double own = factor * static_cast<double>(variance[i]);
            t.variance += own;
            t.largest = std::max(t.largest, own);
        }
    return tiles;
}

void print(const TileErrors& e) {
    std::printf("%6.2f %%  %6.2f %%  %7.2f %% at %4d,%-4d  %10.4g\n", 100 * e.mean, 100 * e.beyond, 100 * e.most, e.x,
                e.y, e.picture);
    std::fflush(stdout);
}

void printWorst(std::vector<Tile> tiles, std::size_t count) {
    std::erase_if(tiles, [](const Tile& t) { return !(t.mean > 0); });
    std::ranges::sort(tiles, std::greater(), &Tile::error);
    tiles.resize(std::min(count, tiles.size()));
    for (const Tile& t : tiles)
        std::printf("    %4d,%-4d  %6.2f %%, of its variance in one pixel %3.0f %%\n", t.x, t.y, 100 * t.error(),
                    100 * t.largest / t.variance);
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
    std::printf("%-44s  %3s  %4dx%-4d %5u  %8.1f  %7.4g  ", file.c_str(), lightPaths ? "on" : "off", film.crop.width(),
                film.crop.height(), settings.samples, s.coreSeconds, s.caustics.of<LightPathFindings>().share);
    print(errorsOf(tilesOf(TileSums(pixels))));
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
        else if (!std::strcmp(argv[i], "--of"))
            o.predicted = std::atof(next());
        else if (!std::strcmp(argv[i], "--worst"))
            o.worst = static_cast<std::size_t>(std::max(0, std::atoi(next())));
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
    if (o.scenes.empty()) throw std::runtime_error("bench_tile_errors SCENE or PICTURE.exr…");
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
            if (scene.ends_with(".exr")) {
                std::printf("%-91s", scene.c_str());
                const std::vector<Tile> tiles = tilesOf(scene, o.predicted);
                print(errorsOf(tiles));
                printWorst(tiles, o.worst);
                continue;
            }
            if (o.with) measure(scene, true, o);
            if (o.without) measure(scene, false, o);
        }
    } catch (const std::exception& e) {
        std::fprintf(stderr, "%s\n", e.what());
        return 1;
    }
}
