// From the sums of layers to the channels of a file, and to the samples of a deep image.
#pragma once

#include "film/film_layers.h"
#include "film/pixel_film.h"
#include "spectrum/color_space.h"

#include <cstddef>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

namespace abbe {

// How sums become numbers: as those of the picture.
struct LayerView {
    const RgbSpace* space = nullptr;
    Matrix3 fromXyz;       // of the picture: to the space, with the white balance
    double scale = 1;      // exposure
    Vec3d origin;          // world position of the origin of render space
    std::string only = {}; // the layer that is wanted, as its sums are; empty: all, rounded to add up
};

struct LayerPlanes {
    std::vector<NamedPlane> planes;
    std::vector<std::pair<std::string, std::string>> header; // attributes that belong to them
    std::size_t unequalSums = 0; // values of groups and components that do not add up to the picture's
};

// `picture`: as resolved with the same view, all of the film or some whole rows that the layers have; its bounds are
// those of the planes. Its parts add up to it, for which its last bits may change where there are
// parts (roundToSum()). docs/output.md describes the channels.
LayerPlanes layerPlanes(const PixelFilm&, ResolvedImage& picture, const LayerView&);

// From the sums of depths to the samples of a deep image.
// Premultiplied samples by rising distance, which do not overlap: a surface is at one, a medium fills the space from
// one to another. Put over each other in this order they are the picture, but for light that comes from no distance,
// that of the sky and what light paths brought.
struct DeepImage {
    PixelBounds bounds;
    std::vector<std::uint32_t> counts;          // of each pixel, row by row from the top
    std::vector<float> front, back, a, r, g, b; // of all samples, pixel by pixel
};

// Requires a film with such sums. As the picture is resolved with the same view; `part`: of the film, else all of it.
DeepImage deepImage(const PixelFilm&, const LayerView&, std::optional<PixelBounds> part = {});

// Planes whose sum is the picture: its light groups, or its components.
using Partition = std::vector<std::span<float>>;

// Parts of a picture are rounded to float one by one, so that their sum misses the picture by some last bits. Changes
// the parts of each partition, by about that much, until part₀ + part₁ + … in float, in this order, is the whole to the
// last bit: what a compositor adds up is the picture. Where parts of opposite signs cancel, no parts of their precision
// add up to so small a whole: there all of them, and the whole, are rounded to the last bit of the largest.
// Returns how many values were left alone because their parts miss the whole by more than rounding can.
std::size_t roundToSum(std::span<float> whole, std::span<const Partition> partitions);

// Cryptomatte 1.2 [Friedman2015]: which things a pixel sees, and how much of it each covers.

// MurmurHash3 of 32 bits, x86 variant, seed 0 [Appleby2011].
std::uint32_t murmurHash3(std::string_view);
// The identifier of a name: its hash as the bits of a float, with the exponent kept from 0 and 255 so that it is
// neither denormal nor infinite nor NaN.
float cryptomatteId(std::string_view name);

// The layer `name` ("CryptoObject"): channels NAME00.R … NAME02.A, six ranks of identifier and coverage, by falling
// coverage, and NAME.R .G .B, a picture for people. `samples[i]`: of pixel `first` + i.
std::vector<NamedPlane> cryptomattePlanes(const FilmLayers&, FilmLayers::Matte, std::string_view name,
                                          const std::vector<float>& samples, std::size_t first = 0);

// The header's attributes of that layer, by name and value: "cryptomatte/d1ab93f/name", ….
std::vector<std::pair<std::string, std::string>> cryptomatteHeader(const FilmLayers&, FilmLayers::Matte,
                                                                   std::string_view name);

} // namespace abbe
