// What every importer of foreign scenes must keep to, whatever is in the file.
#pragma once

#include "base/diagnostic_format.h"
#include "exchange/shared/import.h"
#include "fuzz/target.h"
#include "fuzz/targets/reading.h"
#include "parser/parse.h"

#include <cstdlib>
#include <filesystem>
#include <string>
#include <unistd.h>

namespace abbe::fuzz {

using Importer = void (*)(const std::filesystem::path&, exchange::Import&);

// Where side files go: in memory where the system has such a folder. Every input writes the same names again.
class SideFolder {
  public:
    SideFolder() { require(::mkdtemp(path_.data()), "no temporary folder"); }
    ~SideFolder() {
        std::error_code error;
        std::filesystem::remove_all(path_, error);
    }
    SideFolder(const SideFolder&) = delete;
    SideFolder& operator=(const SideFolder&) = delete;
    const std::string& path() const { return path_; }

  private:
    static std::filesystem::path parent() {
        const char* const memory = "/dev/shm";
        return ::access(memory, W_OK) == 0 ? memory : std::filesystem::temp_directory_path();
    }
    std::string path_ = (parent() / "abbe-fuzz-import-XXXXXX").string();
};

// The import ends, and without errors it makes a scene file that can be read.
inline void importingMakesAScene(Importer read, const std::uint8_t* data, std::size_t size) {
    static const SideFolder folder;
    const MemoryFile file(bytesOf(data, size));
    reading([&] {
        SourceMap sources;
        Diagnostics diagnostics;
        exchange::SideFiles files(std::filesystem::path(folder.path()) / "fuzz.scene");
        exchange::Import import{sources, diagnostics, files, {}};
        read(file.path(), import);
        formatHuman(diagnostics, sources);
        if (diagnostics.hasErrors()) return;
        Diagnostics second;
        const FileId again = sources.add("fuzz.scene", "scene 1\n" + exchange::printScene(import.nodes));
        parse(sources, again, {}, second);
        require(!second.hasErrors(), "the scene that was made cannot be read");
    });
}

// What `read` makes prints as a scene, and its diagnostics have places in the text. Side files go nowhere: a changed
// scene may name a mesh that is there.
template <typename F> void importingPrints(const F& read) {
    reading([&] {
        SourceMap sources;
        Diagnostics diagnostics;
        exchange::SideFiles files("/nowhere/fuzz.scene");
        exchange::Import import{sources, diagnostics, files, {}};
        read(import);
        exchange::printScene(import.nodes);
        for (const Diagnostic& d : diagnostics.all())
            if (d.span.valid()) require(d.span.end <= sources.text(d.span.file).size(), "a place behind the text");
    });
}

} // namespace abbe::fuzz
