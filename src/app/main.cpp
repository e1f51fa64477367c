#include "app/command_line.h"
#include "base/memory_limit.h"
#include "base/parallel.h"
#include "base/text.h"
#include "base/text_output.h"
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

ExitCode execute(const Command& command) {
    setThreadCount(command.common.threads);
    return std::visit([&](const auto& options) { return run(options, command.common); }, command.options);
}

ExitCode guarded(const Command& command) {
    const Console& console = command.common.console;
    try {
        return execute(command);
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

// Whether what a command has to say on stdout is only beside the files that it makes.
bool makesFiles(const Command& command) {
    const auto* const render = std::get_if<RenderOptions>(&command.options);
    return (render && !render->pixel) || std::holds_alternative<MergeOptions>(command.options) ||
           std::holds_alternative<StudyOptions>(command.options);
}

// Who has the text written into a file must learn that it is incomplete.
ExitCode withText(ExitCode code, const Command& command) {
    if (code != ExitCode::done || makesFiles(command) || lostText() == 0) return code;
    command.common.console.error(fmt::format("cannot write to stdout: {}", std::strerror(lostText())));
    return ExitCode::system;
}

} // namespace

int main(int argc, char** argv) {
    keepStandardStreams();
    std::signal(SIGABRT, onAbort);
    std::signal(SIGPIPE, SIG_IGN); // a closed reader must not lose the image
    std::signal(SIGXFSZ, SIG_IGN); // nor a limit on the size of files, which is a full disk
    const auto result = readCommandLine(std::span<const char* const>(argv, static_cast<std::size_t>(argc)).subspan(1));
    if (const auto* end = std::get_if<EarlyEnd>(&result)) {
        const bool wanted = end->code == ExitCode::done;
        writeText(wanted ? TextStream::out : TextStream::err, shownLines(end->text));
        return static_cast<int>(wanted && lostText() != 0 ? ExitCode::system : end->code);
    }
    const auto& command = std::get<Command>(result);
    if (makesFiles(command)) std::signal(SIGHUP, SIG_IGN); // it goes on without its terminal
    return static_cast<int>(withText(guarded(command), command));
}
