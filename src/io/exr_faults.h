// What OpenEXR throws while it reads.
#pragma once

#include "base/memory_limit.h"
#include "io/io_error.h"

#include <fmt/format.h>

namespace abbe {

// Runs `body`; whatever it throws becomes an IoError with the file's name.
template <typename F> auto readingExr(const std::string& path, const F& body) {
    const auto fail = [&](std::string_view why) { throw IoError(fmt::format("cannot read `{}`: {}", path, why)); };
    try {
        return body();
    } catch (const IoError&) {
        throw;
    } catch (const std::bad_alloc& e) {
        fail(memoryReason(e));
    } catch (const std::exception& e) {
        fail(e.what());
    }
    throw IoError(path); // not reached
}

} // namespace abbe
