// Files of named arrays.
#include "fuzz/target.h"
#include "io/file.h"
#include "io/tensor_file.h"

using namespace abbe;

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    try {
        const TensorFile file(std::string(fuzz::bytesOf(data, size)), "fuzz.bsdf");
        for (const char* name : {"theta_i", "spectra", "description"}) {
            const Tensor& t = file[name];
            fuzz::require(t.bytes.size() <= size, "an array larger than its file");
            if (t.type == TensorType::real) fuzz::require(t.numbers().size() == t.size(), "numbers of another count");
        }
    } catch (const IoError&) {
    }
    return 0;
}
