// The film of the renderer: 52 bytes per pixel and replicate, 48 more where light paths add to it and 64 where merged
// light does, and no other plane of the image's size.
#pragma once

#include "film/film_layers.h"
#include "film/film_planes.h"
#include "film/pixel_filter.h"
#include "film/splat_sums.h"
#include "render/film.h"
#include "spectrum/xyz.h"

#include <array>
#include <functional>
#include <optional>
#include <vector>

namespace abbe {

// Planes of the film's bounds, row by row from the top.
struct ResolvedImage {
    PixelBounds bounds;
    std::vector<float> r, g, b;
    // Of the mean's Y, scaled with it: empty with one replicate, infinite where fewer than two have samples.
    std::vector<float> variance;
};

class Integrator;
struct RenderSettings;
struct Scene;

class PixelFilm final : public Film {
  public:
    // `bounds` is the part of the image that is made (the crop). Requires a non-empty one and replicates >= 1.
    // Throws std::bad_alloc.
    PixelFilm(PixelBounds bounds, const PixelFilter& filter, int replicates);
    // Before the first sample: what else to keep. `rows`: of these rows of the film alone, to begin with
    // (FilmLayers::restart()). Throws std::bad_alloc.
    void keepLayers(const LayerPlan&, const SceneNames&, const RgbSpace&, LayerSight = {},
                    std::optional<PixelBounds> rows = {});
    // Before the first sample: a place for light from light paths, in the layers too. Throws std::bad_alloc.
    void keepSplats();
    void keepMerged();
    // Both as a render by an integrator needs it.
    void keepSplatsOf(const Integrator&, const Scene&, const RenderSettings&);
    // Null if nothing else is kept.
    const FilmLayers* layers() const { return layers_.get(); }
    FilmLayers* layers() { return layers_.get(); }
    std::unique_ptr<SampleRecorder> makeRecorder() override { return layers_ ? layers_->makeRecorder() : nullptr; }
    // What a film of this size takes, without layers.
    static std::uint64_t memoryBytes(PixelBounds, int replicates, bool splats = false, bool merged = false);

    PixelBounds bounds() const override { return bounds_; }
    int replicates() const override { return replicates_; }
    FilterSample filter(Vec2 u) const noexcept override { return filter_.sample(u); }
    float filterRadius() const noexcept override { return static_cast<float>(filter_.radius()); }
    float filterWeight(float offset) const noexcept override { return filter_.weight(offset); }
    // Different pixels may be added to from different threads at once.
    void add(int x, int y, int replicate, const ExactXyz& sum, std::uint32_t samples) noexcept override;
    bool takesSplats() const override { return splats(SplatKind::lightPath) != nullptr; }
    bool takesMerged() const override { return splats(SplatKind::merged) != nullptr; }
    void splat(int x, int y, int replicate, const Splat&) noexcept override;
    void countLightPaths(int replicate, std::uint64_t paths) noexcept override;
    void countRounds(int replicate, std::uint64_t rounds) noexcept override;

    // Of what samples found and of what light paths brought, added up. No thread may be splatting, here and below.
    Xyz mean(int x, int y) const noexcept override { return mean(x, y, 0, replicates_); }
    std::uint64_t samples(int x, int y) const noexcept { return samples(x, y, 0, replicates_); }
    std::uint64_t lightPaths() const noexcept { return splatCount(SplatKind::lightPath, 0, replicates_); }
    // The same of the replicates [first, last) alone.
    Xyz mean(int x, int y, int first, int last) const noexcept;
    std::uint64_t samples(int x, int y, int first, int last) const noexcept;
    // Light paths of the frame, or rounds.
    std::uint64_t splatCount(SplatKind, int first, int last) const noexcept;
    // The parts of that mean: over the samples of the pixel, and over those.
    Xyz sampleMean(int x, int y, int first, int last) const noexcept;
    Xyz splatMean(SplatKind, int x, int y, int first, int last) const noexcept;
    // Y of merged light as Splat::closer.
    double closerMean(int x, int y, int first, int last) const noexcept;

    // Variance of mean(x, y).y, unbiased for replicates of equal size: s²/R of the R replicate means, hence R − 1
    // degrees of freedom: a 95 % interval is ± studentFactor95(R − 1) standard errors. Nothing unless two replicates
    // have samples, and light paths if there are any. Pixels that the same light paths add to vary together: what sums
    // over pixels vary by is more than the sum of their variances.
    std::optional<double> variance(int x, int y) const noexcept;
    // Mean of variance() over the (2 radius + 1)² pixels around, as far as they are inside: with two replicates a
    // single pixel's estimate has one degree of freedom and is useless alone, 7×7 of them have up to 49.
    std::optional<double> pooledVariance(int x, int y, int radius = 3) const noexcept;

    // √ mean over pixels of variance/(Y² + ε), ε = 0.01 (image mean of Y)²: the square root of the expected relMSE.
    // Pixels without a variance are left out; 0 if there is none. No thread may be adding.
    double relativeNoise() const override;

    // All that was added, for a checkpoint. They refer to this film.
    FilmPlanes planes();

    // Linear RGB of mean · scale, by the matrix of an RgbSpace (spectrum/color_space.h); negative components stay. No
    // thread may be adding. Pixels without samples are black. `part`: of the film; else all of it.
    ResolvedImage resolve(const Matrix3& fromXyz, double scale, std::optional<PixelBounds> part = {}) const;

  private:
    std::size_t cell(int x, int y, int replicate) const noexcept;
    // Null: there is no place for it.
    const SplatSums* splats(SplatKind k) const { return splats_[static_cast<std::size_t>(k)].get(); }
    SplatSums* splats(SplatKind k) { return splats_[static_cast<std::size_t>(k)].get(); }
    // Mean Y of a pixel and the variance of that mean.
    struct Luminance {
        double mean = 0, variance = 0;
        bool known = false; // the variance
    };
    Luminance luminance(int x, int y) const noexcept;
    double sumOverRows(const std::function<double(int)>& row) const;

    PixelBounds bounds_;
    int replicates_;
    PixelFilter filter_;
    std::vector<ExactXyz> sums_;         // [pixel][replicate]
    std::vector<std::uint32_t> samples_; // [pixel][replicate]
    std::array<std::unique_ptr<SplatSums>, kSplatKinds> splats_;
    std::vector<SharedSum> closer_; // [pixel][replicate]
    std::unique_ptr<FilmLayers> layers_;
};

// Two-sided 95 % quantile of Student's t; requires degreesOfFreedom >= 1.
double studentFactor95(int degreesOfFreedom);

} // namespace abbe
