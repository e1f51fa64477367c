#include "io/exr_append.h"

#include "base/check.h"
#include "io/exr_bounds.h"
#include "io/exr_channels.h"
#include "io/exr_header.h"
#include "io/exr_stream.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfDeepTiledInputPart.h>
#include <OpenEXR/ImfDeepTiledOutputPart.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTiledInputPart.h>
#include <OpenEXR/ImfTiledOutputPart.h>
#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <string_view>

namespace abbe {

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
