// The commands of the helper. Each writes its answer as frames, without the end; they throw Failure or what OpenVDB
// throws; run() writes those.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace abbe::vdb {

using Arguments = std::span<const std::string>;

void info(Arguments);    // FILE
void read(Arguments);    // FILE (GRID USE)…; USE as VdbUse, with "?" when optional
void make(Arguments);    // KIND OUT RESOLUTION SEED
void convert(Arguments); // IN OUT (OPTION=VALUE)…

// What this process may take from now on. A damaged file may ask for any amount of memory or run in circles: a file
// gets what a sound one of its size could need (data that hardly varies is packed two hundredfold), and no more than
// `memory` bytes, which the program may take.
void setLimits(const std::string& file, std::uint64_t memory);

// The command of that name, to the end or to a fault.
void run(const std::string& command, Arguments);

} // namespace abbe::vdb
