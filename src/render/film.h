// The image while it is being made: exact XYZ sums for every pixel and replicate.
#pragma once

#include "math/vec.h"
#include "render/sample_recorder.h"
#include "render/splat.h"
#include "spectrum/xyz.h"

#include <cstdint>
#include <memory>

namespace abbe {

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

// Replicates are independent randomisations of the sample set; their spread gives honest error bars for correlated
// samples [Owen1997]. A pixel's samples go to that pixel alone (filter importance sampling [Ernst2006]), so threads
// never share one; sums are exact, so that they do not depend on the order of the samples either.
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

} // namespace abbe
