// What `abbe volume` was asked to do.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace abbe {

struct VolumeOptions {
    enum class Action : std::uint8_t { info, make, convert };
    Action action = Action::info;
    std::string input; // info, convert: a .vdb file; make: the kind
    std::string output;
    int resolution = 200; // make: voxels along the longest side
    std::uint32_t seed = 0;
    bool quiet = false;
    // convert
    std::vector<std::string> grids; // empty: all
    double resample = 1;            // size of the new voxels in old ones
    bool fog = false, clean = false, half = false;
    std::optional<float> prune;
    std::vector<double> crop; // corners of a box in the file's world: empty or six numbers
};

} // namespace abbe
