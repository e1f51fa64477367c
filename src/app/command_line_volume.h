// The part of the command line that belongs to `abbe volume`.
#pragma once

#include "app/volume_options.h"

namespace CLI {
class App;
}

namespace abbe {

// Adds the actions of `abbe volume` to its command; they write into `options` and `json`, which must live as long.
void addVolumeActions(CLI::App& command, VolumeOptions& options, bool& json);

} // namespace abbe
