// How bright a picture is to be shown: what `exposure auto` goes by, and what is proposed when a picture shows nothing.
#pragma once

#include "caustics/shared/pilot.h"
#include "render/integrator.h"
#include "render/scene.h"

#include <optional>
#include <span>

namespace abbe {

// Linear value that views show as middle grey: that of a card that reflects 18 %.
inline constexpr double kMiddleGrey = 0.18;

// The stops, in tenths, that show the geometric mean of pixel values [Reinhard2002, sec. 3.1] in middle grey. What is
// darker than a thousandth of the median of those above 0 counts as night around the picture and not for the mean.
// Nothing where no value is above 0.
std::optional<double> stopsForMiddleGrey(std::span<const float> luminances);

// The same for a scene before the first sample, from 16 samples of at most 32 × 32 pixels of the whole frame. They have
// a seed of their own and come from camera paths alone, so that the result depends on the scene, its camera and the
// size of the frame, and on no number of samples or threads, seed, crop or part of the render. `sensitivity`: pixel
// value per unit of radiance. Nothing if they find no light.
std::optional<double> meterExposure(const Scene&, const Integrator&, std::uint32_t maxDepth, double sensitivity);

} // namespace abbe
