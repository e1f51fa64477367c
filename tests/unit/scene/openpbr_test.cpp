// What an OpenPBR surface says of the inside of solids, and where its mistakes are shown.
#include "render/light.h"
#include "render/medium.h"
#include "scene_test_fixture.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

std::string surface(const std::string& properties) {
    return "shape sphere { material openpbr {\n" + properties + "\n} }\n";
}

// The diagnostics with the line and column of each. The properties begin in line 5.
std::string openpbrFaults(const std::string& properties) {
    std::string text;
    const TestScene scene = build(surface(properties));
    for (const Diagnostic& d : scene.diagnostics().all()) CHECK(!d.help.empty());
    const std::string report = scene.report();
    for (std::size_t at = 0; at < report.size(); at = report.find('\n', at) + 1) {
        const std::size_t place = report.find(':', at) + 1, code = report.find('[', at) + 1;
        text += (text.empty() ? "" : " ") + report.substr(place, report.find(": ", place) - place) + " " +
                report.substr(code, 5);
    }
    return text;
}

const Material& materialOf(const TestScene& scene) { return *trace(scene, {0, 0, 5}, {0, 0, -1}).hit.material; }

} // namespace

TEST_CASE("openpbr solids: what is filled, and with what") {
    const auto plain = build(surface("base-color 0.5"));
    CHECK(materialOf(plain).interior() == nullptr);
    const auto skin = build(surface("subsurface-weight 0.3"));
    CHECK(materialOf(skin).interior() != nullptr);
    CHECK(materialOf(skin).ior() == nullptr);
    CHECK(skin.scene().effects.has(Effect::media));
    const auto leaf = build(surface("subsurface-weight 1; geometry-thin-walled on"));
    CHECK(materialOf(leaf).interior() == nullptr);
    // Where nothing is matte, there is no subsurface light.
    CHECK(materialOf(build(surface("subsurface-weight 1; transmission-weight 1"))).interior() == nullptr);
    CHECK(materialOf(build(surface("subsurface-weight 1; base-metalness 1"))).interior() == nullptr);
    const auto milky = build(surface("transmission-weight 1; transmission-depth 1 m; transmission-scatter 0.5"));
    CHECK(materialOf(milky).interior() != nullptr);
    CHECK(materialOf(milky).absorption() == nullptr); // it is the medium's
    CHECK(materialOf(milky).ior() != nullptr);
    const auto clear = build(surface("transmission-weight 1; transmission-depth 1 m; transmission-color 0.5"));
    CHECK(materialOf(clear).interior() == nullptr);
    CHECK(materialOf(clear).absorption() != nullptr);
    // Without a depth there is no coefficient.
    CHECK(materialOf(build(surface("transmission-weight 1; transmission-scatter 0.5"))).interior() == nullptr);
}

TEST_CASE("openpbr: contradictions are shown where they are written") {
    CHECK(openpbrFaults("subsurface-weight 1") == "");
    CHECK(openpbrFaults("subsurface-weight 1\ntransmission-weight 0.5") == "6:1 E0700");
    CHECK(openpbrFaults("subsurface-weight 1\n  transmission-weight checker") == "6:3 E0700");
    CHECK(openpbrFaults("subsurface-weight 1; geometry-thin-walled on\ntransmission-weight 0.5") == "");
    CHECK(openpbrFaults("specular-ior glass BK7\ntransmission-weight 1\ntransmission-dispersion-scale 1") ==
          "7:1 E0701");
    CHECK(openpbrFaults("transmission-weight 1; transmission-depth 1 m\ntransmission-color checker") == "6:1 E0702");
    CHECK(openpbrFaults("subsurface-weight 1\nsubsurface-color checker") == "6:1 E0702");
    CHECK(openpbrFaults("subsurface-color checker\ngeometry-thin-walled on; subsurface-weight 1") == "");
    CHECK(openpbrFaults("subsurface-weight 1\nsubsurface-scatter-anisotropy 1") == "6:1 E0703");
    CHECK(openpbrFaults("geometry-thin-walled on; subsurface-weight 1; subsurface-scatter-anisotropy 1") == "");
    CHECK(openpbrFaults("transmission-weight 1; specular-roughness checker\nspecular-roughness-anisotropy 0.5") ==
          "6:1 E0704");
    CHECK(openpbrFaults("transmission-weight checker\nspecular-roughness-anisotropy checker") == "6:1 E0704");
    CHECK(openpbrFaults("transmission-weight 1; specular-roughness checker") == "");
    CHECK(openpbrFaults("specular-roughness checker; specular-roughness-anisotropy 0.5") == "");
    CHECK(openpbrFaults("coat-weight 1; geometry-coat-normal 0; geometry-coat-tangent 0.25") == "");
}

// The light that an OpenPBR surface gives off: how bright, what covers it, on which sides.
namespace {

struct Shining {
    explicit Shining(const std::string& properties)
        : scene(build("shape quad { size 2 2; material openpbr { emission-luminance 100 nits; " + properties +
                      " } }\n")) {
        REQUIRE_MESSAGE(!scene.diagnostics().hasErrors(), scene.report());
    }
    // Radiance towards an eye that looks at the middle from this angle; from behind if `behind`.
    double towards(double degrees, double nm = 550, bool behind = false) const {
        const double t = degrees * kPiD / 180;
        const Vec3d eye{std::sin(t), 0, behind ? -std::cos(t) : std::cos(t)};
        const SurfaceHit hit = trace(scene, eye * 3, eye * -1).hit;
        REQUIRE(hit.light);
        return static_cast<double>(hit.light->emitted(hit, Vec3(eye), Wavelengths::single(static_cast<float>(nm)))[0]);
    }
    const SurfaceLight& light() const { return *trace(scene, {0, 0, 3}, {0, 0, -1}).hit.light; }

    TestScene scene;
};

} // namespace

TEST_CASE("openpbr emission: numbers, rgb and reflectances are factors, spectra of light have the full luminance") {
    const double white = Shining("").towards(0);
    CHECK(white > 0);
    CHECK(Shining("emission-color 1").towards(0) == doctest::Approx(white));
    CHECK(Shining("emission-color 0.5").towards(0) == doctest::Approx(white / 2));
    CHECK(Shining("emission-color rgb 0.25 0.25 0.25").towards(0) == doctest::Approx(white / 4).epsilon(1e-3));
    // 0.2126 of white's luminance is that of its red; a texture of the same colour is as bright.
    const Shining red("emission-color rgb 1 0 0"), picture("emission-color checker { even rgb 1 0 0; odd rgb 1 0 0 }");
    const double watts = Shining("").light().visiblePower();
    CHECK(red.light().visiblePower() / watts == doctest::Approx(0.2126).epsilon(0.15)); // and what lights are chosen by
    CHECK(red.towards(0, 620) == doctest::Approx(picture.towards(0, 620)).epsilon(1e-3));
    // Of any scale, and of the same luminance.
    const Shining emitter("emission-color blackbody 6504 K"), table("emission-color table { - 400 7; - 700 7 }");
    CHECK(emitter.towards(0) == doctest::Approx(white).epsilon(0.1));
    CHECK(table.towards(0) == doctest::Approx(100 / 683.0 / 106.857).epsilon(0.02));
    CHECK(codes(build("shape quad { size 2 2; material openpbr { emission-luminance 1 nits; "
                      "emission-color table { - 400 0; - 700 0 } } }\n")) == "E0343");
}

TEST_CASE("openpbr emission: through the coat by the refracted way, and through what fuzz lets pass") {
    const double bare = Shining("").towards(60);
    const Shining coated("coat-weight 0.5; coat-color 0.49; coat-ior 1.5");
    for (const double degrees : {0.0, 40.0, 75.0}) {
        const double sine = std::sin(degrees * kPiD / 180) / 1.5, way = 1 / std::sqrt(1 - sine * sine);
        CHECK(coated.towards(degrees) == doctest::Approx(bare * (0.5 + 0.5 * std::pow(0.7, way))).epsilon(1e-4));
    }
    const Shining fuzzy("fuzz-weight 1; fuzz-roughness 0.5");
    CHECK(fuzzy.towards(0) < bare);
    CHECK(fuzzy.towards(80) < 0.8 * fuzzy.towards(0));
    // A coat without colour takes nothing, and is none.
    CHECK(Shining("coat-weight 1").towards(60) == doctest::Approx(bare));
}

// What lights are chosen by is what leaves them.
TEST_CASE("openpbr emission: the power is that which passes the cover") {
    const Shining bare(""), covered("coat-weight 1; coat-color 0.3; fuzz-weight 0.7");
    double sum = 0;
    constexpr int kAngles = 90;
    for (int i = 0; i < kAngles; ++i) {
        const double t = (i + 0.5) * kPiD / 2 / kAngles;
        sum += 2 * std::sin(t) * std::cos(t) * covered.towards(t * 180 / kPiD) * kPiD / 2 / kAngles;
    }
    CHECK(covered.light().power() / bare.light().power() == doctest::Approx(sum / bare.towards(0)).epsilon(3e-3));
}

TEST_CASE("openpbr emission: solids shine outwards, thin walls on both sides") {
    const Shining solid(""), thin("geometry-thin-walled on");
    CHECK(solid.towards(30, 550, true) == 0);
    CHECK(thin.towards(30, 550, true) == doctest::Approx(solid.towards(30)));
    CHECK(thin.light().power() == doctest::Approx(2 * solid.light().power()));
}

TEST_CASE("openpbr emission: a cover that varies is refused where it is written") {
    const auto faults = [](const std::string& properties) {
        return codes(build("shape quad { size 2 2; material openpbr { " + properties + " } }\n"));
    };
    const std::string shining = "emission-luminance 1 nits; ";
    CHECK(faults(shining + "coat-weight 1; coat-color checker") == "E0706");
    CHECK(faults(shining + "coat-weight checker; coat-color 0.5") == "E0706");
    CHECK(faults(shining + "fuzz-weight checker") == "E0706");
    CHECK(faults(shining + "coat-weight checker") == ""); // clear: takes nothing
    CHECK(faults("coat-weight 1; coat-color checker; fuzz-weight checker") == "");
}

} // namespace abbe::test
