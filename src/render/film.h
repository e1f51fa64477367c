// The interface of films, which sum up what paths bring to pixels.
#pragma once

#include "math/vec.h"
#include "render/path_observer.h"
#include "spectrum/spectrum.h"
#include "spectrum/xyz.h"

#include <cstddef>
#include <cstdint>
#include <memory>

namespace abbe {

// Which part of a picture a path belongs to. By what it hits between the light and the eye; D scatters diffusely or in
// a medium, S does not.
enum class PathComponent : std::uint8_t {
    direct,   // E S* D? L: at most one D, and no S between it and the light
    indirect, // more than one D
    caustic,  // E … D S+ L
};
inline constexpr std::size_t kPathComponents = 3;

// A kind of light that is added beside the samples of pixels. Who brings it: a light path that the lens sees, or a
// round of merging, in which light paths are gathered where camera paths end (caustics/merging/merge_kernel.h). Each
// kind is counted, and averaged, by itself.
enum class SplatKind : std::uint8_t { lightPath, merged };
inline constexpr std::size_t kSplatKinds = 2;

// Light that paths from the lights bring to a pixel. What is added to one pixel, for the time of the call. The sum of a
// pixel's splats over the number of light paths, or of rounds, tends to the pixel's radiance: the number of pixels of
// the frame and the filter are in it.
struct Splat {
    Xyz value; // finite, each component below ExactSum::kLargest
    // The same before the sensor, for spectral layers: value = sensor(radiance, lambda) · factor.
    const Spectrum& radiance;
    const Wavelengths& lambda;
    double factor;
    const void* light; // where the path began, for light groups
    PathComponent component;
    SplatKind kind = SplatKind::lightPath;
    double closer = 0; // of merged light: its Y if it had been gathered over half of the area, which tells its bias
};

// A place drawn from the pixel filter: offset from the pixel's centre in pixels, weight ±1 times a constant for filters
// with negative lobes.
struct FilterSample {
    Vec2 offset;
    float weight = 1;
};

// Half-open pixel rectangle.
struct PixelBounds {
    int x0 = 0, y0 = 0, x1 = 0, y1 = 0;
    int width() const { return x1 - x0; }
    int height() const { return y1 - y0; }
    std::int64_t area() const { return static_cast<std::int64_t>(width()) * height(); }
};

// The image while it is being made: exact XYZ sums for every pixel and replicate. Replicates are independent
// randomisations of the sample set; their spread gives honest error bars for correlated samples [Owen1997]. A pixel's
// samples go to that pixel alone (filter importance sampling [Ernst2006]), so threads never share one; sums are exact,
// so that they do not depend on the order of the samples either.
class Film {
  public:
    virtual ~Film() = default;
    virtual PixelBounds bounds() const = 0;
    virtual int replicates() const = 0;
    virtual FilterSample filter(Vec2 u) const noexcept = 0;
    // The filter itself, which is separable: along each axis, per unit of its integral, `offset` pixels from a pixel's
    // centre; 0 beyond the radius. The default is a box of a pixel.
    virtual float filterRadius() const noexcept { return 0.5f; }
    virtual float filterWeight(float /*offset*/) const noexcept { return 1; }
    // Adds the sum of `samples` samples to one replicate of a pixel within bounds().
    virtual void add(int x, int y, int replicate, const ExactXyz& sum, std::uint32_t samples) noexcept = 0;
    // Mean over all samples so far.
    virtual Xyz mean(int x, int y) const noexcept = 0;
    // Estimated relative error of the image from the spread of the replicates; 0 with a single replicate or sample.
    virtual double relativeNoise() const = 0;

    // Whether light from light paths has a place here. Without one the next two do nothing.
    virtual bool takesSplats() const { return false; }
    // Adds light to any pixel within bounds(), from several threads at once. Sums are exact: the order does not matter.
    virtual void splat(int /*x*/, int /*y*/, int /*replicate*/, const Splat&) noexcept {}
    // So many light paths have been followed for a replicate, whatever they brought; from several threads at once. A
    // picture is what its samples came to, over their number, and what was splatted, over this one. Of the whole frame,
    // also where the film is a crop.
    virtual void countLightPaths(int /*replicate*/, std::uint64_t /*paths*/) noexcept {}
    // The same of merged light, whose number is that of rounds: splats of that kind have no place elsewhere.
    virtual bool takesMerged() const { return false; }
    virtual void countRounds(int /*replicate*/, std::uint64_t /*rounds*/) noexcept {}

    // What else is to be kept of samples, for one thread; null: nothing. The film outlives it.
    virtual std::unique_ptr<SampleRecorder> makeRecorder() { return nullptr; }
};

// For films that stand in the place of another. Answers as the other film does, so that everybody plans and draws alike
// with either; what is added is left to the derived class. The other film outlives it.
class FilmDecorator : public Film {
  public:
    PixelBounds bounds() const override { return like_.bounds(); }
    int replicates() const override { return like_.replicates(); }
    FilterSample filter(Vec2 u) const noexcept override { return like_.filter(u); }
    float filterRadius() const noexcept override { return like_.filterRadius(); }
    float filterWeight(float offset) const noexcept override { return like_.filterWeight(offset); }
    Xyz mean(int x, int y) const noexcept override { return like_.mean(x, y); }
    double relativeNoise() const override { return like_.relativeNoise(); }
    bool takesSplats() const override { return like_.takesSplats(); }
    bool takesMerged() const override { return like_.takesMerged(); }

  protected:
    explicit FilmDecorator(const Film& like) : like_(like) {}

  private:
    const Film& like_;
};

} // namespace abbe
