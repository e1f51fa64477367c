// Which effects a scene calls for, and who asked for them.
#pragma once

#include "app/json.h"
#include "app/load.h"
#include "scene/build.h"

#include <string>

namespace abbe {

// For people: what is simulated with the lines that asked for it, and what is not with the reason.
std::string effectsText(const LoadedScene&, const BuiltScene&);
// The same for programs: {"simulated": [...], "absent": [...], "unsupported": [...]}.
Json effectsJson(const LoadedScene&, const BuiltScene&);
// All effects that there are, by the words of `forbid`.
std::string allEffectsText();

} // namespace abbe
