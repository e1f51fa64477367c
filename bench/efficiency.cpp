// Throughput and efficiency of the renderer on a scene: efficiency SCENE [--size N] [--depth N] [--replicates N]
//   [--reference SAMPLES] [--samples 16|64|256]
//   [--light-choice tree|power|uniform] [--color]
//   paths and rays per core-second, the share of time inside the intersector, relMSE × samples, efficiency
//   1 / (relMSE × core-seconds), and the core-seconds that relMSE 0.01 and 0.001 take.
// bench/render_error.h says what relMSE is; the last column leaves the worst 0.1 % of the pixels out. With --color
// instead the errors of luminance and chroma of the first samples, of pixels and of means over 2×2 and 4×4 of them.
#include "app/load.h"
#include "base/parallel.h"
#include "render_error.h"
#include "rendering/render_params.h"

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <x86intrin.h>

using namespace abbe;

namespace {

struct Options {
    const char* scene = nullptr;
    int size = 0;             // pixels across; 0: as the scene says
    std::uint32_t depth = 16; // of the comparison with other renderers
    int replicates = 0;       // 0: as the scene says
    std::uint32_t reference = 512;
    std::uint32_t most = 256; // samples of the largest of the measured renders
    std::optional<Technique::LightChoice> choice;
    bool color = false;
};

// Counts the ticks of every 16th call; its own cost is one increment for the others.
class TimedIntersector final : public Intersector {
  public:
    explicit TimedIntersector(std::unique_ptr<const Intersector> inner) : inner_(std::move(inner)) {}
    bool intersect(const Ray& ray, SurfaceHit& hit) const noexcept override {
        return timed([&] { return inner_->intersect(ray, hit); });
    }
    bool occluded(const Ray& ray) const noexcept override {
        return timed([&] { return inner_->occluded(ray); });
    }
    bool occluded(Vec3 from, Vec3 to, float time, RayKind kind) const noexcept override {
        return timed([&] { return inner_->occluded(from, to, time, kind); });
    }
    Bounds3 bounds() const override { return inner_->bounds(); }
    std::uint64_t rejectedRays() const override { return inner_->rejectedRays(); }

    mutable std::uint64_t calls = 0, ticks = 0; // one thread only

  private:
    template <typename F> bool timed(F f) const {
        if (++calls % 16 != 0) return f();
        const std::uint64_t start = __rdtsc();
        const bool result = f();
        ticks += 16 * (__rdtsc() - start);
        return result;
    }
    std::unique_ptr<const Intersector> inner_;
};

MeasuredRender render(const BuiltScene& built, const Options& options, std::uint32_t samples, std::uint64_t seed) {
    RenderSettings how = renderSettings(built.render);
    how.samples = samples;
    how.seed = seed;
    how.maxDepth = options.depth;
    how.noiseTarget = how.timeLimit = 0;
    if (options.choice) how.technique.lightChoice = *options.choice;
    return measuredRender(built, how,
                          options.replicates ? options.replicates : static_cast<int>(built.render.replicates));
}

bool parse(int argc, char** argv, Options& o) {
    for (int i = 1; i < argc; ++i) {
        const auto number = [&] { return ++i < argc ? std::atoi(argv[i]) : 0; };
        if (!std::strcmp(argv[i], "--size"))
            o.size = number();
        else if (!std::strcmp(argv[i], "--depth"))
            o.depth = static_cast<std::uint32_t>(number());
        else if (!std::strcmp(argv[i], "--replicates"))
            o.replicates = number();
        else if (!std::strcmp(argv[i], "--reference"))
            o.reference = static_cast<std::uint32_t>(number());
        else if (!std::strcmp(argv[i], "--samples"))
            o.most = static_cast<std::uint32_t>(number());
        else if (!std::strcmp(argv[i], "--light-choice")) {
            for (const auto choice :
                 {Technique::LightChoice::tree, Technique::LightChoice::power, Technique::LightChoice::uniform}) {
                if (i + 1 < argc && word(choice) == argv[i + 1]) o.choice = choice;
            }
            ++i;
        } else if (!std::strcmp(argv[i], "--color"))
            o.color = true;
        else
            o.scene = argv[i];
    }
    return o.scene != nullptr;
}

void printColorErrors(const BuiltScene& built, const Options& options, const MeasuredRender& reference) {
    std::printf("samples  core-s   luminance, chroma: pixels    2×2               4×4\n");
    for (const std::uint32_t samples : {2u, 4u, 8u, 16u}) {
        const MeasuredRender a = render(built, options, samples, 1), b = render(built, options, samples, 2);
        std::printf("%7u  %6.3f         ", samples, 0.5 * (a.statistics.coreSeconds + b.statistics.coreSeconds));
        for (const int side : {1, 2, 4}) {
            const ColorError error = colorError(a, b, reference, side);
            std::printf("  %.5f %.5f", error.luminance, error.chroma);
        }
        std::printf("\n");
    }
}

// Core-seconds to an error, between the two measured renders around it on a log-log line (beyond them: continued).
double coreSecondsTo(double target, const std::vector<std::pair<double, double>>& errorAndTime) {
    std::size_t i = 1;
    while (i + 1 < errorAndTime.size() && errorAndTime[i].first > target) ++i;
    const auto [e0, t0] = errorAndTime[i - 1];
    const auto [e1, t1] = errorAndTime[i];
    return std::exp(std::log(t0) + std::log(target / e0) / std::log(e1 / e0) * std::log(t1 / t0));
}

double seconds(clockid_t clock) {
    timespec t;
    clock_gettime(clock, &t);
    return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

// Of the thread's own time: other processes on the machine do not count.
void shareOfIntersector(BuiltScene& built, const Options& options) {
    auto timed = std::make_unique<TimedIntersector>(std::move(built.scene.intersector));
    const TimedIntersector& t = *timed;
    built.scene.intersector = std::move(timed);
    const double wall = seconds(CLOCK_MONOTONIC);
    const std::uint64_t start = __rdtsc();
    const MeasuredRender r = render(built, options, 8, 99);
    const double ticksPerSecond = static_cast<double>(__rdtsc() - start) / (seconds(CLOCK_MONOTONIC) - wall);
    std::printf("inside the intersector: %.0f %% of the time\n",
                100 * static_cast<double>(t.ticks) / ticksPerSecond / r.statistics.coreSeconds);
}

} // namespace

int main(int argc, char** argv) {
    Options options;
    if (!parse(argc, argv, options)) {
        std::fprintf(stderr, "usage: efficiency SCENE [--size N] [--depth N] [--replicates N] [--reference SAMPLES] "
                             "[--samples 16|64|256] "
                             "[--light-choice tree|power|uniform] [--color]\n");
        return 2;
    }
    setThreadCount(1);
    const auto loaded = loadScene({options.scene, {}});
    BuildOptions build;
    if (options.size) build.size = Vec2i{options.size, options.size};
    BuiltScene built = buildScene(loaded->tree, loaded->types, build, loaded->diagnostics);
    if (loaded->diagnostics.hasErrors()) {
        std::fprintf(stderr, "%s has errors; see `abbe check`\n", options.scene);
        return 1;
    }
    Options best = options;
    best.choice.reset(); // as the scene says
    const MeasuredRender reference = render(built, best, options.reference, 1000);
    if (options.color) {
        printColorErrors(built, options, reference);
        return 0;
    }
    std::printf("samples  M paths/core-s  M rays/core-s  vertices/path  relMSE×samples  efficiency  without worst\n");
    std::vector<std::pair<double, double>> errorAndTime;
    for (const std::uint32_t samples : {16u, 64u, 256u}) {
        if (samples > options.most) break;
        const MeasuredRender a = render(built, options, samples, 1), b = render(built, options, samples, 2);
        const double seconds = 0.5 * (a.statistics.coreSeconds + b.statistics.coreSeconds);
        const RelativeError error = relativeError(a, b, reference);
        errorAndTime.emplace_back(error.all, seconds);
        std::printf("%7u  %14.3f  %13.2f  %13.2f  %14.4f  %10.3f  %13.3f\n", samples,
                    static_cast<double>(a.statistics.paths) * 1e-6 / seconds,
                    static_cast<double>(a.statistics.rays()) * 1e-6 / seconds,
                    static_cast<double>(a.statistics.vertices) / static_cast<double>(a.statistics.paths),
                    error.all * samples, 1 / (error.all * seconds), 1 / (error.trimmed * seconds));
    }
    if (errorAndTime.size() > 1)
        for (const double target : {0.01, 0.001})
            std::printf("relMSE %g after %.2f core-seconds\n", target, coreSecondsTo(target, errorAndTime));
    shareOfIntersector(built, options);
}
