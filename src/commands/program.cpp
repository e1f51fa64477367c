#include "commands/program.h"

#include "base/memory_limit.h"
#include "base/parallel.h"
#include "base/text.h"
#include "base/text_output.h"
#include "command_line/parser.h"
#include "commands/command_table.h"
#include "io/file.h"

#include <csignal>
#include <cstring>
#include <fmt/format.h>
#include <system_error>
#include <unistd.h>

namespace {

using namespace abbe;

// A broken contract aborts after its message; the caller gets the code of an internal bug.
void onAbort(int) { _exit(static_cast<int>(ExitCode::internal)); }

ExitCode guarded(const CommandLine& line) {
    const Console& console = line.common.console;
    try {
        setThreadCount(line.common.threads);
        return line.command->execute(line.common);
    } catch (const IoError& e) {
        console.error(e.what());
        return ExitCode::system;
    } catch (const std::bad_alloc& e) {
        console.error(fmt::format("out of memory: {}", memoryReason(e)));
        return ExitCode::memory;
    } catch (const std::exception& e) {
        const auto* const system = dynamic_cast<const std::system_error*>(&e);
        if (system && system->code() == std::errc::resource_unavailable_try_again) {
            console.error("out of memory: there is none for another thread");
            return ExitCode::memory;
        }
        console.error(fmt::format("internal error: {}. This is a bug; please report it.", e.what()));
        return ExitCode::internal;
    }
}

// Who has the text written into a file must learn that it is incomplete.
ExitCode withText(ExitCode code, const CommandLine& line) {
    if (code != ExitCode::done || line.command->makesFiles() || lostText() == 0) return code;
    line.common.console.error(fmt::format("cannot write to stdout: {}", std::strerror(lostText())));
    return ExitCode::system;
}

} // namespace

int abbe::runProgram(std::span<const char* const> words) {
    keepStandardStreams();
    std::signal(SIGABRT, onAbort);
    std::signal(SIGPIPE, SIG_IGN); // a closed reader must not lose the image
    std::signal(SIGXFSZ, SIG_IGN); // nor a limit on the size of files, which is a full disk
    const auto result = readCommandLine(commandTable(), words);
    if (const auto* end = std::get_if<EarlyEnd>(&result)) {
        const bool wanted = end->code == ExitCode::done;
        writeText(wanted ? TextStream::out : TextStream::err, shownLines(end->text));
        return static_cast<int>(wanted && lostText() != 0 ? ExitCode::system : end->code);
    }
    const auto& line = std::get<CommandLine>(result);
    if (line.command->makesFiles()) std::signal(SIGHUP, SIG_IGN); // it goes on without its terminal
    return static_cast<int>(withText(guarded(line), line));
}
