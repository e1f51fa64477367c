#include "io/aces_container.h"

#include "spectrum/color_space.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>
#include <map>
#include <optional>

namespace abbe {

namespace {

constexpr std::uint32_t kMagic = 20000630, kVersion = 2, kLongNames = 0x400;
constexpr std::size_t kMaxHeader = std::size_t(1) << 20; // bytes, the file's first eight not among them

// Little-endian numbers and strings, one after the other. Past the end everything is zero and `good` is false.
class Cursor {
  public:
    explicit Cursor(std::string_view bytes, std::size_t at = 0) : bytes_(bytes), at_(at) {}

    bool good() const { return good_; }
    std::size_t position() const { return at_; }
    std::string_view take(std::size_t count) {
        if (!good_ || at_ > bytes_.size() || count > bytes_.size() - at_) {
            good_ = false;
            return {};
        }
        const std::string_view piece = bytes_.substr(at_, count);
        at_ += count;
        return piece;
    }
    std::uint64_t number(std::size_t size) {
        std::uint64_t value = 0;
        const std::string_view piece = take(size);
        for (std::size_t i = 0; i < piece.size(); ++i)
            value |= std::uint64_t{static_cast<unsigned char>(piece[i])} << (8 * i);
        return value;
    }
    std::uint8_t u8() { return static_cast<std::uint8_t>(number(1)); }
    std::uint32_t u32() { return static_cast<std::uint32_t>(number(4)); }
    std::int32_t i32() { return std::bit_cast<std::int32_t>(u32()); }
    float f32() { return std::bit_cast<float>(u32()); }
    // Up to a zero, which is left behind.
    std::string text() {
        const std::size_t end = good_ ? bytes_.find('\0', at_) : std::string_view::npos;
        if (end == std::string_view::npos) {
            good_ = false;
            return {};
        }
        const std::string piece(bytes_.substr(at_, end - at_));
        at_ = end + 1;
        return piece;
    }

  private:
    std::string_view bytes_;
    std::size_t at_;
    bool good_ = true;
};

struct Attribute {
    std::string type;
    std::string_view value;
};

struct NamedType {
    std::string_view name, type;
};
constexpr std::array<NamedType, 10> kRequired{{{"acesImageContainerFlag", "int"},
                                               {"channels", "chlist"},
                                               {"chromaticities", "chromaticities"},
                                               {"compression", "compression"},
                                               {"dataWindow", "box2i"},
                                               {"displayWindow", "box2i"},
                                               {"lineOrder", "lineOrder"},
                                               {"pixelAspectRatio", "float"},
                                               {"screenWindowCenter", "v2f"},
                                               {"screenWindowWidth", "float"}}};
// Attributes whose meaning the standard, or OpenEXR for `adoptedNeutral`, fixes: they may be absent, but mean this.
constexpr std::array<NamedType, 45> kPredefined{{{"adoptedNeutral", "v2f"},
                                                 {"altitude", "float"},
                                                 {"aperture", "float"},
                                                 {"cameraFirmwareVersion", "string"},
                                                 {"cameraIdentifier", "string"},
                                                 {"cameraLabel", "string"},
                                                 {"cameraMake", "string"},
                                                 {"cameraModel", "string"},
                                                 {"cameraPosition", "v3f"},
                                                 {"cameraSerialNumber", "string"},
                                                 {"cameraUpDirection", "v3f"},
                                                 {"cameraViewingDirection", "v3f"},
                                                 {"capDate", "string"},
                                                 {"captureRate", "rational"},
                                                 {"comments", "string"},
                                                 {"convergenceDistance", "float"},
                                                 {"creator", "string"},
                                                 {"expTime", "float"},
                                                 {"focalLength", "float"},
                                                 {"focus", "float"},
                                                 {"framesPerSecond", "rational"},
                                                 {"headerChecksum", "string"},
                                                 {"imageChecksum", "string"},
                                                 {"imageCounter", "int"},
                                                 {"imageRotation", "float"},
                                                 {"interocularDistance", "float"},
                                                 {"isoSpeed", "float"},
                                                 {"keyCode", "keycode"},
                                                 {"latitude", "float"},
                                                 {"lensAttributes", "string"},
                                                 {"lensMake", "string"},
                                                 {"lensModel", "string"},
                                                 {"lensSerialNumber", "string"},
                                                 {"longitude", "float"},
                                                 {"multiView", "stringvector"},
                                                 {"originalImageFlag", "int"},
                                                 {"owner", "string"},
                                                 {"recorderFirmwareVersion", "string"},
                                                 {"recorderMake", "string"},
                                                 {"recorderModel", "string"},
                                                 {"recorderSerialNumber", "string"},
                                                 {"reelName", "string"},
                                                 {"storageMediaSerialNumber", "string"},
                                                 {"timeCode", "timecode"},
                                                 {"utcOffset", "float"}}};

// Bytes of the types whose size is fixed; 0 for the others.
std::size_t sizeOf(std::string_view type) {
    constexpr std::array<std::pair<std::string_view, std::size_t>, 11> kSizes{{{"int", 4},
                                                                               {"float", 4},
                                                                               {"v2f", 8},
                                                                               {"v3f", 12},
                                                                               {"box2i", 16},
                                                                               {"chromaticities", 32},
                                                                               {"compression", 1},
                                                                               {"lineOrder", 1},
                                                                               {"rational", 8},
                                                                               {"keycode", 28},
                                                                               {"timecode", 8}}};
    for (const auto& [name, size] : kSizes)
        if (name == type) return size;
    return 0;
}

struct Box {
    std::int32_t x0 = 0, y0 = 0, x1 = -1, y1 = -1; // all inclusive
    bool empty() const { return x1 < x0 || y1 < y0; }
    std::uint64_t width() const { return static_cast<std::uint64_t>(std::int64_t{x1} - x0 + 1); }
    std::uint64_t height() const { return static_cast<std::uint64_t>(std::int64_t{y1} - y0 + 1); }
};

class Check {
  public:
    explicit Check(std::string_view bytes) : bytes_(bytes), cursor_(bytes) {}

    AcesVerdict run() {
        if (readHeader()) {
            checkTypes();
            checkFlag();
            checkColour();
            checkChannels();
            checkGeometry();
            if (verdict_.valid()) checkScanLines();
        }
        return std::move(verdict_);
    }

  private:
    void fault(std::string text) { verdict_.faults.push_back(std::move(text)); }

    bool readHeader() {
        if (cursor_.u32() != kMagic || !cursor_.good()) {
            fault("it is no OpenEXR file");
            return false;
        }
        const std::uint32_t version = cursor_.u32();
        if (version != kVersion && version != (kVersion | kLongNames))
            fault(fmt::format("its version field is {}, not 2 or 1026: tiles, deep pixels or several parts", version));
        const std::size_t longest = version & kLongNames ? 255 : 31;
        const std::size_t start = cursor_.position();
        for (std::string name = cursor_.text(); !name.empty(); name = cursor_.text()) {
            Attribute a;
            a.type = cursor_.text();
            a.value = cursor_.take(cursor_.u32());
            if (!cursor_.good()) break;
            if (name.size() > longest || a.type.size() > longest)
                fault(fmt::format("the name or type of `{}` is longer than {} characters", name, longest));
            if (!attributes_.emplace(name, a).second) fault(fmt::format("`{}` occurs twice", name));
        }
        if (!cursor_.good()) {
            fault("its header is cut short");
            return false;
        }
        if (cursor_.position() - start > kMaxHeader) fault("its header is larger than 1 MiB");
        verdict_.claimed = attributes_.contains("acesImageContainerFlag");
        return true;
    }

    void checkType(const NamedType& wanted, const Attribute& a) {
        const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; };
        // ST 2065-4 spells it stringVector, OpenEXR stringvector.
        const bool same = std::ranges::equal(a.type, wanted.type, {}, lower, lower);
        const std::size_t size = sizeOf(wanted.type);
        if (!same || (size != 0 && a.value.size() != size))
            fault(fmt::format("`{}` has the type {} of {} bytes, not {}", wanted.name, a.type, a.value.size(),
                              wanted.type));
    }

    void checkTypes() {
        for (const NamedType& wanted : kRequired)
            if (const auto found = attributes_.find(wanted.name); found == attributes_.end())
                fault(fmt::format("`{}` is missing", wanted.name));
            else
                checkType(wanted, found->second);
        for (const NamedType& wanted : kPredefined)
            if (const auto found = attributes_.find(wanted.name); found != attributes_.end())
                checkType(wanted, found->second);
    }

    // The attribute's value, if it has the size that its type must have.
    std::optional<Cursor> value(std::string_view name, std::size_t size = 0) const {
        const auto found = attributes_.find(name);
        if (found == attributes_.end() || (size != 0 && found->second.value.size() != size)) return std::nullopt;
        return Cursor(found->second.value);
    }

    void checkFlag() {
        if (auto flag = value("acesImageContainerFlag", 4))
            if (const std::int32_t f = flag->i32(); f != 1)
                fault(fmt::format("`acesImageContainerFlag` is {}, not 1", f));
    }

    void checkColour() {
        auto c = value("chromaticities", 32);
        if (!c) return;
        for (const Chromaticity& wanted : {rgb::ap0.red, rgb::ap0.green, rgb::ap0.blue, rgb::ap0.white}) {
            const float x = c->f32(), y = c->f32();
            if (x == static_cast<float>(wanted.x) && y == static_cast<float>(wanted.y)) continue;
            fault(fmt::format("`chromaticities` has ({}, {}) where ACES2065-1 has ({}, {})", x, y, wanted.x, wanted.y));
        }
    }

    // R G B, perhaps A, and perhaps the same again for a left eye; 16-bit, at full resolution.
    void checkChannels() {
        auto list = value("channels");
        if (!list) return;
        std::string names;
        for (std::string name = list->text(); !name.empty(); name = list->text()) {
            names += (names.empty() ? "" : " ") + name;
            ++channels_;
            const std::uint32_t type = list->u32();
            const std::uint32_t flags = list->u32(); // perceptually linear, and three bytes that are reserved
            const std::int32_t x = list->i32(), y = list->i32();
            if (type != 1) fault(fmt::format("the channel {} is no half float", name));
            if ((flags & 0xff) != 0) fault(fmt::format("the channel {} is marked as not linear", name));
            if (x != 1 || y != 1) fault(fmt::format("the channel {} is not stored at full resolution", name));
        }
        if (!list->good()) return fault("`channels` is cut short");
        constexpr std::array<std::string_view, 4> kAllowed{"B G R", "A B G R", "B G R left.B left.G left.R",
                                                           "A B G R left.A left.B left.G left.R"};
        if (std::ranges::find(kAllowed, names) == kAllowed.end())
            fault(fmt::format("its channels are {}, not R G B with perhaps A, and a left eye", names));
        if (channels_ > 4 && !attributes_.contains("multiView")) fault("`multiView` is missing for two eyes");
    }

    std::optional<Box> box(std::string_view name) {
        auto v = value(name, 16);
        if (!v) return std::nullopt;
        Box b;
        for (std::int32_t* side : {&b.x0, &b.y0, &b.x1, &b.y1}) *side = v->i32();
        if (b.empty()) fault(fmt::format("`{}` is empty", name));
        return b;
    }

    void checkGeometry() {
        window_ = box("dataWindow").value_or(Box{});
        box("displayWindow");
        if (auto c = value("compression", 1))
            if (const int kind = c->u8(); kind != 0) fault(fmt::format("it is compressed (method {})", kind));
        if (auto o = value("lineOrder", 1)) {
            lineOrder_ = o->u8();
            if (lineOrder_ > 1)
                fault(fmt::format("`lineOrder` is {}, neither increasing nor decreasing y", lineOrder_));
        }
        if (auto r = value("pixelAspectRatio", 4))
            if (const float ratio = r->f32(); !(ratio > 0 && std::isfinite(ratio)))
                fault(fmt::format("`pixelAspectRatio` is {}", ratio));
        if (auto c = value("screenWindowCenter", 8)) {
            const float x = c->f32(), y = c->f32();
            if (!std::isfinite(x) || !std::isfinite(y)) fault("`screenWindowCenter` is not finite");
        }
        if (auto w = value("screenWindowWidth", 4))
            if (const float width = w->f32(); !(width >= 0 && std::isfinite(width)))
                fault(fmt::format("`screenWindowWidth` is {}", width));
    }

    // Each line: its y, the number of its bytes, then a row of each channel. The table has the lines by increasing y.
    void checkScanLines() {
        const std::uint64_t lineBytes = window_.width() * channels_ * 2;
        const std::uint64_t room = bytes_.size() - cursor_.position();
        if (window_.height() > room / (16 + lineBytes)) return fault("its pixels are cut short");
        std::uint64_t previous = 0;
        for (std::uint64_t i = 0; i < window_.height(); ++i) {
            const std::uint64_t offset = cursor_.number(8);
            Cursor line(bytes_, offset);
            const std::int64_t y = line.i32(), wanted = window_.y0 + static_cast<std::int64_t>(i);
            const std::uint32_t size = line.u32();
            line.take(lineBytes);
            if (!line.good() || y != wanted || size != lineBytes)
                return fault(fmt::format("the line offset table does not lead to scan line {}", wanted));
            const bool ordered = i == 0 || (lineOrder_ == 0) == (offset > previous);
            if (!ordered) return fault(fmt::format("scan line {} is not where `lineOrder` puts it", wanted));
            previous = offset;
        }
    }

    std::string_view bytes_;
    Cursor cursor_;
    std::map<std::string, Attribute, std::less<>> attributes_;
    Box window_;
    std::size_t channels_ = 0;
    int lineOrder_ = 0;
    AcesVerdict verdict_;
};

} // namespace

AcesVerdict checkAcesContainer(std::string_view bytes) { return Check(bytes).run(); }

} // namespace abbe
