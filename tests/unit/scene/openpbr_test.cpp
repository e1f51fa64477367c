// What an OpenPBR surface says of the inside of solids, and where its mistakes are shown.
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

} // namespace abbe::test
