// The colours of images through a view of OpenColorIO, for PNGs and for errors as they are seen.
#pragma once

#include "film/film_params.h"
#include "io/exr_writer.h"
#include "io/image.h"
#include "io/ocio_view.h"

#include <span>
#include <string>
#include <vector>

namespace abbe {

// A display rendering for PNG files.
struct ViewOptions {
    std::string display, view; // empty: our own defaults
    std::string config;        // OCIO: checkView()
    double exposure = 0;       // stops
};

// Immutable; shared between threads.
class DisplayView {
  public:
    // Of colours in this space. Throws IoError.
    DisplayView(OutputSpace, const ViewOptions&);

    // Interleaved linear RGB in place: exposure and view, to display values of which 0 … 1 can be shown.
    void apply(std::span<float> rgb) const;
    const OcioView& view() const { return view_; }
    // "sRGB - Display, ACES 1.0 - SDR Video, 0 stops, abbe-aces-1.3".
    std::string name() const;

  private:
    OutputSpace space_;
    double exposure_;
    OcioView view_;
};

// The configuration that views are made with: `--ocio`, else the environment's $OCIO, else the built-in one, which
// `--ocio abbe-aces-1.3` asks for in spite of $OCIO. Nothing takes the place of one that cannot be read: throws
// IoError, and also for an unknown display or view if `png`. Checked before hours are spent.
void checkView(const ViewOptions&, bool png);
// Its name and digest, for the header of an image.
std::vector<ImageAttribute> viewIdentity(const ViewOptions&);

// Linear RGB to ACES2065-1: `neutral`, the chromaticity that looks neutral in these colours, becomes the white of ACES
// by Bradford's transform, as the spaces of [ColorInterop2026] are related.
// In place.
void convertToAces(std::span<float> rgb, const RgbSpace&, Chromaticity neutral);
// The same of an image, unless views know its space, which is returned. Requires chromaticities.
OutputSpace makeViewable(RgbImage&);

} // namespace abbe
