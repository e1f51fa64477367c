// Conventions of glTF, each with the pixel value that they ask for, worked out by hand. The imported scene is rendered
// and must show it, too.
#include "io/png_writer.h"
#include "support/scene_test.h"
#include "unit/exchange/gltf_cases.h"

#include <cmath>
#include <doctest/doctest.h>
#include <fmt/format.h>

using namespace abbe;
using namespace abbe::exchange;

namespace {

// The mean Y of a part of the picture in nits, whatever the exposure.
double gltfNits(const GltfCase& made, PixelBounds part = {3, 3, 5, 5}, std::uint32_t samples = 256) {
    std::string scene = made.scene;
    const std::size_t film = scene.find("film {");
    REQUIRE(film != std::string::npos);
    scene.replace(film, scene.find('\n', film) - film, "film { size 8 8; filter box }");
    return renderImported(made, scene, part, samples).mean * 72983;
}

// The square, seen from z = 5 by a camera that shows just it, with lights and a material.
std::string gltfView(const std::string& material, const std::string& lights, const std::string& nodes = "",
                     const std::string& more = "", const std::string& attributes = "") {
    std::string list = "0,1";
    for (std::size_t at = nodes.find("{\"name\""), n = 2; at != std::string::npos; at = nodes.find("{\"name\"", at + 1))
        list += fmt::format(",{}", n++);
    return gltfWall("\"scenes\":[{\"nodes\":[" + list +
                        "]}],\"nodes\":[{\"mesh\":0},{\"camera\":0,\"translation\":[0,0,5]}" + nodes +
                        R"(],"cameras":[{"type":"orthographic","orthographic":{"xmag":1,"ymag":1,"znear":0,"zfar":9}}],
"materials":[{)" + material +
                        R"(}],"extensionsUsed":["KHR_lights_punctual"],
"extensions":{"KHR_lights_punctual":{"lights":[)" +
                        lights + "]}}" + more,
                    attributes);
}

std::string gltfLight(const std::string& place = "") {
    return R"(,{"name":"light","extensions":{"KHR_lights_punctual":{"light":0}})" + place + "}";
}

// Reflects half of the light, and has no gloss.
std::string gltfMatte(const std::string& more) {
    return "\"pbrMetallicRoughness\":{\"metallicFactor\":0," + more +
           "},\"extensions\":{\"KHR_materials_specular\":{\"specularFactor\":0}}";
}
const std::string kGltfGrey = gltfMatte("\"baseColorFactor\":[0.5,0.5,0.5,1]");
const std::string kGltfBlack = gltfMatte("\"baseColorFactor\":[0,0,0,1]");
const std::string kGltfSun = R"({"type":"directional","intensity":100})";

bool gltfNear(double a, double b, double share = 0.005) {
    INFO(a, " for ", b);
    return std::abs(a - b) <= share * std::abs(b);
}

} // namespace

TEST_CASE("glTF: a directional light has lx, a point has cd") {
    // L = ρ E / π = 0.5 · 100 / π = 15.9155 nits
    CHECK(gltfNear(gltfNits(GltfCase(gltfView(kGltfGrey, kGltfSun, gltfLight()))), 15.9155));
    // turned by 60° about y: half of it
    CHECK(gltfNear(gltfNits(GltfCase(gltfView(kGltfGrey, kGltfSun, gltfLight(",\"rotation\":[0,0.5,0,0.8660254]")))),
                   7.9577));
    // E = I / d² = 40 / 4: L = 0.5 · 10 / π = 1.59155; of a red light 0.2126 of it, which grey surfaces keep
    const std::string at = ",\"translation\":[0,0,2],\"scale\":[7,7,7]";
    CHECK(gltfNear(gltfNits(GltfCase(gltfView(kGltfGrey, R"({"type":"point","intensity":40})", gltfLight(at)))),
                   1.59155, 0.02));
    CHECK(gltfNear(
        gltfNits(GltfCase(gltfView(kGltfGrey, R"({"type":"point","intensity":40,"color":[1,0,0]})", gltfLight(at)))),
        0.33836, 0.02));
}

TEST_CASE("glTF: spots have half angles") {
    const std::string spot = R"({"type":"spot","intensity":40,"spot":{"innerConeAngle":0.3,"outerConeAngle":0.31}})";
    // from 2 m the cone is 2 tan 0.3 = 0.6187 m wide: the middle is lit, the corners are not
    const GltfCase made(gltfView(kGltfGrey, spot, gltfLight(",\"translation\":[0,0,2]")));
    CHECK(gltfNear(gltfNits(made), 1.59155, 0.02));
    CHECK(gltfNits(made, {5, 3, 6, 5}) > 1);   // 0.25 … 0.5 m from the middle
    CHECK(gltfNits(made, {6, 3, 8, 5}) < 0.5); // 0.5 … 1 m
    CHECK(gltfNits(made, {7, 7, 8, 8}) == 0);
}

TEST_CASE("glTF: emission is in nits, or white where the file has no lights") {
    const std::string emission = "\"emissiveFactor\":[1,0.5,0.25],";
    // 3 (0.2126 + 0.7152 / 2 + 0.0722 / 4) = 1.76475
    const std::string strong = R"("pbrMetallicRoughness":{"metallicFactor":0,"baseColorFactor":[0,0,0,1]},
"extensions":{"KHR_materials_specular":{"specularFactor":0},"KHR_materials_emissive_strength":{"emissiveStrength":3}})";
    CHECK(gltfNear(gltfNits(GltfCase(gltfView(emission + strong, kGltfSun, gltfLight()))), 1.76475, 0.01));
    // without lights: 0.2126 + 0.3576 + 0.01805 = 0.58825 of white
    const GltfCase dark(gltfView(emission + kGltfBlack, ""));
    CHECK(dark.says("W0802"));
    CHECK(gltfNear(gltfNits(dark) / 72983, 0.58825, 0.01));
}

TEST_CASE("glTF: images are sRGB, begin above, and are placed by their transform") {
    // 188 of 255 is 0.5029 of light; the quarters have greys of 0, 1, 0.5029 and 0.2140 (127).
    constexpr int kSide = 32;
    std::vector<float> pixels;
    for (int y = 0; y < kSide; ++y)
        for (int x = 0; x < kSide; ++x)
            for (int c = 0; c < 3; ++c)
                pixels.push_back(y < kSide / 2 ? (x < kSide / 2 ? 0.f : 1.f)
                                               : (x < kSide / 2 ? 188 / 255.f : 127 / 255.f));
    const auto nits = [&](const std::string& transform, PixelBounds part) {
        GltfCase made;
        writePng(made.folder / "tex.png", {kSide, kSide, pixels});
        made.import(gltfView(gltfMatte("\"baseColorTexture\":{\"index\":0" + transform + "}"), kGltfSun, gltfLight(),
                             R"(,"images":[{"uri":"tex.png"}],"textures":[{"source":0}])"));
        return gltfNits(made, part, 64) / 31.831; // of what a white sheet shows in 100 lx
    };
    constexpr PixelBounds kLeftUp{1, 1, 3, 3}, kRightUp{5, 1, 7, 3}, kLeftDown{1, 5, 3, 7}, kRightDown{5, 5, 7, 7};
    CHECK(nits("", kLeftUp) < 0.01);
    CHECK(gltfNear(nits("", kRightUp), 1, 0.01));
    CHECK(gltfNear(nits("", kLeftDown), 0.5029, 0.01));
    CHECK(gltfNear(nits("", kRightDown), 0.2122, 0.01));
    const auto transform = [](const char* text) {
        return std::string(",\"extensions\":{\"KHR_texture_transform\":{") + text + "}}";
    };
    // uv' = uv + (0.5, 0): left and right change places
    CHECK(gltfNear(nits(transform("\"offset\":[0.5,0]"), kLeftUp), 1, 0.01));
    // uv' = uv + (0, 0.5): above and below do
    CHECK(gltfNear(nits(transform("\"offset\":[0,0.5]"), kLeftUp), 0.5029, 0.01));
    // half of the picture: (0.25, 0.25) becomes (0.125, 0.125), (0.75, 0.75) (0.375, 0.375), all in the left upper one
    CHECK(nits(transform("\"scale\":[0.5,0.5]"), kRightDown) < 0.01);
    // R = [cos sin; -sin cos] by 90°: (u, v) becomes (v, -u) = (v, 1 - u); the left upper place (0.25, 0.25) shows
    // (0.25, 0.75), the right lower one (0.75, 0.25)
    CHECK(gltfNear(nits(transform("\"rotation\":1.5707963267948966"), kLeftUp), 0.5029, 0.01));
    CHECK(gltfNear(nits(transform("\"rotation\":1.5707963267948966"), kRightDown), 1, 0.01));
    // Scale comes before the turn, and the turn before the offset: (0.25, 0.25) · (1.5, 1) = (0.375, 0.25), turned
    // (0.25, -0.375), moved by (0.5, 0.125) (0.75, -0.25), which is (0.75, 0.75).
    CHECK(gltfNear(nits(transform(R"("rotation":1.5707963267948966,"scale":[1.5,1],"offset":[0.5,0.125])"), kLeftUp),
                   0.2122, 0.01));
}

TEST_CASE("glTF: colours of vertices are linear, and alpha makes holes") {
    // 0.5 · 0.5 · 100 / π
    CHECK(gltfNear(gltfNits(GltfCase(gltfView(kGltfGrey, kGltfSun, gltfLight(), "", ",\"COLOR_0\":4"))), 7.9577));
    const std::string clear = "\"alphaMode\":\"BLEND\"," + gltfMatte("\"baseColorFactor\":[0.5,0.5,0.5,0.25]");
    CHECK(gltfNear(gltfNits(GltfCase(gltfView(clear, kGltfSun, gltfLight())), {3, 3, 5, 5}, 4096), 15.9155 / 4, 0.05));
}

TEST_CASE("glTF: a sheet that transmits diffusely has two colours") {
    const std::string sheet = R"("pbrMetallicRoughness":{"metallicFactor":0,"baseColorFactor":[0.5,0.5,0.5,1]},
"extensions":{"KHR_materials_specular":{"specularFactor":0},"KHR_materials_diffuse_transmission":{
"diffuseTransmissionFactor":0.5,"diffuseTransmissionColorFactor":[0.8,0.8,0.8]}})";
    // From the front: half of it is matte, 0.5 · 0.5 · 100 / π; lit from behind 0.5 · 0.8 · 100 / π = 12.7324.
    CHECK(gltfNear(gltfNits(GltfCase(gltfView(sheet, kGltfSun, gltfLight()))), 7.9577, 0.01));
    CHECK(gltfNear(gltfNits(GltfCase(gltfView(sheet, kGltfSun, gltfLight(",\"rotation\":[0,1,0,0]")))), 12.7324, 0.01));
}

TEST_CASE("glTF: normal maps have x to the right and y upwards") {
    // All of the square leans by 30°, stored as 0.5 + n / 2; light comes from 60° on that side: cos 30° instead of cos
    // 60°.
    const auto nits = [](float x, float y, const std::string& turn) {
        std::vector<float> pixels;
        for (int i = 0; i < 16; ++i)
            for (const float c : {0.5f + x / 2, 0.5f + y / 2, 0.5f + 0.8660254f / 2}) pixels.push_back(c);
        GltfCase made;
        writePng(made.folder / "tex.png", {4, 4, pixels});
        made.import(gltfView(kGltfGrey + ",\"normalTexture\":{\"index\":0}", kGltfSun, gltfLight(turn),
                             R"(,"images":[{"uri":"tex.png"}],"textures":[{"source":0}])"));
        return gltfNits(made);
    };
    const std::string right = ",\"rotation\":[0,0.5,0,0.8660254]", up = ",\"rotation\":[-0.5,0,0,0.8660254]";
    CHECK(gltfNear(nits(0.5f, 0, right), 15.9155 * 0.8660254, 0.01));
    CHECK(gltfNear(nits(0, 0.5f, up), 15.9155 * 0.8660254, 0.01));
    CHECK(nits(0, -0.5f, up) < 0.2);
}
