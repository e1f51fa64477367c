// Packs that are read: unpacked once, checked, and kept in the user's cache for the next render of the same pack.
#pragma once

#include "packs/manifest.h"

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace abbe {

class FolderUse;
class ZipReader;

// Whether a file is a pack: a regular file that begins as ZIP files do, which no scene does.
bool isPack(const std::string& path);

// The scene of a pack on disk, for as long as the object lives.
// Its files are in a private folder (mode 0700) below the folder `cache`, named after the contents: packs with the same
// files share it, and another process that reads them at the same time does, too. Files that are there already with
// the right size and time are not unpacked again. What no process has used for a day is removed by the next one that
// unpacks something; where room is short, all that is not in use. Nothing is ever written elsewhere.
class UnpackedPack {
  public:
    // `cache` empty: packCacheDirectory(). Throws PackFault for what is wrong with the pack, IoError if it cannot be
    // unpacked.
    explicit UnpackedPack(const std::string& path, std::filesystem::path cache = {});
    ~UnpackedPack();
    UnpackedPack(const UnpackedPack&) = delete;
    UnpackedPack& operator=(const UnpackedPack&) = delete;

    const PackManifest& manifest() const { return manifest_; }
    const std::filesystem::path& folder() const { return folder_; }
    std::filesystem::path scenePath() const { return folder_ / manifest_.scene; }

  private:
    std::vector<const PackedFile*> missing() const;
    void unpack(const ZipReader&, const std::string& pack, const std::filesystem::path& cache) const;

    PackManifest manifest_;
    std::filesystem::path folder_;
    std::unique_ptr<const FolderUse> use_;
};

// $XDG_CACHE_HOME/abbe/packs, else ~/.cache/abbe/packs; without either a folder of this user's in that of temporary
// files.
std::filesystem::path packCacheDirectory();

} // namespace abbe
