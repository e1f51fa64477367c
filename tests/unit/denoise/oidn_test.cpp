// `oidn` with a library of our own in its place (support/oidn_stub.cpp), so that no test needs Open Image Denoise.
#include "denoise/denoise.h"
#include "spectrum/color_space.h"
#include "synthetic_picture.h"
#include "unit/io/temporary_folder.h"

#include <algorithm>
#include <cstdlib>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <limits>
#include <sys/stat.h>

using namespace abbe;

namespace {

// A variable of the environment while this lives.
class Variable {
  public:
    Variable(const char* name, const std::string& value) : name_(name) { setenv(name, value.c_str(), 1); }
    ~Variable() { unsetenv(name_); }
    Variable(const Variable&) = delete;
    Variable& operator=(const Variable&) = delete;

  private:
    const char* name_;
};

DenoiserFault faultOf(const DenoiseInput& input) {
    try {
        denoise(input, DenoiseMethod::oidn);
    } catch (const DenoiserFault& fault) {
        return fault;
    }
    return {"none", "", ""};
}

DenoiserFault faultAt(const std::string& place) {
    const Variable library("ABBE_OIDN", place);
    const SyntheticPicture picture(16, 12, 0.3f);
    return faultOf(picture.input());
}

double largestDifference(const std::array<std::vector<float>, 3>& a, const std::array<std::vector<float>, 3>& b) {
    double largest = 0;
    for (std::size_t c = 0; c < 3; ++c)
        for (std::size_t i = 0; i < a[c].size(); ++i)
            largest = std::max(largest, static_cast<double>(std::abs(a[c][i] - b[c][i])));
    return largest;
}

bool contains(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

std::vector<std::string> linesOf(const std::string& path) {
    std::vector<std::string> lines;
    std::ifstream file(path);
    for (std::string line; std::getline(file, line);) lines.push_back(line);
    return lines;
}

} // namespace

TEST_CASE("oidn: what the library does not change comes back as it was, with its version") {
    const Variable library("ABBE_OIDN", ABBE_OIDN_STUB);
    const SyntheticPicture picture(96, 70, 0.3f);
    for (const bool features : {true, false}) {
        const DenoiseResult r = denoise(picture.input(features), DenoiseMethod::oidn);
        CHECK(largestDifference(r.colour, picture.mean) < 1e-5);
        CHECK(r.relMseAfter == doctest::Approx(r.relMseBefore).epsilon(1e-4));
        CHECK(r.outside == 0);
    }
    CHECK(name(DenoiseMethod::oidn) == "oidn");
    CHECK(version(DenoiseMethod::oidn) == "1 (Open Image Denoise 2.5.9, cpu)");
}

// The stub refuses light below 0, as the network takes none, so that a result with the negative parts of deep colours
// shows that nothing was cut off.
TEST_CASE("oidn: colours outside of Rec. 709 keep their negative parts") {
    const Variable library("ABBE_OIDN", ABBE_OIDN_STUB);
    SyntheticPicture picture(80, 72, 0.3f);
    for (auto* planes : {&picture.mean, &picture.half})
        for (std::size_t i = 0; i < 200; ++i) (*planes)[0][i] = (*planes)[2][i] = 0; // a green that only ACEScg has
    DenoiseInput input = picture.input();
    input.toRec709 = rgb::rec709.fromXyz() * rgb::ap1.toXyz();
    const DenoiseResult r = denoise(input, DenoiseMethod::oidn);
    CHECK(largestDifference(r.colour, picture.mean) < 1e-4);
    const auto green =
        std::count_if(picture.mean[1].begin(), picture.mean[1].begin() + 200, [](float v) { return v > 0; });
    CHECK(r.outside >= static_cast<std::uint64_t>(green));
    CHECK(r.outside < picture.size());
}

TEST_CASE("oidn: the estimated error is the error") {
    const Variable library("ABBE_OIDN", ABBE_OIDN_STUB), mode("OIDN_STUB", "blur");
    double after = 0, estimated = 0, pixels = 0;
    for (unsigned seed = 1; seed <= 6; ++seed) {
        SyntheticPicture picture(112, 96, 0.4f, seed);
        picture.repaint( // small squares: what is left is noise and blur
            [](int x, int y) {
                const float light = (x / 4 + y / 4) % 2 == 0 ? 0.5f : 0.6f;
                return std::pair(0.5f, light);
            },
            0.4f);
        const DenoiseResult r = denoise(picture.input(), DenoiseMethod::oidn);
        after += picture.relMse(r.colour);
        estimated += r.relMseAfter;
        pixels += picture.relMse(r.error);
    }
    MESSAGE("after " << after << " ~ " << estimated << " ~ " << pixels);
    CHECK(estimated / after == doctest::Approx(1).epsilon(0.08));
    CHECK(pixels / estimated == doctest::Approx(1).epsilon(0.05));
}

// As the network does it with light of a thousand times what is around, a pixel or two wide.
TEST_CASE("oidn: where it is certain that the picture is ruined, it stays as it is") {
    const Variable library("ABBE_OIDN", ABBE_OIDN_STUB), mode("OIDN_STUB", "spill");
    const SyntheticPicture picture(96, 70, 0.3f);
    const DenoiseResult r = denoise(picture.input(), DenoiseMethod::oidn);
    CHECK(picture.relMse(r.colour) < 3 * picture.relMse(picture.mean));
    CHECK(r.relMseAfter < 3 * r.relMseBefore);
    const DenoiseResult look = denoise(picture.input(), DenoiseMethod::oidn, DenoiseEffort::look);
    CHECK(picture.relMse(look.colour) > 100 * picture.relMse(picture.mean));
}

TEST_CASE("oidn: each half is denoised with its own features, and these are denoised before") {
    const TemporaryFolder folder;
    const Variable library("ABBE_OIDN", ABBE_OIDN_STUB), log("OIDN_STUB_LOG", folder / "log");
    const SyntheticPicture picture(96, 70, 0.3f);
    denoise(picture.input(), DenoiseMethod::oidn);
    const auto lines = linesOf(folder / "log");
    REQUIRE(lines.size() == 9);
    for (std::size_t i = 0; i < lines.size(); i += 3) {
        CHECK(lines[i].starts_with("albedo 96x70 output 96x70 "));
        CHECK(lines[i + 1].starts_with("normal 96x70 output 96x70 "));
        CHECK(lines[i + 2].starts_with("albedo 96x70 color 96x70 normal 96x70 output 96x70 cleanAux=1 hdr=1 "
                                       "inputScale=1 maxMemoryMB="));
        CHECK(contains(lines[i + 2], " quality=6"));
    }
}

TEST_CASE("oidn: a look is one run, and estimates nothing") {
    const TemporaryFolder folder;
    const Variable library("ABBE_OIDN", ABBE_OIDN_STUB), log("OIDN_STUB_LOG", folder / "log");
    const SyntheticPicture picture(96, 70, 0.3f);
    const DenoiseResult r = denoise(picture.input(), DenoiseMethod::oidn, DenoiseEffort::look);
    CHECK(largestDifference(r.colour, picture.mean) < 1e-5);
    CHECK(r.error.empty());
    const auto lines = linesOf(folder / "log");
    REQUIRE(lines.size() == 1);
    CHECK(!contains(lines[0], "cleanAux"));
    CHECK(contains(lines[0], " quality=4"));
}

// A network makes something else of a picture that it cannot see the surroundings of.
TEST_CASE("oidn: small pictures are extended, and come back in their size") {
    const TemporaryFolder folder;
    const Variable library("ABBE_OIDN", ABBE_OIDN_STUB);
    for (const auto& [width, height] : {std::pair{1, 1}, {2, 3}, {70, 1}, {1, 70}, {63, 64}}) {
        const SyntheticPicture picture(width, height, 0.3f);
        const std::string path = folder / (std::to_string(width) + "x" + std::to_string(height));
        const Variable log("OIDN_STUB_LOG", path);
        const DenoiseResult r = denoise(picture.input(), DenoiseMethod::oidn);
        CHECK(r.colour[0].size() == picture.size());
        CHECK(largestDifference(r.colour, picture.mean) < 1e-4);
        const auto lines = linesOf(path);
        REQUIRE(!lines.empty());
        const int w = width < 64 ? width + 64 : width, h = height < 64 ? height + 64 : height;
        CHECK(contains(lines.back(), "color " + std::to_string(w) + "x" + std::to_string(h)));
    }
}

TEST_CASE("oidn: pixels that are not finite are replaced, black and very bright pictures are fine") {
    const Variable library("ABBE_OIDN", ABBE_OIDN_STUB);
    SyntheticPicture picture(80, 70, 0.2f);
    const float infinity = std::numeric_limits<float>::infinity();
    picture.mean[0][500] = infinity;
    picture.half[1][900] = std::numeric_limits<float>::quiet_NaN();
    picture.noisyAlbedo[0][34] = 2e9f;
    picture.halfAlbedo[0][35] = -infinity;
    picture.normal[2][36] = infinity;
    const DenoiseResult r = denoise(picture.input(), DenoiseMethod::oidn);
    CHECK(r.repaired == 2);
    for (const auto& plane : r.colour)
        CHECK(std::all_of(plane.begin(), plane.end(), [](float v) { return std::isfinite(v); }));
    for (const float value : {0.f, 3e7f}) {
        SyntheticPicture flat(70, 66, 0.2f);
        for (auto* planes : {&flat.mean, &flat.half})
            for (auto& plane : *planes) std::fill(plane.begin(), plane.end(), value);
        const DenoiseResult same = denoise(flat.input(), DenoiseMethod::oidn);
        CHECK(largestDifference(same.colour, flat.mean) <= 1e-5 * static_cast<double>(value));
        CHECK(same.relMseAfter < 1e-8);
    }
}

TEST_CASE("oidn: what the library complains about is said, with what can be done") {
    const SyntheticPicture picture(70, 66, 0.3f);
    const Variable library("ABBE_OIDN", ABBE_OIDN_STUB);
    struct Case {
        const char *mode, *text, *help;
    };
    for (const Case& c : {Case{"commit", "2.5.9 failed: the filter does not like it", "--method nfor"},
                          {"memory", "out of memory", "end other programs"},
                          {"unsupported", "SSE4.1 support is required", "needs a processor with SSE4.1"},
                          {"nan", "made pixels that are not finite", "--method nfor"}}) {
        CAPTURE(c.mode);
        const Variable mode("OIDN_STUB", c.mode);
        const DenoiserFault fault = faultOf(picture.input());
        CHECK(fault.code == "E0444");
        CHECK(contains(fault.what(), c.text));
        CHECK(contains(fault.help, c.help));
    }
    CHECK(faultOf(picture.input()).code == "none"); // and works again
}

TEST_CASE("oidn: the library is where $ABBE_OIDN says: a file, its folder, an environment of Python") {
    namespace fs = std::filesystem;
    const TemporaryFolder folder;
    const std::string file = "libOpenImageDenoise.so.2";
    for (const char* below : {"a", "b/lib", "c/lib/python3.11/site-packages/pyoidn/oidn/lib"}) {
        fs::create_directories(fs::path(folder / below));
        fs::copy_file(ABBE_OIDN_STUB, fs::path(folder / below) / file);
    }
    for (const char* place : {"a", "b", "c", "a/libOpenImageDenoise.so.2"})
        CHECK(faultAt(folder / place).code == "none");
    const Variable environment("VIRTUAL_ENV", folder / "c"); // unless the system has one
    CHECK_NOTHROW(version(DenoiseMethod::oidn));
}

TEST_CASE("oidn: a library that is not there or is no such library") {
    const TemporaryFolder folder;
    const DenoiserFault absent = faultAt(folder / "absent");
    CHECK(absent.code == "E0442");
    CHECK(contains(absent.what(), "no such file or folder"));
    CHECK(contains(absent.help, "--method nfor"));
    const DenoiserFault empty = faultAt(folder / ".");
    CHECK(empty.code == "E0442");
    CHECK(contains(empty.what(), "there is no libOpenImageDenoise.so.2 in or below it"));
    std::ofstream(folder / "text") << "not a library";
    CHECK(faultAt(folder / "text").code == "E0443");
    const DenoiserFault other = faultAt("/lib/x86_64-linux-gnu/libm.so.6");
    CHECK(other.code == "E0443");
    CHECK(contains(other.what(), "has no `oidnNewDevice`"));
    // Opened, it would wait for a writer.
    mkfifo((folder / "pipe").c_str(), 0600);
    CHECK(faultAt(folder / "pipe").code == "E0442");
    for (const auto& [mode, text] :
         {std::pair{"old", "it is version 1.4.3, not 2"}, {"no-device", "unsupported device"}}) {
        const std::string copy = folder / mode; // a library is looked at once
        std::filesystem::copy_file(ABBE_OIDN_STUB, copy);
        const Variable set("OIDN_STUB", mode);
        const DenoiserFault fault = faultAt(copy);
        CHECK(fault.code == "E0443");
        CHECK(contains(fault.what(), text));
    }
}
