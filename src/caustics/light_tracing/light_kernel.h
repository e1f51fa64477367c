// One block of light paths: the unit of work beside tiles of pixels.
#pragma once

#include "base/check.h"
#include "caustics/light_tracing/light_path.h"
#include "caustics/shared/kernel_jobs.h"
#include "caustics/shared/light_start.h"
#include "render/film.h"

#include <array>
#include <vector>

namespace abbe {

// All paths of a replicate are points of one sequence, so that they are spread evenly over lights and directions as
// well as any pixel's samples are over its own.
template <EffectBits E> class LightKernel {
  public:
    LightKernel(const PathContext& context, Film& film, const LightJob& job)
        : context_(context), film_(film), job_(job), media_(PathWalk<E>::makeMedia(context.scene, *context.stop)) {
        ABBE_CHECK(2 * film.filterRadius() + 1 <= static_cast<float>(kMostReach));
    }

    // Tells of every path that starts, and of every splat with its luminance, whether it is within the film or not.
    template <typename Listener> TileResult run(Listener& listener) {
        const WorkScope work(Work::lights);
        addWorkFlag(WorkFlag::light);
        std::uint32_t unit = 0;
        for (int r = 0; r < film_.replicates(); ++r) {
            startedAs_ = ~std::uint64_t{0};
            const std::uint64_t before = result_.lightPaths;
            for (std::uint32_t i = job_.first; i < job_.last && !result_.rest; ++i, ++unit)
                if (unit >= job_.from.unit) traceSample(r, i, unit, listener);
            film_.countLightPaths(r, result_.lightPaths - before);
        }
        removeWorkFlag(WorkFlag::light);
        if constexpr (PathWalk<E>::kMedia) result_.excess = media_.tracker.counters.excess();
        return std::move(result_);
    }

  private:
    static constexpr std::uint64_t kKey = 0x6c69676874;        // "light"
    static constexpr std::size_t kMostReach = 33;              // pixels, for filters of the largest radius
    static constexpr std::uint32_t kPixelNumbers = 0x40000000; // beyond those of vertices
    struct Waiting {
        LensSplat splat;
        Xyz value;
        Wavelengths lambda;
        const Light* light;
    };

    // A light path of which something is left out is left out itself: its splats wait until it is through.
    template <typename Listener>
    void traceSample(int replicate, std::uint32_t sample, std::uint32_t unit, Listener& listener) {
        std::uint32_t j = job_.begin + (unit == job_.from.unit ? job_.from.done : 0);
        for (; j < job_.end; ++j) {
            if (context_.toldToStop()) break;
            waiting_.clear();
            trace(replicate, std::uint64_t{sample} * context_.lightPaths->paths + j, listener);
            if (media_.left() || result_.counters.left) break;
            for (const Waiting& w : waiting_) add(replicate, sample, w);
            ++result_.lightPaths;
        }
        if (j < job_.end) result_.rest = {unit, j - job_.begin};
    }

    template <typename Listener> void trace(int replicate, std::uint64_t number, Listener& listener) {
        if (number >> 32 != startedAs_) { // sequences have 2^32 points
            startedAs_ = number >> 32;
            const std::uint64_t key = combine64(combine64(context_.settings.seed, kKey), startedAs_);
            sampler_.startPixel(combine64(key, static_cast<std::uint64_t>(replicate)), Technique::Numbers::sobol, true);
        }
        sampler_.start(static_cast<std::uint32_t>(number));
        const Scene& scene = context_.scene;
        const Wavelengths lambda = scene.wavelengths.sample(sampler_.wavelength());
        const float time = scene.camera->rayTime(sampler_.time());
        const auto start = startOfLightPath(context_.lightPaths->emission, sampler_, lambda, time);
        if (!start) return;
        listener.starts(*start);
        if (isShaded(scene, *start)) return;
        LightPath<E> path(context_, sampler_, arena_, vertexArenas_, result_.counters, media_);
        path.walk().startIn(surroundingsOf(scene, *start));
        path.trace(*start, lambda, [&](const LensSplat& splat) {
            const Xyz value = scene.sensor(splat.value, lambda);
            listener.sees(*start, splat, value.y);
            waiting_.push_back({splat, value, lambda, start->light});
        });
        result_.raysAfterSpread += path.raysAfterSpread();
        removeWorkFlag(WorkFlag::heroOnly);
        setWork(Work::lights);
        if constexpr (PathWalk<E>::kMedia) setWorkCause(0);
    }

    // To one of the pixels whose filter reaches the place, drawn in proportion to the filter: so no two pixels share a
    // splat, and their errors stay independent, as those of samples are. Pixels beyond the film are drawn like all
    // others, or a crop would have other splats than the whole.
    void add(int replicate, std::uint32_t sample, const Waiting& waiting) {
        const auto& [splat, value, lambda, light] = waiting;
        const auto number = static_cast<std::uint32_t>(&waiting - waiting_.data());
        const PixelBounds bounds = film_.bounds();
        const float radius = film_.filterRadius(), x = splat.film.x - 0.5f, y = splat.film.y - 0.5f;
        const int x0 = static_cast<int>(std::ceil(x - radius)), x1 = static_cast<int>(std::floor(x + radius));
        const int y0 = static_cast<int>(std::ceil(y - radius)), y1 = static_cast<int>(std::floor(y + radius));
        if (x1 < bounds.x0 || y1 < bounds.y0 || x0 >= bounds.x1 || y0 >= bounds.y1) return;
        if (!(std::abs(value.x) + std::abs(value.y) + std::abs(value.z) < ExactSum::kLargest)) [[unlikely]]
            return result_.drop({{std::max(x0, bounds.x0), std::max(y0, bounds.y0), replicate, sample},
                                 std::isnan(value.x + value.y + value.z) ? DropCause::nan : DropCause::infinite});
        RandomStream random = sampler_.stream(kPixelNumbers + number);
        const Drawn u = drawPixel(x, x0, x1, random.uniform()), v = drawPixel(y, y0, y1, random.uniform());
        if (u.pixel < bounds.x0 || v.pixel < bounds.y0 || u.pixel >= bounds.x1 || v.pixel >= bounds.y1) return;
        const auto factor = static_cast<double>(u.factor * v.factor);
        if (factor == 0) return;
        film_.splat(u.pixel, v.pixel, replicate, {value * factor, splat.value, lambda, factor, light, splat.component});
        ++result_.splats;
    }

    // Along one axis, of the pixels [first, last] in reach of a place; the factor makes up for the choice.
    struct Drawn {
        int pixel;
        float factor;
    };
    Drawn drawPixel(float place, int first, int last, float u) const {
        std::array<float, kMostReach> weights;
        float sum = 0;
        for (int i = first; i <= last; ++i) {
            float& weight = weights[static_cast<std::size_t>(i - first)];
            weight = film_.filterWeight(place - static_cast<float>(i));
            sum += std::abs(weight);
        }
        float left = u * sum;
        Drawn drawn{first, 0};
        for (int i = first; i <= last; ++i) {
            const float weight = weights[static_cast<std::size_t>(i - first)];
            if (weight == 0) continue;
            drawn = {i, std::copysign(sum, weight)};
            left -= std::abs(weight);
            if (left < 0) break;
        }
        return drawn;
    }

    const PathContext& context_;
    Film& film_;
    const LightJob& job_;
    Sampler sampler_;
    Arena arena_;
    VertexArenas vertexArenas_;
    typename PathWalk<E>::Media media_;
    std::uint64_t startedAs_ = 0;
    std::vector<Waiting> waiting_; // of this path
    TileResult result_;
};

template <EffectBits E> TileResult traceLight(const PathContext& context, Film& film, const LightJob& job) {
    struct NoListener {
        void starts(const EmittedRay&) {}
        void sees(const EmittedRay&, const LensSplat&, double) {}
    } nobody;
    return LightKernel<E>(context, film, job).run(nobody);
}
template <EffectBits E>
TileResult listenToLight(const PathContext& context, Film& film, const LightJob& job, LightListener& listener) {
    return LightKernel<E>(context, film, job).run(listener);
}

} // namespace abbe
