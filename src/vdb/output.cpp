#include "vdb/output.h"

#include <cerrno>
#include <fcntl.h>
#include <ios>
#include <unistd.h>

namespace abbe::vdb {

std::string plainWords(const std::exception& e) {
    if (dynamic_cast<const std::ios_base::failure*>(&e)) return "it has fewer bytes than it says";
    std::string words = e.what();
    const auto colon = words.find(": ");
    const bool isName =
        colon != std::string::npos && words.substr(0, colon).ends_with("Error") && words.find(' ') > colon;
    if (isName) words.erase(0, colon + 2);
    return words;
}

namespace {
int output = STDOUT_FILENO;
}

void takeOutput() {
    const int taken = ::fcntl(STDOUT_FILENO, F_DUPFD_CLOEXEC, STDERR_FILENO + 1);
    if (taken < 0 || ::dup2(STDERR_FILENO, STDOUT_FILENO) < 0) ::_exit(1);
    output = taken;
}

void writeBytes(const void* bytes, std::size_t size) {
    const auto* next = static_cast<const char*>(bytes);
    while (size > 0) {
        const ssize_t written = ::write(output, next, size);
        if (written < 0 && errno == EINTR) continue;
        if (written <= 0) ::_exit(1);
        next += written;
        size -= static_cast<std::size_t>(written);
    }
}

void writeFrame(VdbFrame kind, const std::string& content) {
    const VdbFrameHead head{kind, 0, content.size()};
    writeBytes(&head, sizeof head);
    writeBytes(content.data(), content.size());
}

} // namespace abbe::vdb
