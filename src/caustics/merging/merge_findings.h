// What was found out about merging of light paths before a render, for people to read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace abbe {

// It depends on the scene, the frame and the seed alone.
struct MergeFindings {
    bool measured = false; // a pilot has run: whether the numbers below mean anything
    bool used = false;
    bool found = false; // whether there is any such light
    // Of a sample of every pixel, in the mean over pixels: relative second moment of that light as camera paths find it
    // (infinite where they never do) and as merging does with `every`; relative variance of everything else; and what
    // all of that comes to in efficiency.
    double before = 0, after = 0, rest = 0, gain = 1;
    std::uint32_t every = 1;         // samples of a replicate there are to a round
    std::uint32_t photons = 0;       // light paths of a round
    std::uint64_t rays = 0;          // that it took to find out
    std::vector<std::string> lights; // whose light is merged
    std::vector<std::string> unseen; // whose light camera paths never find, whether it is merged or not
};

} // namespace abbe
