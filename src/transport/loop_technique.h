// What a Technique comes to in the path loop, settled once for all paths: the default costs the loop no question.
#pragma once

#include "math/warp.h"
#include "render/technique.h"
#include "spectrum/spectrum.h"
#include "transport/roulette.h"

namespace abbe {

struct LoopTechnique {
    enum class Rule : std::uint8_t { balance, power, equal, favourLights, favourScattering, lightsOnly };
    // How many samples of the favoured technique each of its samples pretends to be.
    static constexpr float kFavour = 16;

    LoopTechnique() = default;
    explicit LoopTechnique(const Technique& t)
        : wavelengths(t.wavelengths), nextEvent(t.strategy != Technique::Strategy::bsdfOnly),
          rule(t.strategy == Technique::Strategy::lightsOnly ? Rule::lightsOnly
               : t.weights == Technique::Weights::power      ? Rule::power
               : t.weights == Technique::Weights::equal      ? Rule::equal
               : t.weights == Technique::Weights::lights     ? Rule::favourLights
               : t.weights == Technique::Weights::scattering ? Rule::favourScattering
                                                             : Rule::balance),
          balanced(rule == Rule::balance), evenly(t.directions != Technique::Directions::importance),
          mixed(t.directions == Technique::Directions::mixed) {
        if (t.roulette == Technique::Roulette::throughput) leastAfterDelta = 0;
    }

    // Light counts 1 / (1 + odds) where it was found in one of two ways. `ratio`: density of the other way over that of
    // this one, 0 if the other cannot find it; the balance heuristic's odds are the ratio itself. As functions of it no
    // heuristic overflows where densities are extreme: the square of a large one is infinite, which leaves nothing.
    float odds(float ratio, bool foundByLights) const {
        if (!(ratio > 0)) return 0;
        switch (rule) {
        case Rule::balance:
            return ratio;
        case Rule::power:
            return ratio * ratio;
        case Rule::equal:
            return 1;
        case Rule::favourLights: // the balance heuristic of unequal numbers of samples [Veach1997, eq. 9.8]
            return ratio * (foundByLights ? 1 / kFavour : kFavour);
        case Rule::favourScattering:
            return ratio * (foundByLights ? kFavour : 1 / kFavour);
        case Rule::lightsOnly:
            return foundByLights ? 0 : kInfinity;
        }
        return 0;
    }

    // The hero and those of its seven rotations that make n even ones, 1, 2 or 4, over and over in the lanes: every
    // mean over lanes is then one over them.
    static Wavelengths repeated(const Wavelengths& eight, int n) {
        const auto lane = [n](int i) { return i % n * (kLanes / n); };
        Wavelengths w = eight;
        for (int i = 0; i < kLanes; ++i) {
            w.nm.v[i] = eight.nm.v[lane(i)];
            w.cell[i] = eight.cell[lane(i)];
            w.fraction.v[i] = eight.fraction.v[lane(i)];
            w.pdf.v[i] = eight.pdf.v[lane(i)];
        }
        return w;
    }

    // Least scale of roulette after a mirror or clear glass, which shows the pixel what it sees: there the expected
    // radiance is the pixel's, not the image's.
    float leastAfterDelta = 1 / RouletteReference::kThreshold;
    int wavelengths = 8;       // different ones of a path
    bool nextEvent = true;     // next-event estimation
    Rule rule = Rule::balance; // between lights and scattering; without lights there is nothing to weigh
    bool balanced = true;      // by the balance heuristic
    bool evenly = false;       // some of the directions are drawn evenly, or all
    bool mixed = false;        // some

    // Share of them at a vertex. Mixed: densities are then at least 1 - share of the own ones, and the product of that
    // over n vertices is 1/(n + 1): weights grow with the length of a path, not exponentially.
    float evenShare(std::uint32_t depth) const { return mixed ? 1 / static_cast<float>(depth + 2) : 1; }
    // With which a medium's vertex finds a direction that its phase function finds with `own`.
    float mixedDensity(float own, std::uint32_t depth) const {
        if (!evenly) [[likely]]
            return own;
        const float even = evenShare(depth);
        return even * kSpherePdf + (1 - even) * own;
    }
};

} // namespace abbe
