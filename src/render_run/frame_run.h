// The frames of an animation: each is a render of its own, whose image tells of which render it is.
#pragma once

#include "app/console.h"
#include "app/program_end.h"
#include "film/film_params.h"
#include "render_run/render_options.h"

#include <optional>
#include <string>

namespace abbe {

// Renders all of options.frames, one after the other, until one of them does not end well: with its exit code. With
// `resume` those are left out whose images are there, whole, and of this very render.
ExitCode runFrames(const RenderOptions&, const CommonOptions&);

// The image of a frame, or its part. `asked`: what imagePath() says. Requires framePatternFault(asked).empty().
std::string frameImagePath(const std::string& asked, int frame, std::optional<Vec2i> part);

// In the header of a frame's image. Of equal ones all was the same: what makes two renders one, when they end, and what
// is written of them.
inline constexpr const char* kFrameFingerprint = "abbe.frameFingerprint";

struct FrameFacts {
    const LoadedScene* loaded = nullptr;
    const BuiltScene* built = nullptr; // with or without geometry
    PixelBounds crop;                  // that is rendered
};
// Reads the files that the scene names.
std::string frameFingerprint(const RenderOptions&, const FrameFacts&);

} // namespace abbe
