// The meaning of scenes: what `abbe check` does, from text to everything but the acceleration structure.
#include "base/diagnostic_format.h"
#include "fuzz/target.h"
#include "parser/parse.h"
#include "scene/build.h"
#include "scene/registry.h"
#include "schema/scene_tree.h"

#include <new>

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    static const schema::TypeTable types = makeTypeTable();
    SourceMap sources;
    Diagnostics diagnostics;
    const FileId file = sources.add("fuzz.scene", fuzz::bytesOf(data, size));
    const auto document = parse(sources, file, {}, diagnostics);
    const schema::SceneTree tree = schema::resolve(document, types, "/nowhere", diagnostics);
    BuildOptions options;
    options.geometry = false;
    try {
        buildScene(tree, types, options, diagnostics);
    } catch (const std::bad_alloc&) {
    }
    formatHuman(diagnostics, sources);
    return 0;
}
