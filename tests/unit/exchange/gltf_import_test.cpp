// glTF scenes as text in, scene text and diagnostics out.
#include "unit/exchange/gltf_cases.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::exchange;

namespace {

std::string gltfExtension(const std::string& name, const std::string& body, const std::string& more = "") {
    return R"("extensions":{"KHR_materials_)" + name + "\":{" + body + "}" + more + "}";
}

const std::string kGltfDielectric = R"("pbrMetallicRoughness":{"metallicFactor":0,"roughnessFactor":0.2},)";

GltfCase gltfDielectric(const std::string& extension) { return GltfCase(gltfMaterial(kGltfDielectric + extension)); }

std::string gltfPicture(const std::string& name = "tex.png") {
    return R"(,"images":[{"uri":")" + name + R"("}],"textures":[{"source":0}])";
}

const std::string kGltfTexture = R"("baseColorTexture":{"index":0})";

// 2 × 2 pixels with alpha.
std::string gltfAlphaPng() {
    static constexpr unsigned char kBytes[] = {
        0x89, 'P',  'N',  'G',  0x0d, 0x0a, 0x1a, 0x0a, 0,   0,    0,    0x0d, 'I',  'H',  'D',  'R',
        0,    0,    0,    2,    0,    0,    0,    2,    8,   6,    0,    0,    0,    0x72, 0xb6, 0x0d,
        0x24, 0,    0,    0,    0x15, 'I',  'D',  'A',  'T', 0x78, 0xda, 0x63, 0xf8, 0xcf, 0xc0, 0xf0,
        0x1f, 0x08, 0x41, 0xe0, 0x7f, 0xc3, 0x7f, 0x20, 0,   0,    0x3d, 0x57, 0x08, 0x79, 0x22, 0xc5,
        0x0c, 0x7b, 0,    0,    0,    0,    'I',  'E',  'N', 'D',  0xae, 0x42, 0x60, 0x82};
    return {reinterpret_cast<const char*>(kBytes), sizeof kBytes};
}

GltfCase gltfTextured(const std::string& material) {
    return GltfCase(gltfMaterial(material, gltfPicture()), gltfAlphaPng());
}

} // namespace

TEST_CASE("glTF files are known by their bytes") {
    const TemporaryFolder folder;
    const auto known = [&](const std::string& name, const std::string& bytes) {
        writeAll(folder / name, bytes);
        const ImportFormat* const format = importFormat(folder / name);
        return format && format->name == "gltf";
    };
    CHECK(known("a.bin", std::string("glTF\2\0\0\0", 8)));
    CHECK(known("a.json", R"({"asset":{"version":"2.0"}})"));
    CHECK(known("a.gltf", "{}"));
    CHECK_FALSE(known("b.json", R"({"version":1})"));
    CHECK_FALSE(known("a.scene", "scene 1\n"));
}

TEST_CASE("glTF: a mesh with a plain material in front of a camera that is made up") {
    const GltfCase made(
        gltfMaterial(R"("pbrMetallicRoughness":{"baseColorFactor":[0.5,0.25,0.1,1],"metallicFactor":0.5})"));
    INFO(made.report());
    CHECK(made.diagnostics.all().empty());
    CHECK(made.has("material paint openpbr { base-color rgb 0.5 0.25 0.1; base-metalness 0.5; specular-roughness 1 }"));
    CHECK(made.has("shape wall mesh case-files/wall.ply { material paint }") !=
          made.has("shape wall mesh \"case-files/wall.ply\" { material paint }"));
    CHECK(made.has("camera"));
    CHECK(made.has("sky"));
}

TEST_CASE("glTF: faults have places and codes") {
    CHECK(GltfCase("{").says("E0801"));
    CHECK_FALSE(GltfCase("{ hunter2 }").says("hunter2")); // it may be any file
    CHECK(GltfCase(R"({"asset":{"version":"1.0"}})").says("E0801"));
    CHECK(GltfCase(gltfMaterial(R"("pbrMetallicRoughness":{"baseColorTexture":{"index":7}})")).says("E0802"));
    CHECK(GltfCase(gltfMaterial("\"alphaMode\":\"SHINY\"")).says("E0802"));
    CHECK(GltfCase(gltfMaterial(kGltfDielectric + gltfExtension("ior", R"("ior":"high")"))).says("E0802"));
    CHECK(GltfCase(gltfMaterial(kGltfDielectric + gltfExtension("ior", R"("iar":2)"))).says("W0803"));
    CHECK(GltfCase(gltfMaterial(kGltfDielectric + gltfExtension("fur", ""))).says("KHR_materials_fur"));
    const GltfCase missing(gltfMaterial(R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0}})", gltfPicture()));
    CHECK(missing.says("E0401"));
    // the place is that of the material
    const GltfCase placed(gltfMaterial("\"alphaMode\":\"SHINY\""));
    REQUIRE(placed.diagnostics.all().size() == 1);
    const Span span = placed.diagnostics.all()[0].span;
    CHECK(placed.sources.text(span).starts_with("{\"name\":\"paint\""));
    CHECK(placed.sources.text(span).ends_with("}"));
}

TEST_CASE("glTF: extensions of materials become the layers of OpenPBR") {
    const auto has = [](const std::string& extension, std::string_view text) {
        const GltfCase made = gltfDielectric(extension);
        INFO(made.report());
        INFO(made.scene);
        return made.has(text);
    };
    CHECK(has(gltfExtension("ior", R"("ior":1.33)"), "specular-ior 1.33"));
    CHECK(has(gltfExtension("ior", R"("ior":0)"), "specular-weight 25"));
    CHECK(has(gltfExtension("specular", R"("specularFactor":0.5,"specularColorFactor":[2,1,0])"),
              "specular-weight 1; specular-color rgb 1 0.5 0") !=
          has(gltfExtension("specular", R"("specularFactor":0.5,"specularColorFactor":[2,1,0])"),
              "specular-roughness 0.2; specular-color rgb 1 0.5 0")); // 0.5 · 2 is the default
    // without thickness a sheet, with thickness a solid
    CHECK(has(gltfExtension("transmission", R"("transmissionFactor":0.75)"),
              "transmission-weight 0.75; geometry-thin-walled on; transmission-color 1"));
    const std::string volume =
        R"(,"KHR_materials_volume":{"thicknessFactor":1,"attenuationDistance":0.5,"attenuationColor":[0.5,0.9,1]})";
    CHECK(has(gltfExtension("transmission", R"("transmissionFactor":1)", volume),
              "transmission-weight 1; transmission-color rgb 0.5 0.9 1; transmission-depth 0.5 m"));
    const std::string dispersion = R"(,"KHR_materials_dispersion":{"dispersion":)";
    CHECK(has(gltfExtension("transmission", R"("transmissionFactor":1)", volume + dispersion + "0.25}"),
              "transmission-dispersion-scale 0.25"));
    CHECK(has(gltfExtension("transmission", R"("transmissionFactor":1)", volume + dispersion + "2}"),
              "transmission-dispersion-scale 1; transmission-dispersion-abbe-number 10"));
    CHECK(has(gltfExtension("clearcoat", R"("clearcoatFactor":0.5,"clearcoatRoughnessFactor":0.25)"),
              "coat-weight 0.5; coat-roughness 0.25; coat-ior 1.5; coat-darkening 0"));
    CHECK(has(gltfExtension("sheen", R"("sheenColorFactor":[0.5,0.25,0],"sheenRoughnessFactor":0.3)"),
              "fuzz-weight 0.5; fuzz-color rgb 1 0.5 0"));
    CHECK(has(gltfExtension("iridescence", R"("iridescenceFactor":0.5,"iridescenceIor":1.4)"),
              "thin-film-weight 0.5; thin-film-ior 1.4; thin-film-thickness 400 nm"));
    // α = 0.04 across and 0.04 + 0.96 · 0.25 = 0.28 along: 1 - 0.04 / 0.28 = 0.857142…; r⁴ = (0.28² + 0.04²) / 2 = 0.04
    CHECK(has(gltfExtension("anisotropy", R"("anisotropyStrength":0.5,"anisotropyRotation":1.5707963267948966)"),
              "specular-roughness-anisotropy 0.857142857142857"));
    CHECK(has(gltfExtension("anisotropy", R"("anisotropyStrength":0.5,"anisotropyRotation":1.5707963267948966)"),
              "geometry-tangent 0.25; specular-roughness 0.447213595499"));
    CHECK(has(gltfExtension("diffuse_transmission",
                            R"("diffuseTransmissionFactor":0.5,"diffuseTransmissionColorFactor":[1,0.5,0])"),
              "subsurface-weight 0.5; subsurface-color rgb 1 0.5 0; subsurface-scatter-anisotropy 1"));
    CHECK(has("\"emissiveFactor\":[1,0.5,0]," + gltfExtension("emissive_strength", R"("emissiveStrength":5)"),
              "emission-luminance 364915 nits; emission-color rgb 1 0.5 0"));
    // A lamp is in nits, and lights the scene alone.
    const GltfCase lamp = gltfDielectric("\"emissiveFactor\":[1,1,1]," +
                                         gltfExtension("emissive_strength", R"("emissiveStrength":1500)"));
    CHECK(lamp.has("emission-luminance 1500 nits"));
    CHECK_FALSE(lamp.has("light surroundings"));
    CHECK(
        gltfDielectric("\"emissiveFactor\":[1,1,1]," + gltfExtension("emissive_strength", R"("emissiveStrength":1e13)"))
            .says("1e12 nits"));
    CHECK(has(gltfExtension("unlit", ""), "material paint diffuse"));
    CHECK(gltfDielectric(gltfExtension("unlit", "")).says("W0802"));
    // diffuse (1 - 0.2), gloss 0.2 = 5 · 0.04, roughness 1 - 0.75
    CHECK(
        has(gltfExtension("pbrSpecularGlossiness",
                          R"("diffuseFactor":[0.5,0.5,0.5,1],"specularFactor":[0.2,0.1,0.1],"glossinessFactor":0.75)"),
            "base-color 0.4; specular-weight 5; specular-color rgb 1 0.5 0.5; specular-roughness 0.25"));
}

TEST_CASE("glTF: textures with their colour space, place and channels") {
    const GltfCase plain =
        gltfTextured("\"pbrMetallicRoughness\":{" + kGltfTexture +
                     R"(,"baseColorFactor":[1,0.5,1,1],"metallicRoughnessTexture":{"index":0},"roughnessFactor":0.5})");
    INFO(plain.report());
    INFO(plain.scene);
    CHECK(plain.has("texture tex image tex.png space=srgb_rec709_scene") !=
          plain.has("texture tex image \"tex.png\" space=srgb_rec709_scene"));
    CHECK(plain.has("base-color product { first tex; second rgb 1 0.5 1 }"));
    CHECK(plain.has("base-metalness channel { of tex-2; take blue }"));
    CHECK(plain.has("specular-roughness product { first channel { of tex-2; take green }; second 0.5 }"));
    const GltfCase moved =
        gltfTextured(R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":)"
                     R"({"offset":[0.25,0.5],"scale":[2,4]}}}})");
    INFO(moved.scene);
    // v' = 1 - (4 (1 - v) + 0.5) = 4 v - 3.5
    CHECK(moved.has("base-color placed { map tex; scale 2 4; offset 0.25 -3.5 }"));
    const GltfCase turned =
        gltfTextured(R"("pbrMetallicRoughness":{"baseColorTexture":{"index":0,"extensions":{"KHR_texture_transform":)"
                     R"({"rotation":1.5707963267948966}}}})");
    INFO(turned.scene);
    CHECK(turned.has("rotate 90 deg; offset 1 1 }") != turned.has("rotate 90 deg; offset 1 0.9999999999999999 }"));
    CHECK(gltfTextured("\"normalTexture\":{\"index\":0,\"scale\":0.5}").has("normal tex strength=0.5"));
}

TEST_CASE("glTF: alpha is opacity where the material says so") {
    const std::string base = "\"pbrMetallicRoughness\":{" + kGltfTexture;
    CHECK_FALSE(gltfTextured(base + "}").has("opacity"));
    CHECK(gltfTextured(base + "},\"alphaMode\":\"BLEND\"").has("opacity tex-alpha"));
    CHECK(gltfTextured(base + R"(,"baseColorFactor":[1,1,1,0.5]},"alphaMode":"BLEND")")
              .has("opacity product { first tex-alpha; second 0.5 }"));
    CHECK(gltfTextured(base + R"(,"baseColorFactor":[1,1,1,0.5]},"alphaMode":"MASK","alphaCutoff":0.25)")
              .has("opacity ramp { input tex-alpha; stop 0.4999995 0; stop 0.4999995 1 }"));
    CHECK(gltfTextured(base + R"(,"baseColorFactor":[1,1,1,0.5]},"alphaMode":"MASK")").has("opacity ramp"));
    CHECK(gltfTextured(base + R"(,"baseColorFactor":[1,1,1,0.25]},"alphaMode":"MASK")").has("opacity 0"));
    CHECK(gltfTextured(base + "},\"alphaMode\":\"MASK\"").has("take alpha"));
    const GltfCase shining = gltfTextured(base + R"(},"alphaMode":"BLEND","emissiveFactor":[1,1,1])");
    CHECK(shining.says("W0801"));
    CHECK_FALSE(shining.has("emission"));
}

TEST_CASE("glTF: lights and cameras") {
    const GltfCase made(gltfWall(R"("materials":[{}],"scenes":[{"nodes":[0,1,2,3,4]}],"nodes":[
{"mesh":0},{"name":"eye","camera":0,"translation":[0,0,4]},
{"name":"sun","extensions":{"KHR_lights_punctual":{"light":0}}},
{"name":"bulb","translation":[0,1,2],"scale":[3,3,3],"extensions":{"KHR_lights_punctual":{"light":1}}},
{"name":"cone","extensions":{"KHR_lights_punctual":{"light":2}}}],
"cameras":[{"type":"perspective","perspective":{"yfov":1.5707963267948966,"aspectRatio":2,"znear":0.1}}],
"extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[
{"type":"directional","intensity":3},{"type":"point","intensity":10,"color":[1,0,0]},
{"type":"spot","intensity":5,"spot":{"innerConeAngle":0.25,"outerConeAngle":0.5}}]}})"));
    INFO(made.report());
    INFO(made.scene);
    CHECK(made.has("film { size 1440 720 }"));
    // tan 45° · 2 = 2: 2 atan 2 = 126.8699°
    CHECK(made.has("camera eye { fov 126.869897645"));
    CHECK(made.has("from 0 0 4; look-at 0 0 3; up 0 1 0; exposure auto"));
    CHECK(made.has("light sun sun { toward 0 0 -1; angular-diameter 0 deg; irradiance 3 lx }"));
    CHECK(made.has("light bulb point { color rgb 1 0 0; intensity 2.126"));
    CHECK(made.has("cd; transform { translate 0 1 2 } }")); // without the scale of its node
    CHECK(made.has("light cone spot { intensity 5 cd; angle 57.2957795"));
    CHECK_FALSE(made.has("sky"));
    CHECK(made.says("W0802")); // the edge of the cone
}

TEST_CASE("glTF: meshes of several nodes are objects, and moving nodes have keys") {
    const GltfCase shared(gltfWall(
        R"("materials":[{}],"scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0},{"mesh":0,"translation":[1,2,3]}])"));
    INFO(shared.scene);
    CHECK(shared.has("object wall { shape wall mesh"));
    CHECK(shared.has("instance wall { transform { translate 1 2 3 } }"));
    const GltfCase moving(gltfWall(R"("materials":[{}],"scenes":[{"nodes":[0]}],
"nodes":[{"name":"sled","children":[1]},{"name":"box","mesh":0,"translation":[0,5,0]}],
"animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"translation"}}],"samplers":[{"input":5,"output":6}]}])"));
    INFO(moving.report());
    INFO(moving.scene);
    CHECK(moving.has("group sled"));
    CHECK(moving.has("at 0 s { translate 0 0 0 }"));
    CHECK(moving.has("at 1 s { translate 2 0 0 }"));
    CHECK(moving.has("translate 0 5 0"));
}

TEST_CASE("glTF: colours of vertices and variants of materials") {
    const GltfCase colored(gltfWall(
        R"("materials":[{"pbrMetallicRoughness":{"baseColorFactor":[0.5,0.5,0.5,1]}}],"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}])",
        ",\"COLOR_0\":4"));
    INFO(colored.report());
    CHECK(colored.has("base-color product { first 0.5; second attribute color }") !=
          colored.has("base-color product { first 0.5; second attribute \"color\" }"));
}

TEST_CASE("glTF: copies of a mesh are instances, many of them a file of places") {
    const auto copies = [](int accessor) {
        return gltfWall(R"("materials":[{}],"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0,"translation":[0,0,3],
"extensions":{"EXT_mesh_gpu_instancing":{"attributes":{"TRANSLATION":)" +
                        std::to_string(accessor) + "}}}}]");
    };
    const GltfCase few(copies(6));
    INFO(few.report());
    INFO(few.scene);
    CHECK(few.has("object wall { shape wall mesh"));
    CHECK(few.has("instance wall { transform { translate 0 0 3 } }; instance wall { transform { translate 2 0 3 } }"));
    const GltfCase many(copies(7));
    INFO(many.report());
    INFO(many.scene);
    CHECK(many.has("instances wall { points"));
    CHECK(many.has("transform { translate 0 0 3 }"));
    CHECK(readAll(many.folder / "case-files/wall-places.ply")
              .starts_with("ply\nformat binary_little_endian 1.0\n"
                           "element vertex 17\n"));
}

TEST_CASE("glTF: a camera on a moving node has keys, and several moving nodes many") {
    const auto shot = [](const char* nodes, const char* channels) {
        return gltfWall(
            std::string(R"("materials":[{}],"cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}],)") +
            R"("scenes":[{"nodes":[0,1]}],"nodes":[{"mesh":0},)" + nodes + R"(],"animations":[{"channels":[)" +
            channels + R"(],"samplers":[{"input":5,"output":6}]}])");
    };
    const char* const kOuter = R"({"sampler":0,"target":{"node":1,"path":"translation"}})";
    const GltfCase one(shot(R"({"children":[2]},{"camera":0,"translation":[0,0,5]})", kOuter));
    INFO(one.scene);
    CHECK(one.has("transform { at 0 s { translate 0 0 5 }; at 1 s { translate 2 0 5 } }"));
    const GltfCase two(
        shot(R"({"children":[2]},{"camera":0})",
             (std::string(kOuter) + R"(,{"sampler":0,"target":{"node":2,"path":"translation"}})").c_str()));
    INFO(two.scene);
    CHECK(two.has("at 1 s { translate 4 0 0 }"));
    CHECK(two.has("at 0.5 s { translate 2 0 0 }"));
}

TEST_CASE("glTF: other materials of variants are named where they belong") {
    const GltfCase made(
        gltfWall(R"("materials":[{"name":"oak"},{"name":"steel"}],"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"extensions":{"KHR_materials_variants":{"variants":[{"name":"wooden"},{"name":"cold"}]}})",
                 "", R"(,"extensions":{"KHR_materials_variants":{"mappings":[{"material":1,"variants":[1]}]}})"));
    INFO(made.report());
    CHECK(made.has("material oak"));
    CHECK(made.has("// Variant `cold`: material `steel` of the file"));
    CHECK(made.says("W0801"));
}

TEST_CASE("glTF: what is scaled to nothing is left out, and keys keep a size") {
    const GltfCase still(gltfWall(
        R"("materials":[{}],"scenes":[{"nodes":[0,2]}],"nodes":[{"scale":[1,0,1],"children":[1]},{"mesh":0},{"mesh":0}])"));
    INFO(still.report());
    INFO(still.scene);
    CHECK(still.says("nodes[0] is left out"));
    CHECK(still.has("instance wall"));
    CHECK_FALSE(still.has("translate"));
    // scales of (0, 0, 0) and (2, 0, 0)
    const GltfCase moving(gltfWall(R"("materials":[{}],"scenes":[{"nodes":[0]}],"nodes":[{"mesh":0}],
"animations":[{"channels":[{"sampler":0,"target":{"node":0,"path":"scale"}}],"samplers":[{"input":5,"output":6}]}])"));
    INFO(moving.scene);
    CHECK(moving.has("scale 1e-05"));
}

TEST_CASE("glTF: what is stretched while it moves does not emit, and its lights stand still") {
    const GltfCase made(gltfWall(R"("materials":[{"name":"lamp","emissiveFactor":[1,1,1]}],"scenes":[{"nodes":[0]}],
"nodes":[{"scale":[1,2,1],"children":[1]},{"mesh":0,"children":[2]},{"translation":[0,1,0],"extensions":{"KHR_lights_punctual":{"light":0}}}],
"extensionsUsed":["KHR_lights_punctual"],"extensions":{"KHR_lights_punctual":{"lights":[{"type":"point"}]}},
"animations":[{"channels":[{"sampler":0,"target":{"node":1,"path":"translation"}}],"samplers":[{"input":5,"output":6}]}])"));
    INFO(made.report());
    INFO(made.scene);
    CHECK(made.says("what material `lamp` emits is left out"));
    CHECK_FALSE(made.has("emission"));
    CHECK(made.has("light light-2 point { intensity 1 cd; transform { translate 0 2 0 } }"));
    CHECK(made.has("group { transform { scale 1 2 1 }; group node-1 { transform { at 0 s"));
}

TEST_CASE("glTF: what a small file asks for is bounded") {
    std::string many = gltfMaterial("\"alphaMode\":\"OPAQUE\"");
    const std::string first = R"("bufferView":0,"byteOffset":0,"componentType":5126,"count":4,)";
    many.replace(many.find(first), first.size(), R"("componentType":5126,"count":400000000,)");
    CHECK(GltfCase(many).says("E0802"));
    // 300 nodes that move in each other, the last of them with 400 cameras: each has keys of all
    std::string nodes, channels, list;
    for (int i = 1; i <= 300; ++i) {
        nodes += ",{\"children\":[" + (i < 300 ? std::to_string(i + 1) : "301") + "]}";
        channels += (i > 1 ? "," : "") + std::string(R"({"sampler":0,"target":{"node":)") + std::to_string(i) +
                    R"(,"path":"translation"}})";
    }
    for (int i = 301; i < 701; ++i) list += (i > 301 ? "," : "") + std::to_string(i);
    nodes.replace(nodes.rfind("301"), 3, list);
    for (int i = 301; i < 701; ++i) nodes += ",{\"camera\":0}";
    const GltfCase chain(gltfWall(
        R"("materials":[{}],"cameras":[{"type":"perspective","perspective":{"yfov":1,"znear":1}}],"scenes":[{"nodes":[0,1]}],
"nodes":[{"mesh":0})" +
        nodes + R"(],"animations":[{"channels":[)" + channels + R"(],"samplers":[{"input":5,"output":6}]}])"));
    INFO(chain.report());
    CHECK(chain.says("the keys of nodes that move in each other"));
}
