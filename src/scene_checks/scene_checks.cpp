#include "scene_checks/scene_checks.h"

#include "scene_checks/checks.h"

namespace abbe {

CheckOutcome checkWholeScene(const BuiltScene& built, const schema::SceneTree& tree, CheckDepth depth,
                             Diagnostics& diagnostics) {
    CheckOutcome outcome;
    if (diagnostics.hasErrors()) return outcome;
    Diagnostics found;
    checks::checkExtent(built, tree, found);
    checks::checkCameraDistance(built, tree, found);
    checks::checkLampPowers(built, found);
    checks::checkFocus(built, tree, found);
    if (depth == CheckDepth::surfaces) {
        std::vector<checks::Solid> solids = checks::refractingSolids(built);
        checks::checkSurfaces(solids, built, tree, found);
        checks::checkEmittingSides(built, found);
        checks::checkOverlaps(solids, built, tree, found);
        outcome.cameraInBody = checks::checkAroundCamera(solids, built, found);
    }
    if (tree.includes.empty())
        diagnostics.addAll(found);
    else
        addWithIncluders(tree, found, 0, diagnostics);
    return outcome;
}

} // namespace abbe
