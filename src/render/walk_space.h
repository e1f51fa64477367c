// The way of a ray through a field, piece by piece.
#pragma once

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>

namespace abbe {

// A stretch of a ray along which a field (the density of a medium) is known to stay within bounds. Distances along
// the ray.
struct MediumSegment {
    float tNear = 0, tFar = 0;
    float minimum = 0, mean = 0, maximum = 0; // of the field; `mean` is any value between, the nearer the better
};

// Where one walk lives; reused from ray to ray.
struct WalkSpace {
    alignas(32) std::byte bytes[1024];

    template <typename T, typename... Args> T* make(Args&&... args) {
        static_assert(sizeof(T) <= sizeof(bytes) && alignof(T) <= 32 && std::is_trivially_destructible_v<T>);
        return new (bytes) T(std::forward<Args>(args)...);
    }
};

} // namespace abbe
