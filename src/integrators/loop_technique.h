// What a Technique comes to in the path loop, settled once for all paths: the default costs the loop no question.
#pragma once

#include "integrators/roulette.h"
#include "render/technique.h"
#include "spectrum/wavelengths.h"

namespace abbe {

struct LoopTechnique {
    enum class Rule : std::uint8_t { balance, power, equal, lightsOnly };

    LoopTechnique() = default;
    explicit LoopTechnique(const Technique& t)
        : wavelengths(t.wavelengths), asksLights(t.strategy != Technique::Strategy::bsdfOnly),
          rule(t.strategy == Technique::Strategy::lightsOnly ? Rule::lightsOnly
               : t.weights == Technique::Weights::power      ? Rule::power
               : t.weights == Technique::Weights::equal      ? Rule::equal
                                                             : Rule::balance),
          balanced(rule == Rule::balance), uniform(t.directions == Technique::Directions::uniform) {
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
    bool asksLights = true;    // next-event estimation
    Rule rule = Rule::balance; // between lights and scattering; without lights there is nothing to weigh
    bool balanced = true;      // by the balance heuristic
    bool uniform = false;      // directions
};

} // namespace abbe
