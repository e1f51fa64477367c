// One tile of one pass: the unit of work.
#pragma once

#include "caustics/glints/glint_path.h"
#include "caustics/shared/kernel_jobs.h"
#include "path_tracing/camera_caustics.h"
#include "path_tracing/camera_path.h"
#include "transport/camera_start.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>

namespace abbe {

// Paths from the film: where, which wavelengths, what came back. Every sample passes one gate: one that is not finite
// and non-negative is counted by cause and left out of the pixel's mean. A path on which a density exceeded its bound
// has the right to be negative: the mean is right with it.
template <EffectBits E> class TileKernel {
    using Walk = PathWalk<E>;

  public:
    TileKernel(const PathContext& context, Film& film, const TileJob& job)
        : context_(context), film_(film), job_(job), media_(Walk::makeMedia(context.scene, *context.stop)),
          recorder_(film.makeRecorder()) {}

    TileResult run() {
        const WorkScope work(Work::film);
        const std::uint64_t lookups = workState.textureLookups, moving = workState.movingHits;
        takeSamples();
        if constexpr (Walk::kMedia) {
            const MediumCounters& media = media_.tracker.counters;
            result_.excess = media.excess();
            for (std::size_t i = 0; i < kVolumeWorks; ++i) result_.counters.effects.volumes[i].add(media.volumes[i]);
        }
        result_.counters.effects.textureLookups = workState.textureLookups - lookups;
        result_.counters.effects.movingHits = workState.movingHits - moving;
        return std::move(result_);
    }

  private:
    using Media = typename Walk::Media;
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
        const SampleRange nominal{job_.first, job_.last};
        SampleRange range = job_.plan ? job_.plan->of(x, y, nominal) : nominal;
        range.first = std::min(range.first + takenBefore(), range.last);
        if (range.first == range.last) return;
        const std::uint64_t place =
            (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y)) << 32) | static_cast<std::uint32_t>(x);
        const std::uint64_t seed = combine64(combine64(context_.settings.seed, place), static_cast<std::uint64_t>(r));
        const float rouletteScale = job_.roulette->scale(x, y);
        ExactXyz sum;
        std::uint32_t counted = 0;
        sampler_.startPixel(seed, context_.settings.technique.numbers, context_.choices, context_.strata);
        const bool disperses = context_.scene.effects.has(Effect::dispersion) || context_.settings.asIfDispersive;
        sampler_.shareWavelengths(seedOfSquare(x, y, r), x, y, !disperses);
        const auto started = recorder_ ? Clock::now() : Clock::time_point();
        if (recorder_) recorder_->pixel(x, y, r);
        if constexpr (Walk::kLightPaths)
            if (context_.glints) glints_ = context_.glints->ofRow(y);
        for (std::uint32_t i = range.first; i < range.last; ++i) {
            sampler_.start(i);
            const Xyz value = sample(x, y, rouletteScale);
            if (const std::optional<DropCause> cause = fault(value)) {
                if (result_.counters.left) {
                    result_.rest = {unit_, takenBefore() + i - range.first};
                    range.last = i;
                    break;
                }
                result_.drop({{x, y, r, i}, *cause});
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

    // Of the square of 4 × 4 pixels whose wavelengths are stratified together.
    std::uint64_t seedOfSquare(int x, int y, int replicate) const {
        const std::uint64_t place =
            (static_cast<std::uint64_t>(static_cast<std::uint32_t>(y >> 2)) << 32) | static_cast<std::uint32_t>(x >> 2);
        return combine64(combine64(context_.settings.seed ^ 0x510e527fu, place), static_cast<std::uint64_t>(replicate));
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
        CameraPath<E> path = newPath(camera, place);
        startFromCamera(path.walk(), at, camera, around_);
        if constexpr (Walk::kMedia)
            if (const float shown = job_.roulette->shown(rouletteScale); shown > 0)
                path.weighLightBy(
                    static_cast<float>(context_.scene.sensor(Spectrum(1.f), lambda).y * std::abs(factor_)) / shown);
        [[maybe_unused]] const std::uint64_t before = signedWeights();
        Spectrum glints(0.f);
        if constexpr (Walk::kLightPaths) glints = probeGlints(x, y, lambda);
        radiance_ = path.radiance(camera.ray, lambda, rouletteScale, camera.heroOnly);
        if constexpr (Walk::kLightPaths) addGlints(glints);
        setWork(Work::film);
        if constexpr (Walk::kDispersion) removeWorkFlag(WorkFlag::heroOnly);
        if constexpr (Walk::kMedia) setWorkCause(0);
        if constexpr (Walk::kMedia) {
            // Where a density exceeded its bound light may be subtracted.
            const float most = signedWeights() != before ? 0.5f * kNegativeFault : 0;
            if (-maxLane(-path.least()) < most && allFinite(radiance_)) radiance_ = Spectrum(kNegativeFault);
            dropFaultyDensities();
        }
        if constexpr (Walk::kMedia || Walk::kLightPaths) leaveWithParts();
        return context_.scene.sensor(radiance_, lambda) * factor_;
    }

    CameraPath<E> newPath([[maybe_unused]] const CameraRay& camera, [[maybe_unused]] Vec2 place) {
        if constexpr (Walk::kLightPaths)
            return {context_,
                    sampler_,
                    arena_,
                    result_.counters,
                    media_,
                    recorder_.get(),
                    {camera, vertexArenas_, place, glints_}};
        else
            return {context_, sampler_, arena_, result_.counters, media_, recorder_.get()};
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
        radiance_ = Walk::kMedia ? sum : Spectrum(_mm256_blendv_ps(sum.v, radiance_.v, radiance_.v));
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

    Spectrum probe(const ChainSignature& chain, const CameraSample& at, const Wavelengths& lambda, float share) {
        const CameraRay camera = context_.scene.camera->ray(at);
        Spectrum sum(0.f);
        if (!(camera.weight > 0)) return sum;
        if constexpr (Walk::kLightPaths) {
            GlintPath<E> path(context_, sampler_, arena_, result_.counters, media_);
            startFromCamera(path.walk(), at, camera, around_);
            const float factor = share * camera.weight / static_cast<float>(factor_);
            path.follow(camera.ray, lambda, camera.heroOnly, chain, [&](const GlintView& view) {
                const auto see = [&](const Light* light) {
                    if (!context_.glints->has(light)) return;
                    const Spectrum emitted = view.emitted(*light, path.wavelengths());
                    const Spectrum found = view.throughput * emitted * factor;
                    if (!anyNonZero(found)) return;
                    sum += found;
                    if (!recorder_) return;
                    recorder_->hits(light, emitted, 0);
                    recorder_->gathers(found, light, false);
                };
                if (view.hit && view.hit->light) see(view.hit->light);
                if (!view.hit)
                    for (const Light* light : context_.lights.infinite()) see(light);
            });
            if constexpr (Walk::kDispersion) removeWorkFlag(WorkFlag::heroOnly);
        }
        return sum;
    }

    // Where the camera gives no ray there is no light, unless that is a fault of its own.
    Xyz withoutRay(const CameraRay& camera) {
        ++result_.counters.effects.noRays;
        setWork(Work::film);
        if (camera.weight == 0) return {};
        const float fault = camera.weight;
        if (recorder_) recorder_->findsFault(context_.scene.camera.get(), "weight", fault);
        dropSample(fault);
        return {static_cast<double>(radiance_[0]), 0, 0};
    }

    // Tracking counts densities that are none: what it makes of them need not show.
    void dropFaultyDensities() {
        const MediumCounters& media = media_.tracker.counters;
        if (media.faults == densityFaults_) return;
        densityFaults_ = media.faults;
        if (recorder_) recorder_->findsFault(media.faulty, "density", media.fault);
        dropSample(media.fault);
    }

    void dropSample(float fault) { radiance_ = Spectrum(fault < 0 && fault > -kInfinity ? kNegativeFault : fault); }

    std::uint64_t signedWeights() const {
        if constexpr (Walk::kMedia) return media_.tracker.counters.signedWeights;
        return 0;
    }

    // Nothing for a sound sample. The cause is looked for in the lanes: in XYZ an infinite one times a matching
    // function of 0 would be NaN.
    std::optional<DropCause> fault(Xyz v) const {
        // In media a sound path may be negative, and one that is not is far beyond the largest.
        const bool negative = !Walk::kMedia && _mm256_movemask_ps(radiance_.v) != 0;
        if (std::abs(v.x) + std::abs(v.y) + std::abs(v.z) < ExactSum::kLargest && !negative) [[likely]]
            return std::nullopt;
        const bool nan = _mm256_movemask_ps(_mm256_cmp_ps(radiance_.v, radiance_.v, _CMP_UNORD_Q)) != 0;
        const bool below = _mm256_movemask_ps(radiance_.v) != 0 && allFinite(radiance_);
        return nan ? DropCause::nan : below ? DropCause::negative : DropCause::infinite;
    }

    void tellDrop() {
        if (!std::isfinite(factor_))
            recorder_->findsFault(context_.scene.camera.get(), "weight", static_cast<float>(factor_));
        recorder_->drop();
    }

    const PathContext& context_;
    Film& film_;
    const TileJob& job_;
    Sampler sampler_;
    Arena arena_;
    [[no_unique_address]] Media media_;
    const std::unique_ptr<SampleRecorder> recorder_; // null: nobody wants to know more
    [[no_unique_address]] std::conditional_t<Walk::kInterfaces, CameraSurroundings, NoState> around_;
    [[no_unique_address]] std::conditional_t<Walk::kLightPaths, VertexArenas, NoState> vertexArenas_;
    std::span<const std::uint32_t> glints_; // of the row
    TileResult result_;
    std::uint32_t unit_ = 0; // PortionPlace::unit
    Spectrum radiance_;      // of the last sample
    std::uint64_t densityFaults_ = 0;
    double factor_ = 0; // of the camera and the pixel filter, likewise
};

template <EffectBits E> TileResult renderTile(const PathContext& context, Film& film, const TileJob& job) {
    return TileKernel<E>(context, film, job).run();
}

} // namespace abbe
