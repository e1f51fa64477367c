#include "base/check.h"

#include "base/text_output.h"

#include <cstdlib>
#include <fmt/format.h>

namespace abbe {

void checkFailed(const char* condition, const char* file, int line) {
    writeText(TextStream::err,
              fmt::format("abbe: internal error: {} does not hold ({}:{}). This is a bug; please report it.\n",
                          condition, file, line));
    std::abort();
}

} // namespace abbe
