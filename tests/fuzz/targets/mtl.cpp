// Material libraries of OBJ files, and models that name them: what they become prints as a scene, whatever the text
// was.
#include "exchange/obj/mtl.h"

#include "exchange/obj/obj_import.h"
#include "fuzz/targets/importing.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes = fuzz::bytesOf(data, size);
    const fuzz::MemoryFile file(bytes);
    fuzz::importingPrints([&](exchange::Import& import) {
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
    });
    fuzz::importingPrints([&](exchange::Import& import) { exchange::importObj(file.path(), import); });
    return 0;
}
