// Axis-aligned boxes; empty until something is added.
#pragma once

#include "math/vec.h"

namespace abbe {

template <typename T> struct Bounds3T {
    Vec3T<T> lower{std::numeric_limits<T>::infinity(), std::numeric_limits<T>::infinity(),
                   std::numeric_limits<T>::infinity()};
    Vec3T<T> upper{-std::numeric_limits<T>::infinity(), -std::numeric_limits<T>::infinity(),
                   -std::numeric_limits<T>::infinity()};

    bool empty() const { return !(lower.x <= upper.x && lower.y <= upper.y && lower.z <= upper.z); }
    void add(Vec3T<T> p) {
        lower = min(lower, p);
        upper = max(upper, p);
    }
    void add(const Bounds3T& b) {
        lower = min(lower, b.lower);
        upper = max(upper, b.upper);
    }
    bool contains(Vec3T<T> p) const {
        return p.x >= lower.x && p.y >= lower.y && p.z >= lower.z && p.x <= upper.x && p.y <= upper.y && p.z <= upper.z;
    }
    // Touching counts.
    bool overlaps(const Bounds3T& b) const {
        return lower.x <= b.upper.x && lower.y <= b.upper.y && lower.z <= b.upper.z && b.lower.x <= upper.x &&
               b.lower.y <= upper.y && b.lower.z <= upper.z;
    }
    Vec3T<T> centre() const { return (lower + upper) * T(0.5); }
    Vec3T<T> diagonal() const { return upper - lower; }
    // Radius of the bounding sphere about the centre; 0 for an empty box.
    T radius() const { return empty() ? T(0) : length(diagonal()) * T(0.5); }
};

using Bounds3 = Bounds3T<float>;
using Bounds3d = Bounds3T<double>;

} // namespace abbe
