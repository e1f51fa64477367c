// Film, render, camera: what the scene says, what the command line may change, and what is missing.
#include "scene_test_fixture.h"

#include <doctest/doctest.h>

namespace abbe::test {

TEST_CASE("settings: documented defaults") {
    const auto scene = build("");
    REQUIRE(scene.report() == "");
    const BuiltScene& b = scene.built();
    CHECK(b.film.size == Vec2d{1280, 720});
    CHECK(b.render.samples == 64);
    CHECK(b.render.replicates == 2);
    CHECK(b.render.maxDepth == 0);
    CHECK(b.exposure == 1);
    CHECK(b.scene.effects == Effects());
    const RenderSettings s = scene.settings();
    CHECK(s.samples == 64);
    CHECK(s.maxDepth == 0);
    CHECK(s.technique.numbers == Technique::Numbers::sobol);
    CHECK(s.technique.strategy == Technique::Strategy::mis);
    CHECK(s.noiseTarget == 0);
    CHECK(s.timeLimit == 0);
}

TEST_CASE("settings: everything that `render` and `film` say arrives") {
    const auto scene = build("film { size 64 48; crop 8 4 32 40; filter box 0.5 }\n"
                             "render { samples 123; noise 0.5 %; time-limit 2 min; max-depth 9; seed 77; replicates 4;"
                             " sampler random; strategy lights }");
    REQUIRE(scene.report() == "");
    const RenderSettings s = scene.settings();
    CHECK(s.samples == 123);
    CHECK(s.noiseTarget == doctest::Approx(0.005));
    CHECK(s.timeLimit == doctest::Approx(120));
    CHECK(s.maxDepth == 9);
    CHECK(s.seed == 77);
    CHECK(s.technique.numbers == Technique::Numbers::random);
    CHECK(s.technique.strategy == Technique::Strategy::lightsOnly);
    CHECK(scene.built().render.replicates == 4);
    const FilmSettings f = filmSettings(scene.built().film);
    CHECK(f.width == 64);
    CHECK(f.crop.x0 == 8);
    CHECK(f.crop.y1 == 40);
    CHECK(f.filter == FilterShape::box);
}

TEST_CASE("settings: the command line overrides, and a new size takes the crop away") {
    BuildOptions o;
    o.size = Vec2i{10, 20};
    o.samples = 5;
    o.seed = 6;
    o.noise = 0.25;
    o.timeLimit = 3;
    o.strategy = Technique::Strategy::bsdfOnly;
    o.sampler = Technique::Numbers::random;
    const auto scene = build("film { size 64 48; crop 8 4 32 40 }\nrender { samples 123; seed 1; strategy lights }", o);
    const RenderSettings s = scene.settings();
    CHECK(s.samples == 5);
    CHECK(s.seed == 6);
    CHECK(s.noiseTarget == 0.25);
    CHECK(s.timeLimit == 3);
    CHECK(s.technique.strategy == Technique::Strategy::bsdfOnly);
    CHECK(s.technique.numbers == Technique::Numbers::random);
    const FilmSettings f = filmSettings(scene.built().film);
    CHECK(f.crop.x0 == 0);
    CHECK(f.crop.x1 == 10);
    CHECK(f.crop.y1 == 20);
}

TEST_CASE("settings: every choice of a technique has its word") {
    const auto scene = build("render { sampler stratified; strategy bsdf; mis-weights power; directions uniform;"
                             " light-choice power; roulette throughput; light-paths alone; wavelengths 2 }");
    REQUIRE(scene.report() == "");
    CHECK(scene.settings().technique == Technique{Technique::Numbers::stratified, Technique::Strategy::bsdfOnly,
                                                  Technique::Weights::power, Technique::Directions::uniform,
                                                  Technique::LightChoice::power, Technique::Roulette::throughput, 2,
                                                  Technique::LightPaths::alone});
    CHECK(build("").settings().technique == Technique{});
    for (const char* odd : {"3", "5", "6", "7"})
        CHECK(codes(build("render { wavelengths " + std::string(odd) + " }")) == "E0711");
}

TEST_CASE("settings: one film, one render") {
    CHECK(codes(build("film { size 8 8 }\nfilm { size 9 9 }")) == "E0608");
    CHECK(codes(build("render { samples 8 }\nrender { samples 9 }")) == "E0608");
    CHECK(codes(build("film { size 64 48; crop 8 4 8 40 }")) == "E0609");
}

TEST_CASE("camera: none, by name, and unknown") {
    CHECK(codes(TestScene::parse("scene 1\n" + kSky)) == "E0601");
    const std::string two = "scene 1\ncamera a { from 0 0 5; look-at 0 0 0 }\n"
                            "camera b { from 9 0 0; look-at 0 0 0; exposure 2 stops }\n" +
                            kSky;
    CHECK(near(TestScene::parse(two).scene().origin, {0, 0, 5}, 1e-9));
    BuildOptions o;
    o.camera = "b";
    const auto b = TestScene::parse(two, o);
    CHECK(near(b.scene().origin, {9, 0, 0}, 1e-9));
    CHECK(b.built().exposure == doctest::Approx(4));
    o.camera = "c";
    CHECK(codes(TestScene::parse(two, o)) == "E0601");
}

TEST_CASE("camera: the middle of the film looks at the target, for any film") {
    for (const char* size : {"64 64", "200 50", "50 200", "1 1"}) {
        const auto scene = TestScene::parse("scene 1\ncamera { from 1 2 3; look-at 4 -1 2 }\nfilm { size " +
                                            std::string(size) + " }\n" + kSky);
        const FilmSettings f = filmSettings(scene.built().film);
        const CameraRay ray = scene.scene().camera->ray(
            {{static_cast<float>(f.width) / 2, static_cast<float>(f.height) / 2}, {0.5f, 0.5f}, 0});
        CHECK(near(Vec3d(ray.ray.direction), normalize(Vec3d{3, -3, -1}), 1e-6));
    }
}

TEST_CASE("light: none at all is an error, light that is black too") {
    const std::string sphere = "shape sphere { radius 1 }\n";
    CHECK(codes(TestScene::parse(kEye + sphere)) == "E0610");
    CHECK(codes(TestScene::parse(kEye + sphere + "light sky { radiance 0 }")) == "W0740 E0610");
    CHECK(codes(TestScene::parse(kEye + "shape sphere { radius 1; emission 2 }")) == "");
}

TEST_CASE("effects: who asks for them") {
    const auto scene = build("material clear dielectric { ior 1.5 }\n"
                             "material wine dielectric { ior 1.33; absorption 3 }\n"
                             "shape sphere { material clear }\n"
                             "shape sphere { center 3 0 0; material dielectric { ior glass BK7 } }\n"
                             "shape sphere { center 6 0 0; material wine }");
    REQUIRE(scene.report() == "");
    CHECK(scene.scene().effects == (Effects(Effect::absorption) | Effect::dispersion));
    REQUIRE(scene.scene().reasons.size() == 2);
    for (const EffectReason& reason : scene.scene().reasons) {
        CHECK(reason.place.valid());
        CHECK_FALSE(reason.why.empty());
    }
    CHECK(build("shape sphere { material dielectric { ior 1.5 } }").scene().effects == Effects());
    CHECK(build("shape sphere { material dielectric { ior 1.5; absorption 2 } }").scene().effects ==
          Effects(Effect::absorption));
    CHECK(build("shape sphere { material dielectric { ior glass SF11 } }").scene().effects ==
          Effects(Effect::dispersion));
    // A formula that does not vary is no dispersion.
    CHECK(build("shape sphere { material dielectric { ior cauchy 1.5 0 } }").scene().effects == Effects());
}

TEST_CASE("checking alone builds no acceleration structure") {
    BuildOptions o;
    o.geometry = false;
    const auto scene = build("shape sphere", o);
    CHECK(scene.report() == "");
    CHECK(scene.built().scene.intersector == nullptr);
    CHECK(scene.built().facts.shapes == 1);
}

TEST_CASE("types: names are unique, each kind has one default, and every example is sound") {
    const schema::TypeTable table = makeTypeTable();
    for (const schema::TypeInfo& type : table.all()) {
        INFO(std::string(type.name));
        CHECK_FALSE(type.doc.empty());
        CHECK(table.find(type.kind, type.name) == &type);
        int defaults = 0;
        for (const schema::TypeInfo* other : table.of(type.kind)) defaults += other->isDefault;
        CHECK(defaults <= 1);
        std::string text(type.example);
        if (text.find('.') != std::string::npos && text.find('"') != std::string::npos) continue; // needs the file
        std::string head = "scene 1\n";
        if (type.kind != schema::Kind::camera) head += "camera { from 0 0 5; look-at 0 0 0 }\n";
        const auto scene = TestScene::parse(head + kSky + text + "\n");
        // An example stands alone, so nothing uses what it names.
        for (const Diagnostic& d : scene.diagnostics().all()) CHECK(d.code == "W0201");
    }
}

} // namespace abbe::test
