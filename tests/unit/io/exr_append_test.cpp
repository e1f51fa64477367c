#include "io/exr_append.h"
#include "io/exr_channels.h"
#include "io/io_error.h"
#include "temporary_folder.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfInputPart.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <doctest/doctest.h>

using namespace abbe;

namespace {

constexpr int kWidth = 30, kHeight = 20;
const Imath::Box2i kWindow{{4, -2}, {4 + kWidth - 1, -2 + kHeight - 1}};

// Numbers that only their own type holds.
struct Source {
    std::vector<Imath::half> halves;
    std::vector<unsigned> integers;

    Source() {
        for (unsigned i = 0; i < kWidth * kHeight; ++i) {
            halves.emplace_back(0.37f * static_cast<float>(i));
            integers.push_back(0x40000001u + i * 77);
        }
    }
    Imf::Header header() const {
        Imf::Header header(Imath::Box2i{{0, 0}, {99, 49}}, kWindow);
        header.channels().insert("R", Imf::Channel(Imf::HALF));
        header.channels().insert("object.id", Imf::Channel(Imf::UINT));
        header.compression() = Imf::DWAB_COMPRESSION;
        return header;
    }
    Imf::FrameBuffer buffer() const {
        Imf::FrameBuffer buffer;
        buffer.insert("R", Imf::Slice::Make(Imf::HALF, halves.data(), kWindow));
        buffer.insert("object.id", Imf::Slice::Make(Imf::UINT, integers.data(), kWindow));
        return buffer;
    }
};

// The first part's R and object.id as they stand in the file.
Source readBack(const std::string& path, int part = 0) {
    Imf::MultiPartInputFile file(path.c_str(), 0);
    Source source;
    Imf::InputPart input(file, part);
    input.setFrameBuffer(source.buffer());
    input.readPixels(kWindow.min.y, kWindow.max.y);
    return source;
}

bool same(const Source& a, const Source& b) {
    for (std::size_t i = 0; i < a.halves.size(); ++i)
        if (a.halves[i].bits() != b.halves[i].bits() || a.integers[i] != b.integers[i]) return false;
    return true;
}

} // namespace

TEST_CASE("appended channels leave all others as they are, bit for bit") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr", copy = folder / "b.exr";
    const Source source;
    for (const bool tiles : {false, true}) {
        Imf::Header header = source.header();
        if (tiles) {
            header.setTileDescription({16, 16});
            Imf::TiledOutputFile file(path.c_str(), header);
            file.setFrameBuffer(source.buffer());
            file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
        } else {
            Imf::OutputFile file(path.c_str(), header);
            file.setFrameBuffer(source.buffer());
            file.writePixels(kHeight);
        }
        const Source stored = readBack(path); // after what its compression lost
        std::vector<float> added(kWidth * kHeight, 0.1f);
        added[5] = 1e9f;
        const std::vector<ExrChannel> channels{{"denoised.R", added}};
        const std::vector<ImageAttribute> attributes{{"abbe.denoiser", std::string("nfor 1")}};
        appendExr(path, copy, channels, attributes);
        CHECK(same(readBack(copy), stored));
        CHECK(readExrChannel(copy, "denoised.R") == added);
        const ExrInfo info = readExrInfo(copy);
        CHECK(info.display == PixelWindow{0, 0, 100, 50});
        CHECK(info.compression == "zip");
        CHECK(info.attributes.size() >= 1);
        // Again, in place: channels of the same name are replaced.
        added[5] = 2;
        appendExr(copy, copy, channels, attributes);
        CHECK(readExrChannel(copy, "denoised.R") == added);
        CHECK(readExrInfo(copy).channels.size() == 3);
        CHECK(same(readBack(copy), stored));
        CHECK(folder.fileCount() == 2);
    }
}

TEST_CASE("other parts of a file are kept") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    const Source source;
    std::vector<Imf::Header> headers{source.header(), source.header()};
    for (std::size_t i = 0; i < 2; ++i) {
        headers[i].setName(i == 0 ? "rgb" : "ids");
        headers[i].setType(Imf::SCANLINEIMAGE);
    }
    {
        Imf::MultiPartOutputFile file(path.c_str(), headers.data(), 2);
        for (int i = 0; i < 2; ++i) {
            Imf::OutputPart part(file, i);
            part.setFrameBuffer(source.buffer());
            part.writePixels(kHeight);
        }
    }
    const Source second = readBack(path, 1);
    const std::vector<float> added(kWidth * kHeight, 3);
    const std::vector<ExrChannel> channels{{"denoised.R", added}};
    appendExr(path, path, channels, {});
    CHECK(readExrInfo(path).parts == 2);
    CHECK(readExrChannel(path, "denoised.R") == added);
    CHECK(same(readBack(path, 1), second));
    CHECK(Imf::MultiPartInputFile(path.c_str(), 0).header(1).compression() == Imf::DWAB_COMPRESSION);
}

TEST_CASE("a file that cannot be appended to stays as it was") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    CHECK_THROWS_AS(appendExr(folder / "absent.exr", path, {}, {}), IoError);
    writeAll(path, "no image");
    CHECK_THROWS_AS(appendExr(path, path, {}, {}), IoError);
    CHECK(readAll(path) == "no image");
    CHECK(folder.fileCount() == 1);
}
