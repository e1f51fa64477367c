#include "io/exr_writer.h"

#include "base/check.h"
#include "base/parallel.h"
#include "io/exr_library.h"
#include "io/exr_reader.h"
#include "io/file.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfDeepTiledInputPart.h>
#include <OpenEXR/ImfDeepTiledOutputPart.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfTiledInputPart.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <fmt/format.h>
#include <future>
#include <map>
#include <string_view>

namespace abbe {

namespace {

constexpr std::array<std::pair<std::string_view, Imf::Compression>, 8> kCompressions{{
    {"none", Imf::NO_COMPRESSION},
    {"rle", Imf::RLE_COMPRESSION},
    {"zips", Imf::ZIPS_COMPRESSION},
    {"zip", Imf::ZIP_COMPRESSION},
    {"piz", Imf::PIZ_COMPRESSION},
    {"pxr24", Imf::PXR24_COMPRESSION},
    {"dwaa", Imf::DWAA_COMPRESSION},
    {"dwab", Imf::DWAB_COMPRESSION},
}};

Imf::Compression toImf(ExrCompression c) { return kCompressions[static_cast<std::size_t>(c)].second; }

// Channels that are one part of a file, from R G B on or [first, last) of those beside them.
struct ExrPartChannels {
    std::string name; // none where there is no other
    bool colours = false;
    std::size_t first = 0, last = 0;
};

// What stands before the last dot; the levels of a Cryptomatte are one layer.
std::string_view layerOf(std::string_view channel) {
    const std::string_view layer = channel.substr(0, std::min(channel.rfind('.'), channel.size()));
    const std::size_t end = layer.find_last_not_of("0123456789");
    return layer.starts_with("Crypto") && layer.size() - end == 3 ? layer.substr(0, end + 1) : layer;
}

std::vector<ExrPartChannels> partsOf(const ExrPicture& p) {
    if (p.acesContainer) return {{"", true, 0, 0}};
    if (!p.parts) return {{"", true, 0, p.more.size()}};
    std::vector<ExrPartChannels> parts{{"beauty", true, 0, 0}};
    for (std::size_t i = 0; i < p.more.size(); ++i) {
        const std::string_view layer = layerOf(p.more[i].name);
        if (i == 0 || layer != parts.back().name) parts.push_back({std::string(layer), false, i, i});
        parts.back().last = i + 1;
    }
    return parts;
}

// Attributes of a Cryptomatte or a spectrum stand beside their channels, too.
bool belongs(const ImageAttribute& a, const ExrPartChannels& part) {
    if (part.colours) return true;
    if (part.name.starts_with("Crypto")) return a.name.starts_with("cryptomatte/");
    return part.name == "S0" && (a.name == "spectralLayoutVersion" || a.name == "emissiveUnits");
}

Imf::Header makeHeader(const ExrPicture& p, const ExrPartChannels& part) {
    Imf::Header header(toImf(p.display), toImf(p.window));
    header.compression() = toImf(p.compression);
    if (!part.name.empty()) {
        header.setName(part.name);
        header.setType(Imf::SCANLINEIMAGE);
    }
    for (const ImageAttribute& a : p.attributes)
        if (belongs(a, part)) addAttribute(header, a);
    addColours(header, p.chromaticities, p.adoptedNeutral);
    if (p.acesContainer) header.insert("acesImageContainerFlag", Imf::IntAttribute(1));
    if (part.colours)
        for (const char* name : {"R", "G", "B"})
            header.channels().insert(name, Imf::Channel(p.half ? Imf::HALF : Imf::FLOAT));
    for (std::size_t i = part.first; i < part.last; ++i)
        header.channels().insert(p.more[i].name, Imf::Channel(Imf::FLOAT));
    return header;
}

// Half keeps 65504 at most: what is larger is written as that and counted.
std::vector<Imath::half> toHalf(std::span<const float> values, ExrReport& report) {
    constexpr float kLargest = 65504;
    std::vector<Imath::half> result(values.size());
    for (std::size_t i = 0; i < values.size(); ++i) {
        float v = values[i];
        if (std::isfinite(v) && std::abs(v) > kLargest) {
            ++report.halfOverflows;
            v = std::copysign(kLargest, v);
        }
        result[i] = Imath::half(v);
        report.halfUnderflows += v != 0 && result[i].isZero();
    }
    return result;
}

// A slice whose pixel (0, 0) may lie outside the data window, as OpenEXR addresses it.
template <typename T> Imf::Slice slice(const PixelWindow& w, const T* values) {
    const auto type = sizeof(T) == 2 ? Imf::HALF : Imf::FLOAT;
    return Imf::Slice::Make(type, values, toImf(w), sizeof(T), sizeof(T) * static_cast<std::size_t>(w.width()));
}

// Some rows of the picture, whole: what OpenEXR reads from while it writes them.
class RowGroup {
  public:
    RowGroup(const ExrPicture& p, int y0, int y1, std::vector<std::span<const float>> more, ExrReport& report)
        : picture_(p), window_{p.window.x0, y0, p.window.x1, y1}, more_(std::move(more)) {
        const auto width = static_cast<std::size_t>(p.window.width());
        const std::array<std::span<const float>, 3> planes{p.r, p.g, p.b};
        for (std::size_t i = 0; i < planes.size(); ++i) {
            colours_[i] = planes[i].subspan(static_cast<std::size_t>(y0 - p.window.y0) * width, window_.area());
            if (p.half) halves_[i] = toHalf(colours_[i], report);
        }
    }

    Imf::FrameBuffer bufferOf(const ExrPartChannels& part) const {
        constexpr std::array<const char*, 3> kNames{"R", "G", "B"};
        Imf::FrameBuffer buffer;
        for (std::size_t i = 0; part.colours && i < kNames.size(); ++i)
            buffer.insert(kNames[i],
                          picture_.half ? slice(window_, halves_[i].data()) : slice(window_, colours_[i].data()));
        for (std::size_t i = part.first; i < part.last; ++i)
            buffer.insert(picture_.more[i].name, slice(window_, more_[i].data()));
        return buffer;
    }

  private:
    const ExrPicture& picture_;
    PixelWindow window_;
    std::array<std::span<const float>, 3> colours_;
    std::array<std::vector<Imath::half>, 3> halves_;
    std::vector<std::span<const float>> more_;
};

// From the picture itself.
std::vector<std::span<const float>> rowsOf(const ExrPicture& p, int y0, int y1) {
    const auto width = static_cast<std::size_t>(p.window.width());
    std::vector<std::span<const float>> rows;
    for (const ExrChannel& c : p.more)
        rows.push_back(c.values.subspan(static_cast<std::size_t>(y0 - p.window.y0) * width,
                                        static_cast<std::size_t>(y1 - y0) * width));
    return rows;
}

// What the source of rows threw, past those who take all exceptions for OpenEXR's.
struct RowFault {
    std::exception_ptr why;
};

// Calls write(group, count) for as many rows at a time as all threads have lines to compress. The next ones are made
// meanwhile: each of the two has moments in which one thread alone is at work.
template <typename Write>
void forRowGroups(const ExrPicture& p, const ExrRows& rows, ExrReport& report, const Write& write) {
    const int step = kExrRows * threadCount();
    const auto endOf = [&](int y) { return std::min(y + step, p.window.y1); };
    const auto make = [&](int y) {
        flushDenormals();
        try {
            return rows ? rows(y, endOf(y)) : rowsOf(p, y, endOf(y));
        } catch (...) {
            throw RowFault{std::current_exception()};
        }
    };
    const auto policy = threadCount() > 1 ? std::launch::async | std::launch::deferred : std::launch::deferred;
    auto next = std::async(std::launch::deferred, make, p.window.y0);
    for (int y = p.window.y0; y < p.window.y1; y += step) {
        std::vector<std::span<const float>> more = next.get();
        if (endOf(y) < p.window.y1) next = std::async(policy, make, endOf(y));
        write(RowGroup(p, y, endOf(y), std::move(more), report), endOf(y) - y);
    }
}

void writePixels(Imf::OStream& stream, const ExrPicture& p, const ExrRows& rows, ExrReport& report) {
    if (p.acesContainer)
        for (const ExrChannel& c : p.more) report.leftOut.push_back(c.name);
    const std::vector<ExrPartChannels> parts = partsOf(p);
    // Which thread compresses a line makes no difference to the file.
    Imf::setGlobalThreadCount(threadCount());
    if (!p.parts || p.acesContainer) {
        Imf::OutputFile file(stream, makeHeader(p, parts[0]), threadCount());
        forRowGroups(p, rows, report, [&](const RowGroup& group, int count) {
            file.setFrameBuffer(group.bufferOf(parts[0]));
            file.writePixels(count);
        });
        return;
    }
    std::vector<Imf::Header> headers;
    for (const ExrPartChannels& part : parts) headers.push_back(makeHeader(p, part));
    Imf::MultiPartOutputFile file(stream, headers.data(), static_cast<int>(headers.size()), false, threadCount());
    forRowGroups(p, rows, report, [&](const RowGroup& group, int count) {
        for (std::size_t i = 0; i < parts.size(); ++i) {
            Imf::OutputPart part(file, static_cast<int>(i));
            part.setFrameBuffer(group.bufferOf(parts[i]));
            part.writePixels(count);
        }
    });
}

bool isWhole(const std::string& path) {
    Imf::MultiPartInputFile file(path.c_str(), 0);
    for (int part = 0; part < file.parts(); ++part)
        if (!file.partComplete(part)) return false;
    return true;
}

void checkPicture(const ExrPicture& p, bool rows) {
    const std::size_t area = p.window.area();
    ABBE_CHECK(area > 0 && p.r.size() == area && p.g.size() == area && p.b.size() == area);
    for (const ExrChannel& c : p.more) ABBE_CHECK(c.values.size() == (rows ? 0 : area));
    ABBE_CHECK(!p.acesContainer ||
               (p.half && p.compression == ExrCompression::none && p.chromaticities.matches(rgb::ap0)));
}

} // namespace

std::optional<ExrCompression> findExrCompression(std::string_view name) {
    for (std::size_t i = 0; i < kCompressions.size(); ++i)
        if (kCompressions[i].first == name) return static_cast<ExrCompression>(i);
    return std::nullopt;
}

std::string_view name(ExrCompression c) { return kCompressions[static_cast<std::size_t>(c)].first; }

ExrReport writeExr(const std::string& path, const ExrPicture& picture, const ExrRows& rows) {
    checkPicture(picture, static_cast<bool>(rows));
    ExrReport report;
    try {
        writeWhole(
            path, [&](AtomicStream& stream) { writePixels(stream, picture, rows, report); }, isWhole);
    } catch (const RowFault& fault) {
        std::rethrow_exception(fault.why);
    }
    return report;
}

namespace {

bool isLossless(Imf::Compression c) {
    return c == Imf::NO_COMPRESSION || c == Imf::RLE_COMPRESSION || c == Imf::ZIPS_COMPRESSION ||
           c == Imf::ZIP_COMPRESSION || c == Imf::PIZ_COMPRESSION;
}

// The header of the first part with what is added.
Imf::Header extended(const Imf::Header& old, std::span<const ExrChannel> channels,
                     std::span<const ImageAttribute> attributes) {
    // What is replaced may be of another type, and OpenEXR 3.1 leaks what is erased: it is not taken over at all.
    const auto replaced = [&](std::string_view name) {
        return name == "tiles" || name == "chunkCount" || name == "acesImageContainerFlag" ||
               std::ranges::find(attributes, name, &ImageAttribute::name) != attributes.end();
    };
    Imf::Header header;
    for (auto a = old.begin(); a != old.end(); ++a)
        if (!replaced(a.name())) header.insert(a.name(), a.attribute());
    if (header.hasType()) header.setType(Imf::SCANLINEIMAGE);
    header.lineOrder() = Imf::INCREASING_Y;
    if (!isLossless(header.compression())) header.compression() = Imf::ZIP_COMPRESSION;
    for (const ExrChannel& c : channels) header.channels().insert(c.name, Imf::Channel(Imf::FLOAT));
    for (const ImageAttribute& a : attributes) addAttribute(header, a);
    return header;
}

// The pixels of a part in the types of the file, so that no bit changes.
struct NativePixels {
    Imf::FrameBuffer buffer;
    std::map<std::string, std::vector<char>> bytes;

    void add(const std::string& name, const Imf::Channel& c, const Imath::Box2i& window) {
        const std::size_t size = c.type == Imf::HALF ? 2 : 4;
        const auto columns = static_cast<std::size_t>(window.max.x / c.xSampling - window.min.x / c.xSampling + 1);
        const auto rows = static_cast<std::size_t>(window.max.y / c.ySampling - window.min.y / c.ySampling + 1);
        std::vector<char>& plane = bytes[name];
        plane.resize(size * columns * rows);
        buffer.insert(name,
                      Imf::Slice::Make(c.type, plane.data(), window, size, size * columns, c.xSampling, c.ySampling));
    }
};

void writeFirstPart(Imf::MultiPartInputFile& in, Imf::MultiPartOutputFile& out, std::span<const ExrChannel> channels) {
    const Imf::Header& header = in.header(0);
    const Imath::Box2i window = header.dataWindow();
    NativePixels pixels;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        pixels.add(c.name(), c.channel(), window);
    Imf::InputPart input(in, 0);
    input.setFrameBuffer(pixels.buffer);
    input.readPixels(window.min.y, window.max.y);
    for (const ExrChannel& c : channels) {
        ABBE_CHECK(c.values.size() == static_cast<std::size_t>(window.max.x - window.min.x + 1) *
                                          static_cast<std::size_t>(window.max.y - window.min.y + 1));
        const auto width = static_cast<std::size_t>(window.max.x - window.min.x + 1);
        pixels.buffer.insert(
            c.name, Imf::Slice::Make(Imf::FLOAT, c.values.data(), window, sizeof(float), width * sizeof(float)));
    }
    Imf::OutputPart output(out, 0);
    output.setFrameBuffer(pixels.buffer);
    output.writePixels(window.max.y - window.min.y + 1);
}

template <typename Output, typename Input>
void copyPart(Imf::MultiPartInputFile& in, Imf::MultiPartOutputFile& out, int part) {
    Input input(in, part);
    Output(out, part).copyPixels(input);
}

void copyOtherParts(Imf::MultiPartInputFile& in, Imf::MultiPartOutputFile& out) {
    for (int part = 1; part < in.parts(); ++part) {
        const std::string& type = in.header(part).type();
        if (type == Imf::SCANLINEIMAGE)
            copyPart<Imf::OutputPart, Imf::InputPart>(in, out, part);
        else if (type == Imf::TILEDIMAGE)
            copyPart<Imf::TiledOutputPart, Imf::TiledInputPart>(in, out, part);
        else if (type == Imf::DEEPSCANLINE)
            copyPart<Imf::DeepScanLineOutputPart, Imf::DeepScanLineInputPart>(in, out, part);
        else if (type == Imf::DEEPTILE)
            copyPart<Imf::DeepTiledOutputPart, Imf::DeepTiledInputPart>(in, out, part);
    }
}

void copyWith(const std::string& source, AtomicStream& stream, std::span<const ExrChannel> channels,
              std::span<const ImageAttribute> attributes) {
    checkExrBounds(source);
    Imf::MultiPartInputFile in(source.c_str(), 0);
    std::vector<Imf::Header> headers{extended(in.header(0), channels, attributes)};
    for (int part = 1; part < in.parts(); ++part) headers.push_back(in.header(part));
    Imf::MultiPartOutputFile out(stream, headers.data(), in.parts(), false, 0);
    writeFirstPart(in, out, channels);
    copyOtherParts(in, out);
}

} // namespace

void appendExr(const std::string& source, const std::string& target, std::span<const ExrChannel> channels,
               std::span<const ImageAttribute> attributes) {
    writeWhole(
        target, [&](AtomicStream& stream) { copyWith(source, stream, channels, attributes); },
        [](const std::string& written) { return Imf::MultiPartInputFile(written.c_str(), 0).partComplete(0); });
}

} // namespace abbe
