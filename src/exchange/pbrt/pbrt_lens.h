// The lens files of pbrt's realistic camera.
#pragma once

#include "exchange/shared/scene_node.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::exchange {

// From the scene to the film, lengths in mm; a radius of 0 is the stop.
struct PbrtLensSurface {
    double radius = 0, thickness = 0, index = 1, diameter = 0;
};

// Four numbers a line: radius, thickness, index behind (0 for air), diameter. Nothing where it is no such table.
std::optional<std::vector<PbrtLensSurface>> pbrtLens(std::string_view text);
// The stop closed to a diameter, if it is wider.
void pbrtCloseStop(std::vector<PbrtLensSurface>&, double diameter);
// The slope at the film of the ray that comes from far away along the axis and passes the rim of the stop; 0 for none.
double pbrtImageSlope(const std::vector<PbrtLensSurface>&);
void pbrtWriteLens(SceneNode& camera, const std::vector<PbrtLensSurface>&);

} // namespace abbe::exchange
