// Scenes for other programs: exact text where a convention is at stake, and round trips through our own importers.
#include "exchange/exporter/exporter.h"
#include "exchange/importer/importer.h"
#include "io/gltf.h"
#include "parser/parse.h"
#include "scene/build.h"
#include "scene/build_context.h"
#include "scene/instance_places.h"
#include "scene/registry.h"
#include "spectrum/sensor.h"
#include "support/scene_test.h"
#include "unit/io/temporary_folder.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fstream>
#include <set>
#include <sstream>

using namespace abbe;
using namespace abbe::exchange;

namespace {

namespace fs = std::filesystem;

// One folder in which scenes are exported and imported, and what was said about it.
struct Exchange {
    TemporaryFolder folder;
    std::string codes, messages; // of the last step

    fs::path path(const std::string& name) const { return fs::path(folder / "") / name; }

    void note(const Diagnostics& found, const SourceMap& sources) {
        codes.clear();
        messages.clear();
        for (const Diagnostic& d : found.all()) {
            codes += (codes.empty() ? "" : " ") + d.code;
            messages += d.message + "\n";
            if (d.code == "W0801" || d.code == "W0802") CHECK_MESSAGE((d.span.valid() || d.message.empty()), d.message);
            if (d.span.valid()) CHECK(d.span.end <= sources.text(d.span.file).size());
        }
    }

    // The bytes of the exported file; empty, and without a check, where the scene has errors.
    std::string exported(const std::string& format, const std::string& scene, const std::string& name = "made") {
        SourceMap sources;
        Diagnostics found;
        const schema::TypeTable types = makeTypeTable();
        const FileId file = sources.add("case.scene", scene);
        const auto document = abbe::parse(sources, file, {}, found);
        const auto tree = schema::resolve(document, types, path(""), found);
        if (!found.hasErrors()) {
            BuildOptions options;
            options.geometry = false;
            buildScene(tree, types, options, found);
        }
        if (found.hasErrors()) {
            note(found, sources);
            return {};
        }
        Diagnostics said;
        CurveLibrary curves;
        const ExportFormat& to = *findExportFormat(format);
        const InstancePlaces places = to.instancers ? findInstancePlaces(tree, types) : InstancePlaces();
        FindPlaces find;
        if (to.instancers)
            find = [&](const schema::Definition& d) {
                const auto place = places.find(&d);
                return place == places.end() ? nullptr : &place->second;
            };
        const StatedScene stated(
            tree, types, [&](const auto& value, auto role, Diagnostics& d) { return curves.curve(value, role, d); },
            find);
        std::string bytes = exportScene(to, stated, path(name + std::string(to.extension)), said);
        note(said, sources);
        return bytes;
    }

    std::string imported(const std::string& file, const std::string& text) {
        std::ofstream(path(file), std::ios::binary) << text;
        const ImportFormat* const format = importFormat(path(file));
        REQUIRE(format);
        SourceMap sources;
        Diagnostics found;
        std::string scene = importScene(*format, path(file), path(file + ".scene"), sources, found).value_or("");
        note(found, sources);
        INFO(messages);
        CHECK(!scene.empty());
        return scene;
    }
};

bool hasText(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

// The words of a scene, one a line, without comments and with seven digits: how it is laid out does not count.
std::string plain(const std::string& scene) {
    std::istringstream lines(scene);
    std::string out, line;
    while (std::getline(lines, line)) {
        line.resize(std::min(line.find("//"), line.size()));
        std::ranges::replace(line, ';', ' ');
        std::istringstream words(line);
        for (std::string word; words >> word;) {
            char* end = nullptr;
            const double v = std::strtod(word.c_str(), &end);
            out += *end == '\0' ? fmt::format("{:.7g}\n", v + 0.0) : word + "\n";
        }
    }
    return out;
}

// The first line in which two texts differ; empty where they are the same.
std::string difference(const std::string& a, const std::string& b) {
    std::istringstream first(a), second(b);
    for (std::string x, y;;) {
        const bool more = static_cast<bool>(std::getline(first, x)), other = static_cast<bool>(std::getline(second, y));
        if (!more && !other) return {};
        if (more != other || x != y) return (more ? x : "(end)") + "\n" + (other ? y : "(end)");
    }
}

// import → export → import is the same scene, and export → import → export the same text.
void checkStable(const std::string& format, const std::string& extension, const std::string& foreign) {
    Exchange ex;
    const std::string scene = ex.imported("made" + extension, foreign);
    const std::string text = ex.exported(format, scene);
    const std::string again = ex.imported("made" + extension, text);
    CHECK(difference(plain(again.substr(again.find("\n\n"))), plain(scene.substr(scene.find("\n\n")))) == "");
    CHECK(difference(ex.exported(format, again), text) == "");
}

const std::string kView = "scene 1\ncamera { from 0 1 4; look-at 0 0 0; fov 40 deg }\n"
                          "film { size 64 32; filter box 0.5 }\n";
// Without a light a scene is wrong.
const std::string kLit = kView + "light around sky { radiance 0.25 }\n";

std::string mitsubaScene(const std::string& body) {
    return "<scene version=\"3.0.0\"><integrator type=\"path\"><integer name=\"max_depth\" value=\"5\"/></integrator>"
           "<sensor type=\"perspective\" id=\"eye\"><float name=\"fov\" value=\"37.5\"/><transform name=\"to_world\">"
           "<lookat origin=\"0.3, 1.1, 5\" target=\"0.1, 0, 0.2\" up=\"0, 1, 0\"/></transform>"
           "<film type=\"hdrfilm\"><integer name=\"width\" value=\"64\"/><integer name=\"height\" value=\"48\"/>"
           "<rfilter type=\"box\"/></film><sampler type=\"independent\"><integer name=\"sample_count\" value=\"8\"/>"
           "</sampler></sensor>" +
           body + "</scene>";
}

} // namespace

TEST_CASE("export to Mitsuba: conventions") {
    Exchange ex;
    const auto made = [&](const std::string& body) { return ex.exported("mitsuba", kLit + body); };
    std::string text = made("shape quad { size 2 2; material diffuse { reflectance 0.25 } }");
    CHECK(hasText(text, R"(<shape type="rectangle" id="quad">)"));
    CHECK(hasText(text, R"(<bsdf type="twosided">)")); // ours reflects on both sides
    CHECK(hasText(text, R"(<spectrum name="reflectance" value="0.25" />)"));
    CHECK(hasText(text, R"(<float name="fov" value="40" />)"));
    CHECK(ex.codes.empty());
    text = made("shape sphere { material conductor { index { n 0.5; k 2 }; roughness 0.3 } }");
    CHECK(hasText(text, R"(<float name="alpha" value="0.09" />)"));
    text = made("light point { intensity 72983 cd }");
    CHECK(hasText(text, R"(<rgb name="intensity" value="1 1 1" />)")); // factors of D65
    text = made("light spot { angle 40 deg; inner-angle 30 deg; intensity 100 cd; color blackbody 3000 K }");
    CHECK(hasText(text, R"(<float name="cutoff_angle" value="20" />)"));
    CHECK(hasText(text, R"(<float name="beam_width" value="15" />)"));
    CHECK(ex.codes == "W0802");
    text = made("render { max-depth 4 }\nlight sky { radiance 0.5 }");
    CHECK(hasText(text, R"(<integer name="max_depth" value="5" />)"));
    CHECK(hasText(text, R"(<spectrum name="radiance" value="0.5" />)"));
    // One side alone.
    text =
        made("shape quad { material two-sided { front diffuse { reflectance 0.8 }; back diffuse { reflectance 0 } } }");
    CHECK_FALSE(hasText(text, "twosided"));
}

TEST_CASE("export to Mitsuba: exposure is in the light, and what is missing is said with its place") {
    Exchange ex;
    const std::string view =
        "scene 1\ncamera { from 0 1 4; look-at 0 0 0; exposure 3 stops; tilt 3 0 deg }\nfilm { filter box 0.5 }\n";
    std::string text = ex.exported("mitsuba", view + "light point { intensity 72983 cd }");
    CHECK(hasText(text, R"(<rgb name="intensity" value="8 8 8" />)"));
    CHECK(ex.codes == "W0802 W0801");
    CHECK(hasText(ex.messages, "`tilt` of `perspective` is left out"));
    CHECK(hasText(text, "<!-- Left out: `tilt`"));
    text = ex.exported(
        "mitsuba", kLit + "shape sphere { material sheen { color 0.5 } }\nshape points { points 0 0 0; radius 0.1 }");
    CHECK(hasText(ex.messages, "`sheen` is approximated"));
    CHECK(hasText(ex.messages, "shape `points` is left out"));
}

TEST_CASE("export: a grid of instances is instances") {
    Exchange ex;
    const std::string scene = kLit + "object peg { shape sphere { radius 0.1 } }\ninstances peg { grid 2 1 1; spacing "
                                     "3 1 1; transform { translate 0 2 0 } }";
    const std::string text = ex.exported("mitsuba", scene);
    CHECK(hasText(text, R"(<matrix value="1 0 0 -1.5 0 1 0 2 0 0 1 0 0 0 0 1" />)"));
    CHECK(hasText(text, R"(<matrix value="1 0 0 1.5 0 1 0 2 0 0 1 0 0 0 0 1" />)"));
    CHECK(ex.codes.empty());
    ex.exported("pbrt", kLit + "object peg { shape sphere { radius 0.1 } }\ninstances peg { scatter 5 }");
    CHECK(ex.codes == "W0801");
}

TEST_CASE("export to Mitsuba and back: the same scene") {
    const std::string light =
        R"(<emitter type="constant" id="all"><rgb name="radiance" value="0.6, 0.5, 0.4"/></emitter>)";
    const auto ball = [&](const std::string& inside) {
        return mitsubaScene(
            light +
            R"(<shape type="sphere" id="ball"><point name="center" value="0.5, 0.25, -1"/><float name="radius" value="0.8"/>)" +
            inside + "</shape>");
    };
    for (
        const char* bsdf :
        {R"(<bsdf type="twosided" id="m"><bsdf type="diffuse"><rgb name="reflectance" value="0.3, 0.2, 0.7"/></bsdf></bsdf>)",
         R"(<bsdf type="mask" id="m"><float name="opacity" value="0.4"/><bsdf type="twosided"><bsdf type="diffuse"/></bsdf></bsdf>)",
         R"(<bsdf type="plastic" id="m"><float name="int_ior" value="1.4"/><float name="ext_ior" value="1"/><rgb name="diffuse_reflectance" value="0.3, 0.4, 0.5"/></bsdf>)",
         R"(<bsdf type="dielectric" id="m"><float name="int_ior" value="1.45"/><float name="ext_ior" value="1"/></bsdf>)",
         R"(<bsdf type="roughdielectric" id="m"><float name="int_ior" value="1.45"/><float name="ext_ior" value="1"/><string name="distribution" value="ggx"/><float name="alpha" value="0.12"/></bsdf>)",
         R"(<bsdf type="thindielectric" id="m"><float name="int_ior" value="1.45"/><float name="ext_ior" value="1"/></bsdf>)",
         R"(<bsdf type="null" id="m"/><medium type="homogeneous" name="interior" id="fog"><spectrum name="sigma_t" value="1.5"/><spectrum name="albedo" value="0.9"/><phase type="hg"><float name="g" value="0.7"/></phase></medium>)"}) {
        CAPTURE(bsdf);
        std::string scene = ball(bsdf);
        if (hasText(scene, "null")) scene.replace(scene.find("\"path\""), 6, "\"volpath\"");
        checkStable("mitsuba", ".xml", scene);
    }
    checkStable(
        "mitsuba", ".xml",
        mitsubaScene(
            R"(<emitter type="point" id="p"><point name="position" value="2, 3, 1.7"/><rgb name="intensity" value="20, 10, 5"/></emitter>
      <emitter type="directional" id="d"><vector name="direction" value="-1, -2, -1"/><spectrum type="blackbody" name="irradiance"><float name="temperature" value="3200"/></spectrum></emitter>
      <shape type="rectangle" id="wall"><transform name="to_world"><rotate y="1" angle="30"/><translate x="0.3"/></transform>
      <bsdf type="diffuse" id="paint"><rgb name="reflectance" value="0.1, 0.9, 0.3"/></bsdf></shape>
      <shape type="disk" id="half"><bsdf type="blendbsdf" id="both"><float name="weight" value="0.3"/><bsdf type="diffuse" id="one"/><bsdf type="conductor" id="two"/></bsdf></shape>
      <shape type="cube" id="crate"><transform name="to_world"><scale value="0.3"/></transform><bsdf type="twosided" id="wood"><bsdf type="diffuse"/></bsdf></shape>
      <shape type="disk" id="plate"><transform name="to_world"><translate y="1"/></transform><emitter type="area"><rgb name="radiance" value="3, 2, 1"/></emitter></shape>)"));
}

TEST_CASE("export to pbrt: conventions") {
    Exchange ex;
    const auto made = [&](const std::string& body) { return ex.exported("pbrt", kLit + body); };
    std::string text =
        made("shape sphere { center 1 2 3; radius 0.5; material diffuse { reflectance rgb 0.1 0.2 0.3 } }");
    CHECK(hasText(text, "LookAt 0 1 4 ")); // x turned over, z as it is
    CHECK(hasText(text, "Transform [ -1 0 0 0 0 1 0 0 0 0 1 0 -1 2 3 1 ]"));
    CHECK(hasText(text, R"("rgb reflectance" [ 0.1 0.2 0.3 ])"));
    CHECK(ex.codes.empty());
    // The angle across the shorter side: tan(20°)/2 here.
    CHECK(hasText(text, fmt::format(R"("float fov" [ {:.9g} ])", 2 * std::atan(std::tan(20 * kDegree) / 2) / kDegree)));
    text = made("shape sphere { material conductor { index metal Cu; roughness 0.3 } }");
    CHECK(hasText(
        text,
        R"("spectrum eta" [ "metal-Cu-eta" ] "spectrum k" [ "metal-Cu-k" ] "float roughness" [ 0.09 ] "bool remaproughness" [ false ])"));
    text = made("light spot { angle 40 deg; inner-angle 30 deg; intensity 100 cd }");
    CHECK(hasText(text, R"("float coneangle" [ 20 ] "float conedeltaangle" [ 5 ])"));
    text = made("light sun { toward 1 -2 0; angular-diameter 0 deg; irradiance " + std::to_string(2 * kUnitLuminance) +
                " lx }");
    CHECK(hasText(text, R"(LightSource "distant" "point3 from" [ 0 0 0 ] "point3 to" [ -1 -2 0 ] "float scale" [ 2)"));
    text = ex.exported("pbrt", "scene 1\ncamera { from 0 1 4; look-at 0 0 0; exposure 2 stops }\nfilm { size 32 32; "
                               "filter box 0.5 }\nlight sky");
    CHECK(hasText(text, R"("string sensor" [ "cie1931" ] "float iso" [ 400 ])"));
}

TEST_CASE("export to pbrt and back: the same scene") {
    const auto world = [](const std::string& body) {
        return "LookAt 0.25 1.5 -4  0.1 0.3 0.2  0 1 0\nCamera \"perspective\" \"float fov\" 37.5\n"
               "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 48 \"float iso\" 150\n"
               "PixelFilter \"box\"\nSampler \"zsobol\" \"integer pixelsamples\" 8\nIntegrator \"volpath\" \"integer "
               "maxdepth\" 6\n"
               "WorldBegin\n" +
               body;
    };
    checkStable("pbrt", ".pbrt", world(R"(LightSource "point" "rgb I" [ 3 2 1 ] "float scale" 4 "point3 from" [ 1 2 -1 ]
LightSource "infinite" "rgb L" [ 0.2 0.3 0.4 ]
MakeNamedMaterial "paint" "string type" "diffuse" "rgb reflectance" [ 0.3 0.2 0.7 ]
NamedMaterial "paint"
Translate 0.5 0 1
Rotate 20 0 1 0
Shape "sphere" "float radius" 0.75
Shape "trianglemesh" "point3 P" [ 0 0 0  1 0 0  0 1 0 ] "integer indices" [ 0 1 2 ])"));
    for (
        const char* material :
        {R"("string type" "dielectric" "float eta" 1.45 "float roughness" 0.02 "bool remaproughness" false)",
         R"("string type" "conductor" "spectrum eta" "metal-Au-eta" "spectrum k" "metal-Au-k" "float uroughness" 0.2 "float vroughness" 0.1 "bool remaproughness" false)",
         R"("string type" "thindielectric" "float eta" 1.3)",
         R"("string type" "diffusetransmission" "rgb reflectance" [ 0.3 0.2 0.1 ] "rgb transmittance" [ 0.1 0.2 0.4 ])",
         R"("string type" "coateddiffuse" "rgb reflectance" [ 0.3 0.2 0.1 ] "float eta" 1.4 "float roughness" 0.1 "bool remaproughness" false)"}) {
        CAPTURE(material);
        checkStable("pbrt", ".pbrt",
                    world(fmt::format(
                        "LightSource \"infinite\"\nMakeNamedMaterial \"m\" {}\nNamedMaterial \"m\"\nShape \"sphere\"\n",
                        material)));
    }
    checkStable(
        "pbrt", ".pbrt",
        world(
            R"(LightSource "spot" "blackbody I" 3000 "float scale" 5 "point3 from" [ 0 3 0 ] "point3 to" [ 0 2 0.1 ] "float coneangle" 25 "float conedeltaangle" 4
MakeNamedMedium "fog" "string type" "homogeneous" "rgb sigma_s" [ 1 0.5 0.2 ] "rgb sigma_a" [ 0.1 0.2 0.3 ] "float g" 0.4
AttributeBegin
Material "interface"
MediumInterface "fog" ""
Shape "sphere" "float radius" 0.5
AttributeEnd
AttributeBegin
AreaLightSource "diffuse" "rgb L" [ 4 3 2 ]
Translate 0 2 0
Shape "disk" "float radius" 0.4
AttributeEnd
Shape "cylinder" "float radius" 0.3 "float zmin" -0.5 "float zmax" 0.75)"));
}

TEST_CASE("export to pbrt and back shows the same picture") {
    Exchange ex;
    const std::string scene =
        "scene 1\nfilm { size 24 24; filter box 0.5; output \"x.exr\" space=rec709 }\n"
        "camera { from 0.5 1.5 4; look-at 0 0 0; fov 40 deg; exposure 9 stops }\nrender { max-depth 4 }\n"
        "light point { position 2 3 2; intensity 3000 cd; color rgb 1 0.6 0.3 }\n"
        "light quad { size 1 1; power 5000 lm; transform { rotate x 90 deg; translate -1 2 0 } }\n"
        "light sky { luminance 50 nits }\n"
        "shape quad { size 8 8; transform { rotate x -90 deg; translate 0 -1 0 }; material diffuse { reflectance 0.4 } "
        "}\n"
        "shape cylinder { axis 0.4 1 0.3; radius 0.4; center 1 0 0; material diffuse { reflectance rgb 0.2 0.5 0.7 } "
        "}\n"
        "shape box { size 0.7 0.9 0.8; transform { rotate y 25 deg; translate -0.8 -0.5 0 }; material conductor { "
        "index metal Au; roughness 0.4 } }\n"
        "shape sphere { center 0 0.2 0.8; radius 0.4; material dielectric { ior 1.5; absorption rgb 1 2 4 per-m } }\n";
    const std::string text = ex.exported("pbrt", scene);
    const std::string back = ex.imported("made.pbrt", text);
    std::ofstream(ex.path("back.scene")) << back;
    const auto first = abbe::test::TestScene::parse(scene), second = abbe::test::TestScene::load(ex.path("back.scene"));
    INFO(back);
    INFO(second.report());
    REQUIRE_FALSE(second.diagnostics().hasErrors());
    const auto mean = [](const abbe::test::TestScene& s, PixelBounds part) {
        return abbe::test::render(s, 128).film.tile(part).mean * s.built().exposure;
    };
    for (int y = 0; y < 24; y += 8)
        for (int x = 0; x < 24; x += 8) {
            const PixelBounds part{x, y, x + 8, y + 8};
            CHECK(mean(second, part) == doctest::Approx(mean(first, part)).epsilon(0.03));
        }
}

TEST_CASE("export to glTF: what is read back") {
    Exchange ex;
    const std::string bytes =
        ex.exported("gltf", kView + "shape floor quad { size 4 2; transform { translate 0 0.5 0 }; material paint }\n"
                                    "material paint diffuse { reflectance rgb 0.2 0.4 0.6 }\n"
                                    "shape box { material conductor { index metal Au; roughness 0.25 } }\n"
                                    "light lamp point { position 1 2 3; intensity 120 cd }\n");
    CHECK(ex.codes.empty());
    const MeshFile file = parseGltf(bytes, "made.glb");
    CHECK(file.mesh.triangles.size() == 2 + 12);
    CHECK(file.groups.size() == 2);
    CHECK(file.mesh.positions[0] == Vec3(-2, -0.5f, 0));
    CHECK(file.mesh.uvs[0] == Vec2(0, 0)); // turned over and back
    const auto cameras = parseGltfCameras(bytes, "made.glb");
    REQUIRE(cameras.size() == 1);
    CHECK(cameras[0].aspect == doctest::Approx(2));
    CHECK(cameras[0].verticalFov == doctest::Approx(2 * std::atan(std::tan(20 * kDegree) / 2)));
    CHECK(length(cameras[0].placement.t - Vec3d(0, 1, 4)) < 1e-12);
    CHECK(hasText(bytes, R"("type":"point")"));
    CHECK(hasText(bytes, R"("intensity":120.0)"));
    CHECK(hasText(bytes, R"("baseColorFactor":[0.2,0.4,0.6,1.0])"));
    CHECK(hasText(bytes, R"("roughnessFactor":0.25)"));
    ex.exported("gltf", kView + "light sky");
    CHECK(ex.codes == "W0801");
    CHECK(hasText(ex.messages, "light `sky` is left out"));
}

// Whatever a scene states is written, or said to be missing: nothing crashes, and every example of the reference goes
// through every writer.
TEST_CASE("export: every type and property of the language" * doctest::test_suite("sweep")) {
    const schema::TypeTable types = makeTypeTable();
    Exchange ex;
    int tried = 0;
    for (const schema::TypeInfo& type : types.all()) {
        std::vector<std::string> bodies = {std::string(type.example)};
        for (const schema::FieldInfo& field : type.fields)
            if (!field.example.empty() && (type.kind == schema::Kind::shape || type.kind == schema::Kind::light ||
                                           type.kind == schema::Kind::material)) {
                const std::string inner = fmt::format("{} {{ {} }}", type.name, field.example);
                bodies.push_back(type.kind == schema::Kind::material
                                     ? "shape sphere { material " + inner + " }"
                                     : fmt::format("{} {}", schema::keyword(type.kind), inner));
            }
        for (const std::string& body : bodies)
            for (const char* format : {"mitsuba", "pbrt", "gltf", "usda"}) {
                CAPTURE(body);
                const bool camera = type.kind == schema::Kind::camera || type.kind == schema::Kind::film;
                const std::string text = ex.exported(format, (camera ? "scene 1\nlight sky\n" : kLit) + body + "\n");
                tried += text.empty() ? 0 : 1;
            }
    }
    CHECK(tried > 300);
}

const std::string kOpen = "scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\nlight sky { luminance 1000 nits }\n";

TEST_CASE("export to OpenUSD: many instances are one point instancer, where a render has them") {
    Exchange ex;
    const std::string peg = kOpen + "object peg { shape sphere { radius 0.1 } }\n";
    const std::string grid = ex.exported("usda", peg + "instances peg { grid 2 1 2; spacing 0.5 1 2 }");
    CHECK(ex.codes.empty());
    CHECK(grid.find("int[] protoIndices = [0, 0, 0, 0]") != std::string::npos);
    CHECK(grid.find("point3f[] positions = [(-0.25, 0, -1), (0.25, 0, -1), (-0.25, 0, 1), (0.25, 0, 1)]") !=
          std::string::npos);
    CHECK(grid.find("orientations") == std::string::npos);
    CHECK(grid.find("scales") == std::string::npos);
    // A third of a turn about the diagonal takes x to y, after the stretch.
    std::ofstream(ex.path("at.ply")) << "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                                        "property float z\nproperty float qx\nproperty float qy\nproperty float qz\n"
                                        "property float qw\nproperty float sx\nproperty float sy\nproperty float sz\n"
                                        "end_header\n1 2 3 0.5 0.5 0.5 0.5 -2 1 3\n";
    const std::string file = ex.exported("usda", peg + "instances peg { points \"at.ply\" }");
    CHECK(ex.codes.empty());
    CHECK(file.find("quatf[] orientationsf = [(0.5, 0.5, 0.5, 0.5)]") != std::string::npos);
    CHECK(file.find("float3[] scales = [(-2, 1, 3)]") != std::string::npos);
    // As many as there are to be, upright, inside of the area.
    const std::string some = ex.exported("usda", peg + "instances peg { scatter 3; area 2 1; turn 0 deg }");
    CHECK(ex.codes.empty());
    CHECK(some.find("int[] protoIndices = [0, 0, 0]") != std::string::npos);
    CHECK(some.find("orientations") == std::string::npos);
    // Lights in a point instancer are not drawn.
    const std::string lamps = ex.exported("usda", kOpen + "object lamp { light sphere { radius 0.1; power 5 lm } }\n"
                                                          "instances lamp { grid 3 1 1 }");
    CHECK(lamps.find("PointInstancer") == std::string::npos);
    CHECK(lamps.find("instanceable = true") != std::string::npos);
}

TEST_CASE("export to OpenUSD: what displaces and fills a shape is part of its material") {
    Exchange ex;
    const std::string cage =
        "shape s subdivision { points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 1 0 }; faces { - 0 1 2 3 }; "
        "uvs { - 0 0; - 1 0; - 1 1; - 0 1 }; ";
    const std::string bark = ex.exported("usda", kOpen + cage +
                                                     "displacement 2 cm { map ramp { over u; stop 0 0; stop 1 1 }; "
                                                     "midpoint 0.25 } }");
    CHECK(ex.codes.empty());
    CHECK(bark.find("\"ND_displacement_float\"") != std::string::npos);
    CHECK(bark.find("float inputs:scale = 0.02") != std::string::npos);
    CHECK(bark.find("float inputs:in2 = 0.25") != std::string::npos);
    CHECK(bark.find("outputs:mtlx:displacement.connect = </Looks/material_s/displacement.outputs:out>") !=
          std::string::npos);
    // A shape that shines is a light, whose material is not asked.
    ex.exported("usda", kOpen + cage + "emission 0.5; displacement 2 cm { map ramp { over u; stop 0 0; stop 1 1 } } }");
    CHECK(ex.codes == "W0801");
    // 1 / (3 + 1) m, of which light e^-1 is left, 3 of 4 parts scattered.
    const std::string juice =
        ex.exported("usda", kOpen + "shape sphere { radius 1; material boundary; interior homogeneous "
                                    "{ scattering 3 per-m; absorption 1 per-m } }");
    CHECK(ex.codes.empty());
    CHECK(juice.find("float inputs:transmission_depth = 0.25") != std::string::npos);
    CHECK(juice.find("color3f inputs:transmission_color = (0.36787945, 0.36787945, 0.36787945)") != std::string::npos);
    CHECK(juice.find("color3f inputs:transmission_scatter = (0.75, 0.75, 0.75)") != std::string::npos);
}

// A property that a scene states changes what is written, or is said to be missing.
TEST_CASE("export: no property is dropped without a word" * doctest::test_suite("sweep")) {
    const schema::TypeTable types = makeTypeTable();
    Exchange ex;
    // What changes no picture, or is the default in the example.
    const std::set<std::string> silent = {"priority", "portals", "attenuation-distance", "time",
                                          "shutter",  "at",      "texture-cache"};
    const std::array<std::string, 8> bases = {"",
                                              "points 0 0 0  1 0 0  1 1 0  0 1 0",
                                              "points { - 0 0 0; - 1 0 0; - 1 1 0 }; faces { - 0 1 2 }",
                                              "power 100 lm",
                                              "points { - 0 0 0; - 1 0 0; - 1 1 0 }; faces { - 0 1 2 }; power 100 lm",
                                              "index metal Au",
                                              "first diffuse { reflectance 0.8 }; second diffuse { reflectance 0.1 }",
                                              "base diffuse { reflectance 0.7 }"};
    int tried = 0;
    for (const schema::TypeInfo& type : types.all()) {
        const bool material = type.kind == schema::Kind::material;
        if (!material && type.kind != schema::Kind::shape && type.kind != schema::Kind::light) continue;
        for (const schema::FieldInfo& field : type.fields) {
            if (field.example.empty() || silent.contains(std::string(field.name))) continue;
            const double stated = std::atof(field.example.data() + field.name.size());
            if (!field.defaultText.empty() && std::atof(field.defaultText.c_str()) == stated) continue; // nothing new
            std::string example(field.example); // some state the default
            if (field.name == "material") example = "material diffuse { reflectance 0.3 }";
            if (field.name == "normal" && !material) example = "normal 1 1 0";
            if (field.name == "axis") example = "axis 1 1 0";
            for (const std::string& base : bases) {
                const auto body = [&](const std::string& inside) {
                    const std::string text = fmt::format("{} {{ {} }}", type.name, inside);
                    return kLit + (material ? "shape sphere { material " + text + " }"
                                            : fmt::format("{} {}", schema::keyword(type.kind), text));
                };
                bool any = false;
                for (const char* format : {"mitsuba", "pbrt", "gltf", "usda"}) {
                    const std::string without = ex.exported(format, body(base));
                    const std::string codes = ex.codes;
                    const std::string with = ex.exported(format, body(base.empty() ? example : base + "; " + example));
                    if (without.empty() || with.empty()) continue;
                    any = true;
                    if (!codes.empty()) continue; // the whole thing is another there, and that is said
                    ++tried;
                    CHECK_MESSAGE((with != without || ex.codes != codes), format, ": ", schema::keyword(type.kind), " ",
                                  type.name, " { ", base, "; ", example, " }");
                }
                if (any) break;
            }
        }
    }
    CHECK(tried > 150);
}
