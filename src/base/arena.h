// Bump allocator for the objects of one path vertex: fixed size, reset per path, nothing in it is destroyed.
#pragma once

#include "base/check.h"

#include <cstddef>
#include <new>
#include <type_traits>
#include <utility>

namespace abbe {

// One per thread; objects live until reset(). Requires trivially destructible types and alignment up to 32.
class Arena {
  public:
    template <typename T, typename... Args> T* make(Args&&... args) {
        static_assert(std::is_trivially_destructible_v<T>, "arena objects are never destroyed");
        static_assert(alignof(T) <= 32);
        constexpr std::size_t size = (sizeof(T) + 31) / 32 * 32;
        ABBE_CHECK(used_ + size <= capacity);
        void* place = bytes_ + used_;
        used_ += size;
        return new (place) T(std::forward<Args>(args)...);
    }
    void reset() { used_ = 0; }

  private:
    static constexpr std::size_t capacity = 8192;
    alignas(32) std::byte bytes_[capacity];
    std::size_t used_ = 0;
};

} // namespace abbe
