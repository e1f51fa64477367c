// What was found out about caustics behind glass and in mirrors before a render, for people to read.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace abbe {

// Of manifold sampling. It depends on the scene, the frame and the seed alone.
struct ManifoldFindings {
    static constexpr std::size_t kObstacles = 4;

    bool measured = false; // a pilot has run: whether the numbers below mean anything
    bool used = false;
    bool leftToMerging = false; // which has the light of all these lamps; the pilot found too few chains to trust them
    std::uint64_t chains = 0;   // that the pilot found
    // Of a sample of every pixel, in the mean over pixels: relative second moment of the light that chains of polished
    // interfaces bring to what is seen by way of others, as chance and as manifold sampling find it; relative variance
    // of everything else; and what all of that comes to in efficiency.
    double before = 0, after = 0, rest = 0, gain = 1;
    std::uint32_t estimates = 1; // of which a vertex takes the mean: as many as serve efficiency best
    std::uint64_t rays = 0;      // that it took to find out
    // Polished shapes over which chains cannot be followed, with the reason: what they focus is left to chance where it
    // is seen by way of glass or mirrors. The first kObstacles of so many.
    std::vector<std::string> obstacles;
    std::uint64_t obstacleCount = 0;
};

} // namespace abbe
