// The commands of the helper. Each writes its answer as frames, without the end; they throw Failure or what OpenVDB
// throws; run() writes those.
#pragma once

#include <span>
#include <string>

namespace abbe::vdb {

using Arguments = std::span<const std::string>;

void info(Arguments);    // FILE
void read(Arguments);    // FILE (GRID USE)…; USE as VdbUse, with "?" when optional
void make(Arguments);    // KIND OUT RESOLUTION SEED
void convert(Arguments); // IN OUT (OPTION=VALUE)…

// The command of that name, to the end or to a fault.
void run(const std::string& command, Arguments);

} // namespace abbe::vdb
