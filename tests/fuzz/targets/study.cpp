// The state of a study with a right checksum: plan, curve and reference.
#include "checkpoints/study_state.h"
#include "fuzz/target.h"
#include "fuzz/targets/reading.h"
#include "math/byte_hash.h"

#include <cstring>
#include <filesystem>
#include <fstream>
#include <unistd.h>

using namespace abbe;

namespace {

namespace fs = std::filesystem;

// The content between its size and its checksum.
std::string whole(const std::string& content) {
    std::string bytes = "ABBESTDY";
    const auto put = [&](auto v) { bytes.append(reinterpret_cast<const char*>(&v), sizeof v); };
    put(std::uint32_t{2});
    put(static_cast<std::uint64_t>(content.size()));
    bytes += content;
    put(hashOf(std::as_bytes(std::span(content))));
    return bytes;
}

struct StateFolder {
    fs::path path = fs::temp_directory_path() / ("abbe-fuzz-study-" + std::to_string(::getpid()));
    StateFolder() { fs::create_directories(path); }
    ~StateFolder() {
        std::error_code error;
        fs::remove_all(path, error);
    }
};

const fs::path& folderOfState() {
    static const StateFolder folder;
    return folder.path;
}

void check(const StudyImage& image) {
    fuzz::require(image.rgb.size() ==
                      3 * static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height),
                  "an image of another size");
}

void load(const StudyState& state) {
    const StudyStore store = state.store();
    if (const auto curve = store.loadCurve("x"))
        for (const CurveRung& rung : curve->rungs) {
            check(rung.first);
            check(rung.sum);
        }
}

template <typename F> void reading(const F& read) {
    try {
        fuzz::reading(read);
    } catch (const CheckpointFault&) {
    }
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes = whole(fuzz::bytesOf(data, size));
    for (const char* name : {"plan.abbe", "curve-x.abbe", "reference.abbe"})
        std::ofstream(folderOfState() / name, std::ios::binary) << bytes;
    const StudyState state(folderOfState().string(), {{"seed", "1"}});
    reading([&] { state.resume(); });
    reading([&] { StudyState::fact(folderOfState().string(), "seed"); });
    reading([&] { load(state); });
    reading([&] {
        if (const auto reference = state.store().loadReference()) {
            check(reference->a);
            check(reference->b);
        }
    });
    return 0;
}
