// The graphics state of pbrt: what a directive finds in force, and AttributeBegin saves.
#pragma once

#include "exchange/pbrt/pbrt_params.h"
#include "math/transform.h"

#include <map>
#include <memory>
#include <string>
#include <vector>

namespace abbe::exchange {

struct PbrtMaterial;

// The current transform at the beginning and at the end of the motion (TransformTimes).
struct PbrtMotion {
    Transform at[2];

    bool moves() const;
    // Applied before what is there, as all of pbrt's directives are.
    void concat(const Transform& t, unsigned active) {
        for (unsigned i = 0; i < 2; ++i)
            if ((active >> i & 1u) != 0) at[i] = t.then(at[i]);
    }
};

struct PbrtState {
    PbrtMotion place;
    unsigned active = 3; // bits of the times to which transforms apply
    bool isReversed = false;
    std::string colorSpace = "srgb";
    const PbrtMaterial* material = nullptr; // of `Material`; null: grey, or that of the name
    std::string materialName;               // of `NamedMaterial`
    std::shared_ptr<const PbrtParams> areaLight;
    std::string inside, outside;                                           // media
    std::map<std::string, std::vector<PbrtParam>, std::less<>> attributes; // of Attribute, by kind
};

} // namespace abbe::exchange
