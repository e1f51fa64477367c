// Tables of spectra and phase functions.
#include "fuzz/target.h"
#include "schema/files.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const fuzz::MemoryFile file(fuzz::bytesOf(data, size));
    const schema::SpectrumFile read = schema::readSpectrumFile(file.path());
    fuzz::require(!read.error.empty() || read.numbers.size() == 2 * read.lines.size(), "numbers of other lines");
    return 0;
}
