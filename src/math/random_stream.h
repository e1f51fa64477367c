// Independent random numbers without an end, for what may need any number of them.
#pragma once

#include "math/hash.h"

#include <algorithm>
#include <cmath>

namespace abbe {

// SplitMix64 [Steele2014]: a pure function of its seed.
class RandomStream {
  public:
    explicit RandomStream(std::uint64_t seed) : state_(seed) {}

    std::uint64_t bits() { return mix64(state_ += 0x9e3779b97f4a7c15ull); }
    float uniform() { return unitFloat(static_cast<std::uint32_t>(bits() >> 32)); } // [0, 1)
    // Exponentially distributed with mean 1. 32 bits and a half reach 22.9; 24 bits would end at 16.6 and miss the
    // distances beyond.
    float exponential() {
        const double u = (static_cast<double>(bits() >> 32) + 0.5) * 0x1p-32;
        return -std::log(static_cast<float>(u));
    }

  private:
    std::uint64_t state_;
};

} // namespace abbe
