// pbrt scenes: whatever is in the text, the import ends, and without errors it makes a scene file that can be read.
#include "exchange/pbrt/pbrt_import.h"
#include "fuzz/targets/importing.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    fuzz::importingMakesAScene(exchange::importPbrt, data, size);
    return 0;
}
