// Memory for very large arrays: in huge pages where the system has them for the asking. Small pages are each handed out
// by a fault that costs more than filling them.
#pragma once

#include <cstddef>
#include <cstdlib>
#include <new>
#include <vector>

#ifdef __linux__
#include <sys/mman.h>
#endif

namespace abbe {

template <typename T> struct LargeArrayAllocator {
    using value_type = T;

    LargeArrayAllocator() = default;
    template <typename U> LargeArrayAllocator(const LargeArrayAllocator<U>&) {}

    T* allocate(std::size_t count) {
        if (count > static_cast<std::size_t>(-1) / 2 / sizeof(T)) throw std::bad_array_new_length();
        const std::size_t size = count * sizeof(T);
        if (size < kLarge) return static_cast<T*>(::operator new(size, kAlignment));
        const std::size_t whole = (size + kHugePage - 1) / kHugePage * kHugePage;
        void* const memory = ::operator new (whole, std::align_val_t{kHugePage});
#ifdef MADV_HUGEPAGE
        ::madvise(memory, whole, MADV_HUGEPAGE); // refused, it is what it was
#endif
        return static_cast<T*>(memory);
    }
    void deallocate(T* memory, std::size_t count) {
        const bool large = count * sizeof(T) >= kLarge;
        ::operator delete(memory, large ? std::align_val_t{kHugePage} : kAlignment);
    }
    bool operator==(const LargeArrayAllocator&) const { return true; }

  private:
    static constexpr std::size_t kHugePage = std::size_t{2} << 20;
    static constexpr std::size_t kLarge = std::size_t{4} << 20; // a part of a page is lost at the end
    static constexpr std::align_val_t kAlignment{alignof(T)};
};

template <typename T> using LargeArray = std::vector<T, LargeArrayAllocator<T>>;

} // namespace abbe
