// What a reader may end with.
#pragma once

#include "io/io_error.h"

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
