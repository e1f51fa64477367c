#include "app/command_line.h"
#include "base/parallel.h"
#include "io/io_error.h"

#include <csignal>
#include <cstdio>
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
    } catch (const std::bad_alloc&) {
        console.error("out of memory");
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

} // namespace

int main(int argc, char** argv) {
    std::signal(SIGABRT, onAbort);
    std::signal(SIGPIPE, SIG_IGN); // a closed reader must not lose the image
    std::signal(SIGXFSZ, SIG_IGN); // nor a limit on the size of files, which is a full disk
    const auto result = readCommandLine(std::span<const char* const>(argv, static_cast<std::size_t>(argc)).subspan(1));
    if (const auto* end = std::get_if<EarlyEnd>(&result)) {
        std::fputs(end->text.c_str(), end->code == ExitCode::done ? stdout : stderr);
        return static_cast<int>(end->code);
    }
    return static_cast<int>(guarded(std::get<Command>(result)));
}
