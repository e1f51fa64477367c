// Eight neighbouring pixels of a row, treated alike: the unit of work of the denoiser.
#pragma once

#include <cstring>

namespace abbe {

using Lanes = float __attribute__((vector_size(32)));
inline constexpr int kLanes = 8;

inline Lanes load(const float* from) {
    Lanes v;
    std::memcpy(&v, from, sizeof v);
    return v;
}
inline void store(float* to, Lanes v) { std::memcpy(to, &v, sizeof v); }
inline Lanes splat(float s) { return Lanes{} + s; }
inline Lanes min(Lanes a, Lanes b) { return a < b ? a : b; }
inline Lanes max(Lanes a, Lanes b) { return a > b ? a : b; }

// exp(−x) as (1 − x/64)⁶⁴, 0 from 64 on: within 0.004 of it and made of multiplications alone.
inline Lanes decay(Lanes x) {
    Lanes e = max(Lanes{}, 1.f - x * (1 / 64.f));
    for (int i = 0; i < 6; ++i) e *= e;
    return e;
}

} // namespace abbe
