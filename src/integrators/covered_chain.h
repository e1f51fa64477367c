// What a camera path has met since the last vertex at which manifold sampling was asked.
#pragma once

#include "caustics/shared/chain_signature.h"

#include <cstdint>

namespace abbe {

// Plain data of a path; ManifoldSampler::follow() and covers() look after it.
struct CoveredChain {
    static constexpr std::uint32_t kNone = 0xffffffffu;

    // At a vertex where light was asked for by ManifoldSampler::sample(), whatever came of it.
    void start() { *this = {.following = true}; }
    // At any other vertex that is not a delta.
    void stop() { following = false; }

    ChainSignature signature = {};
    std::uint32_t caster = kNone; // the first interface's place in the plan
    bool following = false;
};

} // namespace abbe
