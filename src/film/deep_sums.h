// What is seen at which distance: the sums behind a deep image.
#pragma once

#include "film/film_planes.h"
#include "math/exact_sum.h"
#include "spectrum/xyz.h"

#include <cstdint>
#include <span>
#include <vector>

namespace abbe {

// Part of a pixel's samples that ends between two distances, and the light that comes from there.
struct DeepBin {
    std::uint32_t key = 0; // which distances
    ExactSum share;        // of a sample each
    ExactSum x, y, z;      // light
    ExactSum depth;        // distance times share, m
};

// Each pixel has two lists of bins, of surfaces and of media, on a grid of distances that is fixed: 64 bins from each
// power of two to the next, which are the first bits of a float. Where that makes more of them than are kept, two and
// two become one, throughout the list. How often depends on which bins of the finest grid the samples fall into, and on
// nothing else: whatever the order of samples or of parts that are put together, the sums come out the same.
class DeepSums {
  public:
    enum class Kind : std::uint8_t { surface, medium };

    // `most` bins in each list. Throws std::bad_alloc.
    DeepSums(PixelBounds, int most);
    // As if it had just been made, for other pixels; takes no more memory than before for as many.
    void restart(PixelBounds);
    // The most that `samples` samples per pixel can take.
    static std::uint64_t mostBytes(PixelBounds, int most, std::uint64_t samples);

    // Requires a distance of at least 0. Pixels may be added to from different threads at once. Throws std::bad_alloc.
    void add(std::size_t pixel, Kind, float depth, float share, const Xyz& light);

    struct Bins {
        std::uint32_t level = 0; // how often two and two have become one
        std::vector<DeepBin> list;

        float front(std::size_t i) const; // least distance of a bin, m
        float back(std::size_t i) const;  // where the next one begins
    };
    const Bins& bins(std::size_t pixel, Kind kind) const { return pixels_[2 * pixel + static_cast<std::size_t>(kind)]; }

    std::unique_ptr<FilmPlane> plane();

  private:
    class Plane;
    void add(Bins&, const DeepBin&) const;
    void coarsen(Bins&) const;

    PixelBounds bounds_;
    std::size_t most_;
    std::vector<Bins> pixels_; // [pixel][kind]
};

} // namespace abbe
