// Scenes that are measured, not looked at: `abbe study` and `abbe verify`.
#pragma once

#include "app/load.h"
#include "reports/render_report.h"
#include "scene/build.h"

#include <memory>

namespace abbe {

struct MeasuredScene {
    std::unique_ptr<LoadedScene> loaded;
    BuildOptions options; // with the size of the picture
    BuiltScene built;     // whole frames: without crop and overscan
    ExitCode code = ExitCode::done;
};

// Loads and builds; tells `messages` what is wrong. Without a size in the options the frame is made smaller in
// proportion until no side is longer than `side` pixels.
MeasuredScene loadMeasured(const SceneInput&, const BuildOptions&, int side, RenderReport& messages);

} // namespace abbe
