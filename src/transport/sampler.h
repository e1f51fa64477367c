// The numbers of one path. Dimensions are assigned by purpose, never by order of use: an effect that draws numbers of
// its own does not move those of another, so images with and without it share their samples.
#pragma once

#include "math/hash.h"
#include "math/sobol.h"
#include "math/vec.h"
#include "render/technique.h"

#include <bit>

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
// vertex 0-1, light of the second 2-3, light of the first 4-5, wavelengths 6, film 7-8, BSDF of the second 9-10, light
// and BSDF of the third 11-14, time 15, lens 16-17, light and lobe choice of those vertices 18-19, 20-21 and 22-23.
// Every later vertex has an independently shuffled set of its own (light 0-1, BSDF 2-3, choices 4-5): padding, whose
// cost is one register.
//
// Dimension 6 is the hero wavelength or, where no density depends on it, the place of all eight within an eighth; which
// of them is the hero then follows from the same point, as its place in the dimension that makes a (0, 2)-sequence of
// it. So both are stratified by themselves and as one number, and so they are over squares of pixels
// (docs/decisions/037-paired-wavelengths.md).
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
        shift_ = UInt8{};
        paired_ = false;
    }
    // After startPixel(), for the pixel at (x, y): the 4 × 4 pixels of its square, and the 2 × 2 within, share the
    // strata of their wavelengths, each pixel one of every 16 or 4. `squareSeed`: the same for all pixels of it.
    // `paired`: dimension 6 is the place within an eighth.
    void shareWavelengths(std::uint64_t squareSeed, int x, int y, bool paired) {
        const int place = (x & 1) | (y & 1) << 1 | (x & 2) << 1 | (y & 2) << 2;
        const std::uint32_t first = sobolBits(shuffleIndex(0, seed_), 0)[kWavelength];
        dimensionSeeds_[0][kWavelength] = static_cast<std::uint32_t>(squareSeed);
        shift_[kWavelength] = first ^ kPlaces.within[place];
        heroShift_ = heroOf(first) ^ kPlaces.hero[place] ^ static_cast<std::uint32_t>(squareSeed >> 61);
        paired_ = paired;
    }
    void start(std::uint32_t index) {
        index_ = index;
        if (numbers_ != Technique::Numbers::sobol) [[unlikely]]
            return fillOther(0, true, joint_);
        const std::uint32_t shuffled = shuffleIndex(index, seed_);
        const UInt8 first = sobolBits(shuffled, 0);
        hero_ = heroOf(first[kWavelength]) ^ heroShift_;
        scrambleToFloats(first ^ shift_, dimensionSeeds_[0], joint_);
        for (int g = 1; g < groups_; ++g)
            scrambleToFloats(sobolBits(shuffled, 8 * g), dimensionSeeds_[g], joint_ + 8 * g);
    }
    Vec2 film() const { return {joint_[7], joint_[8]}; }
    // 53 bits, those beyond the sequence's 24 and the hero's 3 at random: a table of wavelengths has cells less likely
    // than 2^-20 (spectrum/wavelength_density.h).
    double wavelength() const {
        const std::uint64_t finer = combine64(stream_ ^ 0x3c6ef372u, index_) >> 35;
        const auto within = static_cast<double>(joint_[kWavelength]);
        if (!paired_ || numbers_ != Technique::Numbers::sobol) return within + static_cast<double>(finer) * 0x1p-53;
        return (static_cast<double>(hero_) + (within + static_cast<double>(finer >> 3) * 0x1p-50)) * 0.125;
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
    static constexpr int kWavelength = 6; // its joint dimension

    // What the places of a square add to the digits of the two numbers, as sobolBits() has them. The rows were found by
    // search: with any number 1, 2, … 32 of samples of each pixel, 2 × 2 and 4 × 4 pixels have one in each of as many
    // strata of either number, and of both as one.
    struct Places {
        std::uint32_t within[16], hero[16];
    };
    static constexpr Places places() {
        constexpr std::uint32_t withinRows[] = {15, 6, 3, 13, 7, 1, 2, 14, 11, 15, 14, 10}, heroRows[] = {11, 13, 7};
        Places all{};
        for (std::uint32_t place = 0; place < 16; ++place) {
            for (int digit = 0; digit < 12; ++digit)
                all.within[place] |= static_cast<std::uint32_t>(std::popcount(place & withinRows[digit]) & 1) << digit;
            for (int digit = 0; digit < 3; ++digit)
                all.hero[place] |= static_cast<std::uint32_t>(std::popcount(place & heroRows[digit]) & 1)
                                   << (2 - digit);
        }
        return all;
    }
    static const Places kPlaces;
    // Which eighth the hero is in: three digits of the second dimension of the Faure sequence in base 2 [Faure1982],
    // if the digits of the first are these, the highest in the lowest bit.
    static std::uint32_t heroOf(std::uint32_t digits) {
        const auto odd = [](std::uint32_t bits) { return static_cast<std::uint32_t>(std::popcount(bits) & 1); };
        return odd(digits) << 2 | odd(digits & 0xaaaaaaaau) << 1 | odd(digits & 0xccccccccu);
    }

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
    UInt8 shift_ = {};            // of the digits of the wavelengths: counted from the first sample's
    std::uint32_t heroShift_ = 0; // of hero_, likewise
    std::uint32_t hero_ = 0;      // the eighth in which it is
    bool paired_ = false;
    int groups_ = 0;
    std::uint64_t stream_ = 0;
    std::uint32_t seed_ = 0, index_ = 0;
    std::uint32_t strata_ = 1;
    Technique::Numbers numbers_ = Technique::Numbers::sobol;
};

inline constexpr Sampler::Places Sampler::kPlaces = Sampler::places();

} // namespace abbe
