// Materials that refer to materials: names and places, cycles, and insides that do not fit.
#include "materials/mix.h"
#include "scene_test_fixture.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

const std::string kUse = "shape sphere { material m }\n";

std::string faults(const std::string& materials) { return codes(build(materials + "\n" + kUse)); }

} // namespace

TEST_CASE("parts by name and in place, before and after they are defined") {
    CHECK(faults("material m mix { first steel; second diffuse { reflectance 0.1 }; amount 20 % }\n"
                 "material steel conductor { index metal Fe }") == "");
    CHECK(faults("material m mix { first mix { first diffuse; second diffuse }; second diffuse }") == "");
    CHECK(faults("material m two-sided { front diffuse; back conductor { index metal Al } }") == "");
    const auto scene = build("material m mix { first dielectric { ior 1.4; absorption 3 }; second diffuse }\n" + kUse);
    const Material& m = *trace(scene, {0, 0, 5}, {0, 0, -1}).hit.material;
    CHECK(m.absorption() != nullptr);
    CHECK(m.needs().has(Effect::absorption));
    CHECK(scene.scene().effects.has(Effect::absorption));
    const auto open = build("material m mix { first diffuse { opacity 0.5 }; second diffuse; amount 0.25 }\n" + kUse);
    CHECK(trace(open, {0, 0, 5}, {0, 0, -1}).hit.material->opacity({}) == doctest::Approx(0.625));
}

TEST_CASE("a material that contains itself is a located error") {
    CHECK(faults("material m mix { first m; second diffuse }") == "E0722");
    CHECK(faults("material m mix { first a; second diffuse }\nmaterial a two-sided { front diffuse; back b }\n"
                 "material b mix { first diffuse; second m }") == "E0722");
    // Of an unknown type, which is an error enough.
    CHECK(faults("material m mxx { first m; second diffuse }") == "E0205");
    CHECK(faults("texture t mxx { even t }\nmaterial m diffuse { reflectance t }") == "E0205");
    CHECK(faults("phase p mxx { part p }\nmedium f homogeneous { phase p }\nmaterial m diffuse") == "E0205");
    const std::string text = build("material m mix {\nfirst m\nsecond diffuse }\n" + kUse).report();
    CHECK(text.find("material `m` contains itself") != std::string::npos);
}

TEST_CASE("parts that cannot be parts") {
    CHECK(faults("material m mix { first boundary; second diffuse }") == "E0723");
    CHECK(faults("material m two-sided { front diffuse; back boundary }") == "E0723");
    CHECK(faults("material m mix { first diffuse }") == "E0207");
    CHECK(faults("material m mix { first diffuse; second nothing }") == "E0202");
    CHECK(faults("material m mix { first diffuse; second diffuse; amount 2 }") == "E0303");
}

TEST_CASE("parts that fill the shape with different things") {
    const auto glasses = [](const std::string& a, const std::string& b) {
        return faults("material m mix { first dielectric { " + a + " }; second dielectric { " + b + " } }");
    };
    CHECK(glasses("absorption 3", "absorption 3; roughness 0.5") == "");
    CHECK(glasses("absorption rgb 1 2 3", "absorption rgb 1 2 3") == "");
    CHECK(glasses("absorption 3", "absorption 4") == "E0724");
    CHECK(glasses("attenuation-color 0.5", "attenuation-color 0.5") == "");
    CHECK(faults("material m two-sided { front dielectric { absorption 2 }; back diffuse }") == "E0724");
    const auto scene =
        build("material m mix { first dielectric { absorption 3 }; second dielectric { absorption 4 } }\n" + kUse);
    REQUIRE(scene.diagnostics().all().size() == 1);
    CHECK(scene.diagnostics().all()[0].related.size() == 1);
}

} // namespace abbe::test
