// Scenes of Mitsuba's, and its files of serialized meshes: what is imported prints as a scene, whatever the text was.
#include "exchange/importer/importer.h"
#include "exchange/mitsuba/mitsuba_import.h"
#include "exchange/mitsuba/shapes.h"
#include "fuzz/target.h"
#include "fuzz/targets/reading.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes = fuzz::bytesOf(data, size);
    const fuzz::MemoryFile file(bytes);
    fuzz::reading([&] {
        SourceMap sources;
        Diagnostics diagnostics;
        // Side files go nowhere: a changed scene may name a mesh that is there.
        exchange::SideFiles files("/nowhere/fuzz.scene");
        exchange::Import import{sources, diagnostics, files, {}};
        exchange::importMitsuba(file.path(), import);
        exchange::printScene(import.nodes);
        for (const Diagnostic& d : diagnostics.all())
            if (d.span.valid())
                fuzz::require(d.span.end <= sources.text(d.span.file).size(), "a place behind the text");
    });
    fuzz::reading([&] {
        const MeshData mesh = exchange::readSerializedMesh(file.path(), 0);
        for (const auto& face : mesh.triangles)
            for (const std::uint32_t i : face) fuzz::require(i < mesh.positions.size(), "a face without its vertex");
    });
    return 0;
}
