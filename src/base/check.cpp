#include "base/check.h"

#include <cstdio>
#include <cstdlib>

namespace abbe {

void checkFailed(const char* condition, const char* file, int line) {
    std::fprintf(stderr, "abbe: internal error: %s does not hold (%s:%d). This is a bug; please report it.\n",
                 condition, file, line);
    std::abort();
}

} // namespace abbe
