// Sigmoid coefficients of all reflectance colours of an RGB space on a grid: what a texture lookup needs [Jakob2019].
#pragma once

#include "spectrum/color_space.h"
#include "spectrum/rgb_upsampling.h"
#include "spectrum/spectrum.h"

#include <filesystem>
#include <optional>
#include <vector>

namespace abbe {

// Immutable after construction; shared between threads.
class UpsamplingTable {
  public:
    static constexpr int kResolution = 64;

    // Fits every node, in parallel; about a second on two cores at full resolution.
    static UpsamplingTable build(const RgbSpace&, int resolution = kResolution);
    // From the cache directory, if a sound table of this space and version lies there; else builds it and tries to
    // leave it there. A damaged file is replaced; a directory that cannot be written is no error.
    static UpsamplingTable loadOrBuild(const RgbSpace&, const std::filesystem::path& directory = cacheDirectory(),
                                       int resolution = kResolution);
    // $XDG_CACHE_HOME/abbe, else ~/.cache/abbe; empty (no cache) without either.
    static std::filesystem::path cacheDirectory();

    // Components are clamped to [0, 1] first: what lies outside is the caller's to count. Greys are exactly flat.
    SigmoidCoefficients lookup(Vec3 rgb) const;
    // A factor without an upper bound, for light: twice the largest component times a reflectance of at most about a
    // half, where the model is smooth [Jakob2019, sec. 4]. Negative components count as 0. White is exactly flat.
    Spectrum unbounded(Vec3 rgb, const Wavelengths& lambda) const;

    // Reading and writing of a cache file. load returns nothing for a file that is missing, damaged or of another
    // space.
    static std::optional<UpsamplingTable> load(const std::filesystem::path&, const RgbSpace&,
                                               int resolution = kResolution);
    bool save(const std::filesystem::path&, const RgbSpace&) const;
    static std::filesystem::path fileName(const RgbSpace&, int resolution = kResolution);

  private:
    explicit UpsamplingTable(int resolution);
    void fitColumn(const class ReflectanceFitter&, int largest, int row, int column);
    std::size_t node(int largest, int z, int row, int column) const;

    int resolution_ = 0;
    std::vector<float> scale_;                 // brightness of the largest component at each z
    std::vector<float> ratio_;                 // other components over the largest, at each row and column
    std::vector<SigmoidCoefficients> entries_; // [largest component][z][row][column]
};

} // namespace abbe
