// What `AreaLightSource "diffuse"` makes of a shape: one that emits, or a light.
#pragma once

#include "exchange/pbrt/pbrt_spectrum.h"

#include <optional>
#include <string>
#include <vector>

namespace abbe::exchange {

struct PbrtEmission {
    PbrtLight light;
    std::string picture; // as the scene names it; empty: none
    bool isTwoSided = false;

    // Shapes emit on one side, and their pictures are no brighter than they are stored.
    bool needsLight() const { return isTwoSided || (!picture.empty() && light.scale > 1); }
    void writeShape(SceneNode&) const;
    void writeLight(SceneNode&) const;
};

// `areas` are those of all parts of the shape, as each is a light of its own in pbrt and has the whole `power`.
// Nothing for a dark one. What is approximated is a remark of `node`.
std::optional<PbrtEmission> pbrtEmissionOf(const PbrtParams& areaLight, const std::string& colorSpace,
                                           const std::vector<double>& areas, PbrtShared&, SceneNode& node);

} // namespace abbe::exchange
