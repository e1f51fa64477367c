#include "io/exr_reader.h"

#include "io/io_error.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputFile.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <array>
#include <fmt/format.h>
#include <sys/stat.h>

namespace abbe {

namespace {

// Runs `body`; whatever OpenEXR throws becomes an IoError with the file's name.
template <typename F> auto guarded(const std::string& path, const F& body) {
    const auto fail = [&](std::string_view why) { throw IoError(fmt::format("cannot read `{}`: {}", path, why)); };
    try {
        return body();
    } catch (const IoError&) {
        throw;
    } catch (const std::bad_alloc&) {
        fail("it needs more memory than there is");
    } catch (const std::exception& e) {
        fail(e.what());
    }
    throw IoError(path); // not reached
}

[[noreturn]] void refuse(const std::string& path, std::string_view why) {
    throw IoError(fmt::format("cannot read `{}`: {}", path, why));
}

PixelWindow fromImf(const Imath::Box2i& b) { return {b.min.x, b.min.y, b.max.x + 1, b.max.y + 1}; }

Chromaticities fromImf(const Imf::Chromaticities& c) {
    const auto point = [](Imath::V2f v) { return Chromaticity{v.x, v.y}; };
    return {point(c.red), point(c.green), point(c.blue), point(c.white)};
}

std::optional<Chromaticities> chromaticitiesOf(const Imf::Header& header) {
    const auto* a = header.findTypedAttribute<Imf::ChromaticitiesAttribute>("chromaticities");
    return a ? std::optional(fromImf(a->value())) : std::nullopt;
}

// A header can claim any size: before memory is taken for it, it must be possible for a file of this length. The most
// that any compression makes of a chunk's bytes is bounded loosely; each chunk of up to 256 rows costs 8 bytes of
// offset.
void checkSize(const std::string& path, const PixelWindow& w) {
    const auto width = static_cast<std::int64_t>(w.x1) - w.x0, height = static_cast<std::int64_t>(w.y1) - w.y0;
    if (width < 1 || height < 1) refuse(path, "it has no pixels");
    if (width > INT32_MAX || height > INT32_MAX ||
        static_cast<std::uint64_t>(width) * static_cast<std::uint64_t>(height) > kMaxImagePixels)
        refuse(path, fmt::format("{} by {} pixels are too many", width, height));
    struct stat status {};
    if (::stat(path.c_str(), &status) == 0 && status.st_size < height / 256 * 8) refuse(path, "it is cut short");
}

// OpenEXR's header as it is checked before reading pixels.
PixelWindow checkedWindow(const std::string& path, const Imf::Header& header) {
    const PixelWindow window = fromImf(header.dataWindow());
    checkSize(path, window);
    return window;
}

void checkChannel(const std::string& path, const Imf::Channel& channel, std::string_view name) {
    if (channel.xSampling != 1 || channel.ySampling != 1)
        refuse(path, fmt::format("channel {} is stored at a lower resolution, which is not supported", name));
}

std::string channelNames(const Imf::ChannelList& channels) {
    std::vector<std::string> names;
    for (auto c = channels.begin(); c != channels.end(); ++c) names.emplace_back(c.name());
    return fmt::format("{}", fmt::join(names, " "));
}

// The slice of component `offset` of interleaved pixels.
Imf::Slice slice(const PixelWindow& w, const float* values, std::size_t components) {
    const std::size_t stride = components * sizeof(float);
    return Imf::Slice::Make(Imf::FLOAT, values, {{w.x0, w.y0}, {w.x1 - 1, w.y1 - 1}}, stride,
                            stride * static_cast<std::size_t>(w.width()));
}

void readPixels(Imf::InputFile& file, const Imf::FrameBuffer& buffer) {
    file.setFrameBuffer(buffer);
    const Imath::Box2i window = file.header().dataWindow();
    file.readPixels(window.min.y, window.max.y);
}

RgbImage readPicture(const std::string& path) {
    Imf::InputFile file(path.c_str(), 0);
    const Imf::Header& header = file.header();
    const Imf::ChannelList& channels = header.channels();
    RgbImage image;
    image.window = checkedWindow(path, header);
    image.display = fromImf(header.displayWindow());
    image.chromaticities = chromaticitiesOf(header);
    const bool colour = channels.findChannel("R") && channels.findChannel("G") && channels.findChannel("B");
    const bool grey = !colour && channels.findChannel("Y") && !channels.findChannel("RY");
    if (!colour && !grey)
        refuse(path, fmt::format("it has neither the channels R G B nor Y alone, but {}", channelNames(channels)));
    image.rgb.resize(3 * image.window.area());
    Imf::FrameBuffer buffer;
    const std::array<const char*, 3> names =
        colour ? std::array<const char*, 3>{"R", "G", "B"} : std::array<const char*, 3>{"Y", nullptr, nullptr};
    for (std::size_t i = 0; i < 3 && names[i]; ++i) {
        checkChannel(path, *channels.findChannel(names[i]), names[i]);
        buffer.insert(names[i], slice(image.window, image.rgb.data() + i, 3));
    }
    readPixels(file, buffer);
    if (grey)
        for (std::size_t i = 0; i < image.rgb.size(); i += 3) image.rgb[i + 1] = image.rgb[i + 2] = image.rgb[i];
    countFaults(image);
    return image;
}

std::vector<float> readPlane(const std::string& path, const std::string& name) {
    Imf::InputFile file(path.c_str(), 0);
    const PixelWindow window = checkedWindow(path, file.header());
    const Imf::Channel* channel = file.header().channels().findChannel(name);
    if (!channel)
        refuse(path, fmt::format("it has no channel {}, only {}", name, channelNames(file.header().channels())));
    checkChannel(path, *channel, name);
    std::vector<float> values(window.area());
    Imf::FrameBuffer buffer;
    buffer.insert(name, slice(window, values.data(), 1));
    readPixels(file, buffer);
    return values;
}

std::optional<ImageAttribute> fromImf(const std::string& name, const Imf::Attribute& a) {
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&a)) return ImageAttribute{name, text->value()};
    if (const auto* number = dynamic_cast<const Imf::IntAttribute*>(&a)) return ImageAttribute{name, number->value()};
    if (const auto* number = dynamic_cast<const Imf::DoubleAttribute*>(&a))
        return ImageAttribute{name, number->value()};
    if (const auto* number = dynamic_cast<const Imf::FloatAttribute*>(&a))
        return ImageAttribute{name, static_cast<double>(number->value())};
    return std::nullopt;
}

std::string_view compressionName(Imf::Compression c) {
    switch (c) {
    case Imf::NO_COMPRESSION:
        return "none";
    case Imf::RLE_COMPRESSION:
        return "rle";
    case Imf::ZIPS_COMPRESSION:
        return "zips";
    case Imf::ZIP_COMPRESSION:
        return "zip";
    case Imf::PIZ_COMPRESSION:
        return "piz";
    case Imf::PXR24_COMPRESSION:
        return "pxr24";
    case Imf::B44_COMPRESSION:
        return "b44";
    case Imf::B44A_COMPRESSION:
        return "b44a";
    case Imf::DWAA_COMPRESSION:
        return "dwaa";
    case Imf::DWAB_COMPRESSION:
        return "dwab";
    default:
        return "unknown";
    }
}

ExrInfo describe(const std::string& path) {
    const Imf::MultiPartInputFile file(path.c_str(), 0, false);
    const Imf::Header& header = file.header(0);
    ExrInfo info;
    info.parts = file.parts();
    info.window = fromImf(header.dataWindow());
    info.display = fromImf(header.displayWindow());
    info.compression = compressionName(header.compression());
    info.chromaticities = chromaticitiesOf(header);
    constexpr std::array<const char*, 3> kTypes{"uint", "half", "float"};
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        info.channels.push_back({c.name(), kTypes.at(static_cast<std::size_t>(c.channel().type))});
    for (auto a = header.begin(); a != header.end(); ++a)
        if (const auto attribute = fromImf(a.name(), a.attribute())) info.attributes.push_back(*attribute);
    const auto* flag = header.findTypedAttribute<Imf::IntAttribute>("acesImageContainerFlag");
    info.acesContainer = flag && flag->value() == 1;
    return info;
}

} // namespace

RgbImage readExr(const std::string& path) {
    return guarded(path, [&] { return readPicture(path); });
}

std::vector<float> readExrChannel(const std::string& path, const std::string& channel) {
    return guarded(path, [&] { return readPlane(path, channel); });
}

ExrInfo readExrInfo(const std::string& path) {
    return guarded(path, [&] { return describe(path); });
}

} // namespace abbe
