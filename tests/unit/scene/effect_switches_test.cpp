// Effects that are left out are gone from the built scene, all others stay, and whoever asks is noted either way.
#include "materials/openpbr.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

constexpr const char* kScene = R"(scene 1
camera { from 0 1 3.4; look-at 0 1 0; fov 45 deg; shutter 1 s; aperture 2 cm; focus 3 m }
film   { size 8 8 }
light lamp quad { points { - -0.3 2 -0.3; - 0.3 2 -0.3; - 0.3 2 0.3; - -0.3 2 0.3 }; luminance 5000 nits }
shape floor quad { points { - -1 0 1; - 1 0 1; - 1 0 -1; - -1 0 -1 }
    material diffuse { reflectance 0.5; bump 2 mm { map noise { scale 1 cm } } } }
shape flint sphere { center 0.5 0.4 0; radius 0.3; material dielectric { ior glass SF11 } }
shape amber sphere { center -0.5 0.4 0; radius 0.3
    material dielectric { ior 1.5; attenuation-color rgb 0.9 0.5 0.1; attenuation-distance 1 m } }
shape ball sphere { center 0 1 0; radius 0.2; material diffuse { reflectance 0.5 }
    transform { at 0 s { translate 0 0 0 }; at 1 s { translate 0.5 0 0 } } }
medium milk homogeneous { extinction 20 per-m; albedo 0.95 }
shape wax sphere { center 0 0.3 0.8; radius 0.2; material dielectric { ior 1.4 }; interior milk }
volume fog atmosphere { extinction 0.1 per-m; scale-height 1 m }
)";

TestScene sceneWithout(std::vector<EffectSwitch> effects) {
    BuildOptions options;
    for (EffectSwitch& e : effects) options.without.leaveOut(std::move(e));
    TestScene scene = TestScene::parse(kScene, options);
    INFO(scene.report());
    REQUIRE(!scene.diagnostics().hasErrors());
    return scene;
}

std::size_t usedMedia(const Scene& scene) {
    return static_cast<std::size_t>(std::ranges::count_if(
        scene.mediumUses, [](const MediumUse& use) { return use.place != MediumUse::Place::nowhere; }));
}

} // namespace

TEST_CASE("effects left out: nothing is, and all that could be is noted") {
    const TestScene scene = sceneWithout({});
    std::vector<std::string> words;
    for (const EffectUser& user : scene.built().effectUsers) {
        CHECK(user.span.valid());
        words.push_back(std::string(wordOf(user.effect.effect)) + user.effect.medium);
    }
    std::ranges::sort(words);
    CHECK(words == std::vector<std::string>{"absorption", "bumps", "depth-of-field", "dispersion", "motion",
                                            "volumefog", "volumemilk"});
    const Scene& s = scene.scene();
    CHECK(s.effects.has(Effect::dispersion));
    CHECK(s.effects.has(Effect::absorption));
    CHECK(s.effects.has(Effect::media));
    CHECK(s.camera->usesLens());
    CHECK(usedMedia(s) == 2);
}

TEST_CASE("effects left out: dispersion and absorption, each alone") {
    const TestScene white = sceneWithout({{SwitchedEffect::dispersion}});
    CHECK(!white.scene().effects.has(Effect::dispersion));
    CHECK(white.scene().effects.has(Effect::absorption));
    bool found = false;
    for (const auto& material : white.scene().materials)
        if (const Curve* ior = material->ior(); ior && ior->at(500) > 1.7) {
            found = true;
            CHECK(ior->isConstant());
            CHECK(ior->at(400) == doctest::Approx(1.7847).epsilon(1e-3)); // SF11 at 587.6 nm
        }
    CHECK(found);
    const TestScene clear = sceneWithout({{SwitchedEffect::absorption}});
    CHECK(!clear.scene().effects.has(Effect::absorption));
    CHECK(clear.scene().effects.has(Effect::dispersion));
    // The amber ball, from above.
    const auto absorptionOfAmber = [](const Scene& scene) {
        SurfaceHit hit;
        REQUIRE(
            scene.intersector->intersect({Vec3(-0.5f, 1.5f, 0) - Vec3(scene.origin), {0, -1, 0}, kInfinity, 0}, hit));
        REQUIRE(hit.material->ior());
        return hit.material->absorption();
    };
    CHECK(absorptionOfAmber(white.scene()) != nullptr);
    CHECK(absorptionOfAmber(clear.scene()) == nullptr);
}

TEST_CASE("effects left out: motion stands at the middle of the exposure") {
    const TestScene still = sceneWithout({{SwitchedEffect::motion}});
    CHECK(still.built().shutter.duration == 0);
    CHECK(still.built().shutter.open == doctest::Approx(0.5));
    SurfaceHit hit;
    // The ball has gone half of its way.
    const Ray ray{Vec3(0.25f, 1, 5) - Vec3(still.scene().origin), {0, 0, -1}, kInfinity, 0};
    REQUIRE(still.scene().intersector->intersect(ray, hit));
    CHECK(hit.distance == doctest::Approx(4.8f).epsilon(1e-3));
    const Ray beside{Vec3(0.0f, 1, 5) - Vec3(still.scene().origin), {0, 0, -1}, kInfinity, 0};
    CHECK(!still.scene().intersector->intersect(beside, hit));
    const CameraRay seen = still.scene().camera->ray({{4, 4}, {0.1f, 0.2f}, 0.9f, 550});
    CHECK(seen.ray.time == 0);
}

TEST_CASE("effects left out: depth of field, bumps, each medium") {
    const TestScene sharp = sceneWithout({{SwitchedEffect::depthOfField}});
    CHECK(!sharp.scene().camera->usesLens());
    const Vec3 a = sharp.scene().camera->ray({{1, 2}, {0.1f, 0.9f}, 0, 550}).ray.origin;
    const Vec3 b = sharp.scene().camera->ray({{1, 2}, {0.8f, 0.3f}, 0, 550}).ray.origin;
    CHECK(length(a - b) == 0);
    const TestScene smooth = sceneWithout({{SwitchedEffect::bumps}});
    CHECK(std::ranges::none_of(smooth.scene().materials, [](const auto& m) { return m->bends(); }));
    const TestScene hollow = sceneWithout({{SwitchedEffect::medium, "milk"}});
    CHECK(usedMedia(hollow.scene()) == 1);
    CHECK(hollow.scene().openMedia.size() == 1);
    const TestScene bright = sceneWithout({{SwitchedEffect::medium, "fog"}});
    CHECK(bright.scene().openMedia.empty());
    CHECK(usedMedia(bright.scene()) == 1);
    const TestScene neither = sceneWithout({{SwitchedEffect::medium, "fog"}, {SwitchedEffect::medium, "milk"}});
    CHECK(!neither.scene().effects.has(Effect::media));
}

TEST_CASE("effects left out: a thin film and the dispersion of a surface that brings its own index") {
    const char* const text = R"(scene 1
camera { from 0 1 3; look-at 0 0 0; fov 45 deg }
film { size 8 8 }
light sky { luminance 1000 nits }
shape ball sphere { radius 0.5; material openpbr { transmission-weight 1; transmission-dispersion-scale 1
    thin-film-weight 1; thin-film-thickness 400 nm } }
)";
    const TestScene with = TestScene::parse(text);
    INFO(with.report());
    REQUIRE(!with.diagnostics().hasErrors());
    CHECK(with.built().effectUsers.size() == 2);
    CHECK(with.scene().effects.has(Effect::dispersion));
    BuildOptions options;
    options.without.leaveOut({SwitchedEffect::dispersion});
    options.without.leaveOut({SwitchedEffect::thinFilm});
    const TestScene without = TestScene::parse(text, options);
    CHECK(!without.scene().effects.has(Effect::dispersion));
    CHECK(without.built().effectUsers.size() == 2);
}

} // namespace abbe::test
