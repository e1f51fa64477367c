#include "vdb/commands.h"
#include "vdb/output.h"

#include <new>

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

} // namespace abbe::vdb
