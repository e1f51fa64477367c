// include, override, remove, variant and --set: what they come to, and what is said where they are wrong.
#include "language_fixture.h"

#include <chrono>
#include <doctest/doctest.h>
#include <fmt/format.h>

using namespace language_test;

namespace {

constexpr const char* kRoom = R"(scene 1
camera main { lens 35 mm; f-stop 2.8 }
film { output "room.exr" }
material red diffuse { reflectance rgb 0.8 0.1 0.1; roughness 0.5 }
material blue diffuse { reflectance rgb 0.1 0.1 0.8 }
group room {
    transform { translate 0 1 0 }
    shape wall quad { size 2 2; material red }
    group corner { shape ball sphere { radius 2; material blue } }
}
light key quad { power 60 W; size 1 1 }
light sky { power 1 W }
)";

class Files {
  public:
    Files() { write("room.scene", kRoom); }
    void write(const std::string& name, const std::string& text) const { folder_.write(name, text); }
    std::unique_ptr<Loaded> shot(const std::string& body, const Choices& choices = {}) const {
        return load("scene 1\n" + body, folder_.path(), choices);
    }
    // Of a scene that includes the room.
    std::unique_ptr<Loaded> over(const std::string& body, const Choices& choices = {}) const {
        return shot("include \"room.scene\"\n" + body, choices);
    }
    std::string path() const { return folder_.path().string(); }

  private:
    TemporaryFolder folder_;
};

void sound(const Loaded& l) {
    INFO(l.human());
    CHECK(l.diagnostics.all().empty());
}

} // namespace

TEST_CASE("include brings in what a file defines") {
    const Files files;
    const auto l = files.over("shape extra sphere { material red }");
    sound(*l);
    CHECK(l->names() ==
          "camera main, film, material red, material blue, group room, shape wall, group corner, shape ball, "
          "light key, light, shape extra");
    CHECK(l->params["camera main"].lens == doctest::Approx(0.035));
    // What it holds may be used before it is included, and what nobody uses is not reported.
    sound(*files.shot("shape extra sphere { material red }\ninclude \"room.scene\""));
}

TEST_CASE("units and folder of an included file are its own") {
    const Files files;
    files.write("sub/mm.scene", "scene 1 length=mm rgb=acescg\nshape ball sphere { radius 5 }\nshape m mesh \"a.ply\"\n"
                                "material c diffuse { reflectance rgb 0.5 0.5 0.5 }\nshape p plane { material c }");
    files.write("sub/a.ply", "");
    const auto l = files.shot("include \"sub/mm.scene\"\noverride shape p { transform { translate 1 0 0 } }\noverride "
                              "shape ball { radius 2 }");
    sound(*l);
    CHECK(l->params["shape ball"].radius == 2); // of this file: metres
    CHECK(l->params["shape m"].file.value == files.path() + "/sub/a.ply");
    CHECK(l->resolver.values.at(0).space == RgbSpaceName::linAp1);
    CHECK(files.shot("include \"sub/mm.scene\"")->params["shape ball"].radius == doctest::Approx(0.005));
}

TEST_CASE("as= is a prefix of all names of a file") {
    const Files files;
    files.write("car.scene", "scene 1\nparam size 2\nmaterial paint diffuse { reflectance 0.5 }\n"
                             "object body { shape hull sphere { radius $size; material paint } }\ninstance body");
    files.write("two.scene", "scene 1\ninclude \"car.scene\" as=front\ninclude \"car.scene\" as=back { param size 3 }");
    const auto l = files.shot("include \"two.scene\" as=train\nmaterial paint diffuse { reflectance 0.1 }\n"
                              "shape s sphere { material \"train:front:paint\" }\nshape t sphere { material paint }");
    INFO(l->human());
    CHECK(l->diagnostics.all().empty());
    CHECK(l->names() == "material train:front:paint, object train:front:body, shape train:front:hull, instance, "
                        "material train:back:paint, object train:back:body, shape train:back:hull, instance, "
                        "material paint, shape s, shape t");
    CHECK(l->params["shape train:front:hull"].radius == 2);
    CHECK(l->params["shape train:back:hull"].radius == 3);
    CHECK(l->tree.definitions[2].target == "train:front:body");
    CHECK(l->resolver.references.at(0) == "train:front:paint");
    // What takes the place of a name inside is used there.
    sound(*files.shot("include \"car.scene\" as=a\nremove material a:paint\nmaterial a:paint dielectric { ior 1.5 }"));
    // Names of the includer are not seen from inside.
    files.write("open.scene", "scene 1\nshape s sphere { material outer }");
    CHECK(files.shot("include \"open.scene\" as=a\nmaterial outer diffuse { reflectance 1 }")->codes().find("E0202") !=
          std::string::npos);
    // Near names are those of the file.
    files.write("near.scene", "scene 1\nmaterial paint diffuse { reflectance 0.5 }\nshape s sphere { material pait }");
    CHECK(files.shot("include \"near.scene\" as=a")->get("E0202").label == "did you mean `paint`?");
}

TEST_CASE("a file that is included twice under one prefix is one layer") {
    const Files files;
    files.write("a.scene", "scene 1\ninclude \"room.scene\"");
    files.write("b.scene", "scene 1\ninclude \"./room.scene\"\noverride camera { f-stop 8 }");
    const auto l = files.shot("include \"a.scene\"\ninclude \"b.scene\"\ninclude \"room.scene\"");
    sound(*l);
    CHECK(l->params["camera main"].fStop == 8);
}

TEST_CASE("override replaces the properties that it names") {
    const Files files;
    const auto l = files.over(R"(
override camera { f-stop 1.4 }
override material red { roughness 0.2 }
override shape ball { radius 3 }
override group room { shape wall { size 4 5 }; shape floor plane { material blue } }
override light key { luminance 500 nits }
override light sky { power 7 W }
override film { filter gaussian }
override render { samples 8 }
)");
    sound(*l);
    CHECK(l->params["camera main"].fStop == 1.4);
    CHECK(l->params["camera main"].lens == doctest::Approx(0.035));
    CHECK(l->params["material red"].roughness == 0.2);
    CHECK(l->params["shape ball"].radius == 3);
    CHECK(l->params["shape wall"].size == Vec2d{4, 5});
    CHECK(l->params.contains("shape floor"));
    CHECK(l->params["light key"].luminance == 500); // and not 60 W beside it: they state one thing
    CHECK(l->params["light key"].size == Vec2d{1, 1});
    CHECK(l->params["light"].amount.value == 7);
    CHECK(l->params["film"].filter.word == "gaussian");
    CHECK(l->params["film"].output.value == "room.exr");
    CHECK(l->params["render"].samples == 8); // which the room does not have
}

TEST_CASE("later wins") {
    const Files files;
    files.write("mid.scene", "scene 1\ninclude \"room.scene\"\noverride camera main { f-stop 4; lens 20 mm }");
    const auto l =
        files.shot("include \"mid.scene\"\noverride camera main { f-stop 5 }\noverride camera main { f-stop 6 }");
    sound(*l);
    CHECK(l->params["camera main"].fStop == 6);
    CHECK(l->params["camera main"].lens == doctest::Approx(0.02));
}

TEST_CASE("arguments, keys and spectra are replaced") {
    const Files files;
    files.write("a.ply", "");
    files.write("b.ply", "");
    const auto l = files.shot(R"(
shape m mesh "a.ply"
shape k mesh "a.ply"
spectrum paint rgb 1 0 0
material c diffuse { reflectance paint }
material w diffuse roughness=0.5 { reflectance 0.5 }
shape p plane { material c }
shape q plane { material w }
override shape m { file "b.ply" }
override shape k mesh "b.ply"
override spectrum paint rgb 0 1 0
override material w roughness=0.25
)");
    sound(*l);
    CHECK(l->params["shape m"].file.value.ends_with("b.ply"));
    CHECK(l->params["shape k"].file.value.ends_with("b.ply"));
    CHECK(l->params["material w"].roughness == 0.25);
    CHECK(l->resolver.values.at(0).numbers == std::vector<double>{0, 1, 0});
}

TEST_CASE("what is given has the units of where it is written") {
    const Files files;
    files.write("cm.scene", "scene 1 length=cm\nshape ball sphere { radius 5; center 1 0 0 }");
    const auto l = files.shot("include \"cm.scene\"\noverride shape ball { center 1 0 0 }");
    CHECK(l->params["shape ball"].radius == doctest::Approx(0.05));
    CHECK(l->params["shape ball"].center.x == 1);
}

TEST_CASE("remove takes out what stands before") {
    const Files files;
    const auto l = files.over("remove light sky\nremove shape wall\nremove light key\nlight key sun { power 3 W }");
    sound(*l);
    CHECK(l->names() ==
          "camera main, film, material red, material blue, group room, group corner, shape ball, light key");
    CHECK(l->params["light key"].amount.value == 3);
    const auto used = files.over("remove material red");
    CHECK(used->codes() == "E0202");
    CHECK(used->get("E0202").related.front().text == "removed here");
    CHECK(used->text(used->get("E0202").related.front().span) == "remove material red");
    CHECK(used->human().find("included from here") != std::string::npos);
    const auto group = files.over("remove group room\noverride shape ball { radius 1 }");
    CHECK(group->codes().find("E0229") != std::string::npos);
    CHECK(group->get("E0229").related.back().text == "removed here");
    sound(*files.shot(
        "object a { shape sphere }\ninstance a\ninstance a\nremove instance a\nremove object a\nshape plane"));
}

TEST_CASE("variants") {
    const Files files;
    files.write("looks.scene", std::string(kRoom) + R"(
variant dusk { override light sky { power 0.1 W }; remove light key; shape moon sphere { material red } }
variant noon { override light sky { power 9 W }; material chrome diffuse { reflectance 0.9 } }
material spare diffuse { reflectance 0.1 }
variant bare { override shape ball { material spare } }
)");
    const auto shot = [&](const std::string& body, std::vector<std::string> chosen) {
        return files.shot("include \"looks.scene\"\n" + body, {{}, std::move(chosen), {}});
    };
    const auto none = shot("", {});
    sound(*none);
    CHECK(none->params["light"].amount.value == 1);
    REQUIRE(none->tree.variants.size() == 3);
    CHECK(none->tree.variants[0].name == "dusk");
    CHECK(!none->tree.variants[0].chosen);
    const auto dusk = shot("override light sky { power 5 W }", {"dusk"});
    sound(*dusk);
    CHECK(dusk->params["light"].amount.value == 0.1); // variants come after all files
    CHECK(dusk->params.contains("shape moon"));
    CHECK(!dusk->params.contains("light key"));
    CHECK(dusk->tree.variants[0].chosen);
    CHECK(shot("", {"dusk", "noon"})->params["light"].amount.value == 9);
    CHECK(shot("", {"noon", "dusk"})->params["light"].amount.value == 0.1);
    // Chosen and extended by the file that includes it.
    CHECK(shot("variant dusk", {})->params["light"].amount.value == 0.1);
    CHECK(shot("variant dusk { override light sky { power 0.2 W } }", {"dusk"})->params["light"].amount.value == 0.2);
    CHECK(files.shot("include \"looks.scene\" as=l", {{}, {"l:dusk"}, {}})->params["light"].amount.value == 0.1);
    const auto unknown = shot("", {"dsk"});
    CHECK(unknown->codes() == "E0231");
    CHECK(unknown->get("E0231").label == "did you mean `dusk`?");
    CHECK(files.over("", {{}, {"dusk"}, {}})->get("E0231").help.starts_with("it has none"));
    CHECK(files.shot("variant a { }\nvariant a { }")->codes() == "E0203");
    CHECK(files.shot("variant a { include \"b.scene\" }\nshape plane")->codes() == "E0232");
    CHECK(files.shot("variant a { param x 1 }\nshape plane")->codes() == "E0232");
    CHECK(files.shot("variant { }")->codes() == "E0232");
    // What only a variant uses is used.
    sound(*files.shot("material spare diffuse { reflectance 0.1 }\nshape p plane\nvariant v { override shape p { "
                      "material spare } }"));
}

TEST_CASE("--set is the last layer") {
    const Files files;
    const auto set = [&](std::vector<std::string> sets, const std::string& body = "") {
        return files.over(body, {{}, {}, std::move(sets)});
    };
    const auto l = set({"camera.main.lens=50 mm", "camera.f-stop=4", "light.sky.power=2 W", "film.filter=box",
                        "material.red.reflectance=rgb 0 0 1", "shape.ball.transform={ translate 0 1 0 }"},
                       "override camera { lens 20 mm }");
    sound(*l);
    CHECK(l->params["camera main"].lens == doctest::Approx(0.05));
    CHECK(l->params["camera main"].fStop == 4);
    CHECK(l->params["light"].amount.value == 2);
    CHECK(l->params["film"].filter.word == "box");
    const Params& ball = l->params["shape ball"];
    CHECK(ball.radius == 2);
    const auto varied = files.shot("shape ball sphere { radius 1 }\nvariant big { override shape ball { radius 5 } }",
                                   {{}, {"big"}, {"shape.ball.radius=2"}});
    sound(*varied);
    CHECK(varied->params["shape ball"].radius == 2); // behind the variants, too
    CHECK(files.shot("shape \"Cube.001\" sphere", {{}, {}, {"shape.Cube.001.radius=3"}})
              ->params["shape Cube.001"]
              .radius == 3);
    CHECK(files.shot("shape \"Cube.001\" sphere", {{}, {}, {"shape.\"Cube.001\".radius=3"}})
              ->params["shape Cube.001"]
              .radius == 3);
    CHECK(files.shot("param r 2\nshape a sphere", {{}, {}, {"shape.a.radius=$r"}})->params["shape a"].radius == 2);
    CHECK(files.shot("param r 2\nshape a sphere", {{}, {}, {"shape.a.radius=\"$r * 2\""}})->params["shape a"].radius ==
          4);
    for (const char* wrong :
         {"camera", "camera.lens", "camera=3", ".lens=3", "camera.=3", "=3", "camera.lens=", "camera.lens=3; f-stop 2",
          "camera.lens=3 } ; override film { filter box", "camera.lens=1\nf-stop 2"}) {
        INFO(wrong);
        CHECK(set({wrong})->codes().find("E0233") != std::string::npos);
    }
    CHECK(set({"camera.lens=\"50"})->codes() == "E0103");
    CHECK(set({"camera.lens=5 s"})->codes() == "E0302");
    CHECK(set({"camera.lense=5 mm"})->codes() == "E0201");
    CHECK(set({"camra.lens=5 mm"})->get("E0232").label == "did you mean `camera`?");
    const auto unknown = set({"material.rad.roughness=1"});
    CHECK(unknown->codes() == "E0229");
    CHECK(unknown->get("E0229").label == "nothing to override; did you mean `red`?");
}

TEST_CASE("parameters of included files") {
    const Files files;
    files.write(
        "ball.scene",
        "scene 1\nparam r 2\nparam q \"$r * 2\"\nshape ball sphere { radius $r }\nshape big sphere { radius \"$q\" }");
    CHECK(files.shot("include \"ball.scene\"")->params["shape ball"].radius == 2);
    const auto outer = files.shot("include \"ball.scene\"\nparam r 3");
    sound(*outer);
    CHECK(outer->params["shape ball"].radius == 3);
    CHECK(outer->params["shape big"].radius == 6);
    CHECK(files.shot("include \"ball.scene\" { param r 4 }\nparam r 3")->params["shape ball"].radius == 4);
    CHECK(files.shot("include \"ball.scene\" as=b\nparam r 3\nshape s sphere { radius $r }")
              ->params["shape b:ball"]
              .radius == 2);
    CHECK(files.shot("include \"ball.scene\" as=b\nparam \"b:r\" 3")->params["shape b:ball"].radius == 3);
    CHECK(files.shot("include \"ball.scene\"", {{"r=5"}, {}, {}})->params["shape ball"].radius == 5);
    CHECK(files.shot("include \"ball.scene\" as=b", {{"b:r=5"}, {}, {}})->params["shape b:ball"].radius == 5);
    CHECK(files.shot("include \"ball.scene\"\nparam r 3", {{"r=5"}, {}, {}})->params["shape ball"].radius == 5);
    files.write("outer.scene", "scene 1\ninclude \"ball.scene\" as=b");
    CHECK(files.shot("include \"outer.scene\" as=a\nparam \"a:b:r\" 6")->params["shape a:b:ball"].radius == 6);
    // A text is computed with the parameters of the file that it stands in.
    CHECK(files.shot("include \"ball.scene\" { param r \"$k + 1\" }\nparam k 6")->params["shape ball"].radius == 7);
    const auto unknown = files.shot("include \"ball.scene\"", {{"rr=5"}, {}, {}});
    CHECK(unknown->codes() == "E0221");
    CHECK(unknown->get("E0221").help == "its parameters are `q` and `r`");
    CHECK(files.shot("include \"ball.scene\" { param s 4 }")->get("E0221").message ==
          "the included file has no parameter `s`");
    CHECK(files.shot("include \"ball.scene\"\nshape s sphere { radius $r }")->codes() == "E0204"); // they are its own
    CHECK(files.shot("include \"ball.scene\" as=b\nparam r 3")->codes() == "W0205");
}

TEST_CASE("what cannot be included") {
    const Files files;
    const auto missing = files.shot("include \"rom.scene\"");
    CHECK(missing->codes() == "E0401");
    CHECK(missing->get("E0401").help == "`room.scene` exists");
    CHECK(files.shot("include")->codes() == "E0232");
    CHECK(files.shot("include \"a\" \"b\"")->codes() == "E0232");
    CHECK(files.shot("include 3")->codes() == "E0232");
    CHECK(files.shot("include \"room.scene\" at=b")->codes() == "E0210");
    CHECK(files.shot("include \"room.scene\" as=3")->codes() == "E0209");
    CHECK(files.shot("include \"room.scene\" as=\"a:b\"")->codes() == "E0209");
    CHECK(files.shot("include \"room.scene\" { shape plane }")->codes() == "E0232");
    CHECK(files.shot("group { include \"room.scene\" }")->codes() == "E0232");
    CHECK(files.shot("shape sphere { include \"room.scene\" }")->codes() == "E0232");
    CHECK(files.shot("include \".\"")->codes() == "E0402");
    files.write("mesh.ply", "ply\nformat ascii 1.0\n");
    CHECK(files.shot("include \"mesh.ply\"")->codes() == "E0413");
    files.write("z.scene", "scene 1 up=z\nshape plane");
    CHECK(files.shot("include \"z.scene\"")->codes() == "E0234");
    CHECK(files.shot("include \"room.scene\"\ninclude \"room.scene\" { param x 1 }")->codes() == "E0232");
}

TEST_CASE("faults in included files stand in them, with the chain") {
    const Files files;
    files.write("inner.scene", "scene 1\nshape ball sphere { radius 2 s }");
    files.write("outer.scene", "scene 1\n\ninclude \"inner.scene\"");
    const auto l = files.shot("include \"outer.scene\"");
    CHECK(l->codes() == "E0302");
    const std::string text = l->human();
    INFO(text);
    const auto inner = text.find("inner.scene:2:30"), by = text.find("outer.scene:3:9"),
               own = text.find("test.scene:2:9");
    CHECK(inner != std::string::npos);
    CHECK(by != std::string::npos);
    CHECK(own != std::string::npos);
    CHECK(inner < by);
    CHECK(by < own);
    // What is wrong with a text that is there twice is said once.
    files.write("bad.scene", "scene 1\nshape ball sphere { radius 2mm }");
    CHECK(files.shot("include \"bad.scene\" as=a\ninclude \"bad.scene\" as=b")->codes() == "E0105");
}

TEST_CASE("cycles, bombs and depth") {
    const Files files;
    files.write("a.scene", "scene 1\ninclude \"b.scene\"");
    files.write("b.scene", "scene 1\ninclude \"a.scene\"");
    const auto cycle = files.shot("include \"a.scene\"");
    CHECK(cycle->codes() == "E0227");
    CHECK(cycle->get("E0227").notes.at(0) == "the chain is `a.scene` → `b.scene` → `a.scene`");
    files.write("p.scene", "scene 1\ninclude \"p.scene\" as=x");
    CHECK(files.shot("include \"p.scene\"")->codes() == "E0227");
    for (int i = 0; i < 40; ++i)
        files.write(fmt::format("deep{}.scene", i), fmt::format("scene 1\ninclude \"deep{}.scene\"", i + 1));
    files.write("deep40.scene", "scene 1");
    CHECK(files.shot("include \"deep0.scene\"")->codes() == "E0228");
    CHECK(files.shot("include \"deep12.scene\"")->codes().empty());
    for (int i = 0; i < 30; ++i)
        files.write(fmt::format("bomb{}.scene", i),
                    fmt::format("scene 1\ninclude \"bomb{0}.scene\" as=l\ninclude \"bomb{0}.scene\" as=r", i + 1));
    files.write("bomb30.scene", "scene 1");
    const auto before = std::chrono::steady_clock::now();
    CHECK(files.shot("include \"bomb0.scene\"")->get("E0228").message == "a scene has at most 1000 files");
    CHECK(std::chrono::steady_clock::now() - before < std::chrono::seconds(20));
}

TEST_CASE("overrides of nothing") {
    const Files files;
    const auto near = files.over("override material rde { roughness 0 }");
    CHECK(near->codes() == "E0229");
    CHECK(near->get("E0229").message == "no material is named `rde`");
    CHECK(near->get("E0229").label == "nothing to override; did you mean `red`?");
    REQUIRE(near->get("E0229").related.size() == 1);
    CHECK(near->human().find("room.scene:4:10") != std::string::npos);
    CHECK(files.over("remove light sunny")->codes() == "E0229");
    CHECK(files.shot("override camera { f-stop 2 }\nshape plane")->get("E0229").message == "the scene has no `camera`");
    const auto order = files.shot("override shape a { radius 3 }\nshape a sphere");
    CHECK(order->codes() == "E0229");
    CHECK(order->get("E0229").label == "`override` stands behind what it changes");
    CHECK(order->get("E0229").message == "shape `a` is defined further down");
    CHECK(files.shot("override camera { f-stop 2 }\ncamera { }\nshape plane")->get("E0229").message ==
          "`camera` is defined further down");
    CHECK(files.over("override group room { shape wal { size 1 1 } }")->codes() == "E0229");
    const auto type = files.over("override light key sun { power 1 W }");
    CHECK(type->codes() == "E0230");
    CHECK(type->get("E0230").help == "`remove light key` first, and define it anew");
    CHECK(files.shot("camera a { }\ncamera b { }\noverride camera { f-stop 2 }")->codes() == "E0230");
    CHECK(files.shot("light sky { power 1 W }\nlight sky { power 2 W }\nremove light sky")->codes() == "E0230");
    CHECK(files.over("override")->codes() == "E0232");
    CHECK(files.over("override 3")->codes() == "E0232");
    CHECK(files.over("override param x")->get("E0232").help.starts_with("a `param` of the same name"));
    CHECK(files.over("override materal red { roughness 0 }")->get("E0232").label == "did you mean `material`?");
    CHECK(files.over("override material 3")->codes() == "E0232");
    CHECK(files.over("override group room x")->codes() == "E0306");
    CHECK(files.over("remove material red { }")->codes().find("E0232") != std::string::npos);
    const auto twice = files.over("material red diffuse { reflectance 1 }");
    CHECK(twice->codes() == "E0203");
    CHECK(twice->get("E0203").help.starts_with(
        "to change the first one in a layer, write `override material red { … }`"));
}

TEST_CASE("many layers take a time that grows with their number") {
    const Files files;
    std::string text = "scene 1\n";
    for (int i = 0; i < 20'000; ++i) text += fmt::format("shape s{} sphere {{ radius 1 }}\n", i);
    files.write("many.scene", text);
    std::string layer = "include \"many.scene\"\n";
    for (int i = 0; i < 20'000; ++i) layer += fmt::format("override shape s{} {{ radius 2 }}\n", i);
    for (int i = 0; i < 10'000; ++i) layer += fmt::format("remove shape s{}\nshape s{} sphere {{ radius 3 }}\n", i, i);
    for (int i = 0; i < 5'000; ++i) layer += fmt::format("override shape missing{} {{ radius 2 }}\n", i);
    const auto before = std::chrono::steady_clock::now();
    const auto l = files.shot(layer);
    CHECK(std::chrono::steady_clock::now() - before < std::chrono::seconds(30));
    CHECK(l->diagnostics.errorCount() == 5'000);
    CHECK(l->params["shape s9"].radius == 3);
    CHECK(l->params["shape s15000"].radius == 2);
}
