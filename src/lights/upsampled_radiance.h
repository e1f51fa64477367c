// RGB of environment images to spectra: 2 max(rgb) times a reflectance of at most 1/2 under the space's white
// [Jakob2019].
#pragma once

#include "lights/environment_light.h"
#include "spectrum/upsampling_table.h"

namespace abbe {

class UpsampledRadiance final : public RgbRadiance {
  public:
    // `illuminant` is the white of the table's space with Y = 1.
    UpsampledRadiance(UpsamplingTable, std::unique_ptr<const Curve> illuminant);
    // Table (from the cache, or fitted now) and illuminant of a space.
    static std::unique_ptr<const RgbRadiance> make(const RgbSpace&);

    Spectrum at(Vec3 rgb, const Wavelengths&) const noexcept override;

  private:
    UpsamplingTable table_;
    std::unique_ptr<const Curve> illuminant_;
};

} // namespace abbe
