// Scenes of Mitsuba's, and its files of serialized meshes: what is imported prints as a scene, whatever the text was.
#include "exchange/importer/importer.h"
#include "exchange/mitsuba/mitsuba_import.h"
#include "exchange/mitsuba/shapes.h"
#include "fuzz/targets/importing.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes = fuzz::bytesOf(data, size);
    const fuzz::MemoryFile file(bytes);
    fuzz::importingPrints([&](exchange::Import& import) { exchange::importMitsuba(file.path(), import); });
    fuzz::reading([&] {
        const MeshData mesh = exchange::readSerializedMesh(file.path(), 0);
        for (const auto& face : mesh.triangles)
            for (const std::uint32_t i : face) fuzz::require(i < mesh.positions.size(), "a face without its vertex");
    });
    return 0;
}
