// The commands of the helper. Each writes its answer as frames, without the end; they throw Failure or what OpenVDB
// throws.
#pragma once

#include <span>
#include <string>

namespace abbe::vdb {

using Arguments = std::span<const std::string>;

void info(Arguments);    // FILE
void read(Arguments);    // FILE (GRID USE)…; USE as VdbUse, with "?" when optional
void make(Arguments);    // KIND OUT RESOLUTION SEED
void convert(Arguments); // IN OUT (OPTION=VALUE)…

} // namespace abbe::vdb
