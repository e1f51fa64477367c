// Flags that several commands have.
#pragma once

#include "app/load.h"
#include "command_line/arguments.h"
#include "pictures/display_view.h"
#include "pictures/image_output.h"
#include "scene/build.h"
#include "tev/tev_image.h"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

void addJson(Arguments&, const char* help = "JSON on stdout");
void addThreads(Arguments&);
void addDefines(Arguments&, std::vector<std::string>& defines,
                const char* help = "Set a parameter of the scene; may be repeated");
// `--variant` and `--set`, of commands that take a scene.
void addSearch(Arguments&, std::vector<std::string>& folders);
void addLayers(Arguments&, LayerChoice&); // with the search
// `--display`, `--view`, `--ocio`, `--exposure`.
void addView(Arguments&, ViewOptions&);
// `--png`; a view asks for a PNG, too.
void addPng(Arguments&, PngOptions&, const ViewOptions&);
// What of the command line a render's picture and plans hang on, beside the scene.
void addFrame(Arguments&, BuildOptions&);
// `--strategy` and `--sampler`, by which a render is not as its scene asks for it.
void addTechniques(Arguments&, BuildOptions&, const char* strategyHelp, const char* samplerHelp, const char* heading);
// `--frame`, of commands that look at one moment of an animation.
void addMoment(Arguments&, std::optional<int>& frame);
// `--fps`, of commands that look at frames.
void addRate(Arguments&, BuildOptions&);
// `--tev`, whose place may be left out.
void addTev(Arguments&, std::optional<TevAddress>&, const char* help);
// `--size` of pictures that a command makes itself.
void addOwnSize(Arguments&, std::optional<Vec2i>& size, std::string help);
inline constexpr double kLargestSeed = 9007199254740992; // 2^53
// `--seed` of a command that needs others beside it.
void addOwnSeed(Arguments&, std::optional<std::int64_t>& seed);

// Values, read as readQuantity() reads them. A time in seconds, above 0.
std::optional<double> readTime(std::string_view text);
std::optional<bool> readSwitch(std::string_view text);
// RenderSettings::pilot, one that can be asked for.
std::optional<int> readPilot(std::string_view text);

} // namespace abbe
