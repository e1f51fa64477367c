// What is suspicious about whole scenes, and what only looks like it.
#include "base/diagnostic_format.h"
#include "parser/layer_files.h"
#include "scene/registry.h"
#include "scene_checks/scene_checks.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

constexpr const char* kSkyLight = "light sky { radiance 1 }\n";
constexpr const char* kTetrahedron = "points { - 0 0 0; - 1 0 0; - 0 1 0; - 0 0 1 }\n";
constexpr const char* kOutwards = "faces { - 0 2 1; - 0 1 3; - 1 2 3; - 0 3 2 }\n";
constexpr const char* kInwards = "faces { - 0 1 2; - 0 3 1; - 1 3 2; - 0 2 3 }\n";

struct Found {
    std::string codes, told;
    bool inBody = false;
};

Found check(const std::string& text, CheckDepth depth = CheckDepth::surfaces) {
    SourceMap sources;
    const schema::TypeTable types = makeTypeTable();
    Diagnostics loading, found;
    const FileId file = sources.add("test.scene", text);
    const auto tree = schema::resolve(readLayerFiles(sources, file, "test.scene", {}, loading), types, loading);
    BuildOptions options;
    options.geometry = false;
    const BuiltScene built = buildScene(tree, types, options, loading);
    REQUIRE_MESSAGE(!loading.hasErrors(), formatShort(loading, sources));
    Found result;
    result.inBody = checkWholeScene(built, tree, depth, found).cameraInBody;
    for (const Diagnostic& d : found.all()) {
        result.codes += (result.codes.empty() ? "" : " ") + d.code;
        result.told += d.message + ": " + d.label + "; ";
        for (const std::string& note : d.notes) result.told += note + "; ";
        result.told += d.help + "\n";
        CHECK_MESSAGE(d.span.valid(), d.code); // located
        CHECK_MESSAGE(findCode(d.code), d.code);
    }
    return result;
}

Found checkBody(const std::string& body, const std::string& camera = "from 0 0 9; look-at 0 0 0") {
    return check("scene 1\ncamera { " + camera + " }\n" + kSkyLight + body);
}

bool holds(const Found& found, std::string_view text) { return found.told.find(text) != std::string::npos; }

std::string glassMesh(const std::string& faces, const std::string& more = "") {
    return "shape crystal mesh {\n" + std::string(kTetrahedron) + faces + "material dielectric\n" + more + "}\n";
}

} // namespace

TEST_CASE("scene checks: a refracting surface with holes, with the number of its edges and one of them") {
    const Found pane = checkBody("shape pane quad { size 1 2; material dielectric }\n");
    CHECK(pane.codes == "W0605");
    CHECK(holds(pane, "`pane`"));
    CHECK(holds(pane, "4 edges of a single face"));
    CHECK(holds(pane, "from -0.5 -1 0 to"));
    CHECK(holds(pane, "`thin-dielectric`"));
    CHECK(holds(checkBody(glassMesh("faces { - 0 2 1; - 0 1 3; - 1 2 3 }\n")), "3 edges of a single face"));
    CHECK(holds(checkBody(glassMesh("faces { - 0 2 1; - 0 1 3; - 1 2 3; - 0 2 3 }\n")),
                "3 edges between faces that are turned"));
    CHECK(checkBody("shape cylinder { caps off; material dielectric }\n").codes == "W0605");
    CHECK(checkBody("shape disk { material dielectric }\n").codes == "W0605");
    // In the units and at the place of the scene, not of the camera.
    CHECK(holds(check("scene 1 length=cm\ncamera { from 7 8 900; look-at 7 8 0 }\n" + std::string(kSkyLight) +
                      "shape pane quad { size 100 200; material dielectric }\n"),
                "from -50 -100 0 to"));
}

TEST_CASE("scene checks: closed solids, thin panes and shapes that close each other are no holes") {
    for (const std::string& body :
         {std::string("shape quad { size 1 2; material thin-dielectric }\n"), glassMesh(kOutwards),
          std::string("shape sphere { material dielectric }\n"), std::string("shape box { material dielectric }\n"),
          std::string("shape cylinder { material dielectric }\n"), std::string("shape torus { material dielectric }\n"),
          std::string("shape cone { material dielectric }\n"),
          std::string("shape plane { center 0 -2 0; material dielectric }\n"),
          std::string("shape quad { size 1 2; material diffuse }\n"),
          // Three sides, and the fourth by itself.
          glassMesh("faces { - 0 2 1; - 0 1 3; - 1 2 3 }\n") + "shape side mesh {\n" + kTetrahedron +
              "faces { - 0 3 2 }\nmaterial dielectric { ior 1.1 }\n}\n"})
        CHECK_MESSAGE(checkBody(body).codes == "", body << checkBody(body).told);
    // The same on its own is open, and a side that is elsewhere closes nothing.
    CHECK(checkBody(glassMesh("faces { - 0 2 1; - 0 1 3; - 1 2 3 }\n") + "shape side mesh {\n" + kTetrahedron +
                    "faces { - 0 3 2 }\nmaterial dielectric\ntransform { translate 2 0 0 }\n}\n")
              .codes == "W0605 W0605");
    // With an interior it is W0694, which comes with the building.
    CHECK(checkBody(glassMesh("faces { - 0 2 1; - 0 1 3; - 1 2 3 }\n", "interior homogeneous { extinction 1 per-m }\n"))
              .codes == "");
}

TEST_CASE("scene checks: solids and lamps that are inside out") {
    const Found turned = checkBody(glassMesh(kInwards));
    CHECK(turned.codes == "W0606");
    CHECK(holds(turned, "`crystal`"));
    CHECK(checkBody(glassMesh(kOutwards)).codes == "");
    // A mirror turns the faces, and the program turns them back.
    CHECK(checkBody(glassMesh(kOutwards, "transform { scale -1 1 1 }\n")).codes == "");
    // The cavity of a bubble.
    CHECK(checkBody("shape sphere { radius 2; material dielectric }\n" + glassMesh(kInwards)).codes == "");
    const auto lamp = [](const std::string& faces) {
        return checkBody("shape lamp mesh {\n" + std::string(kTetrahedron) + faces + "emission illuminant D65\n}\n");
    };
    CHECK(lamp(kInwards).codes == "W0607");
    CHECK(lamp(kOutwards).codes == "");
}

TEST_CASE("scene checks: solids of one priority that cross") {
    const auto pair = [](const std::string& second, const std::string& material = "dielectric { ior 1.33 }") {
        return checkBody("shape a sphere { radius 1; material dielectric }\nshape b " + second + "; material " +
                         material + " }\n");
    };
    const Found crossing = pair("sphere { center 1.2 0 0; radius 1");
    CHECK(crossing.codes == "W0608");
    CHECK(holds(crossing, "`a` and `b` overlap, and both have the priority 0"));
    CHECK(holds(crossing, "`priority 1`"));
    CHECK(pair("sphere { center 1.99 0 0; radius 1").codes == "W0608");    // by a hundredth
    CHECK(pair("box { min -0.1 -0.1 -3; max 0.1 0.1 3").codes == "W0608"); // a rod through it
    CHECK(pair("plane { center 0 0.2 0").codes == "W0608");                // half under water
    CHECK(pair("sphere { center 2.001 0 0; radius 1").codes == "");        // apart
    CHECK(pair("sphere { center 0.2 0 0; radius 0.5").codes == "");        // in it
    CHECK(pair("sphere { radius 3").codes == "");                          // around it
    CHECK(pair("plane { center 0 -1.5 0").codes == "");
    CHECK(pair("sphere { center 1.2 0 0; radius 1", "dielectric { ior 1.33; priority 1 }").codes == "");
    CHECK(pair("sphere { center 1.2 0 0; radius 1", "dielectric { ior 1.5 }").codes == ""); // the same glass
    CHECK(pair("sphere { center 1.2 0 0; radius 1", "thin-dielectric").codes == "");
}

TEST_CASE("scene checks: what only touches does not cross") {
    const auto blocks = [](const std::string& second) {
        return checkBody("shape a box { min -1 -1 -1; max 1 1 1; material dielectric }\nshape b box { " + second +
                         "; material dielectric { ior 1.33 } }\n")
            .codes;
    };
    CHECK(blocks("min 1 -1 -1; max 3 1 1") == "");
    CHECK(blocks("min -1 -1 -1; max 1 0 1") == ""); // in it, with five faces in common
    CHECK(blocks("min 0.9 -1 -1; max 3 1 1") == "W0608");
    CHECK(blocks("min 0.9 -2 -2; max 3 2 2") == "W0608");
}

TEST_CASE("scene checks: the camera in a solid") {
    const auto inside = [](const std::string& material) {
        return checkBody("shape block sphere { radius 20; material " + material + " }\n");
    };
    const Found glass = inside("dielectric { ior 1.5 }");
    CHECK(glass.codes == "W0609");
    CHECK(holds(glass, "`block`"));
    CHECK(!glass.inBody);
    CHECK(inside("dielectric { ior 1.333 }").codes == ""); // under water
    CHECK(inside("diffuse").inBody);
    CHECK(checkBody("shape block sphere { radius 2; material dielectric }\n").codes == "");
    CHECK(!checkBody("shape block sphere { radius 2; material diffuse }\n").inBody);
    // In its box, but not in it.
    CHECK(checkBody("shape ring torus { major-radius 9; minor-radius 0.5; material dielectric }\n",
                    "from 4 0 0; look-at 0 0 0")
              .codes == "");
    CHECK(checkBody("shape ring torus { major-radius 9; minor-radius 0.5; material dielectric }\n",
                    "from 9 0 0; look-at 0 0 0")
              .codes == "W0609");
}

TEST_CASE("scene checks: scenes of unusual sizes, where no text says that they are") {
    const auto ball = [](const std::string& radius, const std::string& header = "") {
        return check("scene 1" + header + "\ncamera { from 0 0 3e7; look-at 0 0 0 }\n" + kSkyLight +
                         "shape globe sphere { radius " + radius + "; material diffuse }\n",
                     CheckDepth::amounts);
    };
    const Found earth = ball("6371000");
    CHECK(earth.codes == "W0610");
    CHECK(holds(earth, "`globe`"));
    CHECK(holds(earth, "length="));
    CHECK(ball("6371 km").codes == "");
    CHECK(ball("6371000", " length=mm").codes.find("W0610") == std::string::npos);
    const Found small = checkBody("shape sphere { radius 1e-6; material diffuse }\n", "from 0 0 1e-5; look-at 0 0 0");
    CHECK(small.codes == "W0610");
    CHECK(checkBody("shape sphere { radius 1 um; material diffuse }\n", "from 0 0 1e-5; look-at 0 0 0").codes == "");
}

TEST_CASE("scene checks: a camera from which the scene is a dot") {
    const auto from = [](const std::string& z, const std::string& more = "") {
        return checkBody("shape sphere { radius 1; material diffuse }\n", "from 0 0 " + z + "; look-at 0 0 0" + more);
    };
    const Found far = from("5000");
    CHECK(far.codes == "W0611");
    CHECK(holds(far, "4999 m away from a scene that is 3.4"));
    CHECK(holds(far, "in mm? Then it is 5 m away"));
    CHECK(from("500").codes == "");
    CHECK(from("5000", "; lens 8 m").codes == ""); // a telescope
}

TEST_CASE("scene checks: lamps of power stations") {
    const auto lamp = [](const std::string& light) {
        return checkBody("light bulb " + light + "\nshape sphere { material diffuse }\n");
    };
    const Found strong = lamp("sphere { center 0 5 0; radius 0.05; power 1e9 W }");
    CHECK(strong.codes == "W0612");
    CHECK(holds(strong, "`bulb` gives off 1e+09 W"));
    CHECK(lamp("point { position 0 5 0; power 1e9 W }").codes == "W0612");
    CHECK(holds(lamp("quad { size 3000 3000; luminance 50000 nits }"), "length=mm"));
    CHECK(lamp("sphere { center 0 5 0; radius 0.05; power 20 kW }").codes == "");
    CHECK(lamp("sun { irradiance 100 klx }").codes == "");
    CHECK(lamp("sphere { center 0 0 -1.5e11; radius 6.96e8; luminance 1.6e9 nits }").codes.find("W0612") ==
          std::string::npos);
}

TEST_CASE("scene checks: lenses for which nothing is sharp") {
    const auto lens = [](const std::string& camera) {
        return checkBody("shape sphere { radius 1; material diffuse }\n", "from 0 0 5; look-at 0 0 0; " + camera);
    };
    const Found blurred = lens("aperture 2; focus 500");
    CHECK(blurred.codes == "W0613");
    CHECK(holds(blurred, "sharp at 500 m"));
    CHECK(holds(blurred, "in cm? Then it is sharp at 5 m"));
    CHECK(lens("aperture 2; focus 5").codes == "");
    CHECK(lens("aperture 2").codes == "");
    CHECK(lens("f-stop 2.8; focus 500").codes == ""); // far, but sharp enough
    CHECK(lens("f-stop 2.8; focus 1 cm").codes == "W0613");
    CHECK(lens("lens 50 mm").codes == "");
}

TEST_CASE("scene checks: before a render there are only those of amounts") {
    CHECK(
        check("scene 1\ncamera { from 0 0 9; look-at 0 0 0 }\n" + std::string(kSkyLight) +
                  "shape quad { material dielectric }\nlight bulb sphere { center 0 5 0; radius 0.05; power 1e9 W }\n",
              CheckDepth::amounts)
            .codes == "W0612");
}

} // namespace abbe::test
