// Takes the noise out of a rendered picture, with a bias, and estimates the error that is left.
#pragma once

#include "spectrum/xyz.h"

#include <array>
#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// One channel of a rendering, row by row: the mean over all replicates, and over the first half of them alone; the
// other half is 2·mean − half. Empty: not there.
struct DenoiseChannel {
    std::span<const float> mean, half;
};

// What is known about the surface behind each pixel. A group without `mean` is absent; without `half` it is taken as
// free of noise. Values that are not finite (the depth of the sky) are allowed.
struct DenoiseFeatures {
    std::array<DenoiseChannel, 3> albedo; // linear RGB
    std::array<DenoiseChannel, 3> normal; // any one space
    DenoiseChannel depth;                 // any unit
};

struct DenoiseInput {
    int width = 0, height = 0;
    std::array<DenoiseChannel, 3> colour; // linear; `half` is required
    DenoiseFeatures features;
    Matrix3 toRec709 = {}; // from the colours and albedos to linear RGB of ITU-R BT.709; for `oidn` alone
};

enum class DenoiseMethod : std::uint8_t {
    nfor,    // regression on features with NL-means weights [Bitterli2016]
    preview, // wavelets with edge-stopping weights [Dammertz2010]: a hundredth of the time
    oidn,    // Open Image Denoise on the CPU, a library that is loaded if it is there
};
std::string_view name(DenoiseMethod);
// Changes whenever the same input gives another picture. Throws DenoiserFault.
std::string version(DenoiseMethod);

// A denoiser that is not there, cannot be used, or failed; with a code and what can be done about it.
struct DenoiserFault : std::runtime_error {
    std::string code, help;

    DenoiserFault(std::string faultCode, const std::string& text, std::string remedy)
        : std::runtime_error(text), code(std::move(faultCode)), help(std::move(remedy)) {}
};

enum class DenoiseEffort : std::uint8_t {
    full,
    look, // as fast as the method can, and no errors: a picture to glance at while it changes
};

struct DenoiseResult {
    std::array<std::vector<float>, 3> colour;
    std::vector<float> error; // estimated root mean square error of a pixel's three channels, bias included
    // Estimated relMSE of the whole picture, as `abbe compare` defines it, of the mean and of the result.
    double relMseBefore = 0, relMseAfter = 0;
    std::uint64_t repaired = 0; // pixels that were not finite; they were given the colour of their neighbours
    std::uint64_t outside = 0;  // pixels with a negative component in Rec. 709; for `oidn` alone
};

// The result does not depend on the number of threads. Throws DenoiserFault, and MemoryLimitExceeded. Requires width,
// height >= 1 and matching spans.
DenoiseResult denoise(const DenoiseInput&, DenoiseMethod, DenoiseEffort = DenoiseEffort::full);

} // namespace abbe
