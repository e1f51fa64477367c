// What a path has entered and not left: the shared part of the stacks of dielectrics and of media.
#pragma once

#include <array>
#include <cstddef>

namespace abbe {

// Of things that others own, in the order of entry. A path that enters more than kMax at once is in an image of soup;
// what does not fit is counted by the caller and not followed.
template <typename T> class EnteredStack {
  public:
    static constexpr int kMax = 16;

    int size() const { return size_; }
    const T* operator[](int i) const { return entered_[static_cast<std::size_t>(i)]; }
    bool contains(const T* thing) const { return lastOf(thing) >= 0; }
    // False if it is full.
    bool enter(const T* thing) {
        if (size_ == kMax) return false;
        entered_[static_cast<std::size_t>(size_++)] = thing;
        return true;
    }
    // Leaving what was never entered does nothing: a mesh with a hole in it is no reason to go astray.
    void leave(const T* thing) {
        int i = lastOf(thing);
        if (i < 0) return;
        for (--size_; i < size_; ++i) entered_[static_cast<std::size_t>(i)] = (*this)[i + 1];
    }

  private:
    int lastOf(const T* thing) const {
        int i = size_ - 1;
        while (i >= 0 && (*this)[i] != thing) --i;
        return i;
    }

    std::array<const T*, kMax> entered_{};
    int size_ = 0;
};

} // namespace abbe
