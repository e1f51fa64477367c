#include "io/file_bytes.h"

#include "io/io_error.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fmt/format.h>
#include <memory>

namespace abbe {

std::string readFileBytes(const std::string& path) {
    const auto fail = [&](int error) {
        throw IoError(fmt::format("cannot read `{}`: {}", path, std::strerror(error)));
    };
    const std::unique_ptr<std::FILE, int (*)(std::FILE*)> file(std::fopen(path.c_str(), "rb"), &std::fclose);
    if (!file) fail(errno);
    std::string bytes;
    char buffer[1 << 16];
    while (const std::size_t count = std::fread(buffer, 1, sizeof buffer, file.get())) bytes.append(buffer, count);
    if (std::ferror(file.get())) fail(errno);
    return bytes;
}

} // namespace abbe
