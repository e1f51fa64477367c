#include "doctor/numeric_check.h"

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

namespace {

constexpr NumericCheck kChecks[] = {
    {0, "fused multiplication and addition", "products whose rounding error is not exact", 0, inexactFusedProducts},
    {0, "rounding to nearest in every thread", "sums that are rounded otherwise", 0, wrongRoundings},
    {1, "a ray leaves a surface", "share of 1e6 rays that meet the surface they leave", 1e-6,
     [] { return selfIntersections(1000000, 0); }},
    {2, "the same far from the origin", "share of 2e5 rays that meet it, 1e4 m from the origin", 1e-6,
     [] { return selfIntersections(200000, 1e4); }},
    {5, "rays at edges and vertices", "of 1e6 rays at the edges of a closed mesh, those that escape", 0,
     [] { return escapesAtEdges(1000000); }},
    {5, "rays at edges and vertices", "share of rays aimed at its very vertices that escape", 0.01,
     [] { return escapesAtVertices(100000); }},
    {12, "a frame about (0, 0, -1)", "largest product of two axes", 1e-6, frameError},
    {24, "GGX density at its peak", "largest relative error against double", 1e-6, ggxDensityError},
    {28, "Fresnel near the critical angle", "largest error against double, all indices", 1e-4, fresnelDielectricError},
    {28, "Fresnel near the critical angle", "largest error for indices more than 0.01 apart", 1e-5,
     fresnelDielectricErrorApart},
    {29, "conductors with k near 0 or huge", "largest error against long double", 1e-5, fresnelConductorError},
    {30, "lights of tiny solid angle", "largest relative error of the solid angle", 1e-6, coneSolidAngleError},
    {31, "small triangles seen from afar", "largest relative error of the solid angle", 1e-3, triangleSolidAngleError},
    {34, "a sun in an environment", "largest relative error of the probability of a dark bin", 1e-5, darkBinError},
    {36, "a random number next to 1", "empty bins drawn by all random numbers", 0, emptyBinsDrawn},
    {44, "thin films of no thickness", "largest difference from no film", 1e-6, emptyFilmError},
    {46, "wavelengths of a path", "largest error of X, Y or Z of white", 1e-4, equalEnergyError},
    {49, "saturated colours", "largest error of the 27 corners and middles of sRGB", 1e-3, rgbRoundTripError},
    {50, "lights with lines", "largest relative error of X or Z of FL11", 1e-3, lineLightColourError},
    {52, "sums of 1e8 samples", "relative error of the mean", 1e-7, filmMeanError},
    {59, "denormals", "denormal numbers left in a worker", 0, denormalsLeft},
    {60, "order of additions", "of 20 orders of the same terms, those with another sum", 0, orderDependentSums},
    {60, "order of additions", "pixels that differ between one thread and all", 0, threadDependentPixels},
};

} // namespace

std::span<const NumericCheck> numericChecks() { return kChecks; }

} // namespace abbe::doctor
