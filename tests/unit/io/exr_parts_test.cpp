// Files with a part for each layer.
#include "io/exr_append.h"
#include "io/exr_channels.h"
#include "io/exr_reader.h"
#include "temporary_folder.h"

#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfMultiPartInputFile.h>
#include <OpenEXR/ImfMultiPartOutputFile.h>
#include <OpenEXR/ImfOutputPart.h>
#include <OpenEXR/ImfPartType.h>
#include <OpenEXR/ImfStringAttribute.h>
#include <doctest/doctest.h>

using namespace abbe;

namespace {

struct Layers {
    std::vector<std::vector<float>> planes;
    ExrPicture picture;

    explicit Layers(bool parts, bool in16Bits = false) {
        const char* const names[] = {"variance.Y",         "albedo.R",         "albedo.G",         "half.albedo.R",
                                     "CryptoObject00.R",   "CryptoObject01.R", "CryptoObject02.A", "CryptoObject.R",
                                     "CryptoMaterial00.R", "S0.385nm"};
        picture.window = {-3, 2, 6, 9};
        picture.display = {0, 0, 12, 10};
        for (std::size_t c = 0; c < 3 + std::size(names); ++c) {
            std::vector<float> plane;
            for (std::size_t i = 0; i < picture.window.area(); ++i)
                plane.push_back(0.37f * static_cast<float>(c + 1) + 0.013f * static_cast<float>(i));
            planes.push_back(std::move(plane));
        }
        picture.r = planes[0];
        picture.g = planes[1];
        picture.b = planes[2];
        for (std::size_t c = 0; c < std::size(names); ++c) picture.more.push_back({names[c], planes[3 + c]});
        picture.chromaticities = Chromaticities::of(rgb::ap1);
        picture.half = in16Bits;
        picture.parts = parts;
        picture.attributes = {{"abbe.sensor", std::string("cie")},
                              {"cryptomatte/1234567/manifest", std::string("{}")},
                              {"spectralLayoutVersion", std::string("1.0")}};
    }
};

} // namespace

TEST_CASE("each layer is a part with its name, type and windows, and its values are those of a file in one part") {
    const TemporaryFolder folder;
    for (const bool in16Bits : {false, true}) {
        const Layers one(false, in16Bits), parts(true, in16Bits);
        writeExr(folder / "one.exr", one.picture);
        writeExr(folder / "parts.exr", parts.picture);
        {
            Imf::MultiPartInputFile file((folder / "parts.exr").c_str());
            std::vector<std::string> names;
            for (int i = 0; i < file.parts(); ++i) {
                const Imf::Header& header = file.header(i);
                names.push_back(header.name());
                CHECK(header.type() == Imf::SCANLINEIMAGE);
                CHECK(header.dataWindow() == file.header(0).dataWindow());
                CHECK(header.displayWindow() == file.header(0).displayWindow());
                CHECK(file.partComplete(i));
                CHECK((header.findTypedAttribute<Imf::StringAttribute>("abbe.sensor") != nullptr) == (i == 0));
                const bool matte = header.name().starts_with("Crypto");
                CHECK((header.findTypedAttribute<Imf::StringAttribute>("cryptomatte/1234567/manifest") != nullptr) ==
                      (i == 0 || matte));
            }
            CHECK(names == std::vector<std::string>{"beauty", "variance", "albedo", "half.albedo", "CryptoObject",
                                                    "CryptoMaterial", "S0"});
        }
        const ExrPlanes a = readExrChannels(folder / "one.exr"), b = readExrChannels(folder / "parts.exr");
        CHECK(a.info.parts == 1);
        CHECK(b.info.parts == 7);
        REQUIRE(a.values.size() == b.values.size());
        for (const ExrInfo::Channel& c : a.info.channels) {
            INFO(c.name);
            REQUIRE(b.find(c.name));
            CHECK(*a.find(c.name) == *b.find(c.name));
        }
        CHECK(readExr(folder / "parts.exr").rgb == readExr(folder / "one.exr").rgb);
        CHECK(readExrChannel(folder / "parts.exr", "CryptoObject02.A") == one.planes[9]);
    }
}

TEST_CASE("channels are appended to files with parts") {
    const TemporaryFolder folder;
    const Layers parts(true);
    const std::string path = folder / "x.exr";
    writeExr(path, parts.picture);
    const std::vector<float> more(parts.picture.window.area(), 7.f);
    const ExrChannel channel{"denoised.R", more};
    appendExr(path, path, {&channel, 1}, {});
    CHECK(readExrInfo(path).parts == 7);
    CHECK(readExrChannel(path, "denoised.R") == more);
    CHECK(readExrChannel(path, "albedo.G") == parts.planes[5]);
}

TEST_CASE("of other programs' files, short names are those of their parts, and other windows are left out") {
    const TemporaryFolder folder;
    const std::string path = folder / "x.exr";
    const Imath::Box2i window{{0, 0}, {1, 1}};
    const std::vector<float> values{1, 2, 3, 4}, others{5, 6, 7, 8};
    std::vector<Imf::Header> headers;
    for (const char* name : {"left", "right", "small"}) {
        Imf::Header header(window, name == std::string("small") ? Imath::Box2i{{0, 0}, {0, 0}} : window);
        header.setName(name);
        header.setType(Imf::SCANLINEIMAGE);
        header.channels().insert("Y", Imf::Channel(Imf::FLOAT));
        headers.push_back(header);
    }
    {
        Imf::MultiPartOutputFile file(path.c_str(), headers.data(), 3);
        for (int i = 0; i < 3; ++i) {
            Imf::OutputPart part(file, i);
            Imf::FrameBuffer buffer;
            const float* data = i == 0 ? values.data() : others.data();
            buffer.insert("Y", Imf::Slice::Make(Imf::FLOAT, data, headers[static_cast<std::size_t>(i)].dataWindow()));
            part.setFrameBuffer(buffer);
            part.writePixels(i == 2 ? 1 : 2);
        }
    }
    CHECK(readExrInfo(path).channelNames() == "Y right.Y");
    CHECK(readExrChannel(path, "Y") == values);
    CHECK(readExrChannel(path, "right.Y") == others);
}
