// Little memory, for the readers that ask how much there is.
#pragma once

#include "base/memory_limit.h"

namespace abbe::test {

// So many bytes more than the process has now, until the end of the scope.
struct MemoryScope {
    explicit MemoryScope(double bytes) { setMemoryLimit(static_cast<double>(residentMemory()) + bytes); }
    ~MemoryScope() { setMemoryLimit(0); }
    MemoryScope(const MemoryScope&) = delete;
    MemoryScope& operator=(const MemoryScope&) = delete;
};

} // namespace abbe::test
