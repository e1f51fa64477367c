// Wavefront OBJ, as mesh and as cage.
#include "fuzz/targets/mesh_checks.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string text = fuzz::bytesOf(data, size);
    fuzz::reading([&] { fuzz::checkMesh(parseObj(text, "fuzz.obj")); });
    fuzz::reading([&] { fuzz::checkCage(parseObjCage(text, "fuzz.obj")); });
    return 0;
}
