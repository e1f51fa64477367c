// How much work pilots do.
#pragma once

#include "render/integrator.h"

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace abbe {

// Numbers of paths, pixels and places of the pilots of one size, RenderSettings::pilot. Sizes are kPilotStep apart in
// work, as far as the least numbers let them.
class PilotSize {
  public:
    static constexpr double kPilotStep = 4;

    // Requires 0 < size <= RenderSettings::kFullPilot.
    explicit PilotSize(const RenderSettings& settings)
        : effort_(std::pow(kPilotStep, settings.pilot - RenderSettings::kFullPilot)) {}

    // Of the work of the full pilot; a power of two.
    double effort() const { return effort_; }
    std::uint32_t count(std::uint32_t full, std::uint32_t least) const {
        return std::max(std::min(full, least), static_cast<std::uint32_t>(full * effort_));
    }
    // Of something along one of two axes.
    int side(int full, int least) const {
        return std::max(std::min(full, least), static_cast<int>(full * std::sqrt(effort_)));
    }

  private:
    double effort_;
};

} // namespace abbe
