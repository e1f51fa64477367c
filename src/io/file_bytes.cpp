#include "io/file_bytes.h"

#include "base/memory_limit.h"
#include "base/regular_file.h"
#include "io/io_error.h"

#include <fmt/format.h>

namespace abbe {

std::string readFileBytes(const std::string& path) {
    RegularFile file(path);
    requireMemory(static_cast<double>(file.size()));
    std::string bytes = file.readAll();
    if (!file.good()) throw IoError(fmt::format("cannot read `{}`: {}", path, file.why()));
    return bytes;
}

} // namespace abbe
