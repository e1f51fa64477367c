// glTF files that are damaged, or ask for what is not there: the message names the place, and nothing crashes.
#include "gltf_support.h"
#include "support/nightly.h"
#include "support/statistics.h"

#include <doctest/doctest.h>
#include <limits>

using namespace abbe;
using namespace abbe::test;

namespace {

// The text with the first `from` replaced; fails loudly if there is none.
std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

bool says(const std::string& message, const std::string& what) {
    const bool found = message.find(what) != std::string::npos;
    if (!found) MESSAGE("message: ", message, " expected: ", what);
    return found;
}

} // namespace

TEST_CASE("gltf: every cut of a binary file is an error that names the byte") {
    const std::string whole = GltfText().binary();
    REQUIRE_NOTHROW(parseGltf(whole, "a.glb"));
    for (std::size_t n = 4; n < whole.size(); ++n) {
        const std::string message = errorOf([&] { parseGltf(std::string_view(whole).substr(0, n), "a.glb"); });
        INFO("cut at " << n);
        REQUIRE(message.find("`a.glb`: byte ") != std::string::npos);
    }
    CHECK(says(errorOf([&] { parseGltf(replaced(whole, "glTF\x02", "glTF\x01"), "a"); }), "byte 4: version 1"));
    std::string longer = whole;
    longer[12] = '\x7f';
    longer[14] = '\x7f'; // a first chunk of 8 MB
    CHECK(says(errorOf([&] { parseGltf(longer, "a"); }), "byte 12: a chunk of"));
}

TEST_CASE("gltf: ranges and indices that lead out of the file") {
    const auto message = [](const std::string& part, const std::string& from, const std::string& to) {
        GltfText text;
        std::string& of = part == "accessors" ? text.accessors
                          : part == "views"   ? text.views
                          : part == "nodes"   ? text.nodes
                          : part == "scene"   ? text.scene
                                              : text.primitive;
        of = replaced(of, from, to);
        return errorOf(text);
    };
    CHECK(says(message("accessors", R"("count":4)", R"("count":5)"), "accessors[0]"));
    CHECK(says(message("accessors", R"("count":4)", R"("count":4000000000)"), "accessors[0]"));
    CHECK(message("accessors", R"("count":4)", R"("count":18446744073709551615)") != "");
    CHECK(message("accessors", R"("count":4)", R"("count":-4)") != "");
    CHECK(message("accessors", R"("count":4)", R"("count":0)") != "");
    CHECK(says(message("accessors", R"({"bufferView":0,)", R"({"bufferView":0,"byteOffset":18446744073709551600,)"),
               "accessors[0]"));
    CHECK(message("accessors", R"({"bufferView":0,)", R"({"bufferView":9,)") != "");
    CHECK(message("accessors", R"({"bufferView":0,)", R"({"bufferView":-2147483648,)") != "");
    CHECK(message("accessors", R"("componentType":5126)", R"("componentType":5127)") != "");
    CHECK(says(message("accessors", R"("type":"VEC3")", R"("type":"VEC2")"), "components"));
    CHECK(message("accessors", R"("type":"VEC3")", R"("type":"MAT4")") != "");
    CHECK(says(message("accessors", R"("componentType":5123)", R"("componentType":5122)"), "unsigned"));
    CHECK(says(message("accessors", R"("count":6)", R"("count":5)"), "5 corners are no triangles"));
    CHECK(message("views", R"("byteLength":48)", R"("byteLength":4800)") != "");
    CHECK(says(message("views", R"("byteOffset":128)", R"("byteOffset":130)"), "bufferViews[3]"));
    CHECK(says(message("views", R"("byteOffset":128)", R"("byteOffset":18446744073709551610)"), "bufferViews[3]"));
    CHECK(says(message("views", R"({"buffer":0,)", R"({"buffer":7,)"), "bufferViews[0].buffer is 7"));
    CHECK(says(message("views", R"("byteLength":48)", R"("byteLength":48,"byteStride":8)"), "byteStride"));
    CHECK(message("primitive", R"("POSITION":0)", R"("POSITION":44)") != "");
    CHECK(message("primitive", R"("indices":3)", R"("indices":44)") != "");
    CHECK(says(message("primitive", R"("NORMAL":1)", R"("NORMAL":3)"), "6 values for 4 positions"));
    CHECK(says(message("nodes", R"("mesh":0)", R"("mesh":3)"), "nodes[0].mesh is 3"));
    CHECK(says(message("scene", R"("nodes":[0])", R"("nodes":[4])"), "node 4"));
    CHECK(says(message("scene", R"("scene":0)", R"("scene":2)"), "scene is 2"));
}

TEST_CASE("gltf: vertices that are not there or not numbers") {
    GltfText text;
    const float nan = std::numeric_limits<float>::quiet_NaN(), infinite = std::numeric_limits<float>::infinity();
    text.data.replace(4 * 4, 4, bytesOf<float>({nan}));
    CHECK(says(errorOf(text), "attributes.POSITION): element 1 is not finite"));
    text.data.replace(4 * 4, 4, bytesOf<float>({infinite}));
    CHECK(says(errorOf(text), "element 1 is not finite"));
    text = GltfText();
    text.data.replace(128 + 2 * 5, 2, bytesOf<std::uint16_t>({4}));
    CHECK(says(errorOf(text), "element 5 names vertex 4 of 4"));
    text = GltfText();
    text.nodes = R"([{"mesh":0,"scale":[1e300,1e300,1e300]}])";
    CHECK(says(errorOf(text), "too far away"));
    text.nodes = R"([{"mesh":0,"rotation":[0,0,0,0]}])";
    CHECK(says(errorOf(text), "nodes[0].rotation"));
    text.nodes = R"([{"mesh":0,"translation":[0,0]}])";
    CHECK(errorOf(text) != "");
}

TEST_CASE("gltf: graphs that are no trees") {
    GltfText text;
    text.nodes = R"([{"children":[1]},{"children":[0],"mesh":0}])";
    CHECK(errorOf(text) != "");
    CHECK(errorOf(text, {.node = "x", .mesh = ""}) != "");
    text.nodes = R"([{"children":[0],"mesh":0}])";
    CHECK(errorOf(text) != "");
    text.nodes = R"([{"name":"a","children":[1]},{"name":"b","children":[2]},{"name":"c","children":[1]}])";
    CHECK(says(errorOf(text), "nodes[1] is a child of nodes[0] and of nodes[2]"));
    text.nodes = R"([{"mesh":0},{"name":"a","children":[2]},{"name":"b","children":[1],"mesh":0}])"; // a ring aside
    CHECK(errorOf(text) == "");
    CHECK(errorOf(text, {.node = "b", .mesh = ""}) != "");
    text.nodes = R"([{"children":[7]}])";
    CHECK(says(errorOf(text), "nodes[0].children[0] is 7"));
    text = GltfText();
    text.scene = R"("scenes":[{"nodes":[0,0]}],)";
    CHECK(says(errorOf(text), "twice"));
}

TEST_CASE("gltf: what is not supported is named") {
    GltfText text;
    text.more = R"(,"extensionsRequired":["KHR_materials_unlit","XX_new_geometry"])";
    CHECK(says(errorOf(text), "extensionsRequired[1]: `XX_new_geometry` is not supported"));
    text.more = R"(,"extensionsRequired":["KHR_materials_unlit"])";
    CHECK(errorOf(text) == "");
    text = GltfText();
    text.primitive.insert(1, R"("extensions":{"KHR_draco_mesh_compression":{"bufferView":7,"attributes":{}}},)");
    CHECK(says(errorOf(text), "meshes[0].primitives[0].extensions.KHR_draco_mesh_compression.bufferView"));
    text = GltfText();
    text.views.insert(2, R"("extensions":{"EXT_meshopt_compression":{"buffer":3}},)");
    CHECK(says(errorOf(text), "bufferViews[0].extensions.EXT_meshopt_compression.buffer is 3"));
    text = GltfText();
    text.nodes = R"([{"mesh":0,"weights":[0.5]}])"; // of no targets
    CHECK(errorOf(text) == "");
    text.nodes = R"([{"mesh":0,"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":9}}}}])";
    CHECK(says(errorOf(text), "EXT_mesh_gpu_instancing.attributes.TRANSLATION is accessor 9"));
    CHECK(says(errorOf([] { parseGltf(R"({"asset":{"version":"1.0"}})", "a"); }), "version"));
    CHECK(errorOf([] { parseGltf("{ not json", "a"); }) != "");
    CHECK(errorOf([] { parseGltf("{}", "a"); }) != "");
}

TEST_CASE("gltf: nesting that would overflow a stack") {
    GltfText text;
    const std::size_t deep = 200000;
    text.more = R"(,"extras":)" + std::string(deep, '[') + std::string(deep, ']');
    CHECK(says(errorOf(text), "levels deep"));
    text.more = R"(,"extras":")" + std::string(1000, '[') + "\"";
    CHECK(errorOf(text) == "");
}

TEST_CASE("gltf: random damage never crashes") {
    GltfText text;
    text.nodes =
        R"([{"mesh":0,"children":[1]},{"camera":0,"rotation":[0,0,0,1],"matrix":[1,0,0,0,0,1,0,0,0,0,1,0,0,0,0,1]}])";
    text.accessors = replaced(text.accessors, R"("type":"VEC3"})",
                              R"("type":"VEC3","sparse":{"count":1,"indices":{"bufferView":3,"componentType":5123},)"
                              R"("values":{"bufferView":0}}})");
    text.more =
        R"(,"cameras":[{"type":"perspective","perspective":{"yfov":0.5,"znear":0.1}}],"images":[{"bufferView":0,)"
        R"("mimeType":"image/png"}],"skins":[{"joints":[0]}],"animations":[{"channels":[],"samplers":[]}])";
    const std::string whole = text.binary();
    REQUIRE(errorOf([&] { parseGltf(whole, "a.glb"); }) == "");
    Random random(1);
    const auto below = [&](std::size_t n) {
        return std::min(n - 1, static_cast<std::size_t>(random.uniform() * static_cast<float>(n)));
    };
    int errors = 0;
    const int tries = test::nightly() ? 20'000 : 3000;
    for (int i = 0; i < tries; ++i) {
        std::string bytes = whole;
        const std::size_t changes = 1 + below(4);
        for (std::size_t k = 0; k < changes; ++k) {
            const std::size_t at = below(bytes.size());
            switch (below(5)) {
            case 0:
                bytes[at] = static_cast<char>(below(256));
                break;
            case 1: // another digit where one stands
                for (std::size_t q = at; q < bytes.size(); ++q)
                    if (bytes[q] >= '0' && bytes[q] <= '9') {
                        bytes[q] = static_cast<char>('0' + below(10));
                        break;
                    }
                break;
            case 2:
                bytes.erase(at, 1 + below(8));
                break;
            case 3:
                bytes.insert(at, std::string(1 + below(4), "0-[{\",9e"[below(8)]));
                break;
            default:
                bytes.resize(std::max<std::size_t>(4, at));
            }
            if (bytes.size() < 24) break;
        }
        // Half of the time the container is put right, so that the damage reaches what lies inside.
        if (i % 2 == 0 && bytes.size() >= 24 && bytes.size() > whole.size() - 40) {
            const std::size_t json = text.json().size() + bytes.size() - whole.size();
            std::string inner = bytes.substr(20, std::min(json, bytes.size() - 20));
            bytes = glb(inner, text.data);
        }
        const std::string message = errorOf([&] {
            const MeshFile file = parseGltf(bytes, "a.glb");
            for (const auto& t : file.mesh.triangles)
                for (const std::uint32_t v : t) REQUIRE(v < file.mesh.positions.size());
            for (const Vec3 p : file.mesh.positions) REQUIRE(isFinite(p));
        });
        errors += !message.empty();
        errorOf([&] { parseGltfCameras(bytes, "a.glb"); });
    }
    CHECK(errors > tries / 2);
    CHECK(errors < tries);
}
