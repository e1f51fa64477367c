// Renders a scene by two estimators until their difference is known well enough, and compares them once.
#pragma once

#include "scene/build.h"
#include "verify/agreement.h"
#include "verify/estimators.h"

#include <array>
#include <atomic>
#include <cstdint>
#include <functional>
#include <optional>

namespace abbe {

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
