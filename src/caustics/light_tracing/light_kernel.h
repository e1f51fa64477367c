// One block of light paths: the unit of work beside tiles of pixels.
#pragma once

#include "base/check.h"
#include "caustics/light_tracing/light_path.h"
#include "caustics/shared/kernel_jobs.h"
#include "caustics/shared/light_start.h"
#include "caustics/shared/shared_work.h"
#include "render/film.h"

#include <algorithm>
#include <array>
#include <span>
#include <vector>

namespace abbe {

// What a light path adds to a pixel, until the path is through.
struct LandedSplat {
    int x = 0, y = 0, replicate = 0;
    Xyz value;
    Spectrum radiance;
    Wavelengths lambda;
    double factor = 0;
    const Light* light = nullptr;
    PathComponent component = PathComponent::direct;

    void addTo(Film& film) const { film.splat(x, y, replicate, {value, radiance, lambda, factor, light, component}); }
};

// Of a number of light paths, one after the other.
struct LandedPaths {
    std::vector<LandedSplat> splats;
    std::vector<DroppedSample> dropped;
    std::size_t paths = 0; // that came to their ends
    void clear() {
        splats.clear();
        dropped.clear();
        paths = 0;
    }
};

// Traces light paths by their numbers. All paths of a replicate are points of one sequence, so that they are spread
// evenly over lights and directions as well as any pixel's samples are over its own.
template <EffectBits E> class LightTracer {
  public:
    LightTracer(const PathContext& context, const Film& film)
        : context_(context), film_(film), media_(PathWalk<E>::makeMedia(context.scene, *context.stop)) {
        ABBE_CHECK(2 * film.filterRadius() + 1 <= static_cast<float>(kMostReach));
    }

    // Path `number` of the replicate, which is one of `sample`. False if it was left before its end: then nothing has
    // landed.
    template <typename Listener>
    bool trace(int replicate, std::uint32_t sample, std::uint64_t number, Listener& listener, LandedPaths& landed) {
        waiting_.clear();
        trace(replicate, number, listener);
        if (media_.left() || result_.counters.left) return false;
        for (const Waiting& w : waiting_) land(replicate, sample, w, landed);
        ++landed.paths;
        return true;
    }

    // What all its paths counted.
    const TileResult& result() {
        if constexpr (PathWalk<E>::kMedia) result_.excess = media_.tracker.counters.excess();
        return result_;
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

    // Sequences have 2^32 points.
    void startSequence(int replicate, std::uint64_t part) {
        if (replicate == replicate_ && part == part_) return;
        replicate_ = replicate;
        part_ = part;
        const std::uint64_t key = combine64(combine64(context_.settings.seed, kKey), part);
        sampler_.startPixel(combine64(key, static_cast<std::uint64_t>(replicate)), Technique::Numbers::sobol, true);
    }

    template <typename Listener> void trace(int replicate, std::uint64_t number, Listener& listener) {
        startSequence(replicate, number >> 32);
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
    void land(int replicate, std::uint32_t sample, const Waiting& waiting, LandedPaths& to) const {
        const auto& [splat, value, lambda, light] = waiting;
        const auto number = static_cast<std::uint32_t>(&waiting - waiting_.data());
        const PixelBounds bounds = film_.bounds();
        const float radius = film_.filterRadius(), x = splat.film.x - 0.5f, y = splat.film.y - 0.5f;
        const int x0 = static_cast<int>(std::ceil(x - radius)), x1 = static_cast<int>(std::floor(x + radius));
        const int y0 = static_cast<int>(std::ceil(y - radius)), y1 = static_cast<int>(std::floor(y + radius));
        if (x1 < bounds.x0 || y1 < bounds.y0 || x0 >= bounds.x1 || y0 >= bounds.y1) return;
        if (!(std::abs(value.x) + std::abs(value.y) + std::abs(value.z) < ExactSum::kLargest)) [[unlikely]]
            return to.dropped.push_back(
                {{std::max(x0, bounds.x0), std::max(y0, bounds.y0), replicate, sample},
                 std::isnan(value.x + value.y + value.z) ? DropCause::nan : DropCause::infinite});
        RandomStream random = sampler_.stream(kPixelNumbers + number);
        const Drawn u = drawPixel(x, x0, x1, random.uniform()), v = drawPixel(y, y0, y1, random.uniform());
        if (u.pixel < bounds.x0 || v.pixel < bounds.y0 || u.pixel >= bounds.x1 || v.pixel >= bounds.y1) return;
        const auto factor = static_cast<double>(u.factor * v.factor);
        if (factor == 0) return;
        to.splats.push_back(
            {u.pixel, v.pixel, replicate, value * factor, splat.value, lambda, factor, light, splat.component});
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
    const Film& film_;
    Sampler sampler_;
    Arena arena_;
    VertexArenas vertexArenas_;
    typename PathWalk<E>::Media media_;
    int replicate_ = -1;           // of the sampler's sequence,
    std::uint64_t part_ = 0;       // and which of the replicate's
    std::vector<Waiting> waiting_; // of this path
    TileResult result_;
};

// The paths of a block in the order of their numbers, batch by batch. Idle threads take part in a batch; what it brings
// goes to the film when all of it is through, and if one of its paths was left, what the paths before that one brought:
// so a portion that is cut short has a place up to which all is done, whoever did it.
template <EffectBits E> class LightKernel {
  public:
    LightKernel(const PathContext& context, Film& film, const LightJob& job)
        : context_(context), film_(film), job_(job), perUnit_(job.end - job.begin) {}

    TileResult run() {
        const WorkScope work(Work::lights);
        addWorkFlag(WorkFlag::light);
        const auto units =
            static_cast<std::uint64_t>(job_.last - job_.first) * static_cast<std::uint64_t>(film_.replicates());
        const std::uint64_t end = units * perUnit_;
        std::uint64_t at = job_.from.unit * perUnit_ + job_.from.done;
        while (at < end && !result_.rest) at = batch(at, std::min(end, at + kBatch));
        for (const auto& tracer : tracers_.all()) result_.add(tracer->result());
        result_.secondsElsewhere = shared_.secondsElsewhere();
        removeWorkFlag(WorkFlag::light);
        return std::move(result_);
    }

    // Tells of every path that starts, and of every splat with its luminance, whether it is within the film or not; one
    // path after the other, and the film has none of them.
    template <typename Listener> TileResult listen(Listener& listener) {
        const WorkScope work(Work::lights);
        addWorkFlag(WorkFlag::light);
        LightTracer<E> tracer(context_, film_);
        LandedPaths unused;
        for (std::uint32_t j = job_.begin; j < job_.end && !context_.toldToStop(); ++j) {
            unused.clear();
            if (!tracer.trace(0, job_.first, std::uint64_t{job_.first} * context_.lightPaths->paths + j, listener,
                              unused))
                break;
        }
        removeWorkFlag(WorkFlag::light);
        return tracer.result();
    }

  private:
    // Paths. A part of a batch is some tenths of a millisecond; a batch some milliseconds, and a megabyte of splats.
    static constexpr std::uint64_t kPart = 32, kParts = 32, kBatch = kPart * kParts;

    struct NoListener {
        void starts(const EmittedRay&) {}
        void sees(const EmittedRay&, const LensSplat&, double) {}
    };

    // The paths [first, last) of the job, to the film. Up to where all is done.
    std::uint64_t batch(std::uint64_t first, std::uint64_t last) {
        const auto parts = static_cast<std::size_t>((last - first + kPart - 1) / kPart);
        const auto beginOf = [&](std::size_t i) { return std::min(last, first + i * kPart); };
        shared_.run(parts, [&](std::size_t i) {
            std::unique_ptr<LightTracer<E>> tracer =
                tracers_.take([&] { return std::make_unique<LightTracer<E>>(context_, film_); });
            landed_[i].clear();
            trace(*tracer, beginOf(i), beginOf(i + 1), landed_[i]);
            tracers_.giveBack(std::move(tracer));
        });
        std::size_t through = 0; // parts up to the one in which a path was left
        std::uint64_t end = last;
        while (through < parts && end == last) {
            const std::uint64_t reached = beginOf(through) + landed_[through].paths;
            if (reached < beginOf(++through)) end = reached;
        }
        shared_.run(through, [&](std::size_t i) {
            for (const LandedSplat& s : landed_[i].splats) s.addTo(film_);
        });
        for (const LandedPaths& landed : std::span(landed_).first(through)) {
            result_.splats += landed.splats.size();
            for (const DroppedSample& s : landed.dropped) result_.drop(s);
        }
        countPaths(first, end);
        if (end < last)
            result_.rest = {static_cast<std::uint32_t>(end / perUnit_), static_cast<std::uint32_t>(end % perUnit_)};
        return end;
    }

    void trace(LightTracer<E>& tracer, std::uint64_t first, std::uint64_t last, LandedPaths& landed) const {
        NoListener nobody;
        const std::uint32_t samples = job_.last - job_.first;
        for (std::uint64_t at = first; at < last && !context_.toldToStop(); ++at) {
            const auto unit = static_cast<std::uint32_t>(at / perUnit_);
            const std::uint32_t sample = job_.first + unit % samples;
            const std::uint64_t number =
                std::uint64_t{sample} * context_.lightPaths->paths + job_.begin + at % perUnit_;
            if (!tracer.trace(static_cast<int>(unit / samples), sample, number, nobody, landed)) return;
        }
    }

    void countPaths(std::uint64_t first, std::uint64_t last) {
        const std::uint64_t perReplicate = perUnit_ * (job_.last - job_.first);
        result_.lightPaths += last - first;
        while (first < last) {
            const std::uint64_t replicate = first / perReplicate, end = std::min(last, (replicate + 1) * perReplicate);
            film_.countLightPaths(static_cast<int>(replicate), end - first);
            first = end;
        }
    }

    const PathContext& context_;
    Film& film_;
    const LightJob& job_;
    const std::uint64_t perUnit_; // paths of a sample of a replicate
    SharedWork shared_;
    ToolPool<LightTracer<E>> tracers_;
    std::array<LandedPaths, kParts> landed_;
    TileResult result_;
};

template <EffectBits E> TileResult traceLight(const PathContext& context, Film& film, const LightJob& job) {
    return LightKernel<E>(context, film, job).run();
}
template <EffectBits E>
TileResult listenToLight(const PathContext& context, Film& film, const LightJob& job, LightListener& listener) {
    return LightKernel<E>(context, film, job).listen(listener);
}

} // namespace abbe
