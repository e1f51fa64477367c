// What a render was asked to do.
#pragma once

#include "app/frame_list.h"
#include "app/load.h"
#include "pictures/display_view.h"
#include "pictures/image_output.h"
#include "render/integrator.h"
#include "scene/build.h"
#include "tev/tev_image.h"

#include <optional>
#include <string>
#include <vector>

namespace abbe {

// How a render is kept from being lost.
struct CheckpointOptions {
    double interval = 25; // s; 0: only when interrupted or asked to
    bool off = false;     // none at all
    bool keep = false;    // also when it is done
    bool resume = false;  // go on from it
};

struct RenderOptions {
    std::vector<SampleId> replay; // these are taken again, and told
    SceneInput input;
    std::string output; // EXR; empty: from the scene
    PngOptions png;
    ViewOptions view;
    BuildOptions build;
    bool largestKernel = false; // run the instantiation with all effects
    bool quiet = false;
    bool strict = false;
    bool cost = false;             // printed at the end
    double progressEvery = 0.25;   // s, between lines of JSON
    std::optional<bool> preview;   // while it goes on; unless off
    std::optional<TevAddress> tev; // where it is shown, too
    std::optional<Vec2i> pixel;    // render this one alone and print it
    std::optional<double> memory;  // MiB, the most that may be taken
    CheckpointOptions checkpoint;
    std::optional<PixelBounds> crop;
    std::optional<Vec2i> part;       // x of y equal ranges of the samples; a file for `merge` is written
    std::uint32_t skip = 0;          // samples per pixel that parts of an earlier round have
    std::vector<std::string> parts;  // nothing is rendered, but these are put together
    bool soFar = false;              // also where samples are missing
    std::vector<int> frames;         // of an animation: each is rendered by itself, one after the other
    std::optional<FrameOfRun> frame; // the one that is rendered, that of `input`; to a file of its own

    bool inMemory = false;   // no files of the image, which a host gets; parts are files all the same
    std::string sheet, clip; // of all frames: a PNG with their pictures, and a film; empty: none

    bool makesFiles() const { return !pixel; }
    // Whether parts become one part, not an image.
    bool mergesToPart() const { return !parts.empty() && output.ends_with(".abbe"); }
};

} // namespace abbe
