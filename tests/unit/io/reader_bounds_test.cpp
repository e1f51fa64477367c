// Readers look before they work: what is no regular file, what a file cannot hold, and what memory cannot. Each of
// these took seconds to minutes, or all memory there was.
#include "base/memory_limit.h"
#include "gltf_support.h"
#include "io/exr_deep.h"
#include "io/exr_reader.h"
#include "io/exr_writer.h"
#include "io/ies.h"
#include "io/image.h"
#include "io/mesh_file.h"
#include "io/ply_points.h"
#include "support/cpu_time.h"
#include "support/exr_bytes.h"
#include "support/memory_scope.h"
#include "temporary_folder.h"

#include <doctest/doctest.h>
#include <functional>
#include <sys/stat.h>

using namespace abbe;
using namespace abbe::test;
using abbe_test::ExrBytes;

namespace {

// Seconds of computing; each of these takes milliseconds, and up to a second under the address sanitizer.
#if defined(__SANITIZE_ADDRESS__)
constexpr double kAtOnce = 10;
#else
constexpr double kAtOnce = 2;
#endif

bool contains(const std::string& text, const std::string& part) {
    const bool found = text.find(part) != std::string::npos;
    if (!found) MESSAGE("expected: ", part, ", said: ", text);
    return found;
}

std::string readingExr(const std::string& path) {
    return test::errorOf([&] { readExr(path); });
}

} // namespace

TEST_CASE("readers: pipes and devices") {
    const TemporaryFolder folder;
    const std::string fifo = folder / "fifo";
    REQUIRE(::mkfifo(fifo.c_str(), 0600) == 0);
    for (const std::string& path : {fifo, std::string("/dev/zero")}) {
        const std::vector<std::function<void()>> readers{[&] { readMesh(path); },
                                                         [&] { readObj(path); },
                                                         [&] { readPly(path); },
                                                         [&] { readGltf(path); },
                                                         [&] { readGltfCameras(path); },
                                                         [&] { readCage(path); },
                                                         [&] { readPlyPoints(path); },
                                                         [&] { readIes(path); },
                                                         [&] { readImage(path); },
                                                         [&] { readExrInfo(path); },
                                                         [&] { readExrChannels(path); },
                                                         [&] { readDeepExr(path); },
                                                         [&] { appendExr(path, folder / "to.exr", {}, {}); }};
        for (const auto& read : readers) {
            std::string said;
            CHECK(cpuSecondsOf([&] { said = test::errorOf([&] { read(); }); }) < kAtOnce);
            CHECK(contains(said, "cannot read `" + path + "`: it is not a regular file"));
        }
    }
}

TEST_CASE("exr bounds: a few bytes promise no picture, whatever their compression") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    for (int compression = 0; compression < 10; ++compression)
        for (const bool tiled : {false, true}) {
            ExrBytes exr;
            exr.window = {0, 0, 16383, 16383};
            exr.compression = compression;
            exr.rest.assign(400, '\0');
            if (tiled) exr.tile = {16384, 16384};
            writeAll(path, exr.bytes());
            std::string said;
            CHECK(cpuSecondsOf([&] { said = readingExr(path); }) < kAtOnce);
            CHECK(contains(said, "what its header promises cannot be in"));
            CHECK(contains(test::errorOf([&] { readExrInfo(path); }), "cannot be in"));
            CHECK(contains(test::errorOf([&] { readDeepExr(path); }), "cannot be in"));
            CHECK(contains(test::errorOf([&] { appendExr(path, folder / "b.exr", {}, {}); }), "cannot be in"));
        }
    CHECK_FALSE(std::filesystem::exists(folder / "b.exr"));
}

TEST_CASE("exr bounds: damaged heads") {
    const TemporaryFolder folder;
    const std::string path = folder / "a.exr";
    const auto said = [&](const std::string& bytes) {
        writeAll(path, bytes);
        return exrBoundsFault(path);
    };
    ExrBytes sound;
    sound.rest.assign(400, '\0');
    const std::string whole = sound.bytes();
    CHECK(said(whole) == "");
    CHECK(said("no picture at all") == "");
    CHECK(said("") == "");
    for (std::size_t n = 8; n < whole.size() - 400; ++n) {
        INFO("cut at ", n);
        REQUIRE(said(whole.substr(0, n)) != "");
    }
    ExrBytes exr = sound;
    exr.window = {5, 0, 4, 3};
    CHECK(said(exr.bytes()) == "it has no pixels");
    exr.window = {-2147483647 - 1, 0, 2147483647, 0};
    CHECK(said(exr.bytes()) == "4294967296 by 1 pixels are too many");
    exr.window = {0, 0, 65535, 65535};
    CHECK(said(exr.bytes()) == "65536 by 65536 pixels are too many");
    exr = sound;
    exr.tile = {1u << 20, 1u << 20};
    CHECK(said(exr.bytes()) == "tiles of 1048576 by 1048576 pixels are larger than it");
    exr.tile = {64, 64}; // larger than the picture, as those of small levels are
    CHECK(said(exr.bytes()) == "");
    exr = sound;
    for (int i = 0; i < 5000; ++i) exr.channels.push_back("c" + std::to_string(i));
    exr.rest.assign(1 << 20, '\0');
    CHECK(said(exr.bytes()) == "5003 channels are too many");
    exr = sound;
    exr.attributes = std::string("note\0string\0\xff\xff\xff\x7f", 16);
    CHECK(contains(said(exr.bytes()), "an attribute of 2147483647 bytes where"));
    exr.attributes = std::string(300, 'x');
    CHECK(contains(said(exr.bytes()), "a name has no end"));
}

TEST_CASE("exr bounds: pictures that there are pass with every compression") {
    const TemporaryFolder folder;
    std::vector<float> plane(4096 * 256, 0.5f); // nothing packs better
    ExrPicture picture;
    picture.window = picture.display = {0, 0, 4096, 256};
    picture.r = picture.g = picture.b = plane;
    for (const char* word : {"none", "rle", "zips", "zip", "piz", "pxr24", "b44", "b44a", "dwaa", "dwab"}) {
        const auto compression = findExrCompression(word);
        if (!compression) continue;
        picture.compression = *compression;
        picture.half = true;
        writeExr(folder / "a.exr", picture);
        INFO(word, ": ", std::filesystem::file_size(folder / "a.exr"), " bytes");
        CHECK(exrBoundsFault(folder / "a.exr") == "");
    }
}

TEST_CASE("readers: what does not fit into memory is told before it is taken") {
    const TemporaryFolder folder;
    std::vector<float> plane(4096 * 2048, 0.5f);
    ExrPicture picture;
    picture.window = picture.display = {0, 0, 4096, 2048};
    picture.r = picture.g = picture.b = plane;
    writeExr(folder / "a.exr", picture); // 96 MiB as floats, and as much again as a picture
    std::string hdr = "#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 2048 +X 4096\n";
    for (int y = 0; y < 2048; ++y) {
        hdr += std::string("\2\2\x10\0", 4);
        for (int c = 0; c < 4; ++c)
            for (int x = 0; x < 4096; x += 64) hdr += std::string("\xc0\x80", 2);
    }
    writeAll(folder / "a.hdr", hdr);
    CHECK(readHdr(folder / "a.hdr").width() == 4096);
    const auto peak = residentMemory();
    const MemoryScope scope(40 << 20);
    CHECK(contains(readingExr(folder / "a.exr"), "a.exr`: it takes 96 MiB of memory; "));
    CHECK_THROWS_AS(readHdr(folder / "a.hdr"), MemoryLimitExceeded);
    CHECK(residentMemory() < peak + (20 << 20));
    const std::string ply =
        "ply\nformat binary_little_endian 1.0\nelement vertex 20000000\nproperty uchar x\n"
        "property uchar y\nproperty uchar z\nelement face 0\nproperty list uchar uchar vertex_indices\n"
        "end_header\n";
    CHECK_THROWS_AS(parsePly(ply + std::string(60'000'000, '\1'), "a.ply"), MemoryLimitExceeded);
}

TEST_CASE("gltf: copies of copies are bounded by the bytes that there are") {
    GltfText text;
    text.data += std::string(12 * 100'000, '\0');
    const std::string count = std::to_string(100'000);
    text.views = R"([{"buffer":0,"byteOffset":140,"byteLength":1200000}])";
    text.accessors = R"([{"bufferView":0,"componentType":5126,"count":)" + count + R"(,"type":"VEC3"}])";
    text.primitive = R"({"attributes":{"POSITION":0}})";
    std::string nodes = R"([{"mesh":0})", roots = "0";
    for (int i = 1; i < 60'000; ++i) {
        nodes += R"(,{"mesh":0})";
        roots += "," + std::to_string(i);
    }
    text.nodes = nodes + "]";
    text.scene = R"("scene":0,"scenes":[{"nodes":[)" + roots + "]}],";
    std::string said;
    CHECK(cpuSecondsOf([&] { said = test::errorOf(text); }) < kAtOnce);
    CHECK(contains(said, "vertices, corners and joints of its nodes: 6e+09 elements, more than 1024 for each of its"));
    GltfText zeros; // no bytes at all behind an accessor
    zeros.accessors = R"([{"componentType":5126,"count":60000000,"type":"VEC3","sparse":{"count":1,)"
                      R"("indices":{"bufferView":3,"componentType":5123},"values":{"bufferView":0}}}])";
    zeros.primitive = R"({"attributes":{"POSITION":0}})";
    CHECK(cpuSecondsOf([&] { said = test::errorOf(zeros); }) < kAtOnce);
    CHECK(contains(said, "accessors[0] (attributes.POSITION): 6e+07 elements, more than 1024"));
}

TEST_CASE("gltf: nodes that share copies or weights are bounded, too") {
    const auto nodesOf = [](const std::string& node) {
        std::string nodes = "[" + node;
        for (int i = 1; i < 20'000; ++i) nodes += "," + node;
        return nodes + "]";
    };
    GltfText copies; // 20 000 nodes with 100 000 copies each
    copies.data += std::string(12 * 100'000, '\0');
    copies.views = R"([{"buffer":0,"byteOffset":140,"byteLength":1200000}])";
    copies.accessors = R"([{"bufferView":0,"componentType":5126,"count":100000,"type":"VEC3"}])";
    copies.primitive = R"({"attributes":{"POSITION":0}})";
    copies.scene = "";
    copies.nodes = nodesOf(R"({"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":0}}}})");
    std::string said;
    CHECK(cpuSecondsOf([&] { said = test::errorOf(copies); }) < kAtOnce);
    CHECK(contains(said, "the vertices, corners and joints of its nodes: 2e+14 elements"));
    GltfText weights; // 20 000 nodes with the 100 000 weights of one mesh
    std::string list = "0";
    for (int i = 1; i < 100'000; ++i) list += ",0";
    weights.primitive += R"(],"weights":[)" + list;
    weights.scene = "";
    weights.nodes = nodesOf(R"({"mesh":0})");
    CHECK(cpuSecondsOf([&] { said = test::errorOf(weights); }) < kAtOnce);
    CHECK(contains(said, "the weights of its nodes: 2e+09 elements"));
}

TEST_CASE("gltf: many roots deep in one tree") {
    GltfText text;
    std::string nodes = R"([{"mesh":0,"children":[1]})";
    constexpr int kDeep = 20'000;
    for (int i = 1; i < kDeep; ++i) nodes += fmt::format(R"(,{{"translation":[1,0,0],"children":[{}]}})", i + 1);
    nodes += R"(,{"children":[)"; // the last of the chain has as many children
    std::string roots;
    for (int i = 0; i < kDeep; ++i) {
        nodes += fmt::format("{}{}", i ? "," : "", kDeep + 1 + i);
        roots += fmt::format("{}{}", i ? "," : "", kDeep + 1 + i);
    }
    nodes += "]}";
    for (int i = 0; i < kDeep; ++i) nodes += i == 0 ? R"(,{"mesh":0})" : ",{}";
    text.nodes = nodes + "]";
    text.scene = R"("scene":0,"scenes":[{"nodes":[)" + roots + "]}],";
    MeshFile mesh;
    CHECK(cpuSecondsOf([&] { mesh = text.mesh(); }) < 2 * kAtOnce);
    REQUIRE(mesh.mesh.positions.size() == 4);
    CHECK(mesh.mesh.positions[0].x == kDeep - 1); // moved by all that are above
}

TEST_CASE("obj: one position with any number of texture vertices") {
    std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
    constexpr int kCount = 200'000;
    for (int i = 0; i < kCount; ++i) text += "vt 0 0\n";
    for (int i = 1; i + 2 <= kCount; i += 3) text += fmt::format("f 1/{} 1/{} 1/{}\n", i, i + 1, i + 2);
    MeshFile mesh;
    CHECK(cpuSecondsOf([&] { mesh = parseObj(text, "a.obj"); }) < kAtOnce);
    CHECK(mesh.mesh.positions.size() == kCount - kCount % 3);
}

TEST_CASE("polygons: the largest that are cut, however they are") {
    // A comb whose teeth all reach into the triangles of its other corners, 1024 corners each.
    std::string text;
    constexpr int kCorners = 1024, kPolygons = 40;
    for (int i = 0; i < kCorners; ++i) {
        const double along = i < kCorners / 2 ? i : kCorners - 1 - i;
        text += fmt::format("v {} {} 0\n", along, (i % 2 ? 100.0 : 0.5) + (i < kCorners / 2 ? 0.0 : 0.25));
    }
    for (int p = 0; p < kPolygons; ++p) {
        text += "f";
        for (int i = 1; i <= kCorners; ++i) text += fmt::format(" {}", i);
        text += "\n";
    }
    MeshFile mesh;
    CHECK(cpuSecondsOf([&] { mesh = parseObj(text, "a.obj"); }) < 2 * kAtOnce); // some microseconds for each byte
    CHECK(mesh.mesh.triangles.size() == kPolygons * (kCorners - 2));
}
