// Spectral radiance of RGB texels: one lookup in the upsampling table per ray.
#pragma once

#include "lights/environment_light.h"
#include "spectrum/upsampling_table.h"

#include <memory>
#include <string>

namespace abbe {

// The upsampler of an RGB space, or null with the reason in `error`.
std::unique_ptr<const RgbRadiance> makeRgbRadiance(const RgbSpace&, std::string& error);

} // namespace abbe
