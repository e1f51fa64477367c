#include "exchange/pbrt/pbrt_shared.h"

#include "base/enclosure.h"
#include "exchange/shared/inflate.h"
#include "io/file.h"
#include "schema/files.h"

#include <fmt/format.h>

namespace abbe::exchange {

std::filesystem::path PbrtShared::file(std::string_view name) const {
    const std::filesystem::path written(name);
    const std::filesystem::path path = schema::placeOfFile(written, folder);
    if (!mayName(folder, path))
        throw IoError(fmt::format("`{}` is outside of the scene's project; {}", name, helpOutsideReach(path)));
    return path;
}

std::string pbrtReadFile(const std::filesystem::path& path) {
    constexpr std::uint64_t kMost = std::uint64_t(1) << 32;
    std::string bytes = readFileBytes(path.string());
    if (bytes.size() <= 2 || bytes[0] != '\x1f' || bytes[1] != '\x8b') return bytes;
    Inflated unpacked = inflated(bytes, Packing::gzip, kMost);
    if (unpacked.end == Inflated::End::tooLarge)
        throw IoError(fmt::format("`{}` is larger than 4 GiB when unpacked", path.string()));
    if (unpacked.end == Inflated::End::damaged)
        throw IoError(fmt::format("`{}` is no intact gzip file", path.string()));
    return std::move(unpacked.bytes);
}

} // namespace abbe::exchange
