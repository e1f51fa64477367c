// `abbe volume`: OpenVDB files, what is in them, procedural ones, and converted ones. Each action is a command.
#pragma once

#include "command_line/command.h"

#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace abbe {

struct VolumeInfoOptions {
    std::string input;
};

struct VolumeMakeOptions {
    std::string kind; // "cumulus", as the helper knows it
    std::string output;
    int resolution = 200; // voxels along the longest side
    std::uint32_t seed = 0;
    bool quiet = false;
};

struct VolumeConvertOptions {
    std::string input, output;
    std::vector<std::string> grids; // empty: all
    double resample = 1;            // size of the new voxels in old ones
    bool fog = false, clean = false, half = false;
    std::optional<float> prune;
    std::vector<double> crop; // corners of a box in the file's world: empty or six numbers
};

extern const char* const kVolumeHelp;
std::span<const CommandEntry> volumeActions();

void addArguments(Arguments&, VolumeInfoOptions&);
void addArguments(Arguments&, VolumeMakeOptions&);
void addArguments(Arguments&, VolumeConvertOptions&);
ExitCode run(const VolumeInfoOptions&, const CommonOptions&);
ExitCode run(const VolumeMakeOptions&, const CommonOptions&);
ExitCode run(const VolumeConvertOptions&, const CommonOptions&);

} // namespace abbe
