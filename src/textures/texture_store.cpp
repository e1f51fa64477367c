#include "textures/texture_store.h"

#include "base/file.h"
#include "base/memory_limit.h"
#include "base/parallel.h"
#include "math/hash.h"
#include "spectrum/color_space.h"
#include "spectrum/rgb_upsampling.h"
#include "spectrum/upsampling_table.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <optional>

namespace abbe {

namespace {

// Texels on their way from a picture into a texture: decoded, checked and counted.
class TexelCheck {
  public:
    // `upsampling` may be null: colours are then not compared with their reflectances.
    TexelCheck(const AbbeImageInfo&, const ColorEncoding&, const UpsamplingTable* upsampling);

    // Stored values become linear ones, in place; colours lose what is negative.
    void apply(float* values, std::size_t texels);

    const TexelCounts& counts() const { return counts_; }
    std::uint64_t notFinite() const { return notFinite_; }

  private:
    void decode(float* values, std::size_t count) const;
    void count(float* texel);
    bool impossible(const float* texel) const;

    const ColorEncoding& encoding_;
    const UpsamplingTable* upsampling_;
    std::optional<ReflectanceFitter> fitter_;
    std::size_t channels_;
    std::uint64_t stride_;       // every so manieth colour is compared
    std::vector<float> decoded_; // of every stored integer; empty for floats
    TexelCounts counts_;
    std::uint64_t notFinite_ = 0;
};

constexpr std::uint64_t kCompared = 4096; // colours of a picture
constexpr double kVisible = 0.02;         // deviation of a channel

TexelCheck::TexelCheck(const AbbeImageInfo& info, const ColorEncoding& encoding, const UpsamplingTable* upsampling)
    : encoding_(encoding), upsampling_(upsampling), channels_(static_cast<std::size_t>(info.channels)) {
    const std::uint64_t texels = static_cast<std::uint64_t>(info.width) * static_cast<std::uint64_t>(info.height);
    stride_ = std::max<std::uint64_t>(1, texels / kCompared);
    if (encoding.space && upsampling && channels_ == 3) fitter_.emplace(*encoding.space, 5);
    const bool integers = info.type == abbeTexel8 || info.type == abbeTexel16;
    if (!integers || encoding.curve == TransferCurve::linear) return;
    const int largest = info.type == abbeTexel8 ? 255 : 65535;
    for (int i = 0; i <= largest; ++i)
        decoded_.push_back(static_cast<float>(encoding.toLinear(static_cast<double>(i) / largest)));
}

void TexelCheck::decode(float* values, std::size_t count) const {
    if (encoding_.curve == TransferCurve::linear) return;
    if (!decoded_.empty()) {
        const auto largest = static_cast<float>(decoded_.size() - 1);
        for (std::size_t i = 0; i < count; ++i)
            values[i] = decoded_[static_cast<std::size_t>(std::clamp(values[i], 0.f, 1.f) * largest + 0.5f)];
        return;
    }
    constexpr std::size_t kPiece = 16384;
    parallelFor((count + kPiece - 1) / kPiece, [&](std::size_t piece) {
        for (std::size_t i = piece * kPiece; i < std::min(count, (piece + 1) * kPiece); ++i)
            values[i] = static_cast<float>(encoding_.toLinear(static_cast<double>(values[i])));
    });
}

bool TexelCheck::impossible(const float* texel) const {
    const SigmoidCoefficients c = upsampling_->lookup({texel[0], texel[1], texel[2]});
    if (!std::isfinite(c.c2)) return false; // white or black
    const Vec3d made = fitter_->rgb({static_cast<double>(c.c0), static_cast<double>(c.c1), static_cast<double>(c.c2)});
    const Vec3d wanted(static_cast<double>(texel[0]), static_cast<double>(texel[1]), static_cast<double>(texel[2]));
    return maxComponent(abs(made - wanted)) > kVisible;
}

void TexelCheck::count(float* texel) {
    const auto [least, most] = std::minmax_element(texel, texel + channels_);
    const bool negative = *least<0, above = *most> 1;
    counts_.negative += negative;
    counts_.above += above;
    if (negative)
        for (std::size_t c = 0; c < channels_; ++c) texel[c] = std::max(0.f, texel[c]);
    if (fitter_ && !negative && !above && counts_.texels % stride_ == 0) {
        ++counts_.sampled;
        counts_.impossible += impossible(texel);
    }
}

void TexelCheck::apply(float* values, std::size_t texels) {
    const std::size_t count = texels * channels_;
    std::uint64_t bad = 0;
    for (std::size_t i = 0; i < count; ++i) bad += !std::isfinite(values[i]);
    notFinite_ += bad;
    if (bad > 0) return; // no texture comes of it
    decode(values, count);
    if (!encoding_.space) {
        counts_.texels += texels;
        return;
    }
    for (std::size_t i = 0; i < texels; ++i, ++counts_.texels) this->count(values + i * channels_);
}

} // namespace

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
std::uint64_t keyOf(const fs::path& picture, const ColorEncoding& encoding, std::int32_t first) {
    std::error_code error;
    std::uint64_t h = hashOf(picture.string(), kVersion);
    h = hashOf(encoding.name, h);
    if (first != 0) h = combine64(h, static_cast<std::uint64_t>(first));
    const std::uint64_t bytes = fs::file_size(picture, error);
    h = combine64(h, static_cast<std::uint64_t>(fs::last_write_time(picture, error).time_since_epoch().count()));
    std::ifstream file(picture, std::ios::binary);
    return combine64(h, sampledHash(file, bytes).value_or(0));
}

// The same of a picture in memory, by all of its content: it has no time at which it was written.
std::uint64_t keyOf(const AbbePixels& picture, const ColorEncoding& encoding, std::int32_t first) {
    std::uint64_t h = hashOf(encoding.name, kVersion);
    for (const std::int32_t n : {first, picture.width, picture.height, picture.channels, picture.type})
        h = combine64(h, static_cast<std::uint64_t>(n));
    const auto values = static_cast<std::size_t>(picture.width) * static_cast<std::size_t>(picture.height) *
                        static_cast<std::size_t>(picture.channels);
    return hashOf(picture.values, values * (picture.type == abbeTexel8 ? 1 : sizeof(float)), h);
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
    const auto pixels = pixelsInMemory(picture);
    const AbbeConversion asked{info.first, info.channels, storedType(info, encoding),        memoryLeft(),
                               &check,     checkTexels,   pixels ? &pixels->pixels : nullptr};
    AbbeImageFault fault{};
    const bool good = imageModule().convert(picture.c_str(), part.path().c_str(), &asked, &fault);
    Converted result{check.counts(), {}};
    int problem = 0;
    if (good && check.notFinite() == 0 && writeTrailer(part.path(), key, result.counts)) {
        problem = part.commit();
        if (problem == 0) return result;
    }
    if (check.notFinite() > 0) throw NotFiniteError(check.notFinite());
    if (!good && fault.kind == abbeFaultOfMemory) throw MemoryLimitExceeded(std::string(fault.reason));
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
    const auto pixels = pixelsInMemory(picture);
    if (pixels && directory.empty())
        throw ImageFileError("a texture out of an array needs a folder, and HOME and XDG_CACHE_HOME are not set");
    if (directory.empty()) return {picture, {}, true, "there is no folder for it: HOME and XDG_CACHE_HOME are not set"};
    std::error_code error;
    fs::path real = fs::canonical(picture, error);
    if (error) real = picture;
    const std::uint64_t key = pixels ? keyOf(pixels->pixels, encoding, info.first) : keyOf(real, encoding, info.first);
    const fs::path file = directory / fmt::format("{}-{:016x}.tif", real.stem().string().substr(0, 200), key);
    if (const auto counts = readTrailer(file, key)) return {file.string(), *counts, false, {}};
    Converted made = convert(real.string(), info, encoding, file, key, upsampling);
    if (made.problem.empty()) return {file.string(), made.counts, false, {}};
    if (pixels) throw ImageFileError(made.problem);
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

TextureStore::TextureStore(TextureStoreSettings settings) : settings_(std::move(settings)) {}

TextureStore::~TextureStore() {
    if (system_) module_->closeSystem(system_);
}

const UpsamplingTable& TextureStore::upsampling(const RgbSpace& space) {
    auto& table = tables_[space.name];
    if (!table) table = std::make_unique<const UpsamplingTable>(UpsamplingTable::loadOrBuild(space, settings_.tables));
    return *table;
}

TextureFile TextureStore::file(const std::string& picture, const AbbeImageInfo& info, const ColorEncoding& encoding,
                               const UpsamplingTable* upsampling) {
    const FileIdentity now = identityOf(picture);
    Known& known = files_[{picture, encoding.name, info.first}];
    std::error_code error;
    if (!known.file.path.empty() && known.picture == now && fs::exists(known.file.path, error)) return known.file;
    known = {};
    TextureFile made = textureFile(picture, info, encoding, settings_.directory, upsampling);
    known = {now, made};
    return made;
}

bool TextureStore::isCurrent() const {
    if (damaged_.load(std::memory_order_relaxed)) return false;
    return std::ranges::all_of(textures_, [](const auto& one) { return identityOf(one.first) == one.second; });
}

void* TextureStore::open(const std::string& path) {
    const auto [known, isNew] = textures_.try_emplace(path);
    ++(isNew ? opened_.anew : opened_.again);
    if (isNew) known->second = identityOf(path);
    AbbeImageFault fault{};
    if (!system_) {
        module_ = &imageModule();
        system_ = module_->openSystem(settings_.bytes, &fault);
        if (!system_) throw ImageFileError(fault.reason);
    }
    void* const texture = module_->openTexture(system_, path.c_str(), &fault);
    if (!texture) throw ImageFileError(fault.reason);
    return texture;
}

std::string TextureStore::lookupFault() const {
    AbbeImageFault fault{};
    module_->lookupFault(system_, &fault);
    return fault.reason;
}

AbbeTextureStatistics TextureStore::statistics() const {
    AbbeTextureStatistics result{};
    if (system_) module_->statistics(system_, &result);
    return result;
}

} // namespace abbe
