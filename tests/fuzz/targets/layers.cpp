// Scenes over other scenes: the bytes are a scene beside files that it may include, a third of the lines is chosen as
// on a command line. Whatever is in them, reading ends, and faults stand in the texts that were read.
#include "base/diagnostic_format.h"
#include "fuzz/target.h"
#include "parser/layer_files.h"
#include "scene/build.h"
#include "scene/registry.h"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <new>
#include <unistd.h>

using namespace abbe;

namespace {

namespace fs = std::filesystem;

// a.scene and b.scene with a little of everything; c.scene includes itself by two ways, and d.scene is a bomb.
class Folder {
  public:
    Folder() {
        fs::create_directories(path);
        const auto write = [&](const char* name, const char* text) { std::ofstream(path / name) << text; };
        write("a.scene",
              "scene 1 length=cm\nparam r 2\ncamera main { fov 40 }\nmaterial m diffuse { reflectance 0.5 }\n"
              "group g { shape s sphere { radius \"$r * 2\"; material m } }\nlight sky { luminance 100 nits }\n"
              "variant v { override shape s { radius 3 }; remove light sky }\n");
        write("b.scene", "scene 1\ninclude \"a.scene\" as=x { param r 3 }\nobject o { shape t sphere }\ninstance o\n");
        write("c.scene", "scene 1\ninclude \"c.scene\"\ninclude \"d.scene\" as=l\n");
        write("d.scene", "scene 1\ninclude \"b.scene\" as=l\ninclude \"b.scene\" as=r\ninclude \"c.scene\" as=c\n");
    }
    ~Folder() {
        std::error_code error;
        fs::remove_all(path, error);
    }
    fs::path path = fs::temp_directory_path() / ("abbe-fuzz-layers-" + std::to_string(::getpid()));
};

// Lines that begin so are for the command line, and comments of the scene.
LayerOptions choicesOf(const std::string& text, SourceMap& sources, Diagnostics& diagnostics) {
    LayerOptions options;
    std::size_t begin = 0;
    while (begin < text.size()) {
        const std::size_t end = std::min(text.find('\n', begin), text.size());
        const std::string line = text.substr(begin, end - begin);
        if (line.starts_with("//set ")) options.sets.push_back(line.substr(6));
        if (line.starts_with("//variant ")) options.variants.push_back(line.substr(10));
        if (line.starts_with("//define "))
            if (auto define = readOverride(sources, line.substr(9), diagnostics))
                options.defines.push_back(std::move(*define));
        begin = end + 1;
    }
    return options;
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const schema::TypeTable types = makeTypeTable();
    static const Folder folder;
    SourceMap sources;
    Diagnostics diagnostics;
    const std::string text = fuzz::bytesOf(data, size);
    const FileId file = sources.add("fuzz.scene", text);
    const LayerOptions options = choicesOf(text, sources, diagnostics);
    const auto files = readLayerFiles(sources, file, folder.path / "fuzz.scene", options, diagnostics);
    const schema::SceneTree tree = schema::resolve(files, types, diagnostics);
    BuildOptions build;
    build.geometry = false;
    try {
        buildScene(tree, types, build, diagnostics);
    } catch (const std::bad_alloc&) {
    }
    for (const Diagnostic& d : diagnostics.all())
        fuzz::require(!d.span.valid() || (d.span.begin <= d.span.end && d.span.end <= sources.text(d.span.file).size()),
                      "a place outside of the text");
    formatHuman(diagnostics, sources);
    formatJson(diagnostics, sources);
    return 0;
}
