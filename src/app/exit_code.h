// How the program ends; documented in docs/command_line.md.
#pragma once

namespace abbe {

enum class ExitCode : int {
    done = 0,          // also when a time limit or a noise goal ended the render
    faulty = 1,        // the scene or an image has errors
    usage = 2,         // wrong command line
    system = 3,        // a file cannot be read or written
    threshold = 4,     // a comparison exceeded its threshold, or --strict and there were warnings
    memory = 5,        // out of memory
    internal = 70,     // a bug of the program
    interrupted = 130, // by SIGINT, after saving; SIGTERM: 143
    terminated = 143,
};

struct ExitCodeText {
    ExitCode code;
    const char* meaning;
};
inline constexpr ExitCodeText kExitCodes[] = {
    {ExitCode::done, "done; also when a time limit or a noise goal ended the render"},
    {ExitCode::faulty, "the scene or an image has errors"},
    {ExitCode::usage, "wrong command line"},
    {ExitCode::system, "a file cannot be read or written"},
    {ExitCode::threshold, "a threshold was exceeded, a check failed, or there were warnings with --strict"},
    {ExitCode::memory, "out of memory"},
    {ExitCode::internal, "a bug of the program"},
    {ExitCode::interrupted, "interrupted by Ctrl-C, after saving"},
    {ExitCode::terminated, "ended by SIGTERM, after saving"},
};

} // namespace abbe
