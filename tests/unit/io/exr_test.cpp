#include "io/exr_reader.h"
#include "io/exr_writer.h"
#include "io/io_error.h"
#include "temporary_folder.h"

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
