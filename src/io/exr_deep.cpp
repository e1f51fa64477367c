#include "io/exr_deep.h"

#include "base/check.h"
#include "base/file.h"
#include "base/memory_limit.h"
#include "base/parallel.h"
#include "io/exr_library.h"
#include "io/exr_reader.h"
#include "io/file.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfChromaticitiesAttribute.h>
#include <OpenEXR/ImfDeepFrameBuffer.h>
#include <OpenEXR/ImfDeepScanLineInputPart.h>
#include <OpenEXR/ImfDeepScanLineOutputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfThreading.h>
#include <OpenEXR/ImfVecAttribute.h>
#include <array>
#include <exception>
#include <fmt/format.h>
#include <numeric>

namespace abbe {

namespace {

constexpr std::array<const char*, 6> kChannels{"Z", "ZBack", "A", "R", "G", "B"};

template <typename Picture> auto planesOf(Picture& p) { return std::array{&p.z, &p.zBack, &p.a, &p.r, &p.g, &p.b}; }

// How many samples each pixel has and where they begin, as OpenEXR asks for it: before it is known how many there are.
struct Pointers {
    Pointers(const PixelWindow& window, std::vector<std::uint32_t>& counts) : window_(window), counts_(counts) {
        const auto width = static_cast<std::size_t>(window.width());
        buffer.insertSampleCountSlice(
            Imf::Slice::Make(Imf::UINT, counts.data(), toImf(window), sizeof(counts[0]), width * sizeof(counts[0])));
    }

    void add(const char* name) {
        std::vector<float*>& pointers = planes_.emplace_back(counts_.size());
        const auto width = static_cast<std::ptrdiff_t>(window_.width());
        // The address of pixel (0, 0), which may lie outside of the window.
        const std::ptrdiff_t origin = -(window_.y0 * width + window_.x0);
        const auto size = static_cast<std::ptrdiff_t>(sizeof(float*));
        char* const base = reinterpret_cast<char*>(reinterpret_cast<std::intptr_t>(pointers.data()) + origin * size);
        buffer.insert(name, Imf::DeepSlice(Imf::FLOAT, base, sizeof(float*),
                                           static_cast<std::size_t>(width) * sizeof(float*), sizeof(float)));
    }

    // The samples of the channel that was added as number `channel`.
    void point(std::size_t channel, float* samples) {
        for (std::size_t i = 0; i < counts_.size(); ++i) {
            planes_[channel][i] = samples;
            samples += counts_[i];
        }
    }

    Imf::DeepFrameBuffer buffer;

  private:
    const PixelWindow& window_;
    const std::vector<std::uint32_t>& counts_;
    std::vector<std::vector<float*>> planes_;
};

Imf::Header makeHeader(const DeepPicture& p) {
    Imf::Header header(toImf(p.display), toImf(p.window));
    header.compression() = Imf::ZIPS_COMPRESSION;
    header.setName("deep");
    header.setType(Imf::DEEPSCANLINE);
    for (const ImageAttribute& a : p.attributes) addAttribute(header, a);
    if (p.chromaticities) addColours(header, *p.chromaticities, p.adoptedNeutral);
    for (const char* name : kChannels) header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    return header;
}

void checkSamples(const DeepPicture& p) {
    ABBE_CHECK(p.window.area() > 0 && p.counts.size() == p.window.area());
    const auto total = std::accumulate(p.counts.begin(), p.counts.end(), std::size_t{0});
    for (const auto* plane : planesOf(p)) ABBE_CHECK(plane->size() == total);
}

void writeRows(Imf::DeepScanLineOutputPart& part, const DeepPicture& picture) {
    checkSamples(picture);
    auto& p = const_cast<DeepPicture&>(picture); // OpenEXR reads from what it could also write to
    Pointers pointers(p.window, p.counts);
    const auto planes = planesOf(p);
    for (std::size_t c = 0; c < planes.size(); ++c) {
        pointers.add(kChannels[c]);
        pointers.point(c, planes[c]->data());
    }
    part.setFrameBuffer(pointers.buffer);
    part.writePixels(p.window.height());
}

int deepPart(const std::string& path, const Imf::MultiPartInputFile& file) {
    for (int part = 0; part < file.parts(); ++part)
        if (file.header(part).hasType() && file.header(part).type() == Imf::DEEPSCANLINE) return part;
    throw IoError(fmt::format("cannot read `{}`: it has no deep scan lines", path));
}

// How many samples there are says a table within the file, which may say anything.
void checkSamples(const std::string& path, const Imf::Header& header, std::size_t samples, std::size_t planes) {
    double bytes = 0;
    for (auto c = header.channels().begin(); c != header.channels().end(); ++c)
        bytes += static_cast<double>(samples) * (c.channel().type == Imf::HALF ? 2 : 4);
    const auto stored = static_cast<double>(RegularFile(path).size());
    if (bytes > stored * exrMostExpansion(header.compression()))
        throw IoError(fmt::format("cannot read `{}`: it cannot hold {} deep samples", path, samples));
    requireMemory(static_cast<double>(samples * planes) * sizeof(float));
}

DeepPicture readSamples(const std::string& path, std::size_t most) {
    checkExrBounds(path);
    Imf::MultiPartInputFile file(path.c_str(), 0);
    const int number = deepPart(path, file);
    const Imf::Header& header = file.header(number);
    const auto window = [](const Imath::Box2i& b) { return PixelWindow{b.min.x, b.min.y, b.max.x + 1, b.max.y + 1}; };
    DeepPicture p;
    p.window = window(header.dataWindow());
    p.display = window(header.displayWindow());
    const bool hasBack = header.channels().findChannel("ZBack");
    for (const char* name : kChannels)
        if (!header.channels().findChannel(name) && std::string_view(name) != "ZBack")
            throw IoError(fmt::format("cannot read `{}`: its deep samples have no channel {}", path, name));
    Imf::DeepScanLineInputPart part(file, number);
    // Counts, and the pointers of each channel.
    requireMemory(static_cast<double>(p.window.area()) * (4 + 8 * static_cast<double>(kChannels.size())));
    p.counts.resize(p.window.area());
    Pointers pointers(p.window, p.counts);
    std::vector<std::vector<float>*> planes;
    for (std::size_t c = 0; c < kChannels.size(); ++c) {
        if (c == 1 && !hasBack) continue;
        pointers.add(kChannels[c]);
        planes.push_back(planesOf(p)[c]);
    }
    part.setFrameBuffer(pointers.buffer);
    part.readPixelSampleCounts(p.window.y0, p.window.y1 - 1);
    const auto total = std::accumulate(p.counts.begin(), p.counts.end(), std::size_t{0});
    if (total > most)
        throw IoError(fmt::format("cannot read `{}`: {} deep samples are too many for its size", path, total));
    checkSamples(path, header, total, planes.size());
    for (std::size_t c = 0; c < planes.size(); ++c) {
        planes[c]->resize(total);
        pointers.point(c, planes[c]->data());
    }
    part.readPixels(p.window.y0, p.window.y1 - 1);
    if (!hasBack) p.zBack = p.z;
    return p;
}

} // namespace

void writeDeepExr(const std::string& path, const DeepPicture& head, const std::function<void(const DeepRows&)>& write) {
    std::exception_ptr fault; // of the source, past those who take all exceptions for OpenEXR's
    const auto writeAll = [&](AtomicStream& stream) {
        const Imf::Header header = makeHeader(head);
        Imf::setGlobalThreadCount(threadCount());
        Imf::MultiPartOutputFile file(stream, &header, 1, false, threadCount());
        Imf::DeepScanLineOutputPart part(file, 0);
        try {
            write([&part](const DeepPicture& rows) { writeRows(part, rows); });
        } catch (...) {
            fault = std::current_exception();
            throw;
        }
    };
    try {
        writeWhole(path, writeAll, [](const std::string& written) {
            return Imf::MultiPartInputFile(written.c_str(), 0).partComplete(0);
        });
    } catch (...) {
        if (fault) std::rethrow_exception(fault);
        throw;
    }
}

void writeDeepExr(const std::string& path, const DeepPicture& picture) {
    writeDeepExr(path, picture, [&](const DeepRows& rows) { rows(picture); });
}

DeepPicture readDeepExr(const std::string& path, std::size_t most) {
    return readingExr(path, [&] { return readSamples(path, most); });
}

FlatPicture flatten(const DeepPicture& p) {
    FlatPicture flat;
    for (auto* plane : {&flat.r, &flat.g, &flat.b, &flat.a}) plane->resize(p.counts.size());
    std::size_t at = 0;
    for (std::size_t i = 0; i < p.counts.size(); ++i) {
        float left = 1;
        for (std::uint32_t s = 0; s < p.counts[i]; ++s, ++at) {
            flat.r[i] += left * p.r[at];
            flat.g[i] += left * p.g[at];
            flat.b[i] += left * p.b[at];
            left *= 1 - p.a[at];
        }
        flat.a[i] = 1 - left;
    }
    return flat;
}

} // namespace abbe
