// OpenVDB files through the helper: whatever becomes of that process, this one gets grids or a fault.
#include "fuzz/target.h"
#include "volumes/vdb_file.h"

#include <array>
#include <new>

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const fuzz::MemoryFile file(fuzz::bytesOf(data, size));
    try {
        const auto facts = inspectVdb(file.path());
        const std::array<VdbRequest, 2> wanted{
            {{"density", VdbUse::amountOrLevelSet, false}, {"velocity", VdbUse::vector, true}}};
        const auto grids = readVdb(file.path(), wanted);
        if (const auto* fault = std::get_if<VdbFault>(&grids)) {
            fuzz::require(!fault->text.empty(), "a fault without a word");
            fuzz::require(fault->kind != VdbFault::Kind::helper, "the helper is not there");
        } else {
            fuzz::require(std::get<0>(grids).size() == wanted.size(), "other grids than were asked for");
        }
    } catch (const std::bad_alloc&) {
    }
    return 0;
}
