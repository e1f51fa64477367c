#include "math/joe_kuo.h"

#include "math/sobol.h"

namespace abbe {

namespace {

// Direction numbers of all dimensions, their bits reversed, by the bit of the index.
struct JoeKuoRows {
    alignas(32) std::uint32_t rows[32][kJoeKuoDimensions];
};
JoeKuoRows makeJoeKuoRows() {
    JoeKuoRows all{};
    for (int dimension = 0; dimension < kJoeKuoDimensions; ++dimension) {
        std::uint32_t v[32] = {};
        joeKuoDirections(dimension, v);
        for (int bit = 0; bit < 32; ++bit) all.rows[bit][dimension] = reverseBits(v[bit]);
    }
    return all;
}

} // namespace

void joeKuoPoint(std::uint32_t index, std::uint32_t seed, float (&out)[kJoeKuoDimensions]) {
    static const JoeKuoRows directions = makeJoeKuoRows();
    UInt8 bits = {};
    for (int bit = 0; index != 0; ++bit, index >>= 1)
        if (index & 1) bits ^= *reinterpret_cast<const UInt8*>(directions.rows[bit]);
    scrambleToFloats(bits, dimensionSeeds(seed, 0), out);
}

} // namespace abbe
