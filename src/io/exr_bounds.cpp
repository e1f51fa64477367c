#include "base/file.h"
#include "io/exr_reader.h"
#include "io/file.h"
#include "io/image.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <stdexcept>
#include <vector>

namespace abbe {

namespace {

constexpr std::uint32_t kExrMagic = 20000630, kTiledFlag = 0x200, kPartsFlag = 0x1000;
constexpr std::size_t kLongestPartName = 255, kMostChannels = 4096, kMostHeaders = 4096;
constexpr double kLargeTile = 64 << 20; // bytes; larger ones may not be larger than the picture

struct BoundsFault : std::runtime_error {
    using std::runtime_error::runtime_error;
};

// What the size of a part depends on.
struct PartHead {
    std::array<std::int32_t, 4> window{0, 0, -1, -1};
    int compression = 0;
    std::uint32_t tileX = 0, tileY = 0; // 0: it has none
    double pixelBytes = 0;
    std::size_t channels = 0;
    bool deep = false, tiledType = false;
};

// How many bytes a compression [OpenEXR, "Technical Introduction"] makes of one at the most, and how many rows are a
// chunk. 1032 is what deflate does with equal bytes; pxr24 makes four of three of them; dwa spends 4 bytes on 256.
struct CompressionBound {
    double expansion;
    int rows;
};
constexpr std::array<CompressionBound, 10> kBounds{
    {{1, 1}, {64, 1}, {1032, 1}, {1032, 16}, {1032, 32}, {1376, 16}, {11, 32}, {11, 32}, {66048, 32}, {66048, 256}}};

CompressionBound boundOf(int compression) {
    const auto i = static_cast<std::size_t>(compression);
    return i < kBounds.size() ? kBounds[i] : kBounds.back();
}

class HeadReader {
  public:
    explicit HeadReader(RegularFile& file) : file_(file), piece_(1 << 16) {}

    bool isExr() { return left() >= 8 && number<std::uint32_t>() == kExrMagic; }
    // Of all parts; behind the magic number.
    std::vector<PartHead> parts();

  private:
    std::uint64_t left() const { return file_.size() - at_; }
    [[noreturn]] static void damaged(std::string_view what) {
        throw BoundsFault(fmt::format("its header is damaged: {}", what));
    }
    char byte();
    template <typename Number> Number number() {
        std::array<char, sizeof(Number)> bytes{};
        for (char& b : bytes) b = byte();
        return std::bit_cast<Number>(bytes);
    }
    std::string text(std::size_t longest);
    bool attribute(PartHead&);
    void channels(std::uint64_t end, PartHead&);

    RegularFile& file_;
    std::vector<char> piece_;
    std::uint64_t at_ = 0, pieceAt_ = 0;
    std::size_t pieceSize_ = 0;
};

char HeadReader::byte() {
    if (left() == 0) damaged("the file ends in it");
    if (at_ < pieceAt_ || at_ >= pieceAt_ + pieceSize_) {
        pieceAt_ = at_;
        pieceSize_ = file_.readAt(at_, piece_);
        if (pieceSize_ == 0) damaged(file_.good() ? "the file ends in it" : file_.why());
    }
    return piece_[static_cast<std::size_t>(at_++ - pieceAt_)];
}

// Up to a zero.
std::string HeadReader::text(std::size_t longest) {
    std::string name;
    for (char c = byte(); c != '\0'; c = byte()) {
        if (name.size() == longest) damaged("a name has no end");
        name += c;
    }
    return name;
}

void HeadReader::channels(std::uint64_t end, PartHead& part) {
    while (at_ < end) {
        if (text(kLongestPartName).empty()) return;
        const auto type = number<std::int32_t>();
        number<std::uint32_t>(); // how it is seen
        const auto x = number<std::int32_t>(), y = number<std::int32_t>();
        if (type < 0 || type > 2 || x < 1 || y < 1) damaged("a channel of an unknown type or sampling");
        part.pixelBytes += (type == 1 ? 2.0 : 4.0) / x / y;
        ++part.channels;
    }
}

// False at the end of a header.
bool HeadReader::attribute(PartHead& part) {
    const std::string name = text(kLongestPartName);
    if (name.empty()) return false;
    const std::string type = text(kLongestPartName);
    const auto size = number<std::int32_t>();
    if (size < 0 || static_cast<std::uint64_t>(size) > left())
        damaged(fmt::format("an attribute of {} bytes where {} are left", size, left()));
    const std::uint64_t end = at_ + static_cast<std::uint64_t>(size);
    if (name == "dataWindow" && size == 16)
        for (std::int32_t& v : part.window) v = number<std::int32_t>();
    if (name == "compression" && size == 1) part.compression = static_cast<unsigned char>(byte());
    if (name == "tiles" && size == 9) {
        part.tileX = number<std::uint32_t>();
        part.tileY = number<std::uint32_t>();
    }
    if (name == "channels") channels(end, part);
    if (name == "type" && size <= 16) {
        std::string word;
        while (at_ < end) word += byte();
        part.deep = word.starts_with("deep");
        part.tiledType = word.ends_with("tiledimage") || word.ends_with("deeptile");
    }
    at_ = end;
    return true;
}

std::vector<PartHead> HeadReader::parts() {
    const auto flags = number<std::uint32_t>();
    std::vector<PartHead> parts;
    for (;;) {
        PartHead part;
        std::size_t attributes = 0;
        while (attribute(part)) ++attributes;
        if (attributes == 0 && !parts.empty()) return parts;
        if (!part.tiledType && !(flags & kTiledFlag)) part.tileX = part.tileY = 0;
        parts.push_back(part);
        if (!(flags & kPartsFlag)) return parts;
        if (parts.size() > kMostHeaders) throw BoundsFault(fmt::format("it has more than {} parts", kMostHeaders));
    }
}

struct Promised {
    double chunks = 0, expanded = 0; // bytes, of the compressed ones
};

void addPart(const PartHead& part, Promised& sum) {
    const double width = static_cast<double>(part.window[2]) - part.window[0] + 1;
    const double height = static_cast<double>(part.window[3]) - part.window[1] + 1;
    if (width < 1 || height < 1) throw BoundsFault("it has no pixels");
    if (width * height > static_cast<double>(kMaxImagePixels) || width > INT32_MAX || height > INT32_MAX)
        throw BoundsFault(fmt::format("{:.0f} by {:.0f} pixels are too many", width, height));
    const CompressionBound bound = boundOf(part.compression);
    const double pixelBytes = part.deep ? 4 : part.pixelBytes; // of deep ones how many samples they have
    double chunks = std::ceil(height / bound.rows);
    if (part.tileX > 0 && part.tileY > 0) {
        const double tile = static_cast<double>(part.tileX) * part.tileY * pixelBytes;
        if (tile > kLargeTile && (part.tileX > width || part.tileY > height))
            throw BoundsFault(fmt::format("tiles of {} by {} pixels are larger than it", part.tileX, part.tileY));
        chunks = std::ceil(width / part.tileX) * std::ceil(height / part.tileY);
    }
    constexpr double kChunkHead = 16; // its place in the table, its own place and its size
    sum.chunks += chunks * kChunkHead;
    sum.expanded += width * height * pixelBytes / bound.expansion;
}

} // namespace

double exrMostExpansion(int compression) { return boundOf(compression).expansion; }

std::string exrBoundsFault(const std::string& path) {
    RegularFile file(path);
    if (!file.good()) return file.why();
    try {
        HeadReader head(file);
        if (!head.isExr()) return {};
        Promised sum;
        std::size_t channels = 0;
        for (const PartHead& part : head.parts()) {
            addPart(part, sum);
            channels += part.channels;
        }
        if (channels > kMostChannels) return fmt::format("{} channels are too many", channels);
        if (std::max(sum.chunks, sum.expanded) > static_cast<double>(file.size()))
            return fmt::format("it is cut short or damaged: what its header promises cannot be in {} bytes",
                               file.size());
        return {};
    } catch (const BoundsFault& e) {
        return e.what();
    }
}

void checkExrBounds(const std::string& path) {
    if (const std::string fault = exrBoundsFault(path); !fault.empty())
        throw IoError(fmt::format("cannot read `{}`: {}", path, fault));
}

} // namespace abbe
