// glTF scenes: whatever is in the file, the import ends, and without errors it makes a scene file that can be read.
#include "exchange/gltf/gltf_import.h"

#include "fuzz/targets/importing.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::importingMakesAScene(exchange::importGltf, data, size);
    return 0;
}
