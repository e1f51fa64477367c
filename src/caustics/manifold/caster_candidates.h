// Shapes with polished interfaces, and whether chains of delta interfaces can be followed over them.
#pragma once

#include "caustics/manifold/manifold_plan.h"
#include "render/scene.h"

#include <string>
#include <vector>

namespace abbe {

struct CasterCandidate {
    const Shape* shape = nullptr;
    const Material* material = nullptr;
    bool reflects = false, transmits = false; // by delta lobes
    std::string obstacle;                     // why chains do not run over it, for people; empty: they do

    // With all chains that can start there; those that reflect less are tried less. Its ball is that of the shape's
    // bounds, infinite for planes. Requires an empty obstacle.
    SpecularCaster caster() const;
};

// All shapes of the scene whose materials have delta lobes, in the order of Scene::surfaces.
std::vector<CasterCandidate> casterCandidates(const Scene&);

} // namespace abbe
