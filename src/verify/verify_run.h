// Renders a scene by the two estimators that `abbe verify` plays off against each other, until their difference is
// known well enough, and compares them once.
#pragma once

#include "render/technique.h"
#include "scene/build.h"
#include "verify/agreement.h"

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>

namespace abbe {

struct Estimator {
    const char* name;
    const char* how; // in a few words
    Technique technique;
};

// They have in common what both would get wrong alike: the scene, polished glass and mirrors, dispersive lobes, lights
// that cannot be hit, and where light is absorbed. All else they do by different means: the first trusts the weights
// that samples of surfaces carry and finds light by scattering where it can, the second trusts values and densities
// alone and uses next-event estimation where it can. Numbers, choice of lights and roulette differ, too. No weight is
// more than 17 times that of the best, nor more than the length of the path in the second: tails stay bounded.
// `lights`: of the scene.
std::array<Estimator, 2> verifyEstimators(std::size_t lights);

struct VerifyPlan {
    double resolution = 0.001;            // standard error of the difference, relative to the mean of the picture
    double timeLimit = 300;               // s, of the whole
    std::optional<std::uint32_t> samples; // per pixel of either, in place of the two above
    double level = 0.001;                 // probability of a false alarm
    std::uint64_t seed = 0;
};

struct VerifyControl {
    const std::atomic<bool>* stop = nullptr;
    std::function<void(double fraction)> progress = {};
};

struct VerifyReport {
    struct Side {
        Estimator estimator;
        std::uint32_t samples = 0; // per pixel
        std::uint64_t rays = 0, dropped = 0;
        double error = 0; // standard error of the picture's mean Y, relative
    };
    std::array<Side, 2> sides;
    Agreement agreement;
    double seconds = 0;
    bool timeLimited = false; // fewer samples than the resolution needs
};

// Nothing if it was stopped. The number of samples is settled by a pilot whose samples are not used again, before the
// only test: looking more often would make false alarms more frequent than the level says. Throws std::bad_alloc.
std::optional<VerifyReport> verify(const BuiltScene&, const VerifyPlan&, const VerifyControl&);

} // namespace abbe
