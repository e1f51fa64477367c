// The numbers of one path. Dimensions are assigned by purpose, never by order of use: an effect that draws numbers of
// its own does not move those of another, so images with and without it share their samples.
#pragma once

#include "math/hash.h"
#include "math/sobol.h"
#include "math/vec.h"
#include "render/technique.h"

namespace abbe {

// What one path vertex may draw.
struct VertexSample {
    Vec2 light; // where on the light
    Vec2 bsdf;  // which direction
    float pick; // which light
    float lobe; // which lobe
};

// Sample `index` of an Owen-scrambled Sobol sequence of its own for every (pixel, replicate). The first 24 dimensions
// are joint, in the order of what their quality is worth (docs/decisions/010-sampler-dimensions.md): BSDF of the first
// vertex 0-1, light of the second 2-3, light of the first 4-5, wavelength 6, film 7-8, BSDF of the second 9-10, light
// and BSDF of the third 11-14, time 15, lens 16-17, light and lobe choice of those vertices 18-19, 20-21 and 22-23.
// Every later vertex has an independently shuffled set of its own (light 0-1, BSDF 2-3, choices 4-5): padding, whose
// cost is one register.
//
// Other numbers, for comparison: independent ones, or strata. Of N strata each block of N samples has one each, in
// every pair of dimensions and every single one by itself and independently of the others (math/multi_jitter.h). With N
// the samples of a replicate that is what is usually called stratified sampling.
class Sampler final {
  public:
    static constexpr std::uint32_t kJointVertices = 3;

    // Of one (pixel, replicate). `choices`: whether lens, light choice or lobe choice will be asked for at all; else
    // their dimensions are left out. `strata`: N, at least 1.
    void startPixel(std::uint64_t pixelSeed, Technique::Numbers numbers, bool choices, std::uint32_t strata = 1) {
        seed_ = static_cast<std::uint32_t>(pixelSeed);
        stream_ = pixelSeed;
        numbers_ = numbers;
        strata_ = strata;
        groups_ = choices ? 3 : 2;
        for (int g = 0; g < groups_; ++g) dimensionSeeds_[g] = dimensionSeeds(seed_, 8 * g);
    }
    void start(std::uint32_t index) {
        index_ = index;
        if (numbers_ != Technique::Numbers::sobol) [[unlikely]]
            return fillOther(0, true, joint_);
        const std::uint32_t shuffled = shuffleIndex(index, seed_);
        for (int g = 0; g < groups_; ++g)
            scrambleToFloats(sobolBits(shuffled, 8 * g), dimensionSeeds_[g], joint_ + 8 * g);
    }
    Vec2 film() const { return {joint_[7], joint_[8]}; }
    // 53 bits, those beyond the sequence's 24 at random: a table of wavelengths has cells less likely than 2^-20
    // (spectrum/wavelength_density.h).
    double wavelength() const {
        const auto finer = static_cast<double>(combine64(stream_ ^ 0x3c6ef372u, index_) >> 35);
        return static_cast<double>(static_cast<std::int32_t>(joint_[6] * 0x1p24f)) * 0x1p-24 + finer * 0x1p-53;
    }
    float time() const { return joint_[15]; }
    Vec2 lens() const { return {joint_[16], joint_[17]}; }

    // Vertex 0 is the first that the camera ray hits.
    VertexSample vertex(std::uint32_t depth) {
        if (depth < kJointVertices) {
            constexpr int lights[] = {4, 2, 11}, bsdfs[] = {0, 9, 13};
            const float* light = joint_ + lights[depth];
            const float* bsdf = joint_ + bsdfs[depth];
            const float* choice = joint_ + 18 + 2 * depth;
            return {{light[0], light[1]}, {bsdf[0], bsdf[1]}, choice[0], choice[1]};
        }
        fillSet(depth);
        return {{set_[0], set_[1]}, {set_[2], set_[3]}, set_[4], set_[5]};
    }
    // For Russian roulette: independent of all other numbers. The survival probability depends on earlier samples of
    // the pixel, and a number that shared their stratification would correlate with it and bias the estimate.
    float roulette(std::uint32_t depth) const {
        const std::uint64_t place = (std::uint64_t{index_} << 32) | depth;
        return unitFloat(static_cast<std::uint32_t>(combine64(stream_ ^ 0x5bd1e995u, place) >> 32));
    }

    // Numbers for tracking through media from a vertex on, of which any number may be needed: independent ones.
    RandomStream stream(std::uint32_t depth) const {
        return RandomStream(combine64(stream_ ^ 0xa54ff53au, (std::uint64_t{index_} << 32) | depth));
    }

  private:
    void fillSet(std::uint32_t set) {
        if (numbers_ != Technique::Numbers::sobol) [[unlikely]]
            return fillOther(set, false, set_);
        const std::uint32_t seed = mix32(seed_ + set * 0x9e3779b9u);
        scrambledSobol8(shuffleIndex(index_, seed), seed, 0, set_);
    }
    [[gnu::cold]] void fillOther(std::uint32_t set, bool joint, float* out) const;
    [[gnu::cold]] void fillRandom(std::uint32_t set, float* out, int count) const;

    alignas(32) float joint_[24] = {};
    alignas(32) float set_[8] = {};
    UInt8 dimensionSeeds_[3] = {};
    int groups_ = 0;
    std::uint64_t stream_ = 0;
    std::uint32_t seed_ = 0, index_ = 0;
    std::uint32_t strata_ = 1;
    Technique::Numbers numbers_ = Technique::Numbers::sobol;
};

} // namespace abbe
