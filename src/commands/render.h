// `abbe render`: a picture of a scene.
#pragma once

#include "command_line/command.h"
#include "render_run/render_options.h"

namespace abbe {

extern const char* const kRenderHelp;
void addArguments(Arguments&, RenderOptions&);
ExitCode run(const RenderOptions&, const CommonOptions&);

} // namespace abbe
