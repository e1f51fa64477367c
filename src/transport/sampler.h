// The numbers of one path. Dimensions are assigned by purpose, never by order of use: an effect that draws numbers of
// its own does not move those of another, so images with and without it share their samples.
#pragma once

#include "math/hash.h"
#include "math/sobol.h"
#include "math/vec.h"
#include "render/technique.h"

#include <array>
#include <bit>

namespace abbe {

// What one path vertex may draw.
struct VertexSample {
    Vec2 light; // where on the light
    Vec2 bsdf;  // which direction
    float pick; // which light
    float lobe; // which lobe
};

// What each of the 4 × 4 pixels of a square adds to the digits of a point that all of them share, before its digits are
// scrambled alike for all. Each pixel then has a scrambled Sobol sequence as it would have by itself; together they
// have one point in each of as many strata as there are points, so that what the points of one pixel leave out its
// neighbours have, and the mean over the square errs less than pixels by themselves would have it [Ahmed2020].
//
// A digit is added where an odd number of the place's four bits are among those of its row: a digital shift, which
// keeps every net. Of any four rows in succession none is a sum of the others, hence the strata with any power of two
// of samples; which rows was found by search (docs/decisions/042-squares-of-pixels.md).
class PixelSquare {
  public:
    static constexpr int kSide = 4;

    // Place of a pixel in its square, of 16 of which each four are those of a 2 × 2: in an order that differs from
    // square to square, as a pattern that is the same in all is seen. Quarters are shuffled, and the pixels of each.
    static std::size_t place(std::uint64_t squareSeed, int x, int y) {
        const auto quarter = static_cast<std::uint32_t>((x >> 1 & 1) | (y & 2));
        const auto pixel = static_cast<std::uint32_t>((x & 1) | (y & 1) << 1);
        return shuffled(mix64(squareSeed ^ 0x5be0cd19u), quarter) << 2 |
               shuffled(mix64(squareSeed ^ (0x6c62272eu + quarter)), pixel);
    }
    // Of dimensions 8 `group` and on, the highest digit in the lowest bit as sobolBits() has them.
    static UInt8 shift(std::size_t place, int group) {
        return *reinterpret_cast<const UInt8*>(kShifts.digits[place].data() + 8 * group);
    }
    // Of the number of the eighth that the hero is in.
    static std::uint32_t heroShift(std::size_t place) { return kShifts.hero[place]; }

  private:
    // Where one of the 24 orders of four has i.
    static std::size_t shuffled(std::uint64_t random, std::uint32_t i) {
        return kOrders[(random >> 32) * 24 >> 32] >> (2 * i) & 3u;
    }
    static const std::array<std::uint8_t, 24> kOrders; // two bits each
    struct Shifts {
        alignas(32) std::array<std::array<std::uint32_t, kSobolDimensions>, kSide * kSide> digits{};
        std::array<std::uint32_t, kSide * kSide> hero{};
    };
    static const Shifts kShifts;
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
// it. So both are stratified by themselves and as one number (docs/decisions/037-paired-wavelengths.md).
//
// The pixels of a square divide the strata of the joint dimensions among them (PixelSquare).
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
        shuffleSeed_ = seed_;
        for (int g = 0; g < groups_; ++g) {
            dimensionSeeds_[g] = dimensionSeeds(seed_, 8 * g);
            shifts_[g] = UInt8{};
        }
        heroShift_ = 0;
        paired_ = false;
    }
    // After startPixel(), for the pixel at (x, y): the 4 × 4 pixels of its square, and the 2 × 2 within, share the
    // strata of their joint dimensions, each pixel one of every 16 or 4. `squareSeed`: the same for all pixels of it.
    // `paired`: dimension 6 is the place within an eighth.
    void shareSquare(std::uint64_t squareSeed, int x, int y, bool paired) {
        const std::size_t place = PixelSquare::place(squareSeed, x, y);
        const std::uint64_t scramble = mix64(squareSeed ^ 0x1f83d9abu);
        shuffleSeed_ = static_cast<std::uint32_t>(squareSeed);
        for (int g = 0; g < groups_; ++g) {
            dimensionSeeds_[g] = dimensionSeeds(static_cast<std::uint32_t>(scramble), 8 * g);
            shifts_[g] = PixelSquare::shift(place, g);
        }
        heroShift_ = PixelSquare::heroShift(place) ^ static_cast<std::uint32_t>(scramble >> 61);
        paired_ = paired;
    }
    void start(std::uint32_t index) {
        index_ = index;
        if (numbers_ != Technique::Numbers::sobol) [[unlikely]]
            return fillOther(0, true, joint_);
        const std::uint32_t shuffled = shuffleIndex(index, shuffleSeed_);
        const UInt8 first = sobolBits(shuffled, 0);
        hero_ = heroOf(first[kWavelength]) ^ heroShift_;
        scrambleToFloats(first ^ shifts_[0], dimensionSeeds_[0], joint_);
        for (int g = 1; g < groups_; ++g)
            scrambleToFloats(sobolBits(shuffled, 8 * g) ^ shifts_[g], dimensionSeeds_[g], joint_ + 8 * g);
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
    UInt8 shifts_[3] = {};        // of the digits of the joint dimensions
    std::uint32_t heroShift_ = 0; // of hero_
    std::uint32_t hero_ = 0;      // the eighth in which it is
    bool paired_ = false;
    int groups_ = 0;
    std::uint64_t stream_ = 0;
    std::uint32_t seed_ = 0, shuffleSeed_ = 0, index_ = 0; // shuffleSeed_: of the joint dimensions
    std::uint32_t strata_ = 1;
    Technique::Numbers numbers_ = Technique::Numbers::sobol;
};

} // namespace abbe
