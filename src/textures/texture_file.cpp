#include "textures/texture_file.h"

#include "base/memory_limit.h"
#include "base/temporary_file.h"
#include "math/hash.h"
#include "spectrum/upsampling_table.h"
#include "textures/texel_check.h"

#include <array>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <optional>

namespace abbe {

namespace fs = std::filesystem;

namespace {

constexpr std::uint64_t kVersion = 1; // of what a conversion does

std::uint64_t hashOf(const void* data, std::size_t bytes, std::uint64_t seed) {
    const auto* p = static_cast<const unsigned char*>(data);
    std::uint64_t h = combine64(seed, bytes);
    for (; bytes >= 8; p += 8, bytes -= 8) {
        std::uint64_t word;
        std::memcpy(&word, p, 8);
        h = combine64(h, word);
    }
    std::uint64_t rest = 0;
    std::memcpy(&rest, p, bytes);
    return combine64(h, rest);
}

std::uint64_t hashOf(std::string_view text, std::uint64_t seed) { return hashOf(text.data(), text.size(), seed); }

// Of 64 blocks evenly spread over the first `bytes` of a file: finds what is cut off, blanked or written anew without
// reading all of it. Nothing if it cannot be read.
std::optional<std::uint64_t> sampledHash(std::ifstream& file, std::uint64_t bytes) {
    constexpr std::uint64_t kBlocks = 64, kBlock = 4096;
    std::array<char, kBlock> block;
    std::uint64_t h = bytes;
    for (std::uint64_t i = 0; i < kBlocks; ++i) {
        const std::uint64_t last = bytes > kBlock ? bytes - kBlock : 0;
        const std::uint64_t at = bytes <= kBlocks * kBlock ? i * kBlock : last / (kBlocks - 1) * i;
        if (at >= bytes) break;
        const std::uint64_t n = std::min(kBlock, bytes - at);
        file.seekg(static_cast<std::streamoff>(at));
        if (!file.read(block.data(), static_cast<std::streamsize>(n))) return std::nullopt;
        h = hashOf(block.data(), n, h);
    }
    return h;
}

// Stands behind the end of a converted file, where readers of TIFF do not look.
struct Trailer {
    char magic[8] = {'A', 'B', 'B', 'E', 'T', 'E', 'X', '1'};
    std::uint64_t key = 0, bytes = 0, hash = 0; // of what stands before it
    TexelCounts counts;
};

std::optional<TexelCounts> readTrailer(const fs::path& path, std::uint64_t key) {
    std::error_code error;
    const std::uint64_t size = fs::file_size(path, error);
    if (error || size < sizeof(Trailer)) return std::nullopt;
    std::ifstream file(path, std::ios::binary);
    file.seekg(static_cast<std::streamoff>(size - sizeof(Trailer)));
    Trailer t;
    if (!file.read(reinterpret_cast<char*>(&t), sizeof t)) return std::nullopt;
    if (std::memcmp(t.magic, Trailer{}.magic, sizeof t.magic) != 0 || t.key != key || t.bytes != size - sizeof t)
        return std::nullopt;
    if (sampledHash(file, t.bytes) != t.hash) return std::nullopt;
    return t.counts;
}

bool writeTrailer(const fs::path& path, std::uint64_t key, const TexelCounts& counts) {
    std::error_code error;
    Trailer t;
    t.key = key;
    t.bytes = fs::file_size(path, error);
    if (error) return false;
    std::ifstream file(path, std::ios::binary);
    const auto hash = sampledHash(file, t.bytes);
    if (!hash) return false;
    t.hash = *hash;
    t.counts = counts;
    std::ofstream out(path, std::ios::binary | std::ios::app);
    out.write(reinterpret_cast<const char*>(&t), sizeof t);
    out.close();
    return static_cast<bool>(out);
}

// Changes whenever the result of the conversion would.
std::uint64_t keyOf(const fs::path& picture, const ColorEncoding& encoding) {
    std::error_code error;
    std::uint64_t h = hashOf(picture.string(), kVersion);
    h = hashOf(encoding.name, h);
    const std::uint64_t bytes = fs::file_size(picture, error);
    h = combine64(h, static_cast<std::uint64_t>(fs::last_write_time(picture, error).time_since_epoch().count()));
    std::ifstream file(picture, std::ios::binary);
    return combine64(h, sampledHash(file, bytes).value_or(0));
}

// Linear colours of 8 or 16 bits as halves, 11 bits of precision at any brightness; numbers as they are.
AbbeTexelType storedType(const AbbeImageInfo& info, const ColorEncoding& encoding) {
    const auto type = static_cast<AbbeTexelType>(info.type);
    return encoding.space && type != abbeTexelFloat ? abbeTexelHalf : type;
}

std::int32_t checkTexels(void* user, float* values, std::int64_t count) {
    try {
        static_cast<TexelCheck*>(user)->apply(values, static_cast<std::size_t>(count));
        return 1;
    } catch (const std::exception&) { // must not cross the interface
        return 0;
    }
}

struct Converted {
    TexelCounts counts;
    std::string problem; // with the cache, or empty
};

// Into a file beside the final one, which no reader ever sees half written.
Converted convert(const std::string& picture, const AbbeImageInfo& info, const ColorEncoding& encoding,
                  const fs::path& file, std::uint64_t key, const UpsamplingTable* upsampling) {
    std::error_code error;
    fs::create_directories(file.parent_path(), error);
    TemporaryFile part(file.string());
    if (part.error() != 0)
        return {{}, fmt::format("the folder `{}` cannot be written to", file.parent_path().string())};
    TexelCheck check(info, encoding, upsampling);
    const AbbeConversion asked{info.channels, storedType(info, encoding), memoryLeft(), &check, checkTexels};
    AbbeImageFault fault{};
    const bool good = imageModule().convert(picture.c_str(), part.path().c_str(), &asked, &fault);
    Converted result{check.counts(), {}};
    int problem = 0;
    if (good && check.notFinite() == 0 && writeTrailer(part.path(), key, result.counts)) {
        problem = part.commit();
        if (problem == 0) return result;
    }
    if (check.notFinite() > 0) throw NotFiniteError(check.notFinite());
    if (!good && fault.kind == abbeFaultOfMemory) throw BeyondMemory(std::string(fault.reason));
    if (!good && fault.kind == abbeFaultOfSource) throw ImageFileError(fault.reason);
    result.problem = !good ? fault.reason : problem != 0 ? std::strerror(problem) : "the folder cannot be written to";
    return result;
}

} // namespace

NotFiniteError::NotFiniteError(std::uint64_t values)
    : ImageFileError(fmt::format("{} values are infinite or not a number", values)), count(values) {}

TextureFile textureFile(const std::string& picture, const AbbeImageInfo& info, const ColorEncoding& encoding,
                        const fs::path& directory, const UpsamplingTable* upsampling) {
    if (info.isTexture && encoding.curve == TransferCurve::linear) return {picture, {}, false, {}};
    if (directory.empty()) return {picture, {}, true, "there is no folder for it: HOME and XDG_CACHE_HOME are not set"};
    std::error_code error;
    fs::path real = fs::canonical(picture, error);
    if (error) real = picture;
    const std::uint64_t key = keyOf(real, encoding);
    const fs::path file = directory / fmt::format("{}-{:016x}.tif", real.stem().string().substr(0, 200), key);
    if (const auto counts = readTrailer(file, key)) return {file.string(), *counts, false, {}};
    Converted made = convert(real.string(), info, encoding, file, key, upsampling);
    if (made.problem.empty()) return {file.string(), made.counts, false, {}};
    return {picture, made.counts, true, std::move(made.problem)};
}

void forgetTextureFile(const std::string& path, const fs::path& directory) {
    std::error_code error;
    if (!directory.empty() && fs::path(path).parent_path() == directory) fs::remove(path, error);
}

fs::path textureCacheDirectory() {
    const fs::path cache = UpsamplingTable::cacheDirectory();
    return cache.empty() ? cache : cache / "textures";
}

} // namespace abbe
