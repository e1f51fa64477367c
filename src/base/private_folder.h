// Folders in a cache that only this user may read or change, each with a lock beside it by which other processes know
// that it is in use.
#pragma once

#include <filesystem>

namespace abbe {

// Makes the folder, with those above it, if need be. 0 if it is there then, a folder of this user's that no other may
// read or change; else errno.
int makePrivateFolder(const std::filesystem::path&);

// Keeps a folder from removal for as long as it lives. The lock is the file `FOLDER.lock`, whose time says when the
// folder was used last. Where locks cannot be had there is none, and then nothing is ever removed.
class FolderUse {
  public:
    explicit FolderUse(const std::filesystem::path& folder);
    ~FolderUse();
    FolderUse(const FolderUse&) = delete;
    FolderUse& operator=(const FolderUse&) = delete;

  private:
    int lock_ = -1; // shared, against removal
};

// Removes the folders in `cache` that no process uses and that were not used for so many seconds.
void removeUnusedFolders(const std::filesystem::path& cache, double seconds);

} // namespace abbe
