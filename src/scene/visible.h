// What hides shapes from rays, and what cannot be hidden.
#pragma once

#include "math/motion.h"
#include "render/visibility.h"

namespace abbe {

// What groups, objects and instances state of their own.
struct Placing {
    KeyedTransform transform;
    Visibility visible = kVisibleToAll;
};

// Whether light goes into a shape, or through holes of it.
struct Passing {
    bool entered = false, open = false;

    void add(Passing p) {
        entered = entered || p.entered;
        open = open || p.open;
    }
};

} // namespace abbe
