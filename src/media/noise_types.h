// Noise as the language writes it: `volume noise` and `medium noise`.
#pragma once

#include "math/transform.h"
#include "media/medium_optics.h"
#include "media/noise_volume.h"

#include <optional>
#include <variant>

namespace abbe {

struct NoiseMediumParams : MediumParams, NoisePattern {
    schema::Choice kindWord{"gradient", std::nullopt};
    Transform transform;
};

struct NoiseVolumeParams : NoiseMediumParams {
    std::optional<Vec3d> size, center, lowest, highest;
    double edge = 0;
    double scaleHeight = std::numeric_limits<double>::infinity();
};

NoisePattern patternOf(const NoiseMediumParams&);
// The box asked for, or why there is none.
std::variant<NoiseBox, std::string_view> boxOf(const NoiseVolumeParams&, bool zUp);

schema::TypeInfo noiseMediumType();
schema::TypeInfo noiseVolumeType();

} // namespace abbe
