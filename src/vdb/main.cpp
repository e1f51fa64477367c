// The helper abbe-vdb: everything that is done with OpenVDB, in a process of its own, so that a damaged file can at
// worst end this one. It is started by src/volumes/vdb_process.cpp and answers with the frames of
// volumes/vdb_message.h.
#include "vdb/commands.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <sys/resource.h>
#include <sys/stat.h>
#include <unistd.h>
#include <vector>

namespace {

using namespace abbe;

#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr bool kSanitized = true; // reserves terabytes of addresses
#else
constexpr bool kSanitized = false;
#endif

void limit(int resource, rlim_t value) {
    rlimit now{};
    if (::getrlimit(static_cast<__rlimit_resource>(resource), &now) != 0) return;
    if (now.rlim_max != RLIM_INFINITY && value > now.rlim_max) value = now.rlim_max;
    now.rlim_cur = value;
    ::setrlimit(static_cast<__rlimit_resource>(resource), &now);
}

// A damaged file may ask for any amount of memory or run in circles: a file gets what a sound one of its size could
// need (data that hardly varies is packed two hundredfold), and no more than `memory`, which the program may take.
void setLimits(const std::string& file, rlim_t memory) {
    limit(RLIMIT_CORE, 0);
    struct stat status {};
    const bool known = ::stat(file.c_str(), &status) == 0;
    const auto size = static_cast<rlim_t>(known ? status.st_size : 0);
    limit(RLIMIT_CPU, known ? 8 + size / 250'000 : 7200);
    if (kSanitized) return;
    limit(RLIMIT_DATA, known ? std::min(memory, 2'000'000'000 + 256 * size) : memory);
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 4 || ::isatty(STDOUT_FILENO)) {
        std::fputs("abbe-vdb is started by abbe; see `abbe volume --help`\n", stderr);
        return 2;
    }
    // The memory in bytes, the command, and a file or the kind of volume to make.
    setLimits(argv[3], std::strtoull(argv[1], nullptr, 10));
    vdb::run(argv[2], std::vector<std::string>(argv + 3, argv + argc));
    ::_exit(0); // without the destructors of libraries, which have nothing to save
}
