// What the samples of a plan are worth against even ones: bench_adaptive SCENE… [--size N] [--seeds N] [--samples 64]
//   [--depth N]
//   error² × rays of even samples over that of planned ones, the rays of the looks ahead counted in both.
// error²: relMSE without the reference's noise (render_error.h), mean over pairs of seeds; its reference is the mean of
// all of these renders. "without worst" leaves the worst 0.1 % of the pixels out.
#include "app/load.h"
#include "base/parallel.h"
#include "render_error.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <filesystem>

using namespace abbe;

namespace {

struct Options {
    std::vector<const char*> scenes;
    int size = 128;
    int seeds = 4;
    std::uint32_t samples = 64;
    std::uint32_t depth = 0; // 0: as the scene says
};

struct Side {
    std::vector<MeasuredRender> renders;
    double rays = 0; // mean

    void add(MeasuredRender render, int seeds) {
        rays += static_cast<double>(render.statistics.rays() + render.statistics.pilotRays) / seeds;
        renders.push_back(std::move(render));
    }
    RelativeError error(const MeasuredRender& reference) const {
        RelativeError sum;
        for (std::size_t i = 0; i + 1 < renders.size(); i += 2) {
            const RelativeError e = relativeError(renders[i], renders[i + 1], reference);
            sum.all += e.all * 2 / static_cast<double>(renders.size());
            sum.trimmed += e.trimmed * 2 / static_cast<double>(renders.size());
        }
        return sum;
    }
};

// Weights by rays.
MeasuredRender meanOf(const Side& a, const Side& b) {
    MeasuredRender mean;
    mean.rgb.resize(a.renders[0].rgb.size());
    double total = 0;
    for (const Side* side : {&a, &b})
        for (const MeasuredRender& r : side->renders) {
            total += 1;
            for (std::size_t i = 0; i < r.rgb.size(); ++i) mean.rgb[i] += r.rgb[i];
        }
    for (double& v : mean.rgb) v /= total;
    return mean;
}

int measure(const char* path, const Options& options) {
    const auto loaded = loadScene({path, {}});
    BuildOptions build;
    build.size = Vec2i{options.size, options.size};
    const BuiltScene built = buildScene(loaded->tree, loaded->types, build, loaded->diagnostics);
    if (loaded->diagnostics.hasErrors()) {
        std::fprintf(stderr, "%s has errors; see `abbe check`\n", path);
        return 1;
    }
    RenderSettings how = renderSettings(built.render);
    how.samples = options.samples;
    how.noiseTarget = how.timeLimit = 0;
    if (options.depth) how.maxDepth = options.depth;
    Side even, planned;
    for (int seed = 1; seed <= options.seeds; ++seed) {
        how.seed = static_cast<std::uint64_t>(seed);
        how.adaptive = false;
        even.add(measuredRender(built, how, static_cast<int>(built.render.replicates)), options.seeds);
        how.adaptive = true;
        planned.add(measuredRender(built, how, static_cast<int>(built.render.replicates)), options.seeds);
    }
    const MeasuredRender reference = meanOf(even, planned);
    const RelativeError a = even.error(reference), b = planned.error(reference);
    std::printf("%-24s %7u  %10.4g %10.4g  %8.3f  %8.3f  %8.3f\n", std::filesystem::path(path).stem().c_str(),
                options.samples, even.rays, a.all, planned.rays / even.rays, a.all * even.rays / (b.all * planned.rays),
                a.trimmed * even.rays / (b.trimmed * planned.rays));
    std::fflush(stdout);
    return 0;
}

} // namespace

int main(int argc, char** argv) {
    Options options;
    for (int i = 1; i < argc; ++i) {
        const auto number = [&] { return ++i < argc ? std::atoi(argv[i]) : 0; };
        if (!std::strcmp(argv[i], "--size"))
            options.size = number();
        else if (!std::strcmp(argv[i], "--seeds"))
            options.seeds = number();
        else if (!std::strcmp(argv[i], "--samples"))
            options.samples = static_cast<std::uint32_t>(number());
        else if (!std::strcmp(argv[i], "--depth"))
            options.depth = static_cast<std::uint32_t>(number());
        else
            options.scenes.push_back(argv[i]);
    }
    if (options.scenes.empty() || options.seeds < 2) {
        std::fprintf(stderr, "usage: bench_adaptive SCENE… [--size N] [--seeds N] [--samples N] [--depth N]\n");
        return 2;
    }
    std::printf("scene                    samples        rays      error²  × rays      gain  without worst\n");
    int faults = 0;
    for (const char* scene : options.scenes) faults += measure(scene, options);
    return faults > 0;
}
