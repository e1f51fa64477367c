#include "vdb/commands.h"

#include "vdb/output.h"

#include <algorithm>
#include <new>
#include <sys/resource.h>
#include <sys/stat.h>

namespace abbe::vdb {

namespace {

bool execute(const std::string& command, Arguments arguments) {
    if (command == "info")
        info(arguments);
    else if (command == "read")
        read(arguments);
    else if (command == "make")
        make(arguments);
    else if (command == "convert")
        convert(arguments);
    else
        return false;
    return true;
}

} // namespace

void run(const std::string& command, Arguments arguments) {
    const std::string subject = arguments.empty() ? std::string() : "`" + arguments[0] + "`";
    try {
        if (!execute(command, arguments))
            throw Failure(VdbFault::Kind::helper, "the helper `abbe-vdb` is not of this version");
        writeFrame(VdbFrame::end);
    } catch (const Failure& e) {
        writeFrame(VdbFrame::fault, e.fault());
    } catch (const std::bad_alloc&) {
        writeFrame(VdbFrame::fault,
                   VdbFault{VdbFault::Kind::memory,
                            subject + " needs more memory than there is, or than a sound file of its size would",
                            {}});
    } catch (const std::exception& e) {
        writeFrame(VdbFrame::fault,
                   VdbFault{VdbFault::Kind::damaged, subject + " cannot be read: " + plainWords(e), {}});
    }
}

namespace {

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

} // namespace

void setLimits(const std::string& file, std::uint64_t memory) {
    limit(RLIMIT_CORE, 0);
    struct stat status {};
    const bool known = ::stat(file.c_str(), &status) == 0;
    const auto size = static_cast<rlim_t>(known ? status.st_size : 0);
    const rlim_t seconds = known ? 8 + size / 250'000 : 7200;
    limit(RLIMIT_CPU, kSanitized ? 5 * seconds : seconds);
    if (kSanitized) return;
    limit(RLIMIT_DATA, known ? std::min<rlim_t>(memory, 2'000'000'000 + 256 * size) : memory);
}

} // namespace abbe::vdb
