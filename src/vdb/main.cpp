// The helper abbe-vdb: everything that is done with OpenVDB, in a process of its own, so that a damaged file can at
// worst end this one. It is started by src/volumes/vdb_process.cpp and answers with the frames of
// volumes/vdb_message.h.
#include "vdb/commands.h"
#include "vdb/output.h"

#include <cstdio>
#include <new>
#include <sys/resource.h>
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

// A damaged file may ask for any amount of memory or run in circles.
void setLimits() {
    limit(RLIMIT_CORE, 0);
    limit(RLIMIT_CPU, 3600);
    if (kSanitized) return;
    const auto pages = static_cast<rlim_t>(::sysconf(_SC_PHYS_PAGES));
    limit(RLIMIT_AS, pages * static_cast<rlim_t>(::sysconf(_SC_PAGESIZE)));
}

bool execute(const std::string& command, vdb::Arguments arguments) {
    if (command == "info")
        vdb::info(arguments);
    else if (command == "read")
        vdb::read(arguments);
    else if (command == "make")
        vdb::make(arguments);
    else if (command == "convert")
        vdb::convert(arguments);
    else
        return false;
    return true;
}

void guarded(const std::string& command, const std::vector<std::string>& arguments) {
    const std::string subject = arguments.empty() ? std::string() : "`" + arguments[0] + "`";
    try {
        if (!execute(command, arguments))
            throw vdb::Failure(VdbFault::Kind::helper, "the helper `abbe-vdb` is not of this version");
        vdb::writeFrame(VdbFrame::end);
    } catch (const vdb::Failure& e) {
        vdb::writeFrame(VdbFrame::fault, e.fault());
    } catch (const std::bad_alloc&) {
        vdb::writeFrame(VdbFrame::fault,
                        VdbFault{VdbFault::Kind::memory, subject + " needs more memory than there is", {}});
    } catch (const std::exception& e) {
        vdb::writeFrame(VdbFrame::fault,
                        VdbFault{VdbFault::Kind::damaged, subject + " cannot be read: " + e.what(), {}});
    }
}

} // namespace

int main(int argc, char** argv) {
    if (argc < 3 || ::isatty(STDOUT_FILENO)) {
        std::fputs("abbe-vdb is started by abbe; see `abbe volume --help`\n", stderr);
        return 2;
    }
    setLimits();
    guarded(argv[1], std::vector<std::string>(argv + 2, argv + argc));
    ::_exit(0); // without the destructors of libraries, which have nothing to save
}
