#include "io/exr_reader.h"

#include "base/memory_limit.h"
#include "io/exr_library.h"
#include "io/file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfDoubleAttribute.h>
#include <OpenEXR/ImfFloatAttribute.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfIntAttribute.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>

namespace abbe {

namespace {

// More values than this are not read at once: 16 GiB.
constexpr std::uint64_t kMaxValues = std::uint64_t(1) << 32;

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

void checkChannel(const std::string& path, const Imf::Channel& channel, std::string_view name) {
    if (channel.xSampling != 1 || channel.ySampling != 1)
        refuse(path, fmt::format("channel {} is stored at a lower resolution, which is not supported", name));
}

// Where a channel's plane lies, as OpenEXR addresses it.
Imf::Slice slice(const PixelWindow& w, const float* values) {
    return Imf::Slice::Make(Imf::FLOAT, values, {{w.x0, w.y0}, {w.x1 - 1, w.y1 - 1}}, sizeof(float),
                            sizeof(float) * static_cast<std::size_t>(w.width()));
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

std::string nameIn(const Imf::Header& header, int part, std::string_view channel) {
    const bool own = part == 0 || !header.hasName() || channel.find('.') != std::string_view::npos;
    return own ? std::string(channel) : fmt::format("{}.{}", header.name(), channel);
}

void addChannels(const Imf::Header& header, int part, ExrInfo& info) {
    if (part > 0 && header.hasType() && Imf::isDeepData(header.type())) return;
    if (fromImf(header.dataWindow()) != info.window) return;
    constexpr std::array<const char*, 3> kTypes{"uint", "half", "float"};
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        if (std::string name = nameIn(header, part, c.name()); !info.has(name))
            info.channels.push_back({std::move(name), kTypes.at(static_cast<std::size_t>(c.channel().type)), part});
}

ExrInfo describe(const Imf::MultiPartInputFile& file) {
    const Imf::Header& header = file.header(0);
    ExrInfo info;
    info.parts = file.parts();
    info.deep = header.hasType() && Imf::isDeepData(header.type());
    info.window = fromImf(header.dataWindow());
    info.display = fromImf(header.displayWindow());
    info.compression = compressionName(header.compression());
    info.chromaticities = chromaticitiesOf(header);
    if (const auto* neutral = header.findTypedAttribute<Imf::V2fAttribute>("adoptedNeutral"))
        info.adoptedNeutral = Chromaticity{neutral->value().x, neutral->value().y};
    for (int part = 0; part < file.parts(); ++part) addChannels(file.header(part), part, info);
    for (auto a = header.begin(); a != header.end(); ++a)
        if (const auto attribute = fromImf(a.name(), a.attribute())) info.attributes.push_back(*attribute);
    const auto* flag = header.findTypedAttribute<Imf::IntAttribute>("acesImageContainerFlag");
    info.acesContainer = flag && flag->value() == 1;
    return info;
}

// Memory for every channel that is wanted, once it is known that there is enough.
void makeRoom(const std::string& path, ExrPlanes& planes, const std::function<bool(std::string_view)>& wanted) {
    const std::uint64_t area = planes.info.window.area();
    std::vector<bool> chosen;
    std::uint64_t values = 0;
    for (const ExrInfo::Channel& c : planes.info.channels) {
        chosen.push_back(!wanted || wanted(c.name));
        values += chosen.back() ? area : 0;
    }
    if (values > kMaxValues) refuse(path, "its channels are more than 16 GiB");
    requireMemory(static_cast<double>(values) * sizeof(float));
    planes.values.resize(chosen.size());
    for (std::size_t i = 0; i < chosen.size(); ++i)
        if (chosen[i]) planes.values[i].resize(area);
}

ExrPlanes readPlanes(const std::string& path, const std::function<bool(std::string_view)>& wanted) {
    checkExrBounds(path);
    Imf::MultiPartInputFile file(path.c_str(), 0);
    ExrPlanes planes{describe(file), {}};
    const PixelWindow& window = planes.info.window;
    // OpenEXR would put them over each other, with media in its own way.
    if (planes.info.deep) refuse(path, "it is a deep image; `abbe convert` shows it");
    makeRoom(path, planes, wanted);
    std::map<int, Imf::FrameBuffer> buffers; // of parts
    for (std::size_t i = 0; i < planes.values.size(); ++i) {
        if (planes.values[i].empty()) continue;
        const auto& [name, type, part] = planes.info.channels[i];
        const Imf::Header& header = file.header(part);
        const Imf::Channel* stored = header.channels().findChannel(name);
        const std::string inPart = stored ? name : name.substr(header.name().size() + 1);
        checkChannel(path, stored ? *stored : header.channels()[inPart.c_str()], name);
        buffers[part].insert(inPart, slice(window, planes.values[i].data()));
    }
    for (const auto& [part, buffer] : buffers) {
        Imf::InputPart input(file, part);
        input.setFrameBuffer(buffer);
        input.readPixels(window.y0, window.y1 - 1);
    }
    return planes;
}

} // namespace

bool ExrInfo::has(std::string_view channel) const {
    return std::any_of(channels.begin(), channels.end(), [&](const Channel& c) { return c.name == channel; });
}

std::string ExrInfo::channelNames() const {
    std::string names;
    for (const Channel& c : channels) names += (names.empty() ? "" : " ") + c.name;
    return names;
}

const std::vector<float>* ExrPlanes::find(std::string_view name) const {
    for (std::size_t i = 0; i < values.size(); ++i)
        if (info.channels[i].name == name) return values[i].empty() ? nullptr : &values[i];
    return nullptr;
}

ExrInfo readExrInfo(const std::string& path) {
    return readingExr(path, [&] {
        checkExrBounds(path);
        const Imf::MultiPartInputFile file(path.c_str(), 0, false);
        return describe(file);
    });
}

ExrPlanes readExrChannels(const std::string& path, const std::function<bool(std::string_view)>& wanted) {
    return readingExr(path, [&] { return readPlanes(path, wanted); });
}

std::vector<float> readExrChannel(const std::string& path, const std::string& channel) {
    ExrPlanes planes = readExrChannels(path, [&](std::string_view name) { return name == channel; });
    for (std::vector<float>& values : planes.values)
        if (!values.empty()) return std::move(values);
    throw IoError(
        fmt::format("cannot read `{}`: it has no channel {}, only {}", path, channel, planes.info.channelNames()));
}

RgbImage readExr(const std::string& path) {
    constexpr std::array<std::string_view, 4> kNames{"R", "G", "B", "Y"};
    const ExrPlanes planes = readExrChannels(
        path, [&](std::string_view name) { return std::find(kNames.begin(), kNames.end(), name) != kNames.end(); });
    std::array<const std::vector<float>*, 3> sources{planes.find("R"), planes.find("G"), planes.find("B")};
    if (!sources[0] || !sources[1] || !sources[2]) {
        // Beside RY and BY, Y is no grey but the luminance of a picture in other channels.
        sources.fill(planes.info.has("RY") ? nullptr : planes.find("Y"));
        if (!sources[0])
            throw IoError(fmt::format("cannot read `{}`: it has neither the channels R G B nor Y alone, but {}", path,
                                      planes.info.channelNames()));
    }
    RgbImage image;
    image.window = planes.info.window;
    image.display = planes.info.display;
    image.chromaticities = planes.info.chromaticities;
    image.adoptedNeutral = planes.info.adoptedNeutral;
    for (const ImageAttribute& a : planes.info.attributes)
        if (const auto* text = std::get_if<std::string>(&a.value); text && a.name == "colorInteropID")
            image.interopId = *text;
    requireMemory(static_cast<double>(image.window.area()) * 3 * sizeof(float));
    image.rgb.resize(3 * image.window.area());
    for (std::size_t i = 0; i < image.rgb.size(); ++i) image.rgb[i] = (*sources[i % 3])[i / 3];
    countFaults(image);
    return image;
}

} // namespace abbe
