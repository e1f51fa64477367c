// What files may name which others (docs/language/files.md). Two rules: what a scene names lies in its project or in a
// folder that its user stated; what is in an enclosed folder came from somebody else, as the files of a pack do, and
// names what is in that folder.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace abbe {

// From now on files in this folder may name only files in this folder. May be called from any thread.
void encloseFolder(const std::filesystem::path& folder);

// The folders that $ABBE_PATH lists, with `:` between them; in these all scenes may read.
std::vector<std::filesystem::path> foldersOfEnvironment();

// The nearest folder, from this one upward, that holds a file `.abbe-project`; this one if none does.
std::filesystem::path projectOf(const std::filesystem::path& folder);

// For as long as it lives, files in the project of `folder` may name what is in that project and below `search`, and
// so may files below `search`. Where several such places are around a file, the deepest counts. Any thread.
class FileReach {
  public:
    FileReach(const std::filesystem::path& folder, const std::vector<std::string>& search);
    ~FileReach();
    FileReach(const FileReach&) = delete;
    FileReach& operator=(const FileReach&) = delete;

  private:
    std::uint64_t number_;
};

// Where files are looked for that are not beside the file at `from`, a file or a folder, that names them: the folders
// that were stated for it, then those of $ABBE_PATH.
std::vector<std::filesystem::path> searchFolders(const std::filesystem::path& from);

// Whether what stands at `from`, a file or a folder, may name the file `named`. In an enclosed folder names alone are
// looked at, since it has no links; elsewhere the places where links lead.
enum class NameFault : std::uint8_t { none, outsideEnclosure, outsideReach };
NameFault nameFault(const std::filesystem::path& from, const std::filesystem::path& named);
bool mayName(const std::filesystem::path& from, const std::filesystem::path& named);
// What to do about a file that is outside of the reach, for diagnostics.
std::string helpOutsideReach(const std::filesystem::path& named);

// Whether a path without `.` and `..` that begins at a folder stays below it; nothing of it is looked up.
bool isBelow(const std::filesystem::path& path, const std::filesystem::path& folder);

} // namespace abbe
