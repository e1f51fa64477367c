// Files of measured scattering: what is read, and that a damaged one is an error with its place.
#include "io/file.h"
#include "io/tensor_file.h"
#include "scene/material_builder.h"
#include "scene_test_fixture.h"

#include <array>
#include <cstddef>
#include <cstdint>
#include <doctest/doctest.h>
#include <filesystem>
#include <fmt/format.h>
#include <numbers>
#include <string>
#include <string_view>
#include <unistd.h>

using namespace abbe;
using namespace abbe::test;

namespace {

const std::string kSmall = ABBE_SOURCE_DIR "/tests/snippets/any.bsdf"; // 3 angles, 2 wavelengths, squares of 4 × 4

struct BsdfFile {
    std::string path =
        (std::filesystem::temp_directory_path() / fmt::format("abbe_measured_{}.bsdf", ::getpid())).string();
    explicit BsdfFile(const std::string& bytes) { writeAtomically(path, bytes); }
    ~BsdfFile() { std::filesystem::remove(path); }

    std::string fault() const {
        try {
            readMeasured(path);
            return {};
        } catch (const IoError& e) {
            return e.what();
        }
    }
    bool says(std::string_view words) const { return fault().find(words) != std::string::npos; }
};

std::string replaced(std::string bytes, std::string_view from, std::string_view to) {
    return bytes.replace(bytes.find(from), from.size(), to);
}

// With three azimuths in place of one: the field's entry says so and where they are, which is at the end.
std::string withAzimuths(std::string bytes, std::array<float, 3> degrees) {
    const auto put = [&bytes](std::size_t place, std::uint64_t value) {
        for (std::size_t i = 0; i < 8; ++i) bytes[place + i] = static_cast<char>(value >> (8 * i));
    };
    const std::size_t entry = bytes.find("phi_i") + 5; // dimensions: 2 bytes, type: 1, offset and size: 8 each
    put(entry + 3, bytes.size());
    put(entry + 11, degrees.size());
    for (const float d : degrees) {
        const float radians = d * std::numbers::pi_v<float> / 180;
        bytes.append(reinterpret_cast<const char*>(&radians), sizeof radians);
    }
    return bytes;
}

} // namespace

TEST_CASE("measured files: sizes, angles and wavelengths" * doctest::test_suite("input")) {
    const MeasuredTables t = readMeasured(kSmall);
    CHECK(t.isotropic);
    CHECK(t.scalesByFacets);
    CHECK(t.theta.size() == 3);
    CHECK(t.wavelengths == std::vector<float>{400, 700});
    CHECK(t.side == 4);
    CHECK(t.spectra.size() == 3 * 2 * 4 * 4);
    CHECK(t.facets.rows == 4);
}

TEST_CASE("measured files: what is wrong is said" * doctest::test_suite("input")) {
    const std::string sound = readFileBytes(kSmall);
    for (std::size_t size = 0; size < sound.size(); size += 7) {
        const BsdfFile cut(sound.substr(0, size));
        REQUIRE_MESSAGE(cut.says("cannot read"), size, " bytes");
    }
    CHECK(BsdfFile(replaced(sound, "tensor_file", "tensor_fool")).says("no file of tensors"));
    CHECK(BsdfFile(replaced(sound, "sigma", "sagma")).says("no array `sigma`, but"));
    std::string colours = replaced(sound, "spectra", "spectrl");
    CHECK(BsdfFile(colours).says("no array `spectra`"));
    // The last angle, and a value that is none.
    const TensorFile file(sound, "sound.bsdf");
    const Tensor& angles = file["theta_i"];
    const auto place = sound.find(std::string(angles.bytes.substr(4, 8)));
    CHECK(BsdfFile(std::string(sound).replace(
                       place, 8, std::string(angles.bytes.substr(8, 4)) + std::string(angles.bytes.substr(4, 4))))
              .says("`theta_i` does not increase"));
    CHECK(BsdfFile(std::string(sound).replace(place, 4, "\xff\xff\xff\x7f")).says("not finite"));
}

TEST_CASE("measured files: azimuths are a circle, or the half or quarter of it to which the rest is turned") {
    const std::string sound = readFileBytes(kSmall);
    const auto says = [&sound](std::array<float, 3> degrees, std::string_view words) {
        return BsdfFile(withAzimuths(sound, degrees)).says(words);
    };
    for (const float last : {180.f, 0.f, -90.f}) // these are read, and the tables are then too few
        CHECK(says({-180, (last - 180) / 2, last}, "the size of `vndf` is not that of its angles"));
    CHECK(says({-180, -120, -60}, "`phi_i` goes from -180 to -60 degrees"));
    CHECK(says({0, 90, 180}, "`phi_i` goes from 0 to 180 degrees"));
    CHECK(says({-180, -90, 90}, "`phi_i` goes from -180 to 90 degrees"));
}

TEST_CASE("measured files: faults have a place in the scene, and whole ones scatter" * doctest::test_suite("input")) {
    const std::string shape = "shape quad { size 2 2; material m }\n";
    CHECK(codes(build("material m measured \"" + kSmall + "\" { scale 0.5 }\n" + shape)).empty());
    const BsdfFile cut(readFileBytes(kSmall).substr(0, 700));
    CHECK(codes(build("material m measured \"" + cut.path + "\"\n" + shape)) == "E0686");
}
