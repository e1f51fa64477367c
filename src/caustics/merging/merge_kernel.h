// Rounds of merging: light paths leave photons, and camera paths through all pixels gather them [Jensen1996;
// Hachisuka2008; Knaus2011].
#pragma once

#include "caustics/merging/gather_path.h"
#include "caustics/merging/photon_path.h"
#include "caustics/shared/kernel_jobs.h"
#include "caustics/shared/light_start.h"
#include "render/film.h"
#include "transport/camera_start.h"

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
    float of(int x, int y) { return most(x, y); }

  private:
    float& most(int x, int y) {
        return most_[static_cast<std::size_t>(bounds_.width()) * static_cast<std::size_t>(y - bounds_.y0) +
                     static_cast<std::size_t>(x - bounds_.x0)];
    }
    PixelBounds bounds_;
    std::vector<float> most_;
};

// A round is a picture of its own: light paths and camera paths are those of its number alone, whoever makes it.
template <EffectBits E> class MergeKernel {
  public:
    MergeKernel(const PathContext& context, Film& film, const MergeJob& job, MergeListener* listener)
        : context_(context), plan_(*context.merging), film_(film), job_(job), listener_(listener),
          media_(PathWalk<E>::makeMedia(context.scene, *context.stop)) {}

    TileResult run() {
        const WorkScope work(Work::lights);
        addWorkFlag(WorkFlag::light);
        std::uint32_t unit = 0;
        for (int r = 0; r < film_.replicates(); ++r)
            for (std::uint32_t i = job_.first; i < job_.last && !result_.rest; ++i, ++unit)
                if (unit >= job_.from && i % plan_.every == 0 && i / plan_.every % job_.blocks == job_.block)
                    if (!round(r, i / plan_.every)) result_.rest = {unit, 0};
        removeWorkFlag(WorkFlag::light);
        if constexpr (PathWalk<E>::kMedia) result_.excess = media_.tracker.counters.excess();
        return std::move(result_);
    }

  private:
    static constexpr std::uint64_t kRound = 0x726f756e64, kPhoton = 0x70686f746f6e, kGather = 0x676174686572,
                                   kGatherMore = 0x676174686d6f7265;

    std::uint64_t key(std::uint64_t purpose, int replicate) const {
        return combine64(combine64(context_.settings.seed, purpose), static_cast<std::uint64_t>(replicate));
    }

    // Whether it came to its end. A round of which something is left out would be too dark: it is left out as a whole.
    bool round(int replicate, std::uint32_t number) {
        sampler_.startPixel(key(kRound, replicate), Technique::Numbers::sobol, true);
        sampler_.start(number);
        lambda_ = context_.scene.wavelengths.sample(sampler_.wavelength());
        time_ = sampler_.time();
        radius_ = job_.wider * MergePlan::radius(number);
        const PathCounters before = result_.counters;
        const PhotonMaps photons(trace(replicate, number));
        const std::uint64_t photonRays = raysOf(result_.counters) - raysOf(before);
        if (!gatherAll(replicate, number, photons)) {
            result_.counters = before;
            return false;
        }
        for (const Gathered& g : gathered_) add(g, replicate, number);
        film_.countRounds(replicate, 1);
        ++result_.rounds;
        result_.photonRays += photonRays;
        result_.photons += photons.size();
        result_.lightPaths += plan_.photons;
        return true;
    }

    static std::uint64_t raysOf(const PathCounters& c) { return c.vertices + c.shadowRays; }

    // Unless it is told to stop.
    bool gatherAll(int replicate, std::uint32_t number, const PhotonMaps& photons) {
        gathered_.clear();
        if (job_.step > 1)
            gatherSome(replicate, number, photons);
        else
            gatherFirst(replicate, number, photons);
        if (plan_.more > 0 && job_.step == 1) gatherMore(replicate, number, photons);
        return !left();
    }

    // In a part of the pixels, others in each round, spread evenly [Roberts2018]; the first is in the middle.
    void gatherSome(int replicate, std::uint32_t number, const PhotonMaps& photons) {
        const PixelBounds frame = context_.scene.frame, pixels = film_.bounds();
        const auto phase = [&](double golden) {
            const double place = 0.5 + number * golden;
            return static_cast<int>((place - std::floor(place)) * job_.step);
        };
        const int px = phase(0.7548776662466927), py = phase(0.5698402909980532);
        for (int y = pixels.y0; y < pixels.y1 && !left(); ++y)
            for (int x = pixels.x0; x < pixels.x1; ++x)
                if ((x - frame.x0) % job_.step == px && (y - frame.y0) % job_.step == py)
                    gather({x, y, replicate, number}, key(kGather, replicate), 1, photons);
    }

    // By one path for every pixel of the film, and for those of the frame near it, which tell of theirs.
    void gatherFirst(int replicate, std::uint32_t number, const PhotonMaps& photons) {
        const PixelBounds frame = context_.scene.frame, film = film_.bounds();
        const int near = plan_.more > 0 ? BrightnessAround::kReach : 0;
        const PixelBounds seen{std::max(frame.x0, film.x0 - near), std::max(frame.y0, film.y0 - near),
                               std::min(frame.x1, film.x1 + near), std::min(frame.y1, film.y1 + near)};
        if (plan_.more > 0) around_.start(seen);
        for (int y = seen.y0; y < seen.y1 && !left(); ++y)
            for (int x = seen.x0; x < seen.x1; ++x) {
                const double luminance = gather({x, y, replicate, number}, key(kGather, replicate), 1, photons);
                if (plan_.more > 0 && luminance != 0) around_.add(x, y, static_cast<float>(std::abs(luminance)));
            }
        std::erase_if(gathered_, [&](const Gathered& g) {
            return g.x < film.x0 || g.y < film.y0 || g.x >= film.x1 || g.y >= film.y1;
        });
    }

    // A camera path that a rim may mirror meets a caustic or does not, and its pixel is as noisy as chance makes that,
    // however many photons there are. So where light is there are more. Neighbours tell where: by its own path a pixel
    // that has not met the light would count as dark, and too bright where it has.
    void gatherMore(int replicate, std::uint32_t number, const PhotonMaps& photons) {
        const PixelBounds film = film_.bounds();
        for (Gathered& g : gathered_) g.factor /= 1 + static_cast<double>(more(g.x, g.y));
        for (int y = film.y0; y < film.y1 && !left(); ++y)
            for (int x = film.x0; x < film.x1; ++x) {
                const std::uint32_t n = more(x, y);
                const double share = 1 / (1 + static_cast<double>(n));
                for (std::uint32_t j = 0; j < n; ++j)
                    gather({x, y, replicate, number * plan_.more + j}, key(kGatherMore, replicate), share, photons);
            }
    }
    std::uint32_t more(int x, int y) { return plan_.moreBeside(around_.of(x, y)); }

    bool left() const { return media_.left() || result_.counters.left || context_.toldToStop(); }

    std::vector<Photon> trace(int replicate, std::uint32_t number) {
        std::vector<Photon> photons;
        std::uint64_t startedAs = ~std::uint64_t{0};
        for (std::uint32_t j = 0; j < plan_.photons && !left(); ++j) {
            const std::uint64_t path = std::uint64_t{number} * plan_.photons + j;
            if (path >> 32 != startedAs) { // sequences have 2^32 points
                startedAs = path >> 32;
                sampler_.startPixel(combine64(key(kPhoton, replicate), startedAs), Technique::Numbers::sobol, true);
            }
            sampler_.start(static_cast<std::uint32_t>(path));
            traceOne(photons);
        }
        return photons;
    }

    void traceOne(std::vector<Photon>& photons) {
        const Scene& scene = context_.scene;
        const auto start = startOfLightPath(plan_.emission, sampler_, lambda_, scene.camera->rayTime(time_));
        if (!start) return;
        if (listener_) listener_->starts(*start);
        if (!plan_.lights.contains(start->light) || isShaded(scene, *start)) return;
        PhotonPath<E> path(context_, sampler_, arena_, vertexArenas_, result_.counters, media_);
        path.walk().startIn(surroundingsOf(scene, *start));
        path.leavePhotons(*start, lambda_, [&](Photon photon) {
            photon.flux *= 1 / static_cast<float>(plan_.photons);
            photons.push_back(photon);
        });
        removeWorkFlag(WorkFlag::heroOnly);
    }

    // By the camera path of this number of a pixel's, which counts for a share of them; luminance that it found.
    double gather(const SampleId& id, std::uint64_t key, double share, const PhotonMaps& photons) {
        const auto [x, y, replicate, number] = id;
        const auto place =
            (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32) | static_cast<std::uint32_t>(x);
        sampler_.startPixel(combine64(key, place), Technique::Numbers::sobol, true);
        sampler_.start(number);
        const FilterSample filter = film_.filter(sampler_.film());
        const CameraSample at{
            {static_cast<float>(x) + 0.5f + filter.offset.x, static_cast<float>(y) + 0.5f + filter.offset.y},
            sampler_.lens(),
            time_,
            lambda_.nm[0]};
        const CameraRay camera = context_.scene.camera->ray(at);
        if (listener_) listener_->begins(x, y);
        if (!(camera.weight > 0)) return 0;
        const std::uint64_t before = raysOf(result_.counters);
        GatherPath<E> path(context_, sampler_, arena_, result_.counters, media_);
        startFromCamera(path.walk(), at, camera, surroundings_);
        const auto factor = static_cast<double>(camera.weight * filter.weight);
        sums_.clear();
        path.gather(camera.ray, lambda_, camera.heroOnly, photons, radius_, [&](const GatheredLight& light) {
            if (listener_) tell(light, factor);
            Sum& sum = sumOf(light.photon.light);
            sum.radiance += light.value;
            sum.closer += light.value * light.closer;
        });
        removeWorkFlag(WorkFlag::heroOnly);
        if (listener_) listener_->ends(raysOf(result_.counters) - before);
        double luminance = 0;
        for (const Sum& sum : sums_) {
            gathered_.push_back({x, y, factor * share, sum});
            luminance += context_.scene.sensor(sum.radiance, lambda_).y * factor;
        }
        return luminance;
    }

    // Of one light, for light groups.
    struct Sum {
        const Light* light = nullptr;
        Spectrum radiance{0.f}, closer{0.f};
    };
    Sum& sumOf(const Light* light) {
        for (Sum& sum : sums_)
            if (sum.light == light) return sum;
        return sums_.emplace_back(Sum{light});
    }

    void tell(const GatheredLight& light, double factor) const {
        const double found = context_.scene.sensor(light.value, lambda_).y * factor;
        const double odds = static_cast<double>(light.photon.cameraOdds) * static_cast<double>(light.cameraPdf);
        const double one = found * plan_.photons / static_cast<double>(light.kernel); // by a single light path
        listener_->gathers(light.photon, found, odds > 0 ? one / odds : 0);
    }

    // What a pixel is to have of the round.
    struct Gathered {
        int x = 0, y = 0;
        double factor = 0;
        Sum sum;
    };
    void add(const Gathered& gathered, int replicate, std::uint32_t number) {
        const auto& [x, y, factor, sum] = gathered;
        const SampleId sample{x, y, replicate, number * plan_.every};
        const Xyz value = context_.scene.sensor(sum.radiance, lambda_) * factor;
        const double closer = context_.scene.sensor(sum.closer, lambda_).y * factor;
        const double size = std::abs(value.x) + std::abs(value.y) + std::abs(value.z) + std::abs(closer);
        if (!(size < ExactSum::kLargest)) [[unlikely]]
            return result_.drop({sample, std::isnan(size) ? DropCause::nan : DropCause::infinite});
        film_.splat(
            sample.x, sample.y, sample.replicate,
            {value, sum.radiance, lambda_, factor, sum.light, PathComponent::caustic, SplatKind::merged, closer});
        ++result_.splats;
    }

    const PathContext& context_;
    const MergePlan& plan_;
    Film& film_;
    const MergeJob& job_;
    MergeListener* const listener_;
    Sampler sampler_;
    Arena arena_;
    VertexArenas vertexArenas_;
    CameraSurroundings surroundings_;
    typename PathWalk<E>::Media media_;
    std::vector<Sum> sums_;          // of this pixel
    std::vector<Gathered> gathered_; // of the round
    BrightnessAround around_;        // likewise
    Wavelengths lambda_;             // of the round
    float time_ = 0;                 // likewise, as CameraSample::time
    float radius_ = 0;               // likewise, over that of cones
    TileResult result_;
};

template <EffectBits E>
TileResult merge(const PathContext& context, Film& film, const MergeJob& job, MergeListener* listener) {
    return MergeKernel<E>(context, film, job, listener).run();
}

} // namespace abbe
