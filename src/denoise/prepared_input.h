// Removes the noise of features (albedo, normal, depth) before they explain colours. A picture made ready for
// denoising: finite, of one brightness, in bordered planes.
#pragma once

#include "denoise/denoise.h"
#include "denoise/half_buffers.h"
#include "denoise/regression.h"

#include <optional>

namespace abbe {

// NL-means over 11 × 11 pixels, each half with the weights of the other, and the mean of both [Bitterli2016, §5.1].
// The planes of one feature share their weights.
std::vector<Plane> filterFeature(const HalfBuffers& feature, float epsilon);

struct PreparedInput {
    HalfBuffers colour; // linear, scaled
    Modulation modulation;
    // The modulation of each pixel by itself, and colours divided by it: mostly the light that falls on a surface.
    // Textures do not hide in it what is noise.
    ColourPlanes divisor;
    std::array<std::vector<Plane>, 2> shading;
    HalfBuffers guide;           // compressed() shading, for weights
    std::vector<Plane> features; // at most kMaxFeatures, free of noise as far as the halves tell, in units near 1
    float scale = 1;             // of the colours: their median is kTypical after it
    std::uint64_t repaired = 0;  // pixels of the colours that were not finite
};

// `filterFeatures`: the noise of features is removed; else they are taken as they are.
PreparedInput prepare(const DenoiseInput&, bool filterFeatures);
// The same with colours that are divided by nothing.
PreparedInput undivided(const PreparedInput&);

// A picture and its features with their noise, finite, for a denoiser that makes of them itself what it needs.
struct NoisyInput {
    HalfBuffers colour; // linear, scaled
    std::optional<HalfBuffers> albedo, normal;
    float scale = 1; // as in PreparedInput
    std::uint64_t repaired = 0;
};
NoisyInput noisyInput(const DenoiseInput&);

void multiply(ColourPlanes& colours, const ColourPlanes& factors);
void divide(ColourPlanes& colours, const ColourPlanes& factors);

// Squared differences of compressed colours and of features below this count as none.
inline constexpr float kColourEpsilon = 1e-6f, kFeatureEpsilon = 1e-6f;

} // namespace abbe
