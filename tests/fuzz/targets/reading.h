// What a reader may end with.
#pragma once

#include "io/file.h"

#include <new>

namespace abbe::fuzz {

template <typename F> void reading(const F& read) {
    try {
        read();
    } catch (const IoError&) {
    } catch (const std::bad_alloc&) {
    }
}

} // namespace abbe::fuzz
