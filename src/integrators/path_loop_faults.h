// The part of the path loop that finds what is wrong with a sample though its light looks sound: a density that is
// infinite makes a contribution 0, one that is negative makes it too bright. Such numbers condemn the sample, which its
// gate (tile_kernel.h) then drops. Included by path_loop.h.
#pragma once

#include <bit>
#include <limits>

namespace abbe {

// Light that is negative for whatever reason.
inline constexpr float kNegativeFault = -std::numeric_limits<float>::max();

// Whatever else comes to the sample: it is not a number, infinite, or has a negative part.
template <EffectBits E> [[gnu::cold, gnu::noinline]] void PathLoop<E>::condemn(float fault, Blame blame) {
    if (fault == 0) return; // -0
    if (observer_ && blame.who) observer_->blames(blame.who, blame.what, fault);
    if (fault < 0 && fault > -kInfinity)
        path_.least = Spectrum(kNegativeFault);
    else
        path_.radiance = Spectrum(std::isnan(fault) ? fault : kInfinity);
}

// In the order of unsigned numbers the bits of all that is no density lie above those of the finite ones.
template <EffectBits E> void PathLoop<E>::checkDensities(float a, float b, Blame blame) {
    constexpr auto kInfinite = std::bit_cast<std::uint32_t>(kInfinity);
    const auto bitsA = std::bit_cast<std::uint32_t>(a), bitsB = std::bit_cast<std::uint32_t>(b);
    if (std::max(bitsA, bitsB) >= kInfinite) [[unlikely]]
        condemn(bitsA >= bitsB ? a : b, blame);
}

// A negative weight would change roulette before any light shows it. All other faults reach the light.
template <EffectBits E> void PathLoop<E>::checkWeight(const Spectrum& weight, Blame blame) {
    if (_mm256_movemask_ps(weight.v) != 0) [[unlikely]]
        condemn(-maxLane(-weight), blame);
}

// Densities at other wavelengths over the hero's.
template <EffectBits E> void PathLoop<E>::checkRatios(const Spectrum& ratios) {
    if (!allFinite(ratios))
        condemn(sum(ratios), {}); // NaN or infinite
    else
        checkWeight(ratios);
}

} // namespace abbe
