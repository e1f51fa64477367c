// Which shapes' interiors a path is in.
#pragma once

#include "render/medium.h"

#include <array>

namespace abbe {

// Interiors that overlap add up. A path that enters more than kMax at once is in an image of soup; what does not fit is
// counted by the caller and not followed.
class MediumStack {
  public:
    static constexpr int kMax = 16;

    int size() const { return size_; }
    const Medium* operator[](int i) const { return media_[static_cast<std::size_t>(i)]; }
    // False if it is full.
    bool enter(const Medium* medium) {
        if (size_ == kMax) return false;
        media_[static_cast<std::size_t>(size_++)] = medium;
        return true;
    }
    // Leaving what was never entered does nothing: a mesh with a hole in it is no reason to go astray.
    void leave(const Medium* medium) {
        for (int i = size_ - 1; i >= 0; --i)
            if (media_[static_cast<std::size_t>(i)] == medium) {
                for (--size_; i < size_; ++i)
                    media_[static_cast<std::size_t>(i)] = media_[static_cast<std::size_t>(i + 1)];
                return;
            }
    }
    void clear() { size_ = 0; }

  private:
    std::array<const Medium*, kMax> media_{};
    int size_ = 0;
};

} // namespace abbe
