// Folders that nothing in them may point out of: what is in them came from somebody else, as the files of a pack do.
#pragma once

#include <filesystem>

namespace abbe {

// From now on files in this folder may name only files in this folder. May be called from any thread.
void encloseFolder(const std::filesystem::path& folder);

// Whether what stands at `from`, a file or a folder, may name the file `named`. By names alone: an enclosed folder has
// no links. True unless `from` is in an enclosed folder and `named` is not.
bool mayName(const std::filesystem::path& from, const std::filesystem::path& named);

// Whether a path without `.` and `..` that begins at a folder stays below it; nothing of it is looked up.
bool isBelow(const std::filesystem::path& path, const std::filesystem::path& folder);

} // namespace abbe
