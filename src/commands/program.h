// The program from its words to its exit code.
#pragma once

#include <span>

namespace abbe {

// Runs the command that the words name, without the program's own name before them. The exit code
// (docs/command_line.md); every fault has been reported on stderr. Sets the signals of the process: once, from the main
// thread.
int runProgram(std::span<const char* const> words);

} // namespace abbe
