// OpenEXR through all ways that the program reads it: header, channels, picture, deep samples, a copy with more
// channels.
#include "fuzz/target.h"
#include "fuzz/targets/reading.h"
#include "io/aces_container.h"
#include "io/exr_deep.h"
#include "io/exr_reader.h"
#include "io/exr_writer.h"

#include <cstdlib>
#include <filesystem>
#include <numeric>
#include <unistd.h>

using namespace abbe;

namespace {

std::string targetPath() {
    static const std::string path =
        (std::filesystem::temp_directory_path() / ("abbe-fuzz-exr-" + std::to_string(::getpid()) + ".exr")).string();
    return path;
}

void append(const std::string& from) {
    const ExrInfo info = readExrInfo(from);
    const std::vector<float> more(info.window.area(), 0.5f);
    const ExrChannel channel{"more", more};
    appendExr(from, targetPath(), {&channel, 1}, {});
    fuzz::require(readExrInfo(targetPath()).has("more"), "a channel that was added is not there");
    std::filesystem::remove(targetPath());
}

} // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    const std::string bytes = fuzz::bytesOf(data, size);
    checkAcesContainer(bytes);
    const fuzz::MemoryFile file(bytes);
    fuzz::reading([&] { readExrInfo(file.path()); });
    fuzz::reading([&] {
        const ExrPlanes planes = readExrChannels(file.path());
        for (const auto& values : planes.values)
            fuzz::require(values.size() == planes.info.window.area(), "a channel of another size");
    });
    fuzz::reading([&] { readExr(file.path()); });
    fuzz::reading([&] {
        const DeepPicture deep = readDeepExr(file.path());
        const auto total = std::accumulate(deep.counts.begin(), deep.counts.end(), std::size_t{0});
        for (const auto* plane : {&deep.z, &deep.zBack, &deep.a, &deep.r, &deep.g, &deep.b})
            fuzz::require(plane->size() == total, "deep samples of another number");
        flatten(deep);
    });
    fuzz::reading([&] { append(file.path()); });
    return 0;
}
