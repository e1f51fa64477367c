#include "film/layer_recorder.h"

#include "render/camera.h"
#include "render/intersector.h"
#include "spectrum/sensor.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

// A term that is out of range counts as nothing: the sample itself was sound.
void add(ExactSum& sum, double term) {
    if (std::abs(term) < ExactSum::kLargest) sum += ExactSum(term);
}

void add(std::span<ExactSum> three, Xyz v) {
    add(three[0], v.x);
    add(three[1], v.y);
    add(three[2], v.z);
}

Xyz xyz(Vec3 v) { return {v.x, v.y, v.z}; }

std::span<ExactSum> threeAt(std::span<ExactSum> sums, int offset) {
    return sums.subspan(static_cast<std::size_t>(offset), 3);
}

} // namespace

LayerRecorder::LayerRecorder(FilmLayers& layers)
    : layers_(layers), plan_(layers.plan()), at_(plan_.offsets()),
      groups_(static_cast<std::size_t>(plan_.groupCount())) {}

void LayerRecorder::pixel(int x, int y, int replicate) noexcept {
    pixel_ = layers_.pixelIndex(x, y);
    middle_ = {x + 0.5, y + 0.5};
    half_ = layers_.halfOf(replicate);
}

void LayerRecorder::start(const Ray& fromEye, const Wavelengths& lambda) noexcept {
    ray_ = fromEye;
    lambda_ = lambda;
    along_.clear();
    litDepth_.reset();
    end_.reset();
    left_ = 1;
    first_ = {};
    looked_ = passedMedium_ = specularSince_ = false;
    diffuse_ = 0;
    for (Part& part : groups_) part = {};
    for (Part& part : components_) part = {};
}

void LayerRecorder::arrives(const SurfaceHit& hit, const Spectrum&) noexcept {
    if (first_.met || passedMedium_) return;
    const float depth = depthOf(hit.p);
    first_ = {true, hit.p, depth, hit.uv, hit.shape, hit.material, {}};
    end_ = {DeepSums::Kind::surface, depth};
    if (plan_.motion) first_.motion = motionOf(hit, depth);
}

// From where the point is seen when the shutter opens to where it is seen when it closes.
std::optional<Vec2d> LayerRecorder::motionOf(const SurfaceHit& hit, float depth) const noexcept {
    const LayerSight& sight = layers_.sight();
    const Ray onto{ray_.origin, (hit.p - ray_.origin) / depth, kInfinity, ray_.time, RayKind::camera};
    const auto passage = sight.world->passage(onto, hit, depth);
    if (!passage) return std::nullopt;
    const auto from = sight.camera->project(Vec3d(passage->opening), 0, middle_);
    if (!from) return std::nullopt;
    const auto to = sight.camera->project(Vec3d(passage->closing), 1, *from);
    return to ? std::optional(*to - *from) : std::nullopt;
}

void LayerRecorder::lightsUp(Vec3 p) noexcept { litDepth_ = depthOf(p); }

void LayerRecorder::absorbs(Vec3 p, float share) noexcept {
    if (!plan_.deep || end_ || !(share > 0)) return;
    const float absorbed = left_ * std::min(share, 1.f);
    left_ -= absorbed;
    along_.push_back({depthOf(p), absorbed, Spectrum(0.f)});
}

void LayerRecorder::gathers(const Spectrum& radiance, const void* source, bool passing) noexcept {
    if (!groups_.empty()) {
        Part& part = groups_[static_cast<std::size_t>(layers_.groupOf(source))];
        part.radiance += radiance;
        part.lit = true;
    }
    if (plan_.components) {
        Part& part = components_[static_cast<std::size_t>(component(passing))];
        part.radiance += radiance;
        part.lit = true;
    }
    if (plan_.deep && litDepth_ && !end_) along_.push_back({*litDepth_, 0, radiance});
    litDepth_.reset();
    chained_ = false;
}

void LayerRecorder::scatters(const SurfaceHit& hit, Lobes lobes, const Spectrum& beta,
                             const BsdfSample* next) noexcept {
    if (lobes.has(Lobe::diffuse)) {
        ++diffuse_;
        specularSince_ = false;
    } else {
        specularSince_ = true;
    }
    if (looked_ || !lobes.any(Lobes(Lobe::diffuse) | Lobe::glossy)) return;
    looked_ = true;
    normal_ = hit.shading.z;
    // Weights of samples have the albedo as their mean.
    albedo_ = next ? beta * next->weight * (1 / mean(next->pdfRatio)) : Spectrum(0.f);
}

void LayerRecorder::collides(Vec3 p, const Spectrum& beta) noexcept {
    if (!end_) end_ = {DeepSums::Kind::medium, depthOf(p)};
    ++diffuse_;
    specularSince_ = false;
    passedMedium_ = true;
    if (looked_) return;
    looked_ = true;
    normal_ = {};
    albedo_ = beta;
}

void LayerRecorder::keepFeatures(std::span<ExactSum> sums, double factor) const noexcept {
    const auto at = [&](int offset) -> ExactSum& { return sums[static_cast<std::size_t>(offset)]; };
    if (first_.met && (plan_.position || plan_.depth || plan_.uv)) {
        at(at_.surface) += ExactSum(1);
        if (plan_.position) add(threeAt(sums, at_.position), xyz(first_.p));
        if (plan_.depth) add(at(at_.depth), first_.depth);
        if (plan_.uv) {
            add(at(at_.uv), first_.uv.x);
            add(at(at_.uv + 1), first_.uv.y);
        }
    }
    if (first_.motion) {
        at(at_.followed) += ExactSum(1);
        add(at(at_.motion), first_.motion->x);
        add(at(at_.motion + 1), first_.motion->y);
    }
    if (!looked_) return;
    if (plan_.normal) {
        at(at_.looks) += ExactSum(1);
        add(threeAt(sums, at_.normal), xyz(normal_));
    }
    if (plan_.albedo) add(threeAt(sums, at_.albedo), toXyz(albedo_ * layers_.white()->at(lambda_), lambda_) * factor);
}

void LayerRecorder::keepParts(std::span<ExactSum> sums, const Sensor& sensor, double factor) const noexcept {
    for (std::size_t g = 0; g < groups_.size(); ++g)
        if (groups_[g].lit)
            add(threeAt(sums, at_.groups + 3 * static_cast<int>(g)), sensor(groups_[g].radiance, lambda_) * factor);
    if (!plan_.components) return;
    for (int c = 0; c < 3; ++c)
        if (components_[c].lit)
            add(threeAt(sums, at_.components + 3 * c), sensor(components_[c].radiance, lambda_) * factor);
}

void LayerRecorder::keepSpectrum(std::span<ExactSum> sums, const Spectrum& radiance, double factor) const noexcept {
    const auto bins = sums.subspan(static_cast<std::size_t>(at_.spectral));
    spreadOverBins(*plan_.spectral, radiance, lambda_, factor,
                   [&](std::size_t bin, double term) { add(bins[bin], term); });
}

// Light that reaches the eye although nothing was met, as that of the sky, is of no depth.
void LayerRecorder::keepDeep(const Spectrum& radiance, const Sensor& sensor, double factor) noexcept {
    DeepSums& sums = *layers_.deep();
    Spectrum rest = radiance;
    for (const Along& a : along_) {
        sums.add(pixel_, DeepSums::Kind::medium, a.depth, a.share, sensor(a.light, lambda_) * factor);
        rest = rest - a.light;
    }
    if (end_) sums.add(pixel_, end_->kind, end_->depth, left_, sensor(rest, lambda_) * factor);
}

void LayerRecorder::keep(const Spectrum& radiance, const Sensor& sensor, double factor) noexcept {
    const std::span<ExactSum> sums = layers_.sums(pixel_, half_);
    keepFeatures(sums, factor);
    keepParts(sums, sensor, factor);
    if (plan_.spectral) keepSpectrum(sums, radiance, factor);
    if (plan_.deep) keepDeep(radiance, sensor, factor);
    if (!first_.met) return;
    if (plan_.coversObjects()) layers_.cover(pixel_, FilmLayers::Matte::objects, first_.shape);
    if (plan_.coversMaterials()) layers_.cover(pixel_, FilmLayers::Matte::materials, first_.material);
}

void LayerRecorder::drop() noexcept { layers_.addInvalid(pixel_); }

void LayerRecorder::pixelDone(double seconds) noexcept { layers_.addSeconds(pixel_, seconds); }

} // namespace abbe
