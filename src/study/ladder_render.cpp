#include "study/ladder_render.h"

#include "base/check.h"
#include "base/stopwatch.h"
#include "denoise/denoise.h"
#include "film/layer_planes.h"
#include "rendering/path_tracer.h"

#include <numeric>
#include <string>

namespace abbe {

namespace {

PixelBounds frameOf(const FilmSettings& film) { return {0, 0, film.width, film.height}; }

StudyImage interleaved(const FilmSettings& film, std::span<const float> r, std::span<const float> g,
                       std::span<const float> b) {
    StudyImage image{film.width, film.height, {}};
    image.rgb.reserve(3 * r.size());
    for (std::size_t i = 0; i < r.size(); ++i) image.rgb.insert(image.rgb.end(), {r[i], g[i], b[i]});
    return image;
}

std::span<const float> find(const LayerPlanes& layers, const std::string& name) {
    for (const NamedPlane& plane : layers.planes)
        if (plane.name == name) return plane.values;
    return {};
}

using Names = std::array<const char*, 3>;

std::array<DenoiseChannel, 3> channels(const LayerPlanes& layers, const std::string& prefix, const Names& names) {
    std::array<DenoiseChannel, 3> result;
    for (std::size_t c = 0; c < 3; ++c)
        result[c] = {find(layers, prefix + names[c]), find(layers, "half." + prefix + names[c])};
    return result;
}

} // namespace

LadderRender::LadderRender(const StudySubject& subject, const StudyVariant& variant, std::uint64_t seed,
                           const std::atomic<bool>* stop)
    : subject_(subject), variant_(variant), settings_(variant.settings(subject.settings)), stop_(stop),
      integrator_(makePathTracer(subject.largestKernel ? kLoopEffects : subject.built->scene.effects)) {
    settings_.seed = seed;
    settings_.noiseTarget = settings_.timeLimit = 0;
    settings_.part = settings_.parts = 1;
    begin();
}

void LadderRender::begin() {
    const FilmSettings& film = subject_.film;
    const Scene& scene = subject_.built->scene;
    film_.emplace(frameOf(film), PixelFilter(film.filter, film.filterRadius), subject_.replicates);
    const std::size_t blocks = integrator_->lightBlocks(scene, settings_);
    film_->keepSplatsOf(*integrator_, scene, settings_);
    state_.emplace(film_->bounds(), 0, blocks);
    cost_ = {};
    LayerPlan plan;
    plan.halves = plan.albedo = plan.normal = plan.depth = variant_.denoised; // as `layers { denoise }`
    if (variant_.denoised)
        film_->keepLayers(plan, scene.names, rgbSpace(film.space), {scene.intersector.get(), scene.camera.get()});
}

std::optional<LadderRung> LadderRender::advance(std::uint32_t samplesPerReplicate,
                                                const std::function<void(double)>& progress) {
    if (settings_.technique.numbers == Technique::Numbers::stratified && state_->reached() > 0) begin();
    settings_.samples = samplesPerReplicate * static_cast<std::uint32_t>(subject_.replicates);
    RenderControl control{stop_, {}, &*state_};
    if (progress) control.progress = [&](const Progress& p) { progress(p.fraction); };
    const Stopwatch rendering;
    const RenderStatistics statistics = integrator_->render(subject_.built->scene, *film_, settings_, control);
    if (statistics.stopped || state_->reached() < samplesPerReplicate) return std::nullopt;
    account(statistics, rendering.seconds());
    LadderRung rung{settings_.samples, {}, cost_};
    const FilmSettings& film = subject_.film;
    ResolvedImage picture =
        film_->resolve(rgbSpace(film.space).fromXyz() * film.whiteBalance, subject_.built->exposure);
    if (!variant_.denoised) {
        rung.image = interleaved(film, picture.r, picture.g, picture.b);
        return rung;
    }
    const Stopwatch denoising;
    const double before = processSeconds();
    rung.image = denoised(picture);
    rung.cost.seconds += denoising.seconds();
    rung.cost.coreSeconds += processSeconds() - before;
    return rung;
}

// Each step looks ahead again, though a render that did not stop would have done so once. What later looks took is
// estimated from their share of the rays, and taken off.
void LadderRender::account(const RenderStatistics& s, double seconds) {
    const bool first = cost_.rays == 0;
    const std::uint64_t before = first ? 0 : cost_.rays - firstPilot_;
    const auto traced = static_cast<double>(std::max<std::uint64_t>(s.rays() - before, 1));
    const auto pilot = static_cast<double>(s.pilotRays);
    if (first) {
        firstPilot_ = s.pilotRays;
        pilotCoreSeconds_ = s.pilotCoreSeconds;
    }
    cost_.seconds += first ? seconds : seconds * traced / (traced + pilot);
    cost_.coreSeconds = s.coreSeconds + pilotCoreSeconds_; // the render's sum knows nothing of looks ahead
    cost_.sampleSeconds = s.coreSeconds;
    cost_.rays = s.rays() + firstPilot_;
    dropped_ = std::accumulate(s.dropped.begin(), s.dropped.end(), std::uint64_t{0});
}

StudyImage LadderRender::denoised(ResolvedImage& picture) const {
    const FilmSettings& film = subject_.film;
    const RgbSpace& space = rgbSpace(film.space);
    const LayerView view{&space, space.fromXyz() * film.whiteBalance, subject_.built->exposure,
                         subject_.built->scene.origin};
    const LayerPlanes layers = layerPlanes(*film_, picture, view);
    constexpr Names kRgb{"R", "G", "B"}, kXyz{"X", "Y", "Z"};
    DenoiseInput input{film.width, film.height, channels(layers, "", kRgb), {}};
    input.colour[0].mean = picture.r;
    input.colour[1].mean = picture.g;
    input.colour[2].mean = picture.b;
    input.features.albedo = channels(layers, "albedo.", kRgb);
    input.features.normal = channels(layers, "normal.", kXyz);
    input.features.depth = {find(layers, "depth.Z"), find(layers, "half.depth.Z")};
    ABBE_CHECK(!input.colour[0].half.empty());
    const DenoiseResult result = denoise(input, DenoiseMethod::nfor);
    return interleaved(film, result.colour[0], result.colour[1], result.colour[2]);
}

} // namespace abbe
