#include "io/file.h"
#include "io/png_writer.h"
#include "temporary_folder.h"

#include <cmath>
#include <cstdint>
#include <doctest/doctest.h>
#include <limits>
#include <png.h>

using namespace abbe;

namespace {

struct Chunk {
    std::string type, data;
};

std::uint32_t bigEndian(const std::string& s, std::size_t at) {
    std::uint32_t v = 0;
    for (std::size_t i = 0; i < 4; ++i) v = v << 8 | static_cast<unsigned char>(s[at + i]);
    return v;
}

std::vector<Chunk> chunksOf(const std::string& file) {
    REQUIRE(file.substr(0, 8) == "\x89PNG\r\n\x1a\n");
    std::vector<Chunk> chunks;
    for (std::size_t at = 8; at + 12 <= file.size();) {
        const std::uint32_t length = bigEndian(file, at);
        chunks.push_back({file.substr(at + 4, 4), file.substr(at + 8, length)});
        at += 12 + length;
    }
    return chunks;
}

// Samples row by row.
std::vector<int> readSamples(const std::string& path) {
    std::FILE* file = std::fopen(path.c_str(), "rb");
    REQUIRE(file);
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, nullptr, nullptr, nullptr);
    png_infop info = png_create_info_struct(png);
    png_init_io(png, file);
    png_read_png(png, info, PNG_TRANSFORM_IDENTITY, nullptr);
    const png_bytepp rows = png_get_rows(png, info);
    const bool wide = png_get_bit_depth(png, info) == 16;
    std::vector<int> samples;
    for (png_uint_32 y = 0; y < png_get_image_height(png, info); ++y)
        for (std::size_t i = 0; i < 3 * std::size_t{png_get_image_width(png, info)}; ++i)
            samples.push_back(wide ? rows[y][2 * i] << 8 | rows[y][2 * i + 1] : rows[y][i]);
    png_destroy_read_struct(&png, &info, nullptr);
    std::fclose(file);
    return samples;
}

const Chunk* find(const std::vector<Chunk>& chunks, const std::string& type) {
    for (const Chunk& c : chunks)
        if (c.type == type) return &c;
    return nullptr;
}

} // namespace

TEST_CASE("chunks of a PNG") {
    const TemporaryFolder folder;
    const std::vector<float> rgb(3 * 5 * 4, 0.5f);
    PngPicture p{.width = 5, .height = 4, .rgb = rgb, .texts = {{"Scene", "cornell.scene"}, {"View", "ACES é"}}};
    writePng(folder / "a.png", p);
    auto chunks = chunksOf(readAll(folder / "a.png"));
    const Chunk* head = find(chunks, "IHDR");
    REQUIRE(head);
    CHECK(bigEndian(head->data, 0) == 5);
    CHECK(bigEndian(head->data, 4) == 4);
    CHECK(head->data[8] == 8);
    CHECK(head->data[9] == 2); // RGB
    CHECK(find(chunks, "sRGB"));
    REQUIRE(find(chunks, "iTXt"));
    CHECK(find(chunks, "iTXt")->data.find("cornell.scene") != std::string::npos);
    CHECK(chunks.back().type == "IEND");

    p.bits = 16;
    p.srgb = false;
    p.texts.clear();
    writePng(folder / "a.png", p);
    chunks = chunksOf(readAll(folder / "a.png"));
    CHECK(find(chunks, "IHDR")->data[8] == 16);
    CHECK(!find(chunks, "sRGB"));
    CHECK(!find(chunks, "gAMA"));
    CHECK(folder.fileCount() == 1);
}

TEST_CASE("values are rounded and clamped, never wrapped") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.png";
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinity = std::numeric_limits<float>::infinity();
    const std::vector<float> rgb{0,   1,        0.5f,      -3,           1.04f, 100.4f / 255,
                                 nan, infinity, -infinity, 100.6f / 255, 1e30f, 0.25f};
    PngPicture p{.width = 2, .height = 2, .rgb = rgb, .texts = {}};
    writePng(path, p);
    CHECK(readSamples(path) == std::vector<int>{0, 255, 128, 0, 255, 100, 0, 255, 0, 101, 255, 64});
    p.bits = 16;
    writePng(path, p);
    const auto wide = readSamples(path);
    CHECK(wide[1] == 65535);
    CHECK(wide[2] == 32768);
    CHECK(wide[3] == 0);
    CHECK(wide[11] == 16384);
}

TEST_CASE("a PNG that cannot be written keeps the old one") {
    const TemporaryFolder folder;
    const std::vector<float> rgb(3, 0.5f);
    std::filesystem::create_directory(folder / "a.png");
    CHECK_THROWS_AS(writePng(folder / "a.png", {.width = 1, .height = 1, .rgb = rgb}), IoError);
    CHECK_THROWS_AS(writePng(folder / "absent/a.png", {.width = 1, .height = 1, .rgb = rgb}), IoError);
}
