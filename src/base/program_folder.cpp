#include "base/program_folder.h"

#include <system_error>
#include <utility>

namespace abbe {

namespace {

std::filesystem::path& folderThatWasSet() {
    static std::filesystem::path folder;
    return folder;
}

} // namespace

std::filesystem::path programFolder() {
    if (!folderThatWasSet().empty()) return folderThatWasSet();
    std::error_code error;
    const auto self = std::filesystem::read_symlink("/proc/self/exe", error);
    return error ? std::filesystem::path() : self.parent_path();
}

void setProgramFolder(std::filesystem::path folder) { folderThatWasSet() = std::move(folder); }

} // namespace abbe
