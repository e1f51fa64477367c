// What a scene needs simulated: each effect is seen where it is asked for, and nowhere else, and can be forbidden.
#include "scene_test_fixture.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {

namespace {

const std::string kOpenEye = "scene 1\ncamera { from 0 0 5; look-at 0 0 0; shutter 1 s }\n" + kSky;
const std::string kCage = "shape subdivision {\npoints -1 -1 0  1 -1 0  1 1 0  -1 1 0\nfaces { - 0 1 2 3 }\ndicing 2\n";

struct Case {
    Effect effect;
    std::string with;
    std::string without; // the same but for what asks
};
std::vector<Case> cases() {
    const auto ball = [](const std::string& more) { return "shape sphere { " + more + " }\n"; };
    const std::string smoke = "medium smoke { extinction 1; albedo 0.5; ";
    return {
        {Effect::absorption, ball("material dielectric { ior 1.5; absorption 2 }"),
         ball("material dielectric { ior 1.5 }")},
        {Effect::dispersion, ball("material dielectric { ior glass BK7 }"), ball("material dielectric { ior 1.5 }")},
        {Effect::media, smoke + "}\natmosphere smoke\n", smoke + "}\n"},
        {Effect::textures, ball("material diffuse { reflectance checker { scale 1 } }"), ball("material diffuse")},
        {Effect::interfaces, ball("material diffuse { opacity 0.5 }"), ball("material diffuse { opacity 1 }")},
        {Effect::subsurface, smoke + "}\n" + ball("interior smoke"), smoke + "}\natmosphere smoke\n"},
        {Effect::glow, smoke + "temperature 2000 K }\n" + ball("interior smoke"),
         smoke + "}\n" + ball("interior smoke")},
        {Effect::bumps, ball("material diffuse { bump 1 mm { map noise { scale 1 } } }"), ball("material diffuse")},
        {Effect::thinFilm, ball("material openpbr { thin-film-weight 1 }"), ball("material openpbr")},
        {Effect::motion, ball("transform { at 0 s { translate 0 0 0 }\nat 1 s { translate 1 0 0 } }"),
         ball("transform { at 2 s { translate 0 0 0 }\nat 3 s { translate 1 0 0 } }")},
        {Effect::displacement, kCage + "displacement 0.1 { map noise { scale 1 } }\n}\n", kCage + "}\n"},
        {Effect::subdivision, kCage + "}\n", "shape quad { size 1 1 }\n"},
        {Effect::curves, "shape curves { basis linear; radius 0.1; points 0 0 0  0 1 0 }\n",
         "shape points { radius 0.1; points 0 0 0  0 1 0 }\n"},
    };
}

TestScene sceneOf(const std::string& body) { return TestScene::parse(kOpenEye + body); }
std::string forbid(std::string_view words) { return fmt::format("render {{ forbid {{ {} }} }}\n", words); }

bool asked(const TestScene& scene, Effect effect) {
    return scene.scene().effects.has(effect) && std::ranges::any_of(scene.scene().reasons, [&](const EffectReason& r) {
               return r.effect == effect && r.place.valid() && !r.why.empty();
           });
}

} // namespace

TEST_CASE("effects: each is seen where it is asked for, with the place, and not without it") {
    for (const Case& c : cases()) {
        CAPTURE(infoOf(c.effect).word);
        const TestScene with = sceneOf(c.with), without = sceneOf(c.without);
        REQUIRE(with.report() == "");
        REQUIRE(without.report() == "");
        CHECK(asked(with, c.effect));
        CHECK_FALSE(without.scene().effects.has(c.effect));
    }
    CHECK(asked(TestScene::parse("scene 1\ncamera { from 0 0 5; look-at 0 0 0; f-stop 2 }\n" + kSky),
                Effect::depthOfField));
    CHECK_FALSE(sceneOf("").scene().effects.has(Effect::depthOfField));
}

TEST_CASE("effects: motion of cameras, lights, instances and shapes that deform") {
    const std::string way = "transform { at 0 s { translate 0 0 0 }\nat 1 s { translate 1 0 0 } }";
    for (const std::string& moving :
         {"object ball { shape sphere }\ninstance ball { " + way + " }\n", "group { " + way + "\nshape sphere }\n",
          "light sphere { radius 0.1; radiance 3; " + way + " }\n",
          std::string("shape points { radius 0.1; at 0 s { points 0 0 0 }\nat 1 s { points 1 0 0 } }\n")}) {
        CAPTURE(moving);
        CHECK(sceneOf(moving).report() == "");
        CHECK(asked(sceneOf(moving), Effect::motion));
        CHECK_FALSE(build(moving).scene().effects.has(Effect::motion)); // without a shutter
    }
    CHECK(asked(TestScene::parse("scene 1\ncamera { shutter 1 s; at 0 s { from 0 0 5; look-at 0 0 0 }\n"
                                 "at 1 s { from 0 0 6; look-at 0 0 0 } }\n" +
                                 kSky),
                Effect::motion));
}

TEST_CASE("effects: forbidding one that is needed is an error at the line that needs it") {
    for (const Case& c : cases()) {
        CAPTURE(infoOf(c.effect).word);
        const TestScene scene = sceneOf(c.with + forbid(infoOf(c.effect).word));
        REQUIRE(!scene.diagnostics().all().empty());
        for (const Diagnostic& d : scene.diagnostics().all()) {
            CHECK(d.code == "E0684");
            CHECK(d.related.size() == 1);
        }
        CHECK(codes(sceneOf(c.without + forbid(infoOf(c.effect).word))) == "");
    }
}

TEST_CASE("effects: the words of `forbid`") {
    CHECK(codes(sceneOf(forbid("fluorescence; polarization; diffraction"))) == "");
    const TestScene wrong = sceneOf(forbid("dispersoin; motion; glow 3"));
    CHECK(codes(wrong) == "E0683 E0309");
    CHECK(wrong.diagnostics().all()[0].help == "did you mean `dispersion`?");
    CHECK(codes(sceneOf(forbid("wavelength-shifting-paint"))) == "E0683");
}

} // namespace abbe::test
