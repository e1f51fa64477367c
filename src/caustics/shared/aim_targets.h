// What focuses light, for paths of light to be sent to.
#pragma once

#include "caustics/shared/aim_cone.h"
#include "math/bounds.h"
#include "render/scene.h"
#include "render/shape.h"

#include <span>
#include <string>
#include <vector>

namespace abbe {

// Balls around boxes, as far as they are in the scene's; those near one another are put together, so that few are left
// to look at for every density.
struct AimTargets {
    std::vector<AimTarget> balls;
    std::vector<std::string> names; // as many: of what each is around, "ball, lens, ring and others"
};
// `round`: boxes of shapes that are balls. The ball around such a box has three times the cross-section of the shape,
// so that they are aimed at themselves, if by themselves.
AimTargets aimTargets(const std::vector<FocusingShape>& focusing, const Bounds3& scene,
                      std::span<const Bounds3> round = {});

// Of the shapes that stand for themselves, not in objects; m, render space.
std::vector<Bounds3> boxesOfBalls(std::span<const SurfaceUse> surfaces);

} // namespace abbe
