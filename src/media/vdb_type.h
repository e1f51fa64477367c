// `volume vdb`: grids from a file.
#pragma once

#include "math/transform.h"
#include "media/glow_type.h"

namespace abbe {

struct VdbParams : MediumParams, GlowParams {
    schema::Text file;                   // resolved path
    std::optional<schema::Text> density; // names of grids; empty: the usual one
    std::optional<schema::Text> temperature, flame, color, velocity;
    std::optional<double> time; // s, of the file's fields; when the shutter opens if absent
    bool levelSet = false;      // a level set is made into fog
    Transform transform;
};

schema::TypeInfo vdbType();

} // namespace abbe
