// Where the program's own modules and helpers are.
#pragma once

#include <filesystem>

namespace abbe {

// The folder of the running program; of a library inside of another program, the one that was set. Empty if the system
// does not tell.
std::filesystem::path programFolder();

// For such a library, before anything is looked for: its own folder.
void setProgramFolder(std::filesystem::path);

} // namespace abbe
