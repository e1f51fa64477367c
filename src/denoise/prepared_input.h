// A picture made ready for denoising: finite, of one brightness, in bordered planes.
#pragma once

#include "denoise/denoise.h"
#include "denoise/half_buffers.h"

namespace abbe {

struct PreparedInput {
    HalfBuffers colour;          // linear, scaled
    HalfBuffers guide;           // compressed() colours, for weights
    std::vector<Plane> features; // at most kMaxFeatures, free of noise as far as the halves tell, in units near 1
    float scale = 1;             // of the colours: their mean is 0.25 after it, as in relMSE
    std::uint64_t repaired = 0;  // pixels of the colours that were not finite
};

// `filterFeatures`: the noise of features is removed; else they are taken as they are.
PreparedInput prepare(const DenoiseInput&, bool filterFeatures);

// Squared differences of compressed colours and of features below this count as none.
inline constexpr float kColourEpsilon = 1e-6f, kFeatureEpsilon = 1e-6f;

} // namespace abbe
