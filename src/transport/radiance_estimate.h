// What one sample has found so far, and whether it may be kept.
#pragma once

#include "render/path_observer.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

namespace abbe {

// Light that is negative for whatever reason.
inline constexpr float kNegativeFault = -std::numeric_limits<float>::max();

// Whose number is at fault, and which.
struct FaultSource {
    const void* source = nullptr; // null: the observer's other events tell
    const char* what = "";
};

// The radiance at the eye that a path has gathered, in the lanes of the wavelengths that it started with.
//
// Something may be wrong with a sample though its light looks sound: a density that is infinite makes a contribution 0,
// one that is negative makes it too bright. So numbers that a sample's light hides are checked: what is divided by
// them, or chosen by them, is finite and positive again. A number at fault is written into the sample, whose gate
// (tile_kernel.h) then drops it.
struct RadianceEstimate {
    Spectrum radiance{0.f};
    Spectrum least{0.f};              // the least of all that was added to it, which the sum does not show
    PathObserver* observer = nullptr; // null: nobody watches

    // Light that reached the eye from `source`, a Light or a MediumEmission. `passing`: as PathObserver::gathers().
    void add(const Spectrum& light, const void* source, bool passing = false) {
        add(light, source, passing, [] {});
    }
    // `tell` makes the calls of the observer that come before.
    template <typename Tell> void add(const Spectrum& light, const void* source, bool passing, Tell tell) {
        radiance += light;
        least = min(light, least); // in this order NaN leaves it alone
        if (observer) [[unlikely]] {
            tell();
            observer->gathers(light, source, passing);
        }
    }
    // The render is to end: what was gathered is no number.
    void leave() { radiance = Spectrum(std::numeric_limits<float>::quiet_NaN()); }

    // The sample will be dropped, whatever else comes to it. `fault` is not a number, infinite, or negative.
    [[gnu::cold, gnu::noinline]] void dropSample(float fault, FaultSource from) {
        if (fault == 0) return; // -0
        if (observer && from.source) observer->findsFault(from.source, from.what, fault);
        if (fault < 0 && fault > -kInfinity)
            least = Spectrum(kNegativeFault);
        else
            radiance = Spectrum(std::isnan(fault) ? fault : kInfinity);
    }
    // In the order of unsigned numbers the bits of all that is no density lie above those of the finite ones.
    void checkDensities(float a, float b, FaultSource from = {}) {
        constexpr auto kInfinite = std::bit_cast<std::uint32_t>(kInfinity);
        const auto bitsA = std::bit_cast<std::uint32_t>(a), bitsB = std::bit_cast<std::uint32_t>(b);
        if (std::max(bitsA, bitsB) >= kInfinite) [[unlikely]]
            dropSample(bitsA >= bitsB ? a : b, from);
    }
    void checkDensity(float pdf, FaultSource from = {}) { checkDensities(pdf, 0, from); }
    // A negative weight would change roulette before any light shows it. All other faults reach the light.
    void checkWeight(const Spectrum& weight, FaultSource from = {}) {
        if (_mm256_movemask_ps(weight.v) != 0) [[unlikely]]
            dropSample(-maxLane(-weight), from);
    }
    // Densities at other wavelengths over the hero's.
    void checkRatios(const Spectrum& ratios) {
        if (!allFinite(ratios))
            dropSample(sum(ratios), {}); // NaN or infinite
        else
            checkWeight(ratios);
    }
    void checkDirection(Vec3 w, FaultSource from = {}) {
        if (!(lengthSquared(w) < 2)) [[unlikely]]
            dropSample(dot(w, w), from);
    }
};

} // namespace abbe
