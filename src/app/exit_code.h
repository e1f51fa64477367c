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

} // namespace abbe
