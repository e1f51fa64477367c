// The numbers of one path. Dimensions are assigned by purpose, never by order of use: an effect that draws numbers of
// its own does not move those of another, so images with and without it share their samples.
#pragma once

#include "math/hash.h"
#include "math/sobol.h"
#include "math/vec.h"

namespace abbe {

// What one path vertex may draw.
struct VertexSample {
    Vec2 light; // where on the light
    Vec2 bsdf;  // which direction
    float pick; // which light
    float lobe; // which lobe
};

// Sample `index` of an Owen-scrambled Sobol sequence of its own for every (pixel, replicate). The first sixteen
// dimensions are joint: film 0-1, light and BSDF of the first vertex 2-5, lens 6-7, wavelength 8, time 9, light and
// lobe choice of the first vertex 10-11, light and BSDF of the second vertex 12-15. Every later vertex has an
// independently shuffled set of its own (light 0-1, BSDF 2-3, choices 4-5), which also serves the choices of the
// second.
class Sampler final {
  public:
    // `random`: independent random numbers instead, for comparison.
    void start(std::uint64_t pixelSeed, std::uint32_t index, bool random) {
        index_ = index;
        seed_ = static_cast<std::uint32_t>(pixelSeed);
        stream_ = pixelSeed;
        random_ = random;
        if (random)
            fillRandom(0, joint_, 16);
        else
            scrambledSobol16(index, seed_, joint_);
    }
    Vec2 film() const { return {joint_[0], joint_[1]}; }
    Vec2 lens() const { return {joint_[6], joint_[7]}; }
    float wavelength() const { return joint_[8]; }
    float time() const { return joint_[9]; }

    // Vertex 0 is the first that the camera ray meets. `choices`: whether pick and lobe will be used at all.
    VertexSample vertex(std::uint32_t depth, bool choices) {
        if (depth == 0) return {{joint_[2], joint_[3]}, {joint_[4], joint_[5]}, joint_[10], joint_[11]};
        if (depth > 1 || choices) fillSet(depth);
        if (depth == 1) return {{joint_[12], joint_[13]}, {joint_[14], joint_[15]}, set_[4], set_[5]};
        return {{set_[0], set_[1]}, {set_[2], set_[3]}, set_[4], set_[5]};
    }
    // For Russian roulette: independent of all other numbers. The survival probability depends on earlier samples of
    // the pixel, and a number that shared their stratification would correlate with it and bias the estimate.
    float roulette(std::uint32_t depth) const {
        return unitFloat(
            static_cast<std::uint32_t>(combine64(stream_ ^ 0x5bd1e995u, (std::uint64_t{index_} << 32) | depth) >> 32));
    }

  private:
    void fillSet(std::uint32_t set) {
        if (random_) return fillRandom(set, set_, 8);
        const std::uint32_t seed = mix32(seed_ + set * 0x9e3779b9u);
        scrambledSobol8(shuffleIndex(index_, seed), seed, 0, set_);
    }
    void fillRandom(std::uint32_t set, float* out, int count) {
        std::uint64_t state = combine64(stream_, (std::uint64_t{index_} << 32) | set);
        for (int i = 0; i < count; ++i) {
            state += 0x9e3779b97f4a7c15ull; // SplitMix64
            out[i] = unitFloat(static_cast<std::uint32_t>(mix64(state) >> 32));
        }
    }

    alignas(32) float joint_[16];
    alignas(32) float set_[8] = {};
    std::uint64_t stream_ = 0;
    std::uint32_t seed_ = 0, index_ = 0;
    bool random_ = false;
};

} // namespace abbe
