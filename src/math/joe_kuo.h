// The Sobol sequence of [Joe2008] (file new-joe-kuo-6), and the points by which scenes place things. Paths have numbers
// of their own (math/sobol.h), which may change when better ones are found; what stands in a scene must stay there.
#pragma once

#include <cstdint>

namespace abbe {

inline constexpr int kJoeKuoDimensions = 8;

// Degree s, coefficients a and initial numbers m of dimensions 2 to 8; dimension 1 is van der Corput's.
struct JoeKuo {
    int s, a;
    std::uint32_t m[5];
};
inline constexpr JoeKuo kJoeKuo[kJoeKuoDimensions - 1] = {
    {1, 0, {1}},          {2, 1, {1, 3}},        {3, 1, {1, 3, 1}},       {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}}, {4, 4, {1, 3, 5, 13}}, {5, 2, {1, 1, 5, 5, 17}}};

// Direction numbers v_1 … v_32 of one dimension, most significant bit first [Joe2008, eq. 2-3].
constexpr void joeKuoDirections(int dimension, std::uint32_t (&v)[32]) {
    if (dimension == 0) {
        for (int i = 0; i < 32; ++i) v[i] = 1u << (31 - i);
        return;
    }
    const JoeKuo& p = kJoeKuo[dimension - 1];
    for (int i = 0; i < 32; ++i) {
        if (i < p.s) {
            v[i] = p.m[i] << (31 - i);
            continue;
        }
        v[i] = v[i - p.s] ^ (v[i - p.s] >> p.s);
        for (int k = 1; k < p.s; ++k)
            if ((p.a >> (p.s - 1 - k)) & 1) v[i] ^= v[i - k];
    }
}

// All eight, Owen-scrambled: 24-bit fractions in [0, 1). `out` is 32-byte aligned.
void joeKuoPoint(std::uint32_t index, std::uint32_t seed, float (&out)[kJoeKuoDimensions]);

} // namespace abbe
