// Material libraries of OBJ files, and models that name them: what they become prints as a scene, whatever the text
// was.
#include "exchange/obj/mtl.h"

#include "exchange/obj/obj_import.h"
#include "fuzz/target.h"
#include "fuzz/targets/reading.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes = fuzz::bytesOf(data, size);
    const fuzz::MemoryFile file(bytes);
    fuzz::reading([&] {
        SourceMap sources;
        Diagnostics diagnostics;
        exchange::SideFiles files("/nowhere/fuzz.scene");
        exchange::Import import{sources, diagnostics, files, {}};
        exchange::MtlLibrary library;
        exchange::readMtl(file.path(), {}, library, import);
        for (auto& [name, material] : library) {
            // Pictures of the corpus are not there.
            for (const char* map : {"map_kd", "map_ks", "map_ns", "map_bump", "norm", "map_pr"})
                if (size % 7 == 0) material.maps[map].path = "/nowhere/picture.png";
            exchange::SceneNode& shape = import.nodes.emplace_back("shape");
            exchange::writeMtlMaterial(shape.child("material"), material, {size % 3 != 0, 1}, import);
            exchange::writeMtlEmission(shape, material, {}, import);
        }
        exchange::printScene(import.nodes);
        for (const Diagnostic& d : diagnostics.all())
            if (d.span.valid())
                fuzz::require(d.span.end <= sources.text(d.span.file).size(), "a place behind the text");
    });
    fuzz::reading([&] {
        SourceMap sources;
        Diagnostics diagnostics;
        exchange::SideFiles files("/nowhere/fuzz.scene");
        exchange::Import import{sources, diagnostics, files, {}};
        exchange::importObj(file.path(), import);
        exchange::printScene(import.nodes);
        for (const Diagnostic& d : diagnostics.all())
            if (d.span.valid())
                fuzz::require(d.span.end <= sources.text(d.span.file).size(), "a place behind the text");
    });
    return 0;
}
