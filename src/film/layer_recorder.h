// From the events of a path to the sums of the layers.
#pragma once

#include "film/film_layers.h"
#include "film/layer_plan.h"
#include "render/film.h"
#include "render/path_observer.h"
#include "spectrum/spectrum.h"

#include <cstddef>

namespace abbe {

// Refers to the layers, which outlive it.
class LayerRecorder final : public SampleRecorder {
  public:
    explicit LayerRecorder(FilmLayers&);

    void pixel(int x, int y, int replicate) noexcept override;
    void start(const Ray& fromEye, const Wavelengths&) noexcept override;
    void arrives(const SurfaceHit&, const Spectrum& beta) noexcept override;
    void gathers(const Spectrum& radiance, const void* source, bool passing) noexcept override;
    void chains(const Light*, Vec3) noexcept override { chained_ = true; }
    void lightsUp(Vec3 p) noexcept override;
    void absorbs(Vec3 p, float share) noexcept override;
    void scatters(const SurfaceHit&, Lobes, const Spectrum& beta, const BsdfSample*) noexcept override;
    void collides(Vec3 p, const Spectrum& beta) noexcept override;
    void keep(const Spectrum& radiance, const Sensor&, double factor) noexcept override;
    void drop() noexcept override;
    void pixelDone(double seconds) noexcept override;

  private:
    PathComponent component(bool passing) const {
        const int diffuse = diffuse_ + passing;
        if (chained_ || (!passing && specularSince_ && diffuse > 0)) return PathComponent::caustic;
        return diffuse <= 1 ? PathComponent::direct : PathComponent::indirect;
    }
    struct FirstSurface {
        bool met = false;
        Vec3 p;
        float depth = 0;
        Vec2 uv;
        const void *shape = nullptr, *material = nullptr;
        std::optional<Vec2d> motion; // pixels, down the film
    };
    // What is seen in media on the way to where the path ends for the eye: share that is absorbed, light given off.
    struct Along {
        float depth = 0, share = 0;
        Spectrum light{0.f};
    };
    // There all that is left of it ends, and from there comes all other light.
    struct End {
        DeepSums::Kind kind = DeepSums::Kind::surface;
        float depth = 0;
    };
    float depthOf(Vec3 p) const { return length(p - ray_.origin); }
    std::optional<Vec2d> motionOf(const SurfaceHit&, float depth) const noexcept;
    void keepDeep(const Spectrum& radiance, const Sensor&, double factor) noexcept;
    void keepFeatures(std::span<ExactSum>, double factor) const noexcept;
    void keepParts(std::span<ExactSum>, const Sensor&, double factor) const noexcept;
    void keepSpectrum(std::span<ExactSum>, const Spectrum& radiance, double factor) const noexcept;

    FilmLayers& layers_;
    const LayerPlan& plan_;
    const LayerPlan::Offsets at_;
    std::size_t pixel_ = 0;
    Vec2d middle_; // of the pixel
    int half_ = 0;

    Ray ray_; // from the eye
    Wavelengths lambda_;
    FirstSurface first_;
    bool looked_ = false; // met something that is no mirror
    bool passedMedium_ = false;
    Vec3 normal_;
    Spectrum albedo_;
    int diffuse_ = 0;            // scatterings so far
    bool specularSince_ = false; // a mirror since the last of them
    bool chained_ = false;       // what is gathered next has met mirrors
    struct Part {
        Spectrum radiance{0.f};
        bool lit = false;
    };
    std::vector<Along> along_;
    std::optional<float> litDepth_; // of what is gathered next, if it comes from the way
    std::optional<End> end_;
    float left_ = 1; // of the share that ends there
    std::vector<Part> groups_;
    Part components_[kPathComponents];
};

// From the lanes of a path to the bins of spectral layers.
// Each lane is an estimate of the radiance at its wavelength with a density of its own; a bin gets those within it, so
// that it holds the mean spectral radiance over its width, without bias, also where all lanes but the hero's ended.
// Calls add(bin, term) for each lane within the bins.
template <typename Add>
void spreadOverBins(const SpectralBins& bins, const Spectrum& radiance, const Wavelengths& lambda, double factor,
                    const Add& add) {
    const double scale = factor / (kLanes * bins.width);
    for (int lane = 0; lane < kLanes; ++lane) {
        const double place = (static_cast<double>(lambda.nm[lane]) - bins.first) / bins.width;
        if (place < 0 || place >= bins.count()) continue;
        add(static_cast<std::size_t>(place),
            static_cast<double>(radiance[lane]) / static_cast<double>(lambda.pdf[lane]) * scale);
    }
}

} // namespace abbe
