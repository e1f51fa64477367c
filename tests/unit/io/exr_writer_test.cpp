#include "io/exr_reader.h"
#include "io/exr_writer.h"
#include "io/file.h"
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
#include <OpenEXR/ImfStringAttribute.h>
#include <OpenEXR/ImfTiledOutputFile.h>
#include <algorithm>
#include <cmath>
#include <csignal>
#include <doctest/doctest.h>
#include <limits>
#include <random>
#include <sys/resource.h>

using namespace abbe;

namespace {

// Three planes of a small picture and a description that refers to them.
struct TestPicture {
    std::vector<float> r, g, b, variance;
    ExrPicture picture;

    explicit TestPicture(PixelWindow window, PixelWindow display) {
        std::mt19937 random(1);
        std::lognormal_distribution<float> values(0, 3);
        for (auto* plane : {&r, &g, &b, &variance})
            for (std::size_t i = 0; i < window.area(); ++i) plane->push_back(values(random) - 0.1f);
        picture.window = window;
        picture.display = display;
        picture.r = r;
        picture.g = g;
        picture.b = b;
        picture.chromaticities = Chromaticities::of(rgb::ap0);
    }
    TestPicture(int width, int height) : TestPicture({0, 0, width, height}, {0, 0, width, height}) {}
};

bool sameValues(const RgbImage& image, const TestPicture& t) {
    if (image.rgb.size() != 3 * t.r.size()) return false;
    for (std::size_t i = 0; i < t.r.size(); ++i)
        if (image.rgb[3 * i] != t.r[i] || image.rgb[3 * i + 1] != t.g[i] || image.rgb[3 * i + 2] != t.b[i])
            return false;
    return true;
}

const ImageAttribute* findAttribute(const ExrInfo& info, const std::string& name) {
    const auto found = std::find_if(info.attributes.begin(), info.attributes.end(),
                                    [&](const ImageAttribute& a) { return a.name == name; });
    return found == info.attributes.end() ? nullptr : &*found;
}

template <typename T> T attribute(const ExrInfo& info, const std::string& name) {
    const ImageAttribute* a = findAttribute(info, name);
    REQUIRE(a);
    return std::get<T>(a->value);
}

bool failsToRead(const std::string& path) {
    try {
        readExr(path);
        return false;
    } catch (const IoError&) {
        return true;
    }
}

} // namespace

TEST_CASE("float pictures come back bit for bit with every lossless compression") {
    const TemporaryFolder folder;
    TestPicture t(53, 37);
    t.r[5] = 1e9f;
    t.g[6] = -1e-5f;
    t.b[7] = 1e-30f;
    for (const char* word : {"none", "rle", "zips", "zip", "piz"}) {
        t.picture.compression = *findExrCompression(word);
        const std::string path = folder / "a.exr";
        const ExrReport report = writeExr(path, t.picture);
        CHECK(report.halfOverflows == 0);
        const RgbImage image = readImage(path);
        CHECK(sameValues(image, t));
        CHECK(image.chromaticities->matches(rgb::ap0));
        CHECK(image.chromaticities->space().name == rgb::ap0.name);
        CHECK(readExrInfo(path).compression == word);
        CHECK(folder.fileCount() == 1);
    }
    for (const char* word : {"pxr24", "dwaa", "dwab"}) CHECK(name(*findExrCompression(word)) == word);
    CHECK(!findExrCompression("jpeg"));
}

TEST_CASE("crops, channels and attributes are in the header") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    TestPicture t({10, 20, 40, 33}, {0, 0, 100, 50});
    t.picture.chromaticities = Chromaticities::of(rgb::ap1);
    t.picture.more.push_back({"variance.Y", t.variance});
    t.picture.attributes = {
        {"abbe.scene", std::string("cornell.scene é")}, {"abbe.samples", 64}, {"abbe.seconds", 1.25}};
    writeExr(path, t.picture);

    const RgbImage image = readExr(path);
    CHECK(image.window == t.picture.window);
    CHECK(image.display == t.picture.display);
    CHECK(sameValues(image, t));
    CHECK(readExrChannel(path, "variance.Y") == t.variance);
    CHECK_THROWS_AS(readExrChannel(path, "depth"), IoError);

    const ExrInfo info = readExrInfo(path);
    CHECK(info.window == t.picture.window);
    CHECK(info.channels.size() == 4);
    CHECK(info.channels.back().name == "variance.Y");
    CHECK(info.channels.back().type == "float");
    CHECK(info.chromaticities->matches(rgb::ap1));
    CHECK(attribute<std::string>(info, "abbe.scene") == "cornell.scene é");
    CHECK(attribute<int>(info, "abbe.samples") == 64);
    CHECK(attribute<double>(info, "abbe.seconds") == 1.25);
}

TEST_CASE("pictures of one pixel and of one long row") {
    const TemporaryFolder folder;
    for (const auto& t : {TestPicture(1, 1), TestPicture(32768, 1), TestPicture(1, 5000)}) {
        writeExr(folder / "a.exr", t.picture);
        CHECK(sameValues(readExr(folder / "a.exr"), t));
    }
}

TEST_CASE("half counts what it cannot hold") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    TestPicture t(8, 8);
    std::fill(t.r.begin(), t.r.end(), 0.5f);
    std::fill(t.g.begin(), t.g.end(), 0.25f);
    std::fill(t.b.begin(), t.b.end(), 0.f);
    t.r[0] = 70000;
    t.r[1] = -1e9f;
    t.r[2] = 65504;
    t.g[0] = 1e-9f;
    t.b[0] = std::numeric_limits<float>::infinity();
    t.picture.half = true;
    const ExrReport report = writeExr(path, t.picture);
    CHECK(report.halfOverflows == 2);
    CHECK(report.halfUnderflows == 1);
    const RgbImage image = readExr(path);
    CHECK(image.rgb[0] == 65504);
    CHECK(image.rgb[3] == -65504);
    CHECK(image.rgb[6] == 65504);
    CHECK(image.rgb[9] == 0.5f);
    CHECK(image.nonFinite == 1);
    CHECK(image.negative == 1);
    CHECK(readExrInfo(path).channels[0].type == "half");
}

TEST_CASE("the neutral colour and the identifier of the space come back") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    TestPicture t(2, 2);
    writeExr(path, t.picture);
    CHECK(readImage(path).adoptedNeutral->x == 0.32168f); // the white, if nothing else is said
    CHECK(readImage(path).interopId.empty());
    t.picture.chromaticities = Chromaticities::of(rgb::xyz);
    t.picture.adoptedNeutral = rgb::rec709.white;
    t.picture.attributes = {{"colorInteropID", std::string(rgb::xyz.name)}};
    writeExr(path, t.picture);
    const RgbImage image = readImage(path);
    CHECK(image.adoptedNeutral->x == 0.3127f);
    CHECK(image.adoptedNeutral->y == 0.329f);
    CHECK(image.interopId == "lin_ciexyzd65_scene");
    CHECK(image.chromaticities->space().name == image.interopId);
    CHECK(sameValues(image, t));
}

TEST_CASE("a write that fails says why and keeps the old picture") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    writeAll(path, "old");
    const TestPicture t(200, 200);
    rlimit old{};
    ::getrlimit(RLIMIT_FSIZE, &old);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    // Room for the header's beginning, and for some of the pixels.
    for (const rlim_t bytes : {100, 20000}) {
        const rlimit limit{bytes, old.rlim_max};
        ::setrlimit(RLIMIT_FSIZE, &limit);
        CHECK_THROWS_WITH_AS(writeExr(path, t.picture), doctest::Contains("File too large"), IoError);
        ::setrlimit(RLIMIT_FSIZE, &old);
        CHECK(readAll(path) == "old");
        CHECK(folder.fileCount() == 1);
    }
    std::signal(SIGXFSZ, handler);
    CHECK_THROWS_WITH_AS(writeExr(folder / "absent/a.exr", t.picture), doctest::Contains("No such file"), IoError);
}

TEST_CASE("damaged and unsuitable files are errors, never crashes") {
    const TemporaryFolder folder;
    const std::string good = folder / "good.exr", bad = folder / "bad.exr";
    CHECK(failsToRead(folder / "absent.exr"));
    const TestPicture t(64, 64);
    writeExr(good, t.picture);
    const std::string bytes = readAll(good);
    for (const std::size_t length : {0, 3, 4, 60, 400, 2000}) {
        writeAll(bad, bytes.substr(0, length));
        CHECK_THROWS_AS(readImage(bad), IoError);
    }
    writeAll(bad, bytes.substr(0, bytes.size() - 10));
    CHECK(failsToRead(bad));
    std::mt19937 random(2);
    int errors = 0;
    for (int i = 0; i < 200; ++i) {
        std::string damaged = bytes;
        for (int k = 0; k < 8; ++k) damaged[random() % 600] = static_cast<char>(random());
        writeAll(bad, damaged);
        errors += failsToRead(bad);
    }
    CHECK(errors > 150);
    writeAll(bad, "not an image at all");
    CHECK_THROWS_WITH_AS(readImage(bad), doctest::Contains("neither OpenEXR nor Radiance"), IoError);
    CHECK_THROWS_WITH_AS(readImage(folder / ""), doctest::Contains("directory"), IoError);
}

TEST_CASE("a header that claims a huge picture takes no memory") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    writeExr(path, TestPicture(16, 16).picture);
    std::string bytes = readAll(path);
    const std::size_t at = bytes.find("dataWindow");
    REQUIRE(at != std::string::npos);
    // name \0 box2i \0 size, then xMin yMin xMax yMax.
    const std::size_t corner = at + sizeof "dataWindow" + sizeof "box2i" + 4 + 8;
    for (int i = 0; i < 2; ++i)
        bytes.replace(corner + 4 * static_cast<std::size_t>(i), 4, std::string("\xff\xff\xff\x0f", 4));
    writeAll(path, bytes);
    CHECK(failsToRead(path));
}

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

// Files with a part for each layer.

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

TEST_CASE("rows that are made while others are written are the picture's, and their faults come out") {
    const TemporaryFolder folder;
    const std::string path = folder / "x.exr";
    constexpr int kHeight = 40 * kExrRows + 3;
    TestPicture test({0, 0, 5, kHeight}, {0, 0, 5, kHeight});
    const std::vector<float> whole = test.variance;
    test.picture.more = {{"depth.Z", {}}};
    std::vector<float> held[2]; // as long as they are promised to be
    int calls = 0, failing = -1;
    const ExrRows rows = [&](int y0, int y1) {
        if (calls == failing) throw std::out_of_range("no more rows");
        std::vector<float>& here = held[calls++ % 2];
        here.assign(whole.begin() + 5 * y0, whole.begin() + 5 * y1);
        return std::vector<std::span<const float>>{here};
    };
    writeExr(path, test.picture, rows);
    CHECK(readExrChannel(path, "depth.Z") == whole);
    for (failing = 0; failing < 2; ++failing) {
        calls = 0;
        CHECK_THROWS_AS(writeExr(path, test.picture, rows), std::out_of_range);
        CHECK(readExrChannel(path, "depth.Z") == whole); // the older file
    }
}
