// What readers of files throw, as diagnostics at the place that names the file.
#pragma once

#include "base/diagnostic.h"
#include "base/memory_limit.h"
#include "io/file.h"

#include <fmt/format.h>

namespace abbe {

// Runs `read`; false after a fault of the file.
template <typename F>
bool readsFile(const std::string& file, Span at, Diagnostics& diagnostics, const F& read, const char* code = "E0402") {
    try {
        read();
        return true;
    } catch (const IoError& e) {
        diagnostics.error(code, at, e.what(), "cannot be read");
    } catch (const std::bad_alloc& e) {
        diagnostics.error("E0404", at, fmt::format("`{}` does not fit into memory", file), memoryReason(e));
    }
    return false;
}

} // namespace abbe
