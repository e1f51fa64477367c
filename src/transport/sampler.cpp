#include "transport/sampler.h"

#include "math/multi_jitter.h"

#include <array>
#include <span>

namespace abbe {

namespace {

// Dimensions that are stratified together.
struct Strata {
    std::uint8_t first, width;
};
// In the order of the joint dimensions (sampler.h): places and directions are pairs.
constexpr std::array<Strata, 16> kJointStrata{{{0, 2},
                                               {2, 2},
                                               {4, 2},
                                               {6, 1},
                                               {7, 2},
                                               {9, 2},
                                               {11, 2},
                                               {13, 2},
                                               {15, 1},
                                               {16, 2},
                                               {18, 1},
                                               {19, 1},
                                               {20, 1},
                                               {21, 1},
                                               {22, 1},
                                               {23, 1}}};
constexpr std::array<Strata, 4> kSetStrata{{{0, 2}, {2, 2}, {4, 1}, {5, 1}}};

} // namespace

void Sampler::fillOther(std::uint32_t set, bool joint, float* out) const {
    if (numbers_ == Technique::Numbers::random) return fillRandom(set, out, joint ? 24 : 8);
    const std::uint64_t key = combine64(combine64(stream_ ^ 0x6a09e667u, index_ / strata_), set);
    const std::uint32_t place = index_ % strata_;
    for (const Strata s : joint ? std::span<const Strata>(kJointStrata) : std::span<const Strata>(kSetStrata)) {
        const std::uint64_t own = combine64(key, s.first + 1u);
        if (s.width == 1) {
            out[s.first] = jittered(place, strata_, own);
            continue;
        }
        const Vec2 pair = multiJittered(place, strata_, own);
        out[s.first] = pair.x;
        out[s.first + 1] = pair.y;
    }
}

void Sampler::fillRandom(std::uint32_t set, float* out, int count) const {
    std::uint64_t state = combine64(stream_, (std::uint64_t{index_} << 32) | set);
    for (int i = 0; i < count; ++i) {
        state += 0x9e3779b97f4a7c15ull; // SplitMix64
        out[i] = unitFloat(static_cast<std::uint32_t>(mix64(state) >> 32));
    }
}

} // namespace abbe
