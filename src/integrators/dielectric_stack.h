// Which dielectrics a path has entered [Schmidt2002].
#pragma once

#include "render/material.h"

#include <array>

namespace abbe {

// Where dielectrics overlap, the one of the highest priority fills the space; among equals the one entered last.
class DielectricStack {
  public:
    static constexpr int kMax = 16;

    int size() const { return size_; }
    const Material* operator[](int i) const { return entered_[static_cast<std::size_t>(i)]; }
    // What fills the space here; null: air.
    const Material* top() const {
        const Material* best = nullptr;
        for (int i = 0; i < size_; ++i)
            if (!best || (*this)[i]->priority() >= best->priority()) best = (*this)[i];
        return best;
    }
    // False if it is full.
    bool enter(const Material* material) {
        if (size_ == kMax) return false;
        entered_[static_cast<std::size_t>(size_++)] = material;
        return true;
    }
    // Leaving what was never entered does nothing: a mesh with a hole in it is no reason to go astray.
    void leave(const Material* material) {
        for (int i = size_ - 1; i >= 0; --i)
            if ((*this)[i] == material) {
                for (--size_; i < size_; ++i)
                    entered_[static_cast<std::size_t>(i)] = entered_[static_cast<std::size_t>(i + 1)];
                return;
            }
    }

  private:
    std::array<const Material*, kMax> entered_{};
    int size_ = 0;
};

} // namespace abbe
