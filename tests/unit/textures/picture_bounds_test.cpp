// Pictures whose header promises more than the file or the memory can hold, before anything is decoded.
#include "io/png_writer.h"
#include "support/cpu_time.h"
#include "support/exr_bytes.h"
#include "support/memory_scope.h"
#include "support/picture_file.h"
#include "textures/image_texture.h"

#include <doctest/doctest.h>
#include <sys/stat.h>

using namespace abbe;
namespace fs = std::filesystem;

namespace {

constexpr double kSoon = 2; // seconds; each takes milliseconds

struct Bounds {
    abbe_test::TemporaryFolder folder;

    std::string write(const std::string& name, const std::string& bytes) const {
        std::ofstream(folder.path / name, std::ios::binary) << bytes;
        return (folder.path / name).string();
    }
    // Codes of what is said of a texture, which is made ready as before a render.
    std::string codes(const std::string& path, TextureUse use = TextureUse::number) const {
        TextureStoreSettings settings;
        settings.directory = folder.path / "cache";
        ImageTextureParams params;
        params.file.value = path;
        params.file.keys.emplace_back("space", "data");
        Diagnostics diagnostics;
        CHECK(test::cpuSecondsOf([&] {
                  auto made = makeImageTexture(params, std::make_shared<TextureStore>(settings), diagnostics);
                  if (made) made->prepare(use, {}, diagnostics);
              }) < kSoon);
        std::string all;
        for (const Diagnostic& d : diagnostics.all()) all += d.code + ": " + d.message + " " + d.label + "\n";
        return all;
    }
};

bool says(const std::string& text, const std::string& part) {
    const bool found = text.find(part) != std::string::npos;
    if (!found) MESSAGE("expected: ", part, ", said: ", text);
    return found;
}

// A PNG of one colour, 16384 by 256: 12 MiB as stored, in a few kilobytes.
std::string longPng(const Bounds& b) {
    const std::vector<float> rgb(3 * 16384 * 256, 0.25f);
    PngPicture png;
    png.width = 16384;
    png.height = 256;
    png.rgb = rgb;
    const auto path = (b.folder.path / "long.png").string();
    writePng(path, png);
    return path;
}

} // namespace

TEST_CASE("pictures: pipes and devices") {
    const Bounds b;
    const std::string fifo = (b.folder.path / "fifo.png").string();
    REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
    CHECK(says(b.codes(fifo), "E0402: `fifo.png`: it is not a regular file"));
    CHECK(says(b.codes("/dev/zero"), "E0402: `zero`: it is not a regular file"));
}

TEST_CASE("pictures: tiny OpenEXR files of many pixels") {
    const Bounds b;
    abbe_test::ExrBytes exr;
    exr.rest.assign(100, '\0');
    for (const int compression : {0, 3, 9})
        for (const std::uint32_t tile : {0u, 16384u}) {
            exr.compression = compression;
            exr.window = {0, 0, 16383, 16383};
            exr.tile = {tile, tile};
            CHECK(says(b.codes(b.write("a.exr", exr.bytes())), "cannot be in"));
            exr.window = {0, 0, 0, 2147483646};
            exr.tile = {tile, tile};
            CHECK(says(b.codes(b.write("a.exr", exr.bytes())), "are too many"));
        }
}

TEST_CASE("pictures: tiny files of other formats and many pixels") {
    const Bounds b;
    std::string head = "\x89PNG\r\n\x1a\n";
    const auto chunk = [&](const char* name, const std::string& data, const char* crc) {
        for (int shift = 24; shift >= 0; shift -= 8) head += static_cast<char>(data.size() >> shift);
        head += name + data + std::string(crc, 4);
    };
    // 65536 by 65536 of 16 bits, with their right checksum.
    chunk("IHDR", std::string("\0\1\0\0\0\1\0\0\x10\2\0\0\0", 13), "\xb3\x76\x7b\xf7");
    const std::string said = b.codes(b.write("a.png", head + std::string(64, '\0')));
    CHECK(says(said, "E0402"));
    abbe_test::writePicture(b.folder.path / "a.tif", {64, 64, 1, 1});
    std::string tiff;
    {
        std::ifstream in(b.folder.path / "a.tif", std::ios::binary);
        tiff.assign(std::istreambuf_iterator<char>(in), {});
    }
    // The first two fields of its directory, width and height, are the same number.
    const std::size_t directory = 8 + 64 * 64;
    for (const std::size_t at : {directory + 2 + 8, directory + 14 + 8})
        tiff.replace(at, 4, std::string("\0\0\1\0", 4));
    CHECK(says(b.codes(b.write("b.tif", tiff)), "65536 by 65536 pixels cannot be in"));
    CHECK(says(b.codes(b.write("a.ppm", "P6\n60000 60000\n255\n123456789012")), "60000 by 60000 pixels cannot be in"));
    CHECK(
        says(b.codes(b.write("a.hdr", "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 60000 +X 60000\n\2\2\2\2")), "E0402"));
}

TEST_CASE("pictures: more than the memory that is left") {
    const Bounds b;
    const std::string path = longPng(b);
    CHECK(fs::file_size(path) < 100'000);
    CHECK(b.codes(path, TextureUse::heights) == "");
    CHECK(b.codes(path) == "");
    {
        const test::MemoryScope left(60 << 20); // the whole picture as floats takes 48 MiB, and again as stored
        CHECK(says(b.codes(path, TextureUse::heights), "E0404: `long.png` does not fit into memory it takes 96 MiB"));
        CHECK(b.codes(path) == ""); // from the cache
    }
    fs::remove_all(b.folder.path / "cache");
    const test::MemoryScope left(4 << 20); // not even a band of rows
    CHECK(says(b.codes(path), "E0404: `long.png` does not fit into memory to read it takes"));
    CHECK(b.codes(path).find("W0452") == std::string::npos);
}
