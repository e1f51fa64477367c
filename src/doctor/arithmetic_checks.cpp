#include "doctor/arithmetic_checks.h"

#include "base/parallel.h"
#include "math/hash.h"

#include <atomic>
#include <cmath>
#include <limits>

namespace abbe::doctor {

double inexactFusedProducts() {
    int wrong = 0;
    for (std::uint64_t i = 0; i < 100000; ++i) {
        const float a = 1 + unitFloat(static_cast<std::uint32_t>(mix64(2 * i)));
        const float b = 1 + unitFloat(static_cast<std::uint32_t>(mix64(2 * i + 1)));
        const volatile float product = a * b;
        // Two numbers of 24 bits have a product of 48, which double holds.
        const double exact = static_cast<double>(a) * static_cast<double>(b) - static_cast<double>(product);
        wrong += static_cast<double>(std::fma(a, b, -product)) != exact;
    }
    return wrong;
}

double wrongRoundings() {
    std::atomic<int> wrong = 0;
    parallelFor(256, [&](std::size_t i) {
        // Half a unit in the last place is a tie and goes to the even neighbour; a little more or less decides.
        const volatile float one = 1, odd = 1 + 0x1p-23f, tie = 0x1p-24f, more = 0x1.000002p-24f;
        const volatile float sums[] = {one + tie, odd + tie, one + more, -one - tie, -odd - tie};
        const float expected[] = {1, 1 + 0x1p-22f, 1 + 0x1p-23f, -1, -1 - 0x1p-22f};
        for (int k = 0; k < 5; ++k) wrong += sums[k] != expected[k];
        const volatile double wide = 1, half = 0x1p-53, above = 0x1.0000000000001p-53;
        wrong += wide + half != 1 || wide + above != 1 + 0x1p-52 || -wide - half != -1;
        static_cast<void>(i);
    });
    return wrong;
}

double denormalsLeft() {
    std::atomic<int> left = 0;
    parallelFor(4096, [&](std::size_t) {
        const volatile float smallest = std::numeric_limits<float>::min(), half = 0.5f;
        const volatile float denormal = std::numeric_limits<float>::denorm_min(), large = 1e30f;
        left += smallest * half != 0;  // flushed to zero
        left += denormal * large != 0; // taken as zero
    });
    return left;
}

} // namespace abbe::doctor
