// Which dielectrics a path has entered [Schmidt2002].
#pragma once

#include "integrators/entered_stack.h"
#include "render/material.h"

namespace abbe {

class DielectricStack : public EnteredStack<Material> {
  public:
    // What fills the space here; null: air. Where dielectrics overlap, it is the one of the highest priority; among
    // equals the one entered last.
    const Material* top() const {
        const Material* best = nullptr;
        for (int i = 0; i < size(); ++i)
            if (!best || (*this)[i]->priority() >= best->priority()) best = (*this)[i];
        return best;
    }
};

} // namespace abbe
