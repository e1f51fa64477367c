#pragma once

#include <cstdlib>

namespace abbe::test {

// True in the long runs (./test nightly), which take more samples and more cases.
inline bool nightly() {
    const char* value = std::getenv("ABBE_NIGHTLY");
    return value && *value == '1';
}

} // namespace abbe::test
