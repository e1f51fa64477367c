// One tile of one pass: the unit of work, and the only function that exists once per set of effects.
#pragma once

#include "integrators/camera_start.h"
#include "integrators/glint_loop.h"
#include "integrators/path_loop.h"
#include "render/portion.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

namespace abbe {

class SamplingPlan;
// What samples a pixel takes when `nominal` ones are asked for: those, without a plan.
SampleRange plannedRange(const SamplingPlan*, int x, int y, SampleRange nominal);

// Samples [first, last) of every replicate of every pixel of `pixels`, or what the plan makes of them; but for those
// before `from`.
struct TileJob {
    PixelBounds pixels;
    std::uint32_t first = 0, last = 0;
    const RouletteReference* roulette = nullptr;
    const SamplingPlan* plan = nullptr;
    PortionPlace from = {};
};

struct TileResult {
    PathCounters counters;
    std::array<std::uint64_t, 3> dropped{}; // by DropCause
    std::vector<DroppedSample> examples;    // at most a few
    DensityExcess excess;
    std::uint64_t lightPaths = 0, splats = 0, rounds = 0; // as in PathTally
    // Of all rays that counters tell: of light paths after they were spread, and of those for merging.
    std::uint64_t raysAfterSpread = 0, photonRays = 0;
    std::uint64_t photons = 0; // that these left
    // Nothing unless it was told to stop: the rest of the job.
    std::optional<PortionPlace> rest;

    void drop(const DroppedSample& sample) {
        ++dropped[static_cast<std::size_t>(sample.cause)];
        if (examples.size() < 4) examples.push_back(sample);
    }
    void add(const TileResult& r) {
        counters.add(r.counters);
        for (std::size_t i = 0; i < dropped.size(); ++i) dropped[i] += r.dropped[i];
        for (const DroppedSample& s : r.examples)
            if (examples.size() < 4) examples.push_back(s);
        excess.add(r.excess);
        lightPaths += r.lightPaths;
        splats += r.splats;
        rounds += r.rounds;
        raysAfterSpread += r.raysAfterSpread;
        photonRays += r.photonRays;
        photons += r.photons;
        if (r.rest) rest = r.rest;
    }
};

// Paths from the film: where, which wavelengths, what came back. Every sample passes one gate: one that is not finite
// and non-negative is counted by cause and left out of the pixel's mean. A path on which a density exceeded its bound
// has the right to be negative: the mean is right with it.
template <EffectBits E> class TileKernel {
  public:
    TileKernel(const PathContext& context, Film& film, const TileJob& job)
        : context_(context), film_(film), job_(job), media_(PathLoop<E>::makeMedia(context.scene, *context.stop)),
          recorder_(film.makeRecorder()) {}

    TileResult run() {
        const WorkScope work(Work::film);
        const std::uint64_t lookups = workState.textureLookups, moving = workState.movingHits;
        takeSamples();
        if constexpr (PathLoop<E>::kMedia) {
            const MediumCounters& media = media_.tracker.counters;
            result_.excess = media.excess();
            for (std::size_t i = 0; i < kVolumeWorks; ++i) result_.counters.effects.volumes[i].add(media.volumes[i]);
        }
        result_.counters.effects.textureLookups = workState.textureLookups - lookups;
        result_.counters.effects.movingHits = workState.movingHits - moving;
        return std::move(result_);
    }

  private:
    using Media = typename PathLoop<E>::Media;
    using Clock = std::chrono::steady_clock;

    void takeSamples() {
        for (int y = job_.pixels.y0; y < job_.pixels.y1; ++y)
            for (int x = job_.pixels.x0; x < job_.pixels.x1; ++x)
                for (int r = 0; r < film_.replicates(); ++r, ++unit_) {
                    if (unit_ < job_.from.unit) continue;
                    if (context_.toldToStop()) return void(result_.rest = {unit_, takenBefore()});
                    replicate(x, y, r);
                    if (result_.rest) return;
                }
    }

    // Of the samples of this unit.
    std::uint32_t takenBefore() const { return unit_ == job_.from.unit ? job_.from.done : 0; }

    void replicate(int x, int y, int r) {
        SampleRange range = plannedRange(job_.plan, x, y, {job_.first, job_.last});
        range.first = std::min(range.first + takenBefore(), range.last);
        if (range.first == range.last) return;
        const std::uint64_t place =
            (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32) | static_cast<std::uint32_t>(x);
        const std::uint64_t seed = combine64(combine64(context_.settings.seed, place), static_cast<std::uint64_t>(r));
        const float rouletteScale = job_.roulette->scale(x, y);
        ExactXyz sum;
        std::uint32_t counted = 0;
        sampler_.startPixel(seed, context_.settings.technique.numbers, context_.choices, context_.strata);
        const auto started = recorder_ ? Clock::now() : Clock::time_point();
        if (recorder_) recorder_->pixel(x, y, r);
        if constexpr (PathLoop<E>::kTraced)
            if (context_.glints) glints_ = context_.glints->ofRow(y);
        for (std::uint32_t i = range.first; i < range.last; ++i) {
            sampler_.start(i);
            const Xyz value = sample(x, y, rouletteScale);
            if (const auto cause = fault(value); cause < 3) {
                if (result_.counters.left) {
                    result_.rest = {unit_, takenBefore() + i - range.first};
                    range.last = i;
                    break;
                }
                result_.drop({{x, y, r, i}, static_cast<DropCause>(cause)});
                if (recorder_) tellDrop();
                continue;
            }
            if (recorder_) recorder_->keep(radiance_, context_.scene.sensor, factor_);
            sum += value;
            ++counted;
        }
        film_.add(x, y, r, sum, counted);
        if (recorder_) recorder_->pixelDone(std::chrono::duration<double>(Clock::now() - started).count());
        result_.counters.paths += range.last - range.first;
    }

    Xyz sample(int x, int y, float rouletteScale) {
        setWork(Work::camera);
        const FilterSample filter = film_.filter(sampler_.film());
        const Vec2 place{static_cast<float>(x) + 0.5f + filter.offset.x,
                         static_cast<float>(y) + 0.5f + filter.offset.y};
        Wavelengths lambda = context_.scene.wavelengths.sample(sampler_.wavelength());
        if (context_.how.wavelengths != kLanes) [[unlikely]]
            lambda = LoopTechnique::repeated(lambda, context_.how.wavelengths);
        const CameraSample at{place, sampler_.lens(), sampler_.time(), lambda.nm[0]};
        const CameraRay camera = context_.scene.camera->ray(at);
        radiance_ = Spectrum(0.f);
        factor_ = static_cast<double>(camera.weight * filter.weight);
        if (recorder_) recorder_->start(camera.ray, lambda);
        if (!(camera.weight > 0)) return withoutRay(camera);
        PathLoop<E> loop(context_, sampler_, arena_, result_.counters, media_);
        loop.watch(recorder_.get());
        if constexpr (PathLoop<E>::kInterfaces) loop.startIn(around_.at(context_.scene, camera.ray));
        if constexpr (PathLoop<E>::kTextures) loop.startWith(coneOf(*context_.scene.camera, at, camera.ray));
        if constexpr (hasEffect(E, Effect::dispersion))
            if (camera.heroOnly) loop.startWithHero();
        if constexpr (PathLoop<E>::kTraced) {
            view_.camera = camera;
            view_.query = lensQuery(context_.scene.frame, camera.ray.time, lambda.nm[0]);
            loop.weighAgainst(view_);
            loop.leaveOut(glints_, place);
        }
        [[maybe_unused]] const std::uint64_t before = signedWeights();
        Spectrum glints(0.f);
        if constexpr (PathLoop<E>::kTraced) glints = probeGlints(x, y, lambda);
        radiance_ = loop.radiance(camera.ray, lambda, rouletteScale);
        if constexpr (PathLoop<E>::kTraced) addGlints(glints);
        setWork(Work::film);
        if constexpr (hasEffect(E, Effect::dispersion)) removeWorkFlag(WorkFlag::heroOnly);
        if constexpr (PathLoop<E>::kMedia) setWorkCause(0);
        if constexpr (PathLoop<E>::kMedia) {
            // Where a density exceeded its bound light may be subtracted.
            const float most = signedWeights() != before ? 0.5f * kNegativeFault : 0;
            if (-maxLane(-loop.least()) < most && allFinite(radiance_)) radiance_ = Spectrum(kNegativeFault);
            condemnDensities();
        }
        if constexpr (PathLoop<E>::kMedia || PathLoop<E>::kTraced) leaveWithParts();
        return context_.scene.sensor(radiance_, lambda) * factor_;
    }

    // A sample of which a probe, or a ray in a medium, was left is left itself.
    void leaveWithParts() {
        result_.counters.left |= media_.left();
        if (result_.counters.left) [[unlikely]]
            radiance_ = Spectrum(std::numeric_limits<float>::quiet_NaN());
    }

    // Lanes that are at fault stay as they are.
    void addGlints(const Spectrum& light) {
        const Spectrum sum = radiance_ + light;
        radiance_ = PathLoop<E>::kMedia ? sum : Spectrum(_mm256_blendv_ps(sum.v, radiance_.v, radiance_.v));
    }

    // What the pixel sees of glints, over factor_: the mean over probes, even within what the filter has in common
    // with the box, of the filter times the light.
    Spectrum probeGlints(int x, int y, const Wavelengths& lambda) {
        Spectrum sum(0.f);
        constexpr std::uint32_t kNumbers = 0x30000000; // beyond those of vertices and of chains
        const Vec2 centre{static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f};
        const float reach = film_.filterRadius();
        const FilmBox support{centre - Vec2{reach, reach}, centre + Vec2{reach, reach}};
        for (const std::uint32_t i : glints_) {
            const Glint& glint = context_.glints->glints()[i];
            const FilmBox box = glint.box.common(support);
            if (!(box.area() > 0)) continue;
            RandomStream random = sampler_.stream(kNumbers + i);
            const float step = 1 / static_cast<float>(glint.side);
            for (std::uint32_t j = 0; j < glint.side * glint.side; ++j) {
                const Vec2 cell{static_cast<float>(j % glint.side), static_cast<float>(j / glint.side)};
                const float u = random.uniform(), v = random.uniform();
                const Vec2 place{box.lower.x + (cell.x + u) * step * (box.upper.x - box.lower.x),
                                 box.lower.y + (cell.y + v) * step * (box.upper.y - box.lower.y)};
                const Vec2 lens{random.uniform(), random.uniform()};
                const float density = film_.filterWeight(place.x - centre.x) * film_.filterWeight(place.y - centre.y);
                sum += probe(glint.chain, {place, lens, sampler_.time(), lambda.nm[0]}, lambda,
                             density * box.area() * step * step);
            }
        }
        return sum;
    }

    Spectrum probe(const GlintChain& chain, const CameraSample& at, const Wavelengths& lambda, float share) {
        const CameraRay camera = context_.scene.camera->ray(at);
        Spectrum sum(0.f);
        if (!(camera.weight > 0)) return sum;
        if constexpr (PathLoop<E>::kTraced) {
            GlintLoop<E> loop(context_, sampler_, arena_, result_.counters, media_);
            loop.startIn(around_.at(context_.scene, camera.ray));
            loop.startWith(coneOf(*context_.scene.camera, at, camera.ray));
            if (camera.heroOnly) loop.startWithHero();
            const float factor = share * camera.weight / static_cast<float>(factor_);
            loop.follow(camera.ray, lambda, chain, [&](const GlintView& view) {
                const auto see = [&](const Light* light) {
                    if (!context_.glints->has(light)) return;
                    const Spectrum emitted = view.emitted(*light, loop.wavelengths());
                    const Spectrum found = view.throughput * emitted * factor;
                    if (!anyNonZero(found)) return;
                    sum += found;
                    if (!recorder_) return;
                    recorder_->meets(light, emitted, 0);
                    recorder_->gathers(found, light, false);
                };
                if (view.hit && view.hit->light) see(view.hit->light);
                if (!view.hit)
                    for (const Light* light : context_.lights.infinite()) see(light);
            });
            if constexpr (hasEffect(E, Effect::dispersion)) removeWorkFlag(WorkFlag::heroOnly);
        }
        return sum;
    }

    // Where the camera gives no ray there is no light, unless that is a fault of its own.
    Xyz withoutRay(const CameraRay& camera) {
        ++result_.counters.effects.noRays;
        setWork(Work::film);
        if (camera.weight == 0) return {};
        const float fault = camera.weight;
        if (recorder_) recorder_->blames(context_.scene.camera.get(), "weight", fault);
        condemn(fault);
        return {static_cast<double>(radiance_[0]), 0, 0};
    }

    // Tracking counts densities that are none: what it makes of them need not show.
    void condemnDensities() {
        const MediumCounters& media = media_.tracker.counters;
        if (media.faults == densityFaults_) return;
        densityFaults_ = media.faults;
        if (recorder_) recorder_->blames(media.faulty, "density", media.fault);
        condemn(media.fault);
    }

    void condemn(float fault) { radiance_ = Spectrum(fault < 0 && fault > -kInfinity ? kNegativeFault : fault); }

    std::uint64_t signedWeights() const {
        if constexpr (PathLoop<E>::kMedia) return media_.tracker.counters.signedWeights;
        return 0;
    }

    // Index of the DropCause, or 3 for a sound sample. The cause is looked for in the lanes: in XYZ an infinite one
    // times a matching function of 0 would be NaN.
    unsigned fault(Xyz v) const {
        // In media a sound path may be negative, and one that is not is far beyond the largest.
        const bool negative = !PathLoop<E>::kMedia && _mm256_movemask_ps(radiance_.v) != 0;
        if (std::abs(v.x) + std::abs(v.y) + std::abs(v.z) < ExactSum::kLargest && !negative) [[likely]]
            return 3;
        const bool nan = _mm256_movemask_ps(_mm256_cmp_ps(radiance_.v, radiance_.v, _CMP_UNORD_Q)) != 0;
        const bool below = _mm256_movemask_ps(radiance_.v) != 0 && allFinite(radiance_);
        const DropCause cause = nan ? DropCause::nan : below ? DropCause::negative : DropCause::infinite;
        return static_cast<unsigned>(cause);
    }

    void tellDrop() {
        if (!std::isfinite(factor_))
            recorder_->blames(context_.scene.camera.get(), "weight", static_cast<float>(factor_));
        recorder_->drop();
    }

    const PathContext& context_;
    Film& film_;
    const TileJob& job_;
    Sampler sampler_;
    Arena arena_;
    [[no_unique_address]] Media media_;
    const std::unique_ptr<SampleRecorder> recorder_; // null: nobody wants to know more
    [[no_unique_address]] std::conditional_t<PathLoop<E>::kInterfaces, CameraSurroundings, path_detail::Nothing>
        around_;
    [[no_unique_address]] std::conditional_t<PathLoop<E>::kTraced, TracedView, path_detail::Nothing> view_;
    std::span<const std::uint32_t> glints_; // of the row
    TileResult result_;
    std::uint32_t unit_ = 0; // PortionPlace::unit
    Spectrum radiance_;      // of the last sample
    std::uint64_t densityFaults_ = 0;
    double factor_ = 0; // of the camera and the pixel filter, likewise
};

using TileFunction = TileResult (*)(const PathContext&, Film&, const TileJob&);
template <EffectBits E> TileResult renderTile(const PathContext& context, Film& film, const TileJob& job) {
    return TileKernel<E>(context, film, job).run();
}

// The sets of effects that have a kernel of their own, one translation unit each (path_kernel_*.cpp). All are always
// built, so that none rots.
inline constexpr Effects kPlainKernel;
inline constexpr Effects kTexturesKernel = Effect::textures;
inline constexpr Effects kAbsorptionKernel = Effect::absorption;
inline constexpr Effects kInterfacesKernel = kAbsorptionKernel | Effect::textures | Effect::interfaces;
inline constexpr Effects kDispersionKernel = kAbsorptionKernel | Effect::dispersion;
inline constexpr Effects kSpectralInterfacesKernel = kInterfacesKernel | Effect::dispersion;
inline constexpr Effects kMediaKernel = kInterfacesKernel | Effect::media;
inline constexpr Effects kFullKernel = kLoopEffects;
// The same beside paths of light.
inline constexpr Effects kTracedInterfacesKernel = kSpectralInterfacesKernel | Effect::lightPaths;
inline constexpr Effects kTracedFullKernel = kFullKernel | Effect::lightPaths;
extern template TileResult renderTile<kPlainKernel.bits()>(const PathContext&, Film&, const TileJob&);
extern template TileResult renderTile<kTexturesKernel.bits()>(const PathContext&, Film&, const TileJob&);
extern template TileResult renderTile<kAbsorptionKernel.bits()>(const PathContext&, Film&, const TileJob&);
extern template TileResult renderTile<kInterfacesKernel.bits()>(const PathContext&, Film&, const TileJob&);
extern template TileResult renderTile<kDispersionKernel.bits()>(const PathContext&, Film&, const TileJob&);
extern template TileResult renderTile<kSpectralInterfacesKernel.bits()>(const PathContext&, Film&, const TileJob&);
extern template TileResult renderTile<kMediaKernel.bits()>(const PathContext&, Film&, const TileJob&);
extern template TileResult renderTile<kFullKernel.bits()>(const PathContext&, Film&, const TileJob&);
extern template TileResult renderTile<kTracedInterfacesKernel.bits()>(const PathContext&, Film&, const TileJob&);
extern template TileResult renderTile<kTracedFullKernel.bits()>(const PathContext&, Film&, const TileJob&);

} // namespace abbe
