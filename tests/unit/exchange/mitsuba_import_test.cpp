// Scenes of Mitsuba's as text in, scene text and diagnostics out.
#include "exchange/importer/importer.h"
#include "unit/io/temporary_folder.h"

#include <doctest/doctest.h>
#include <fstream>
#include <sstream>
#include <vector>

using namespace abbe;
using namespace abbe::exchange;

namespace {

namespace fs = std::filesystem;

struct Imported {
    std::string text;  // empty after errors
    std::string codes; // "W0801 W0803"
    std::string messages;
};

bool holds(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

void writeText(const fs::path& path, std::string_view text) { std::ofstream(path, std::ios::binary) << text; }

Imported importText(const TemporaryFolder& folder, const std::string& text) {
    const fs::path path = fs::path(folder / "") / "room.xml";
    writeText(path, text);
    const ImportFormat* const format = importFormat(path);
    REQUIRE(format);
    CHECK(format->name == "mitsuba");
    SourceMap sources;
    Diagnostics diagnostics;
    Imported result;
    result.text = importScene(*format, path, fs::path(folder / "") / "room.scene", sources, diagnostics).value_or("");
    for (const Diagnostic& d : diagnostics.all()) {
        result.codes += (result.codes.empty() ? "" : " ") + d.code;
        result.messages += d.message + "\n" + d.help + "\n";
        if (d.span.valid()) CHECK(d.span.end <= sources.text(d.span.file).size());
    }
    return result;
}

Imported importText(const std::string& text) {
    const TemporaryFolder folder;
    return importText(folder, text);
}

std::string scene(const std::string& body, const char* version = "3.0.0") {
    return std::string("<scene version=\"") + version + "\">" + body + "</scene>";
}

std::string ball(const std::string& bsdf) { return scene("<shape type=\"sphere\">" + bsdf + "</shape>"); }

} // namespace

TEST_CASE("a scene of Mitsuba is known by its root") {
    const TemporaryFolder folder;
    const fs::path path = fs::path(folder / "") / "a.xml";
    writeText(path, "<?xml version=\"1.0\"?>\n<!-- -->\n<scene version=\"3.0.0\"></scene>");
    CHECK(importFormat(path));
    writeText(path, "<html></html>");
    CHECK_FALSE(importFormat(path));
    CHECK_FALSE(importFormat(fs::path(folder / "") / "none.xml"));
}

TEST_CASE("a sphere with a material and a light become a shape") {
    const Imported made =
        importText(scene(R"(<bsdf type="diffuse" id="paint"><rgb name="reflectance" value="0.2, 0.4, 0.6"/></bsdf>
<shape type="sphere" id="ball"><point name="center" x="1" y="2"/><float name="radius" value="0.5"/><ref id="paint"/>
<emitter type="area"><rgb name="radiance" value="3"/></emitter></shape>)"));
    CHECK(made.codes == "");
    CHECK(holds(made.text, "scene 1 length=m"));
    CHECK(holds(made.text, "material paint diffuse { reflectance rgb 0.2 0.4 0.6 }"));
    CHECK(holds(made.text, "shape ball sphere { center 1 2 0; radius 0.5; material paint; emission rgb 3 3 3 }"));
}

TEST_CASE("cameras look where Mitsuba's do") {
    const Imported made =
        importText(scene(R"(<sensor type="perspective"><float name="fov" value="90"/><string name="fov_axis" value="y"/>
<transform name="to_world"><lookat origin="0, 0, 5" target="0, 0, 0" up="0, 1, 0"/></transform>
<film type="hdrfilm"><integer name="width" value="200"/><integer name="height" value="100"/></film></sensor>)"));
    CHECK(made.codes == "");
    CHECK(holds(made.text, "from 0 0 5; look-at 0 0 4; up 0 1 0"));
    CHECK(holds(made.text, "fov 126.8698976458"));
    CHECK(holds(made.text, "size 200 100"));
    CHECK(holds(made.text, "output room.exr space=rec709") != holds(made.text, "output \"room.exr\" space=rec709"));
}

TEST_CASE("a scene without a sensor is seen whole, in light if it has none") {
    const Imported made = importText(scene(R"(<shape type="sphere"><point name="center" x="10"/></shape>
<shape type="shapegroup" id="g"><shape type="cube"/></shape>
<shape type="instance"><ref id="g"/><transform name="to_world"><translate x="-10"/></transform></shape>)"));
    CHECK(made.codes == "");
    // From −11 to 11 in x, 2 high and deep: the camera is far enough away.
    CHECK(holds(made.text, "// The other scene has no sensor"));
    const std::size_t from = made.text.find("from ", made.text.find("camera perspective"));
    REQUIRE(from != std::string::npos);
    CHECK(std::stod(made.text.substr(from + 5)) > 11);
    CHECK(holds(made.text, "light key sun"));
    CHECK_FALSE(holds(importText(scene("<emitter type=\"constant\"/>")).text, "light key sun"));
}

TEST_CASE("what the camera is in is everywhere") {
    const std::string air = R"(<medium type="homogeneous" id="air"><float name="sigma_t" value="0.1"/></medium>)";
    const std::string sensor = "<sensor type=\"perspective\">" + air + "</sensor>";
    const std::string ball = R"(<shape type="sphere"><ref name="exterior" id="air"/></shape>)";
    const Imported made = importText(scene("<integrator type=\"volpath\"/>" + sensor + ball));
    CHECK(made.codes == "");
    CHECK(holds(made.text, "atmosphere air\n"));
    CHECK(importText(scene("<integrator type=\"path\"/>" + sensor + ball)).codes == "W0801");
    CHECK(importText(scene("<integrator type=\"volpath\"/>" + air + ball)).codes == "W0801");
}

TEST_CASE("defaults, includes and aliases") {
    const TemporaryFolder folder;
    writeText(fs::path(folder / "") / "part.xml", scene("<shape type=\"disk\" id=\"$name\"/>"));
    const Imported made = importText(
        folder, scene(R"(<default name="name" value="plate"/><default name="r" value="2"/><default name="rx" value="7"/>
<include filename="part.xml"/><shape type="sphere" id="b"><float name="radius" value="$rx"/><ref id="other"/></shape>
<bsdf type="diffuse" id="one"/><alias id="one" as="other"/>)"));
    CHECK(made.codes == "");
    CHECK(holds(made.text, "shape plate disk"));
    CHECK(holds(made.text, "radius 7"));
    CHECK(holds(made.text, "material one"));
}

TEST_CASE("faults of the text have places") {
    CHECK(importText("<scene version=\"3.0.0\"><shape").codes == "E0801");
    CHECK(importText(scene("<include filename=\"room.xml\"/>")).codes == "E0801");
    CHECK(importText(scene("<include filename=\"none.xml\"/>")).codes == "E0401");
    CHECK(importText(scene("<shape type=\"sphere\"><float name=\"radius\" value=\"$r\"/></shape>")).codes ==
          "E0802 E0802");
    CHECK(importText(ball("<ref id=\"none\"/>")).codes == "E0802");
    CHECK(importText(ball("<float name=\"radius\" value=\"1e999\"/>")).codes == "E0802");
    CHECK(importText(ball("<float name=\"radius\" value=\"nan\"/>")).codes == "E0802");
    CHECK(importText(ball("<float name=\"radius\" value=\"-1\"/>")).codes == "E0802");
    CHECK(importText(ball("<wrong name=\"radius\"/>")).codes.starts_with("E0802"));
    CHECK(importText(ball("<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"watr\"/></bsdf>"))
              .messages.find("water") != std::string::npos);
    CHECK(
        importText(
            scene("<shape type=\"rectangle\"><transform name=\"to_world\"><matrix value=\"1 2\"/></transform></shape>"))
            .codes == "E0802");
}

TEST_CASE("objects that contain themselves, and endless nesting, end in a diagnostic") {
    CHECK(holds(
        importText(
            scene(R"(<bsdf type="twosided" id="a"><ref id="b"/></bsdf><bsdf type="twosided" id="b"><ref id="a"/></bsdf>
<shape type="sphere"><ref id="a"/></shape>)"))
            .codes,
        "E0802"));
    std::string deep;
    for (int i = 0; i < 5000; ++i) deep += "<bsdf type=\"twosided\">";
    CHECK(holds(importText(ball(deep)).codes, "E0801"));
    for (int i = 0; i < 5000; ++i) deep += "</bsdf>";
    CHECK(importText(ball(deep)).codes.starts_with("E0801"));
    // A tree of references that doubles at every level is told level by level.
    std::string doubled = "<bsdf type=\"diffuse\" id=\"m0\"/>";
    for (int i = 1; i < 40; ++i)
        doubled += "<bsdf type=\"blendbsdf\" id=\"m" + std::to_string(i) + "\"><ref id=\"m" + std::to_string(i - 1) +
                   "\"/><ref id=\"m" + std::to_string(i - 1) + "\"/></bsdf>";
    CHECK(importText(scene(doubled + "<shape type=\"sphere\"><ref id=\"m39\"/></shape>")).text.size() < 20000);
}

TEST_CASE("objects that are named twice at every level do not double") {
    const auto chain = [](const std::string& tag, const std::string& type, const std::string& first, int levels) {
        std::string text = first;
        for (int i = 1; i < levels; ++i) {
            const std::string ref = "<ref id=\"n" + std::to_string(i - 1) + "\"/>";
            text +=
                "<" + tag + " type=\"" + type + "\" id=\"n" + std::to_string(i) + "\">" + ref + ref + "</" + tag + ">";
        }
        return text;
    };
    const Imported merged = importText(scene(chain("shape", "merge", "<shape type=\"sphere\" id=\"n0\"/>", 30)));
    CHECK(merged.text.size() < 100000);
    const Imported phases = importText(
        scene("<integrator type=\"volpath\"/>" + chain("phase", "blendphase", "<phase type=\"hg\" id=\"n0\"/>", 30) +
              "<shape type=\"sphere\"><bsdf type=\"null\"/><medium type=\"homogeneous\" name=\"interior\">"
              "<ref id=\"n29\"/></medium></shape>"));
    CHECK(holds(phases.codes, "E0802"));
}

TEST_CASE("what has no counterpart is said, and stands in the scene") {
    for (const char* shape : {"sdfgrid", "ellipsoids", "heightfield"}) {
        const Imported made = importText(
            scene(std::string("<shape type=\"") + shape + "\"><string name=\"filename\" value=\"a\"/></shape>"));
        CHECK(made.codes == "W0801");
        CHECK(holds(made.messages, shape));
    }
    CHECK(importText(ball("<bsdf type=\"measured_polarized\"><string name=\"filename\" value=\"a.pbsdf\"/></bsdf>"))
              .codes == "W0801");
    CHECK(
        importText(scene("<emitter type=\"projector\"><texture type=\"checkerboard\" name=\"irradiance\"/></emitter>"))
            .codes == "W0801");
    const Imported rough = importText(ball("<bsdf type=\"roughconductor\"/>"));
    CHECK(rough.codes == "W0802");
    CHECK(holds(rough.text, "// Approximated: distribution `beckmann`"));
    CHECK(importText(ball("<float name=\"raduis\" value=\"1\"/>")).codes == "W0803");
}

TEST_CASE("names of older versions are today's") {
    const Imported made =
        importText(scene(R"(<shape type="sphere"><transform name="toWorld"><translate x="1"/></transform>
<bsdf type="dielectric"><float name="intIOR" value="1.33"/><float name="extIOR" value="1"/></bsdf></shape>)",
                         "0.6.0"));
    CHECK(made.codes == "");
    CHECK(holds(made.text, "ior 1.33"));
    CHECK(holds(made.text, "translate 1 0 0"));
}

TEST_CASE("lights in the units of the language") {
    const Imported made = importText(
        scene(R"(<emitter type="point"><point name="position" value="1 2 3"/><rgb name="intensity" value="2"/></emitter>
<emitter type="spot"><float name="cutoff_angle" value="30"/><float name="beam_width" value="30"/><spectrum name="intensity" value="1"/></emitter>
<emitter type="directional"><vector name="direction" value="0 -1 0"/><rgb name="irradiance" value="1"/></emitter>)"));
    CHECK(made.codes == "");
    CHECK(holds(made.text, "intensity 145966 cd; color rgb 2 2 2"));
    CHECK(holds(made.text, "angle 60 deg; inner-angle 60 deg; intensity 72983 cd; color 1"));
    CHECK(holds(made.text, "irradiance 72983 lx"));
}

TEST_CASE("one-sided materials of open shapes are black from behind") {
    CHECK(holds(importText(scene("<shape type=\"rectangle\"/>")).text, "two-sided"));
    CHECK_FALSE(holds(importText(scene("<shape type=\"cube\"/>")).text, "two-sided"));
    const Imported both =
        importText(scene("<shape type=\"rectangle\"><bsdf type=\"twosided\"><bsdf type=\"diffuse\"/></bsdf></shape>"));
    CHECK_FALSE(holds(both.text, "two-sided"));
}

TEST_CASE("media are seen by integrators for media alone") {
    const std::string ball = R"(<shape type="sphere"><bsdf type="null"/><medium type="homogeneous" name="interior">
<float name="sigma_t" value="2"/><float name="scale" value="3"/><rgb name="albedo" value="0.5"/></medium></shape>)";
    const Imported seen = importText(scene("<integrator type=\"volpath\"/>" + ball));
    CHECK(seen.codes == "");
    CHECK(holds(seen.text, "medium medium homogeneous { extinction 6; albedo 0.5 }"));
    CHECK(holds(seen.text, "material boundary; interior medium"));
    CHECK(importText(scene("<integrator type=\"path\"/>" + ball)).codes == "W0801");
}

TEST_CASE("depth counts what scatters between the segments of a path") {
    CHECK(holds(
        importText(scene("<integrator type=\"path\"><integer name=\"max_depth\" value=\"5\"/></integrator>")).text,
        "max-depth 4"));
    CHECK(importText(scene("<integrator type=\"path\"><integer name=\"max_depth\" value=\"1\"/></integrator>")).codes ==
          "W0802");
    CHECK_FALSE(holds(importText(scene("<integrator type=\"path\"/>")).text, "max-depth"));
}

namespace {

// The numbers behind a word.
std::vector<double> numbersBehind(const std::string& text, const std::string& word) {
    std::vector<double> list;
    if (const std::size_t at = text.find(word + " "); at != std::string::npos) {
        std::istringstream rest(text.substr(at + word.size()));
        for (double value = 0; rest >> value;) list.push_back(value);
    }
    return list;
}

} // namespace

TEST_CASE("the sun of a sky stands where date and place have it") {
    // What Mitsuba 3.9.1 answers, z up: for its defaults, and for the Cape in summer.
    const auto check = [](const std::string& params, Vec3d sun) {
        const Imported made = importText(scene("<emitter type=\"sunsky\">" + params + "</emitter>"));
        const auto toward = numbersBehind(made.text, "toward");
        REQUIRE(toward.size() == 3);
        CHECK(toward[0] == doctest::Approx(-sun.x).epsilon(0.002));
        CHECK(toward[1] == doctest::Approx(-sun.z).epsilon(0.002));
        CHECK(toward[2] == doctest::Approx(sun.y).epsilon(0.002));
    };
    check("", {0.05138545, 0.69174796, 0.7203085});
    check("<float name=\"latitude\" value=\"-33\"/><float name=\"longitude\" value=\"20\"/>"
          "<float name=\"timezone\" value=\"2\"/><float name=\"hour\" value=\"10\"/>"
          "<integer name=\"month\" value=\"12\"/><integer name=\"day\" value=\"21\"/>",
          {-0.05217244, -0.5833583, 0.8105375});
}

TEST_CASE("a stated sun is one of the world, and sun and sky have brightnesses of their own") {
    const std::string turned = "<vector name=\"sun_direction\" value=\"0, 0.6, 0.8\"/><transform name=\"to_world\">"
                               "<rotate x=\"1\" angle=\"-90\"/></transform>";
    const Imported sky = importText(scene("<emitter type=\"sunsky\">" + turned + "</emitter>"));
    CHECK(holds(sky.text, "daylight {"));
    const auto toward = numbersBehind(sky.text, "toward"); // its own y is up, and the transform is none any more
    CHECK(toward.at(1) == doctest::Approx(-0.6));
    CHECK(toward.at(2) == doctest::Approx(-0.8));
    CHECK_FALSE(holds(sky.text, "sun off"));
    const Imported bright =
        importText(scene("<emitter type=\"sunsky\">" + turned + "<float name=\"sun_scale\" value=\"2\"/></emitter>"));
    CHECK(holds(bright.text, "sun off"));
    CHECK(holds(bright.text, "light sun"));
    CHECK(numbersBehind(bright.text, "irradiance").at(0) > 800); // twice some 450 W/m² of visible light
    CHECK(numbersBehind(bright.text, "irradiance").at(0) < 1300);
    const Imported old =
        importText(scene("<emitter type=\"sun\"><vector name=\"sunDirection\" value=\"0, 1, 0\"/></emitter>", "0.6.0"));
    CHECK_FALSE(holds(old.text, "daylight"));
    CHECK(holds(old.text, "toward 0 -1 0"));
    CHECK(importText(scene("<emitter type=\"sunsky\"><float name=\"hour\" value=\"23\"/></emitter>")).codes == "W0801");
}

TEST_CASE("hair is brown or absorbs what is stated, and thin sheets have gloss only where light passes") {
    const auto hair = [](const std::string& params) {
        return importText(ball("<bsdf type=\"hair\">" + params + "</bsdf>")).text;
    };
    CHECK(holds(hair(""), "eumelanin 1.3"));
    CHECK(holds(hair("<float name=\"eumelanin\" value=\"0.3\"/>"), "eumelanin 0.3"));
    CHECK(holds(hair("<rgb name=\"sigma_a\" value=\"0.5\"/><float name=\"scale\" value=\"2\"/>"), "absorption 1"));
    const auto thin = [](const std::string& params) {
        return importText(ball("<bsdf type=\"principledthin\">" + params + "</bsdf>")).text;
    };
    CHECK(holds(thin(""), "specular-weight 0"));
    CHECK(holds(thin("<float name=\"diff_trans\" value=\"1\"/>"), "subsurface-weight 0.5"));
    CHECK(holds(thin("<float name=\"spec_trans\" value=\"1\"/>"), "transmission-color 0.5"));
    CHECK(holds(thin("<float name=\"spec_trans\" value=\"0.25\"/>"), "amount 0.25"));
    CHECK(holds(importText(ball("<bsdf type=\"principled\"><rgb name=\"base_color\" value=\"0.25\"/>"
                                "<float name=\"spec_trans\" value=\"1\"/></bsdf>"))
                    .text,
                "transmission-color 0.5"));
    CHECK(holds(importText(ball("<bsdf type=\"polarizer\"/>")).text, "opacity 0.5"));
    CHECK(holds(importText(ball("<bsdf type=\"retarder\"/>")).text, "opacity 0"));
}

TEST_CASE("sensors in a batch are cameras, and what measures irradiance is said") {
    const Imported batch = importText(scene(R"(<sensor type="batch"><sensor type="perspective" id="left"/>
<sensor type="thinlens" id="right"/><film type="hdrfilm"><integer name="width" value="200"/><integer name="height" value="80"/></film>
</sensor>)"));
    CHECK(holds(batch.text, "camera left perspective"));
    CHECK(holds(batch.text, "camera right perspective"));
    CHECK(holds(batch.text, "size 100 80"));
    const Imported meter = importText(scene("<shape type=\"rectangle\"><sensor type=\"irradiancemeter\"/></shape>"));
    CHECK(meter.codes == "W0801");
    CHECK(holds(meter.messages, "irradiance / π"));
}

TEST_CASE("a projector throws its picture as a photometric file") {
    const Imported made =
        importText(scene("<emitter type=\"projector\"><rgb name=\"irradiance\" value=\"2\"/></emitter>"));
    CHECK(holds(made.text, "light projector ies \"room-files/projector.ies\""));
    CHECK(made.codes == "W0802");
}
