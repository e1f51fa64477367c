// Long renders that an image is measured against, with what each says about its own error.
#pragma once

#include "film/error_certificate.h"
#include "film/measured_error.h"
#include "io/image.h"

#include <optional>
#include <string>
#include <vector>

namespace abbe {

struct ViewOptions;

// An image as `certify` needs it.
struct CertifyImage {
    std::string path;
    RgbImage image;
    std::vector<float> variance;                 // of the luminance; empty: the file has none
    std::optional<ErrorCertificate> certificate; // that states an error
    std::string seed;                            // empty: the file does not say

    // Throws IoError.
    static CertifyImage read(const std::string& path);
    // Equal seeds are equal samples, as far as both have them.
    bool sharesSamplesWith(const CertifyImage& other) const { return !seed.empty() && seed == other.seed; }
};

// What an image is off by, with an interval of 95 % for what the noise of the references leaves open.
struct MeasuredFigures {
    ErrorFigure relative;
    std::optional<ErrorFigure> display;
    std::vector<std::string> notes; // what limits the measurement, a sentence each
};

// `view` is that of the image's certificate; null: the display is left out. One or two references, of the image's
// size and with chromaticities.
MeasuredFigures measureAgainst(const CertifyImage&, std::vector<CertifyImage> references, const ViewOptions* view);

} // namespace abbe
