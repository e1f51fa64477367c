// Folders that nothing in them may point out of: what is in them came from somebody else, as the files of a pack do.
#pragma once

#include <cstdint>
#include <filesystem>

namespace abbe {

// From now on files in this folder may name only files in this folder. May be called from any thread.
void encloseFolder(const std::filesystem::path& folder);

// Whether what stands at `from`, a file or a folder, may name the file `named`.
// In an enclosed folder: what is in it, by names alone, since it has no links. Elsewhere anything or, where $ABBE_ROOT
// lists folders with `:` between them, what is below one of them or below the folder of `from`, by the places where
// links lead.
enum class NameFault : std::uint8_t { none, outsideEnclosure, outsideRoots };
NameFault nameFault(const std::filesystem::path& from, const std::filesystem::path& named);
bool mayName(const std::filesystem::path& from, const std::filesystem::path& named);

// The value of $ABBE_ROOT; null if it is not set, or empty.
const char* rootFolders();

// Whether a path without `.` and `..` that begins at a folder stays below it; nothing of it is looked up.
bool isBelow(const std::filesystem::path& path, const std::filesystem::path& folder);

} // namespace abbe
