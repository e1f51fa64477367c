// Files beside an open text: those that it includes, as editors hold them or as they are on the disk, and those that
// include it.
#pragma once

#include "base/diagnostic.h"
#include "base/file.h"
#include "base/source.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::lsp {

class OpenText;

// The same for all ways to one file.
std::filesystem::path realPathOf(const std::filesystem::path&);

class Workspace {
  public:
    // A state of a file: equal ones have the same text.
    struct Stamp {
        const OpenText* open = nullptr; // or null: on the disk
        std::int64_t version = 0;       // of an open text
        FileIdentity identity;          // of one on the disk

        bool operator==(const Stamp&) const = default;
    };

    // Texts that are open, by their real paths.
    void open(const OpenText&);
    void close(const OpenText&);
    const OpenText* find(const std::filesystem::path&) const;

    Stamp stampOf(const std::filesystem::path&) const;
    // As LayerOptions::read has it. Files that did not change are not read again.
    std::optional<FileId> read(SourceMap&, const std::filesystem::path&, Diagnostics&) const;
    // Nothing for a file that cannot be read.
    std::optional<std::string> textOf(const std::filesystem::path&) const;

    // Scenes that include one of these files, by whatever steps: of the open texts and of the folders that the editor
    // has open, or, without any, of the folders of the files. At most kMostScenes are looked at.
    std::vector<std::filesystem::path> scenesIncluding(const std::set<std::filesystem::path>&) const;

    std::vector<std::filesystem::path> folders; // that the editor has open
    bool documentChanges = false;               // the editor takes edits of files together with their versions

  private:
    struct Kept {
        FileIdentity identity;
        std::string text;
    };
    static constexpr std::size_t kMostScenes = 5000;
    static constexpr std::size_t kMostKept = std::size_t{256} << 20; // bytes
    std::set<std::filesystem::path> scenes(const std::set<std::filesystem::path>& files) const;
    std::vector<std::filesystem::path> includesOf(const std::filesystem::path&) const;

    std::map<std::filesystem::path, const OpenText*> open_;
    mutable std::map<std::filesystem::path, Kept> kept_;
    mutable std::size_t keptBytes_ = 0;
};

} // namespace abbe::lsp
