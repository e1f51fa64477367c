#include "io/exr_deep.h"
#include "io/exr_reader.h"
#include "io/file.h"
#include "temporary_folder.h"

#include <OpenEXR/ImfDeepScanLineInputFile.h>
#include <OpenEXR/ImfHeader.h>
#include <OpenEXR/ImfTestFile.h>
#include <doctest/doctest.h>
#include <fstream>

using namespace abbe;

namespace {

// Pixels with no samples, one, and several; a window that is not at the origin.
DeepPicture someSamples() {
    DeepPicture p;
    p.window = {-2, 5, 1, 7};
    p.display = {0, 0, 8, 8};
    p.counts = {0, 1, 3, 2, 0, 1};
    for (int i = 0; i < 7; ++i) {
        const auto f = static_cast<float>(i);
        p.z.push_back(1 + f);
        p.zBack.push_back(1.5f + f);
        p.a.push_back(0.125f * (f + 1));
        p.r.push_back(f);
        p.g.push_back(10 * f);
        p.b.push_back(1e5f * f);
    }
    p.chromaticities = Chromaticities::of(rgb::ap1);
    p.attributes = {{"abbe.sensor", std::string("cie")}};
    return p;
}

} // namespace

TEST_CASE("deep samples come back from a file, which OpenEXR's own reader takes for deep scan lines") {
    const TemporaryFolder folder;
    const std::string path = folder / "x.deep.exr";
    const DeepPicture p = someSamples();
    writeDeepExr(path, p);
    const DeepPicture back = readDeepExr(path);
    CHECK(back.window == p.window);
    CHECK(back.display == p.display);
    CHECK(back.counts == p.counts);
    CHECK(back.z == p.z);
    CHECK(back.zBack == p.zBack);
    CHECK(back.a == p.a);
    CHECK(back.r == p.r);
    CHECK(back.g == p.g);
    CHECK(back.b == p.b);

    bool deep = false, tiled = true, multiPart = true;
    CHECK(Imf::isOpenExrFile(path.c_str(), tiled, deep, multiPart));
    CHECK(deep);
    CHECK_FALSE(tiled);
    CHECK_FALSE(multiPart);
    const Imf::DeepScanLineInputFile file(path.c_str(), 1);
    CHECK(file.isComplete());
    CHECK(file.header().type() == "deepscanline");
    const ExrInfo info = readExrInfo(path);
    CHECK(info.channelNames() == "A B G R Z ZBack");
    CHECK_THROWS_AS(readExrChannels(path), IoError);
}

TEST_CASE("flattening puts the samples of a pixel over each other") {
    const FlatPicture flat = flatten(someSamples());
    CHECK(flat.a[0] == 0);
    CHECK(flat.r[0] == 0);
    // Samples 1, 2, 3 of the third pixel: r 1, 2, 3 and a 1/4, 3/8, 1/2.
    CHECK(flat.r[2] == doctest::Approx(1 + 0.75 * 2 + 0.75 * 0.625 * 3));
    CHECK(flat.a[2] == doctest::Approx(1 - 0.75 * 0.625 * 0.5));
    CHECK(flat.g[5] == 60);
}

TEST_CASE("what is no deep file is refused with its name") {
    const TemporaryFolder folder;
    const std::string path = folder / "flat.exr";
    const std::vector<float> values(4, 1.f);
    ExrPicture flat;
    flat.window = flat.display = {0, 0, 2, 2};
    flat.r = flat.g = flat.b = values;
    flat.chromaticities = Chromaticities::of(rgb::ap1);
    writeExr(path, flat);
    CHECK_THROWS_WITH_AS(readDeepExr(path), doctest::Contains("no deep scan lines"), IoError);
    CHECK_THROWS_AS(readDeepExr(folder / "none.exr"), IoError);
    writeDeepExr(path, someSamples());
    std::string bytes;
    {
        std::ifstream in(path, std::ios::binary);
        bytes.assign(std::istreambuf_iterator<char>(in), {});
    }
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size() * 2 / 3));
    CHECK_THROWS_AS(readDeepExr(path), IoError);
}
