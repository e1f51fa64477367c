#include "io/exr_writer.h"

#include "base/check.h"
#include "io/exr_stream.h"
#include "io/io_error.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfStandardAttributes.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <array>
#include <cmath>
#include <fmt/format.h>

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

Imath::V2f toImf(Chromaticity c) { return {static_cast<float>(c.x), static_cast<float>(c.y)}; }

Imf::Chromaticities toImf(const Chromaticities& c) {
    return {toImf(c.red), toImf(c.green), toImf(c.blue), toImf(c.white)};
}

Imath::Box2i toImf(const PixelWindow& w) { return {{w.x0, w.y0}, {w.x1 - 1, w.y1 - 1}}; }

void addAttribute(Imf::Header& header, const ImageAttribute& a) {
    const char* name = a.name.c_str();
    if (const auto* text = std::get_if<std::string>(&a.value)) header.insert(name, Imf::StringAttribute(*text));
    if (const auto* number = std::get_if<int>(&a.value)) header.insert(name, Imf::IntAttribute(*number));
    if (const auto* number = std::get_if<double>(&a.value)) header.insert(name, Imf::DoubleAttribute(*number));
}

Imf::Header makeHeader(const ExrPicture& p) {
    Imf::Header header(toImf(p.display), toImf(p.window));
    header.compression() = toImf(p.compression);
    for (const ImageAttribute& a : p.attributes) addAttribute(header, a);
    Imf::addChromaticities(header, toImf(p.chromaticities));
    Imf::addAdoptedNeutral(header, toImf(p.adoptedNeutral.value_or(p.chromaticities.white)));
    if (p.acesContainer) header.insert("acesImageContainerFlag", Imf::IntAttribute(1));
    const Imf::PixelType colour = p.half ? Imf::HALF : Imf::FLOAT;
    for (const char* name : {"R", "G", "B"}) header.channels().insert(name, Imf::Channel(colour));
    if (!p.acesContainer)
        for (const ExrChannel& c : p.more) header.channels().insert(c.name, Imf::Channel(Imf::FLOAT));
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

void writePixels(Imf::OStream& stream, const ExrPicture& p, ExrReport& report) {
    Imf::OutputFile file(stream, makeHeader(p), 0);
    Imf::FrameBuffer buffer;
    std::array<std::vector<Imath::half>, 3> halves;
    const std::array<std::span<const float>, 3> planes{p.r, p.g, p.b};
    constexpr std::array<const char*, 3> kNames{"R", "G", "B"};
    for (std::size_t i = 0; i < 3; ++i) {
        if (p.half) halves[i] = toHalf(planes[i], report);
        buffer.insert(kNames[i], p.half ? slice(p.window, halves[i].data()) : slice(p.window, planes[i].data()));
    }
    for (const ExrChannel& c : p.more) {
        if (p.acesContainer)
            report.leftOut.push_back(c.name);
        else
            buffer.insert(c.name, slice(p.window, c.values.data()));
    }
    file.setFrameBuffer(buffer);
    file.writePixels(p.window.height());
}

void checkPicture(const ExrPicture& p) {
    const std::size_t area = p.window.area();
    ABBE_CHECK(area > 0 && p.r.size() == area && p.g.size() == area && p.b.size() == area);
    for (const ExrChannel& c : p.more) ABBE_CHECK(c.values.size() == area);
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

ExrReport writeExr(const std::string& path, const ExrPicture& picture) {
    checkPicture(picture);
    ExrReport report;
    AtomicFile file(path);
    AtomicStream stream(file);
    try {
        writePixels(stream, picture, report);
        // Ends with what a damaged disk or a full one would have spoilt: the offsets of all lines.
        if (stream.error().empty() && !Imf::InputFile(file.temporaryPath().c_str(), 0).isComplete())
            throw IoError(fmt::format("cannot write `{}`: the file came out incomplete", path));
    } catch (const IoError&) {
        throw;
    } catch (const std::exception& e) {
        throw IoError(stream.error().empty() ? fmt::format("cannot write `{}`: {}", path, e.what()) : stream.error());
    }
    if (!stream.error().empty()) throw IoError(stream.error());
    file.commit();
    return report;
}

} // namespace abbe
