#include "io/exr_reader.h"
#include "io/file.h"
#include "temporary_folder.h"

#include <Imath/half.h>
#include <OpenEXR/ImfChannelList.h>
#include <OpenEXR/ImfFrameBuffer.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfOutputFile.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <doctest/doctest.h>
#include <limits>
#include <random>

using namespace abbe;

namespace {

constexpr int kChannelWidth = 38, kChannelHeight = 22, kLeft = 6, kTop = -4;

// One channel of each type over a window whose corner is not the origin; scan lines or tiles.
struct MixedFile {
    std::vector<float> floats;
    std::vector<Imath::half> halves;
    std::vector<unsigned> integers;

    MixedFile() {
        for (int i = 0; i < kChannelWidth * kChannelHeight; ++i) {
            floats.push_back(0.1f * static_cast<float>(i) - 7);
            halves.emplace_back(0.25f * static_cast<float>(i));
            integers.push_back(static_cast<unsigned>(i * 1001));
        }
        floats[3] = std::numeric_limits<float>::infinity();
    }

    void write(const std::string& path, bool tiles, int sampling = 1) {
        const Imath::Box2i window{{kLeft, kTop}, {kLeft + kChannelWidth - 1, kTop + kChannelHeight - 1}};
        Imf::Header header(Imath::Box2i{{0, 0}, {99, 49}}, window);
        Imf::FrameBuffer buffer;
        const auto add = [&](const char* name, Imf::PixelType type, const void* values, std::size_t bytes) {
            header.channels().insert(name, Imf::Channel(type, sampling, sampling));
            buffer.insert(name,
                          Imf::Slice::Make(type, values, window, bytes, bytes * kChannelWidth, sampling, sampling));
        };
        add("depth.Z", Imf::FLOAT, floats.data(), 4);
        add("half.albedo.R", Imf::HALF, halves.data(), 2);
        add("object.id", Imf::UINT, integers.data(), 4);
        if (tiles) {
            header.setTileDescription({8, 8});
            Imf::TiledOutputFile file(path.c_str(), header);
            file.setFrameBuffer(buffer);
            file.writeTiles(0, file.numXTiles() - 1, 0, file.numYTiles() - 1);
        } else {
            Imf::OutputFile file(path.c_str(), header);
            file.setFrameBuffer(buffer);
            file.writePixels(kChannelHeight);
        }
    }
};

} // namespace

TEST_CASE("every channel of an EXR is read by its name, whatever its type") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    MixedFile file;
    for (const bool tiles : {false, true}) {
        file.write(path, tiles);
        const ExrPlanes planes = readExrChannels(path);
        CHECK(planes.info.window == PixelWindow{kLeft, kTop, kLeft + kChannelWidth, kTop + kChannelHeight});
        CHECK(planes.info.display == PixelWindow{0, 0, 100, 50});
        CHECK(planes.info.parts == 1);
        CHECK(planes.info.channelNames() == "depth.Z half.albedo.R object.id");
        CHECK(planes.info.has("object.id"));
        CHECK(!planes.info.has("object"));
        REQUIRE(planes.find("depth.Z"));
        CHECK(*planes.find("depth.Z") == file.floats);
        const auto &halves = *planes.find("half.albedo.R"), &integers = *planes.find("object.id");
        int wrong = 0;
        for (std::size_t i = 0; i < file.halves.size(); ++i)
            wrong += halves[i] != file.halves[i] || integers[i] != static_cast<float>(file.integers[i]);
        CHECK(wrong == 0);
        CHECK(!planes.find("R"));
    }
}

TEST_CASE("channels that are not wanted are not read") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    MixedFile().write(path, false);
    const ExrPlanes planes = readExrChannels(path, [](std::string_view name) { return name.ends_with(".Z"); });
    CHECK(planes.find("depth.Z"));
    CHECK(!planes.find("object.id"));
    CHECK(planes.info.channels.size() == 3);
    CHECK(!readExrChannels(path, [](std::string_view) { return false; }).find("depth.Z"));
    CHECK(readExrChannel(path, "object.id").size() == kChannelWidth * kChannelHeight);
    CHECK_THROWS_WITH_AS(readExrChannel(path, "R"), doctest::Contains("only depth.Z half.albedo.R object.id"), IoError);
}

TEST_CASE("channels of damaged, absent and unsuitable files are errors") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr", bad = folder / "bad.exr";
    CHECK_THROWS_AS(readExrChannels(folder / "absent.exr"), IoError);
    MixedFile file;
    file.write(path, false, 2);
    CHECK_THROWS_WITH_AS(readExrChannels(path), doctest::Contains("lower resolution"), IoError);
    std::mt19937 random(7);
    for (const bool tiles : {false, true}) {
        file.write(path, tiles);
        const std::string bytes = readAll(path);
        for (const std::size_t length : {std::size_t{0}, std::size_t{10}, std::size_t{300}, bytes.size() - 20}) {
            writeAll(bad, bytes.substr(0, length));
            CHECK_THROWS_AS(readExrChannels(bad), IoError);
        }
        for (int i = 0; i < 100; ++i) { // ends, well or with an IoError
            std::string damaged = bytes;
            for (int k = 0; k < 8; ++k) damaged[random() % 600] = static_cast<char>(random());
            writeAll(bad, damaged);
            try {
                readExrChannels(bad);
            } catch (const IoError&) {
            }
        }
    }
}
