#include "math/sobol.h"

namespace abbe {

namespace {

// Degree s, coefficients a and initial numbers m of dimensions 2 to 24 [Joe2008]; dimension 1 is van der Corput's.
struct JoeKuo {
    int s, a;
    std::uint32_t m[7];
};
constexpr JoeKuo kJoeKuo[kSobolDimensions - 1] = {
    {1, 0, {1}},
    {2, 1, {1, 3}},
    {3, 1, {1, 3, 1}},
    {3, 2, {1, 1, 1}},
    {4, 1, {1, 1, 3, 3}},
    {4, 4, {1, 3, 5, 13}},
    {5, 2, {1, 1, 5, 5, 17}},
    {5, 4, {1, 1, 5, 5, 5}},
    {5, 7, {1, 1, 7, 11, 19}},
    {5, 11, {1, 1, 5, 1, 1}},
    {5, 13, {1, 1, 1, 3, 11}},
    {5, 14, {1, 3, 5, 5, 31}},
    {6, 1, {1, 3, 3, 9, 7, 49}},
    {6, 13, {1, 1, 1, 15, 21, 21}},
    {6, 16, {1, 3, 1, 13, 27, 49}},
    {6, 19, {1, 1, 1, 15, 7, 5}},
    {6, 22, {1, 3, 1, 15, 13, 25}},
    {6, 25, {1, 1, 5, 5, 19, 61}},
    {7, 1, {1, 3, 7, 11, 23, 15, 103}},
    {7, 4, {1, 3, 7, 13, 13, 15, 69}},
    {7, 7, {1, 1, 3, 13, 7, 35, 63}},
    {7, 8, {1, 3, 5, 9, 1, 25, 53}},
    {7, 14, {1, 3, 1, 13, 9, 35, 107}},
};

// Direction numbers v_1 … v_32 of one dimension, most significant bit first [Joe2008, eq. 2-3].
constexpr void directionNumbers(int dimension, std::uint32_t (&v)[32]) {
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

constexpr std::uint32_t reversed(std::uint32_t x) {
    std::uint32_t r = 0;
    for (int b = 0; b < 32; ++b) r |= ((x >> b) & 1u) << (31 - b);
    return r;
}

constexpr SobolTable makeTable() {
    SobolTable table{};
    for (int dimension = 0; dimension < kSobolDimensions; ++dimension) {
        std::uint32_t v[32] = {};
        directionNumbers(dimension, v);
        for (int nibble = 0; nibble < 8; ++nibble)
            for (int value = 0; value < 16; ++value)
                for (int b = 0; b < 4; ++b)
                    if ((value >> b) & 1) table.rows[nibble][value][dimension] ^= reversed(v[4 * nibble + b]);
    }
    return table;
}

} // namespace

constexpr SobolTable kSobolTable = makeTable();

} // namespace abbe
