// glTF scenes: whatever is in the file, the import ends, and without errors it makes a scene file that can be read.
#include "exchange/gltf/gltf_import.h"

#include "base/diagnostic_format.h"
#include "fuzz/target.h"
#include "fuzz/targets/reading.h"
#include "parser/parse.h"

#include <cstdlib>
#include <filesystem>

using namespace abbe;

namespace {

// Where side files go; every input writes the same names again.
struct SideFolder {
    std::string path = (std::filesystem::temp_directory_path() / "abbe-fuzz-gltf-XXXXXX").string();
    SideFolder() { fuzz::require(::mkdtemp(path.data()), "no temporary folder"); }
    ~SideFolder() {
        std::error_code error;
        std::filesystem::remove_all(path, error);
    }
};

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const SideFolder folder;
    const fuzz::MemoryFile file(fuzz::bytesOf(data, size));
    fuzz::reading([&] {
        SourceMap sources;
        Diagnostics diagnostics;
        exchange::SideFiles files(std::filesystem::path(folder.path) / "fuzz.scene");
        exchange::Import import{sources, diagnostics, files, {}};
        exchange::importGltf(file.path(), import);
        formatHuman(diagnostics, sources);
        if (diagnostics.hasErrors()) return;
        Diagnostics second;
        const FileId again = sources.add("fuzz.scene", "scene 1\n" + exchange::printScene(import.nodes));
        parse(sources, again, {}, second);
        fuzz::require(!second.hasErrors(), "the scene that was made cannot be read");
    });
    return 0;
}
