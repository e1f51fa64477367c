// How much of what lights may give arrives, as a look at the frame found it: walls are in the way.
#pragma once

#include "guiding/space_tree.h"
#include "render/film.h"
#include "render/receiver.h"

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <vector>

namespace abbe {

class Light;
class LightSampler;

// Of groups of lights: those below each branch of the root of the tree, and each of the lights far away. For surfaces
// in small cells. Frozen.
class LightArrival {
  public:
    static constexpr std::size_t kBranches = 8, kGroups = 16;
    // What a group may give there is to be multiplied by, for choosing: in (0, 1].
    using Factors = std::array<float, kGroups>;

    // `factors`: of the leaves of `cells`.
    LightArrival(SpaceTree cells, std::vector<Factors> factors)
        : cells_(std::move(cells)), factors_(std::move(factors)) {}

    // kGroups of them; null in media, of which nothing is known.
    const float* at(const Receiver& at) const {
        return at.surface ? factors_[cells_.leaf(at.p, faceOf(at.n))].data() : nullptr;
    }

  private:
    SpaceTree cells_;
    std::vector<Factors> factors_;
};

// Listens to a look at a frame in which lights are asked for at surfaces alone. Thread-safe.
class LightPilot {
  public:
    // A place at which next-event estimation asked for a light.
    struct Asked {
        int x = 0, y = 0; // pixel
        Receiver at{Vec3()};
        const Light* light = nullptr;
        std::uint32_t part = 0;
        float shown = 0; // of the light, by the path; 0: it did not arrive
    };

    std::unique_ptr<SampleRecorder> recorder();
    void add(const std::vector<Asked>&);
    // Nothing where the noise of next-event estimation would not be much less with it. `over`: what a pixel's light is
    // to be multiplied by, so that all count alike.
    std::optional<LightArrival> learn(const LightSampler&, const std::function<float(int, int)>& over);

  private:
    std::mutex mutex_;
    std::vector<Asked> asked_;
};

} // namespace abbe
