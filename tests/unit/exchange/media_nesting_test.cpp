// Media around shapes and cameras in scenes of Mitsuba and pbrt: what reaches the camera, by Beer and Lambert, and what
// is said where media are not as they were stated.
#include "exchange/importer/importer.h"
#include "unit/exchange/pbrt_cases.h"

#include <cmath>
#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::exchange;

namespace {

// Fog that absorbs 1/2 per metre.
const std::string kMitsubaFog = R"(<medium type="homogeneous" id="fog"><spectrum name="sigma_t" value="0.5"/>
<spectrum name="albedo" value="0"/></medium>)";

struct MediaCase : ImportCase {
    // The camera is at the origin and looks along −z at a sky of 1.
    MediaCase(const std::string& sensor, const std::string& shapes) {
        writeAll(folder / "case.xml", R"(<scene version="3.0.0"><integrator type="volpath"/>)" + kMitsubaFog +
                                          R"(<sensor type="perspective"><float name="fov" value="3"/>
<transform name="to_world"><lookat origin="0,0,0" target="0,0,-1" up="0,1,0"/></transform>)" +
                                          sensor +
                                          R"(<film type="hdrfilm"><integer name="width" value="8"/>
<integer name="height" value="8"/></film></sensor><emitter type="constant"><spectrum name="radiance" value="1"/></emitter>)" +
                                          shapes + "</scene>");
        const ImportFormat* const format = importFormat(folder / "case.xml");
        REQUIRE(format);
        scene = importScene(*format, folder / "case.xml", folder / "case.scene", sources, diagnostics).value_or("");
    }
    bool has(std::string_view text) const { return scene.find(text) != std::string::npos; }
    // Of what there would be without media.
    double share() const {
        static const double kSky = renderImported(MediaCase("", ""), MediaCase("", "").scene, {0, 0, 8, 8}, 64).mean;
        return renderImported(*this, scene, {0, 0, 8, 8}, 512).mean / kSky;
    }
};

const std::string kIn = R"(<ref name="interior" id="fog"/>)", kOut = R"(<ref name="exterior" id="fog"/>)",
                  kOfSensor = R"(<ref id="fog"/>)", kNull = R"(<bsdf type="null"/>)";
// From −2 to 2 m.
const std::string kRoom =
    R"(<shape type="cube"><transform name="to_world"><scale value="2"/></transform>)" + kNull + kIn + "</shape>";

std::string mitsubaBall(const std::string& inside) {
    return R"(<shape type="sphere" id="ball"><point name="center" x="0" y="0" z="-1"/><float name="radius" value="0.5"/>)" +
           inside + "</shape>";
}

} // namespace

TEST_CASE("Mitsuba: a camera in a shape of fog is in that fog alone") {
    const MediaCase made(kOfSensor, kRoom);
    INFO(made.report());
    INFO(made.scene);
    CHECK(made.report() == "");
    CHECK_FALSE(made.has("atmosphere"));
    CHECK(made.share() == doctest::Approx(std::exp(-1.0)).epsilon(0.01)); // 2 m
    // What stands in the fog says so.
    const MediaCase held(kOfSensor, kRoom + mitsubaBall(kOut));
    CHECK(held.report() == "");
    // Outside of all shapes it is everywhere.
    const MediaCase open(kOfSensor, mitsubaBall(kOut));
    CHECK(open.report() == "");
    CHECK(open.has("atmosphere fog"));
}

TEST_CASE("Mitsuba: a surface with one medium on both sides is within it") {
    const MediaCase made(kOfSensor, kRoom + mitsubaBall(kNull + kIn + kOut));
    INFO(made.scene);
    CHECK(made.report() == "");
    CHECK(made.share() == doctest::Approx(std::exp(-1.0)).epsilon(0.01)); // and not 2.5 m
    const MediaCase open(kOfSensor, mitsubaBall(R"(<bsdf type="dielectric"/>)" + kIn + kOut));
    INFO(open.scene);
    CHECK(open.report() == "");
    CHECK(open.has("atmosphere fog"));
    CHECK_FALSE(open.has("interior"));
}

TEST_CASE("Mitsuba: media that cannot be as they are stated are named") {
    const std::string milk = R"(<medium type="homogeneous" name="interior"><float name="sigma_t" value="9"/></medium>)";
    const MediaCase nested(kOfSensor, kRoom + mitsubaBall(kNull + milk + kOut));
    INFO(nested.report());
    CHECK(nested.says("the medium inside of `ball` is approximated: what is around it goes on inside"));
    const MediaCase hole(kOfSensor, mitsubaBall(R"(<bsdf type="dielectric"/>)" + kOut));
    INFO(hole.report());
    CHECK(hole.says("the inside of `ball`, without a medium, is approximated"));
    const MediaCase twice(kOfSensor, mitsubaBall(kNull + kIn));
    INFO(twice.report());
    CHECK(twice.says("it is twice as dense here"));
    const MediaCase nowhere("", mitsubaBall(kOut));
    INFO(nowhere.report());
    CHECK(nowhere.says("`exterior` of `ball` is left out: a medium fills a closed shape"));
    const MediaCase beside("", R"(<shape type="sphere"><point name="center" x="5"/>)" + kNull + kIn + "</shape>" +
                                   mitsubaBall(kOut));
    INFO(beside.report());
    CHECK(beside.says("the shape that is filled with this medium does not hold it"));
    const MediaCase open("", R"(<shape type="rectangle">)" + kNull + kIn + "</shape>");
    INFO(open.report());
    CHECK(open.says("an open surface has no inside"));
    CHECK_FALSE(open.has("interior"));
    // Glass in glass has its own medium alone, as there.
    const MediaCase glass("",
                          R"(<shape type="cube"><bsdf type="dielectric"/>)" + kIn + "</shape>" +
                              R"(<shape type="sphere"><float name="radius" value="0.5"/><bsdf type="dielectric"/>)" +
                              milk + kOut + "</shape>");
    INFO(glass.report());
    CHECK(glass.report() == "");
}

TEST_CASE("pbrt: media around shapes and the camera") {
    const std::string fog = "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [0.5 0.5 0.5] "
                            "\"rgb sigma_s\" [0 0 0]\n";
    const auto around = [&](const std::string& world) {
        return PbrtCase(fog + "MediumInterface \"\" \"fog\"\n" + pbrtWorld("LightSource \"infinite\"\n" + world));
    };
    const auto share = [](const PbrtCase& made) {
        const PbrtCase sky(pbrtWorld("LightSource \"infinite\"\n"));
        const auto mean = [](const PbrtCase& of) {
            return renderImported(of, "scene 1\n" + of.scene, {0, 0, 8, 8}, 512).mean;
        };
        return mean(made) / mean(sky);
    };
    const std::string room = "AttributeBegin\nMediumInterface \"fog\" \"\"\nMaterial \"interface\"\nShape \"sphere\" "
                             "\"float radius\" 2\nAttributeEnd\n";
    const PbrtCase held = around(room);
    INFO(held.scene);
    CHECK(held.report() == "");
    CHECK_FALSE(held.has("atmosphere"));
    CHECK(share(held) == doctest::Approx(std::exp(-1.0)).epsilon(0.01));
    const std::string within =
        "AttributeBegin\nTranslate 0 0 1\nMediumInterface \"fog\"\nMaterial \"interface\"\nShape "
        "\"sphere\" \"float radius\" 0.5\nAttributeEnd\n";
    const PbrtCase same = around(room + within);
    INFO(same.scene);
    CHECK(same.report() == "");
    CHECK(share(same) == doctest::Approx(std::exp(-1.0)).epsilon(0.01));
    const std::string glass = "Material \"dielectric\"\nShape \"sphere\" \"float radius\" 0.2\n";
    CHECK(around("MediumInterface \"fog\"\n" + glass).report() == "");
    CHECK(around("MediumInterface \"\" \"fog\"\n" + glass).says("without a medium, is approximated"));
    CHECK(PbrtCase(fog + pbrtWorld("MediumInterface \"\" \"fog\"\nShape \"sphere\"\n"))
              .says("the outer medium of a shape `sphere` is left out"));
}
