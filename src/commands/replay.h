// `abbe replay`: samples of a render that are taken again and told vertex by vertex.
#pragma once

#include "command_line/command.h"
#include "render_run/render_options.h"

#include <optional>

namespace abbe {

struct ReplayOptions {
    RenderOptions render;           // how the samples were taken; its input is a scene or an image
    std::optional<Vec2i> pixel;     // absent, of an image: all that its header lists
    std::optional<SampleId> sample; // its replicate and index
};

extern const char* const kReplayHelp;
void addArguments(Arguments&, ReplayOptions&);
ExitCode run(const ReplayOptions&, const CommonOptions&);

} // namespace abbe
