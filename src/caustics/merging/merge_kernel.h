// Rounds of merging: light paths leave photons, and camera paths through all pixels gather them [Jensen1996;
// Hachisuka2008; Knaus2011].
#pragma once

#include "caustics/merging/gather_path.h"
#include "caustics/merging/photon_path.h"
#include "caustics/shared/kernel_jobs.h"
#include "caustics/shared/light_start.h"
#include "caustics/shared/shared_work.h"
#include "render/film.h"
#include "transport/camera_start.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <memory>
#include <span>
#include <utility>
#include <vector>

namespace abbe {

// How bright the pixels around each are by their first camera paths of a round.
class BrightnessAround {
  public:
    static constexpr int kReach = 3; // pixels: bright rims are thin, and one path in a few meets what they mirror

    void start(PixelBounds bounds) {
        bounds_ = bounds;
        most_.assign(static_cast<std::size_t>(bounds.area()), 0);
    }
    void add(int x, int y, float luminance) {
        float& itself = most(x, y);
        const float before = itself;
        const int x0 = std::max(x - kReach, bounds_.x0), x1 = std::min(x + kReach + 1, bounds_.x1);
        for (int v = std::max(y - kReach, bounds_.y0); v < std::min(y + kReach + 1, bounds_.y1); ++v) {
            float* const row = &most(x0, v);
            for (int i = 0; i < x1 - x0; ++i) row[i] = std::max(row[i], luminance);
        }
        itself = before;
    }
    // The brightest of the others within kReach.
    float of(int x, int y) const { return most_[place(x, y)]; }

  private:
    float& most(int x, int y) { return most_[place(x, y)]; }
    std::size_t place(int x, int y) const {
        return static_cast<std::size_t>(bounds_.width()) * static_cast<std::size_t>(y - bounds_.y0) +
               static_cast<std::size_t>(x - bounds_.x0);
    }

    PixelBounds bounds_;
    std::vector<float> most_;
};

// What the paths of one round share.
struct MergeRound {
    int replicate = 0;
    std::uint32_t number = 0;
    Wavelengths lambda;
    float time = 0;   // as CameraSample::time
    float radius = 0; // over that of cones
};

// Of one light, for light groups.
struct MergedSum {
    const Light* light = nullptr;
    Spectrum radiance{0.f}, closer{0.f};
};

// What a pixel is to have of a round.
struct MergedPixel {
    int x = 0, y = 0;
    double factor = 0;
    MergedSum sum;
};

// Traces paths of rounds, of lights and of the camera.
template <EffectBits E> class MergeTracer {
  public:
    MergeTracer(const PathContext& context, const Film& film, const MergeJob& job, MergeListener* listener)
        : context_(context), plan_(*context.merging), film_(film), job_(job), listener_(listener),
          media_(PathWalk<E>::makeMedia(context.scene, *context.stop)) {}

    // What the round's light paths [first, last) leave.
    void trace(const MergeRound& round, std::uint32_t first, std::uint32_t last, std::vector<Photon>& photons) {
        std::uint64_t startedAs = ~std::uint64_t{0};
        for (std::uint32_t j = first; j < last && !left(); ++j) {
            const std::uint64_t path = std::uint64_t{round.number} * plan_.photons + j;
            if (path >> 32 != startedAs) { // sequences have 2^32 points
                startedAs = path >> 32;
                sampler_.startPixel(combine64(key(kPhoton, round.replicate), startedAs), Technique::Numbers::sobol,
                                    true);
            }
            sampler_.start(static_cast<std::uint32_t>(path));
            traceOne(round, photons);
        }
    }

    // What camera paths find in the pixels, here and below, unless they are told to stop; by one path for each. Of a
    // part of the pixels, if the job says so, others in each round, spread evenly [Roberts2018]; the first is in the
    // middle.
    void gatherFirst(const MergeRound& round, PixelBounds pixels, const PhotonMaps& photons,
                     std::vector<MergedPixel>& gathered) {
        const PixelBounds frame = context_.scene.frame;
        const auto phase = [&](double golden) {
            const double place = 0.5 + round.number * golden;
            return static_cast<int>((place - std::floor(place)) * job_.step);
        };
        const int px = phase(0.7548776662466927), py = phase(0.5698402909980532);
        for (int y = pixels.y0; y < pixels.y1 && !left(); ++y)
            for (int x = pixels.x0; x < pixels.x1; ++x)
                if ((x - frame.x0) % job_.step == px && (y - frame.y0) % job_.step == py)
                    gather(round, {x, y, round.number, kGather, 1}, photons, gathered);
    }
    // By as many more as more(x, y) says.
    template <typename More>
    void gatherMore(const MergeRound& round, PixelBounds pixels, const PhotonMaps& photons, const More& more,
                    std::vector<MergedPixel>& gathered) {
        for (int y = pixels.y0; y < pixels.y1 && !left(); ++y)
            for (int x = pixels.x0; x < pixels.x1; ++x) {
                const std::uint32_t n = more(x, y);
                const double share = 1 / (1 + static_cast<double>(n));
                for (std::uint32_t j = 0; j < n; ++j)
                    gather(round, {x, y, round.number * plan_.more + j, kGatherMore, share}, photons, gathered);
            }
    }

    bool left() const { return media_.left() || counters_.left || context_.toldToStop(); }

    // Since it was asked last.
    PathCounters takeCounters() { return std::exchange(counters_, {}); }
    // In all.
    DensityExcess excess() const {
        if constexpr (PathWalk<E>::kMedia) return media_.tracker.counters.excess();
        return {};
    }

  private:
    static constexpr std::uint64_t kPhoton = 0x70686f746f6e, kGather = 0x676174686572, kGatherMore = 0x676174686d6f7265;

    // A camera path: its number of those that the pixel has for this purpose, and what part of the pixel's it is.
    struct GatherId {
        int x, y;
        std::uint32_t number;
        std::uint64_t purpose;
        double share;
    };

    std::uint64_t key(std::uint64_t purpose, int replicate) const {
        return combine64(combine64(context_.settings.seed, purpose), static_cast<std::uint64_t>(replicate));
    }

    void traceOne(const MergeRound& round, std::vector<Photon>& photons) {
        const Scene& scene = context_.scene;
        const auto start = startOfLightPath(plan_.emission, sampler_, round.lambda, scene.camera->rayTime(round.time));
        if (!start) return;
        if (listener_) listener_->starts(*start);
        if (!plan_.lights.contains(start->light) || isShaded(scene, *start)) return;
        PhotonPath<E> path(context_, sampler_, arena_, vertexArenas_, counters_, media_);
        path.walk().startIn(surroundingsOf(scene, *start));
        path.leavePhotons(*start, round.lambda, [&](Photon photon) {
            photon.flux *= 1 / static_cast<float>(plan_.photons);
            photons.push_back(photon);
        });
        removeWorkFlag(WorkFlag::heroOnly);
    }

    static std::uint64_t raysOf(const PathCounters& c) { return c.vertices + c.shadowRays; }

    void gather(const MergeRound& round, const GatherId& id, const PhotonMaps& photons,
                std::vector<MergedPixel>& gathered) {
        const auto place =
            (static_cast<std::uint64_t>(static_cast<std::uint32_t>(id.y)) << 32) | static_cast<std::uint32_t>(id.x);
        sampler_.startPixel(combine64(key(id.purpose, round.replicate), place), Technique::Numbers::sobol, true);
        sampler_.start(id.number);
        const FilterSample filter = film_.filter(sampler_.film());
        const CameraSample at{
            {static_cast<float>(id.x) + 0.5f + filter.offset.x, static_cast<float>(id.y) + 0.5f + filter.offset.y},
            sampler_.lens(),
            round.time,
            round.lambda.nm[0]};
        const CameraRay camera = context_.scene.camera->ray(at);
        if (listener_) listener_->begins(id.x, id.y);
        if (!(camera.weight > 0)) return;
        const std::uint64_t before = raysOf(counters_);
        GatherPath<E> path(context_, sampler_, arena_, counters_, media_);
        startFromCamera(path.walk(), at, camera, surroundings_);
        const auto factor = static_cast<double>(camera.weight * filter.weight);
        sums_.clear();
        path.gather(camera.ray, round.lambda, camera.heroOnly, photons, round.radius, [&](const GatheredLight& light) {
            if (listener_) tell(round, light, factor);
            MergedSum& sum = sumOf(light.photon.light);
            sum.radiance += light.value;
            sum.closer += light.value * light.closer;
        });
        removeWorkFlag(WorkFlag::heroOnly);
        if (listener_) listener_->ends(raysOf(counters_) - before);
        for (const MergedSum& sum : sums_) gathered.push_back({id.x, id.y, factor * id.share, sum});
    }

    MergedSum& sumOf(const Light* light) {
        for (MergedSum& sum : sums_)
            if (sum.light == light) return sum;
        return sums_.emplace_back(MergedSum{light});
    }

    void tell(const MergeRound& round, const GatheredLight& light, double factor) const {
        const double found = context_.scene.sensor(light.value, round.lambda).y * factor;
        const double odds = static_cast<double>(light.photon.cameraOdds) * static_cast<double>(light.cameraPdf);
        const double one = found * plan_.photons / static_cast<double>(light.kernel); // by a single light path
        listener_->gathers(light.photon, found, odds > 0 ? one / odds : 0);
    }

    const PathContext& context_;
    const MergePlan& plan_;
    const Film& film_;
    const MergeJob& job_;
    MergeListener* const listener_;
    Sampler sampler_;
    Arena arena_;
    VertexArenas vertexArenas_;
    CameraSurroundings surroundings_;
    typename PathWalk<E>::Media media_;
    std::vector<MergedSum> sums_; // of this pixel
    PathCounters counters_;
};

// A round is a picture of its own: light paths and camera paths are those of its number alone, whoever makes it. Idle
// threads take part in it, unless somebody listens.
template <EffectBits E> class MergeKernel {
  public:
    MergeKernel(const PathContext& context, Film& film, const MergeJob& job, MergeListener* listener)
        : context_(context), plan_(*context.merging), film_(film), job_(job), listener_(listener) {}

    TileResult run() {
        const WorkScope work(Work::lights);
        addWorkFlag(WorkFlag::light);
        std::uint32_t unit = 0;
        for (int r = 0; r < film_.replicates(); ++r)
            for (std::uint32_t i = job_.first; i < job_.last && !result_.rest; ++i, ++unit)
                if (unit >= job_.from && i % plan_.every == 0 && i / plan_.every % job_.blocks == job_.block)
                    if (!round(r, i / plan_.every)) result_.rest = {unit, 0};
        removeWorkFlag(WorkFlag::light);
        for (const auto& tracer : tracers_.all()) result_.excess.add(tracer->excess());
        result_.secondsElsewhere = shared_.secondsElsewhere();
        return std::move(result_);
    }

  private:
    static constexpr std::uint64_t kRound = 0x726f756e64;
    static constexpr std::uint32_t kPathsOfPart = 256;      // of light
    static constexpr int kPixelsOfPart = 256;               // as many rows as have so many
    using Gathered = std::vector<std::vector<MergedPixel>>; // by parts of the picture, in the order of the pixels

    // Whether it came to its end. A round of which something is left out would be too dark: it is left out as a whole.
    bool round(int replicate, std::uint32_t number) {
        const MergeRound round = begin(replicate, number);
        const PhotonMaps photons(trace(round));
        const PathCounters ofPhotons = takeCounters();
        const Gathered parts = gather(round, photons);
        const PathCounters ofPixels = takeCounters();
        if (left_) return false;
        result_.counters.add(ofPhotons);
        result_.counters.add(ofPixels);
        for (const std::vector<MergedPixel>& part : parts)
            for (const MergedPixel& pixel : part) add(pixel, round);
        film_.countRounds(replicate, 1);
        ++result_.rounds;
        result_.photonRays += ofPhotons.vertices + ofPhotons.shadowRays;
        result_.photons += photons.size();
        result_.lightPaths += plan_.photons;
        return true;
    }

    MergeRound begin(int replicate, std::uint32_t number) const {
        Sampler sampler;
        sampler.startPixel(combine64(combine64(context_.settings.seed, kRound), static_cast<std::uint64_t>(replicate)),
                           Technique::Numbers::sobol, true);
        sampler.start(number);
        return {replicate, number, context_.scene.wavelengths.sample(sampler.wavelength()), sampler.time(),
                job_.wider * MergePlan::radius(number)};
    }

    // In the order of the light paths.
    std::vector<Photon> trace(const MergeRound& round) {
        const std::uint32_t size = listener_ ? std::max(1u, plan_.photons) : kPathsOfPart;
        std::vector<std::vector<Photon>> parts((plan_.photons + size - 1) / size);
        share(parts.size(), [&](MergeTracer<E>& tracer, std::size_t i) {
            const auto first = static_cast<std::uint32_t>(i) * size;
            tracer.trace(round, first, std::min(plan_.photons, first + size), parts[i]);
        });
        if (parts.size() == 1) return std::move(parts[0]);
        std::vector<Photon> all;
        std::size_t count = 0;
        for (const std::vector<Photon>& part : parts) count += part.size();
        all.reserve(count);
        for (std::vector<Photon>& part : parts) {
            all.insert(all.end(), part.begin(), part.end());
            part = {};
        }
        return all;
    }

    Gathered gather(const MergeRound& round, const PhotonMaps& photons) {
        // Pixels of the frame near the film tell of theirs.
        const PixelBounds frame = context_.scene.frame, film = film_.bounds();
        const bool takesMore = plan_.more > 0 && job_.step == 1;
        const int near = takesMore ? BrightnessAround::kReach : 0;
        const PixelBounds seen{std::max(frame.x0, film.x0 - near), std::max(frame.y0, film.y0 - near),
                               std::min(frame.x1, film.x1 + near), std::min(frame.y1, film.y1 + near)};
        Gathered all = inRows(seen, [&](MergeTracer<E>& tracer, PixelBounds rows, std::vector<MergedPixel>& to) {
            tracer.gatherFirst(round, rows, photons, to);
        });
        if (takesMore) gatherMore(round, seen, photons, all);
        return all;
    }

    // A camera path that a rim may mirror meets a caustic or does not, and its pixel is as noisy as chance makes that,
    // however many photons there are. So where light is there are more. Neighbours tell where: by its own path a pixel
    // that has not met the light would count as dark, and too bright where it has.
    void gatherMore(const MergeRound& round, PixelBounds seen, const PhotonMaps& photons, Gathered& all) {
        const PixelBounds film = film_.bounds();
        look(round, seen, all);
        const auto more = [this](int x, int y) { return plan_.moreBeside(around_.of(x, y)); };
        for (std::vector<MergedPixel>& part : all) {
            std::erase_if(part, [&](const MergedPixel& g) {
                return g.x < film.x0 || g.y < film.y0 || g.x >= film.x1 || g.y >= film.y1;
            });
            for (MergedPixel& g : part) g.factor /= 1 + static_cast<double>(more(g.x, g.y));
        }
        Gathered others = inRows(film, [&](MergeTracer<E>& tracer, PixelBounds rows, std::vector<MergedPixel>& to) {
            tracer.gatherMore(round, rows, photons, more, to);
        });
        std::ranges::move(others, std::back_inserter(all));
    }

    // How bright pixels are by their first paths, whose light lies side by side, one light after the other.
    void look(const MergeRound& round, PixelBounds seen, const Gathered& first) {
        around_.start(seen);
        for (const std::vector<MergedPixel>& part : first)
            for (std::size_t i = 0; i < part.size();) {
                const MergedPixel& pixel = part[i];
                double luminance = 0;
                for (; i < part.size() && part[i].x == pixel.x && part[i].y == pixel.y; ++i)
                    luminance += context_.scene.sensor(part[i].sum.radiance, round.lambda).y * part[i].factor;
                if (luminance != 0) around_.add(pixel.x, pixel.y, static_cast<float>(std::abs(luminance)));
            }
    }

    // Calls body(tracer, rows, what it is to add to) for all rows of the pixels, shared out.
    template <typename Body> Gathered inRows(PixelBounds pixels, Body&& body) {
        const int each = listener_ ? pixels.height() : std::max(1, kPixelsOfPart / pixels.width());
        Gathered parts(static_cast<std::size_t>((pixels.height() + each - 1) / each));
        share(parts.size(), [&](MergeTracer<E>& tracer, std::size_t i) {
            const int y0 = pixels.y0 + static_cast<int>(i) * each;
            body(tracer, PixelBounds{pixels.x0, y0, pixels.x1, std::min(pixels.y1, y0 + each)}, parts[i]);
        });
        return parts;
    }

    template <typename Body> void share(std::size_t parts, Body&& body) {
        shared_.run(parts, [&](std::size_t i) {
            std::unique_ptr<MergeTracer<E>> tracer =
                tracers_.take([&] { return std::make_unique<MergeTracer<E>>(context_, film_, job_, listener_); });
            body(*tracer, i);
            tracers_.giveBack(std::move(tracer));
        });
    }

    // Of all tracers, and whether anything was left.
    PathCounters takeCounters() {
        PathCounters sum;
        for (const auto& tracer : tracers_.all()) {
            left_ |= tracer->left();
            sum.add(tracer->takeCounters());
        }
        return sum;
    }

    void add(const MergedPixel& gathered, const MergeRound& round) {
        const auto& [x, y, factor, sum] = gathered;
        const SampleId sample{x, y, round.replicate, round.number * plan_.every};
        const Xyz value = context_.scene.sensor(sum.radiance, round.lambda) * factor;
        const double closer = context_.scene.sensor(sum.closer, round.lambda).y * factor;
        const double size = std::abs(value.x) + std::abs(value.y) + std::abs(value.z) + std::abs(closer);
        if (!(size < ExactSum::kLargest)) [[unlikely]]
            return result_.drop({sample, std::isnan(size) ? DropCause::nan : DropCause::infinite});
        film_.splat(
            sample.x, sample.y, sample.replicate,
            {value, sum.radiance, round.lambda, factor, sum.light, PathComponent::caustic, SplatKind::merged, closer});
        ++result_.splats;
    }

    const PathContext& context_;
    const MergePlan& plan_;
    Film& film_;
    const MergeJob& job_;
    MergeListener* const listener_;
    SharedWork shared_;
    ToolPool<MergeTracer<E>> tracers_;
    BrightnessAround around_; // of the round
    bool left_ = false;       // something, since the render is to end
    TileResult result_;
};

template <EffectBits E>
TileResult merge(const PathContext& context, Film& film, const MergeJob& job, MergeListener* listener) {
    return MergeKernel<E>(context, film, job, listener).run();
}

} // namespace abbe
