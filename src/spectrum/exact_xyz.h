// Sums of XYZ that are the same in any order.
#pragma once

#include "math/exact_sum.h"
#include "spectrum/xyz.h"

namespace abbe {

struct ExactXyz {
    ExactSum x, y, z;

    ExactXyz() = default;
    // Requires components below ExactSum::kLargest.
    ExactXyz(Xyz v) noexcept : x(v.x), y(v.y), z(v.z) {} // NOLINT: an Xyz is a sum of one term

    ExactXyz& operator+=(const ExactXyz& b) noexcept {
        x += b.x;
        y += b.y;
        z += b.z;
        return *this;
    }
    bool operator==(const ExactXyz&) const = default;
    Xyz value() const noexcept { return {x.value(), y.value(), z.value()}; }
};

} // namespace abbe
