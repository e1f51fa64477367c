// `kind [name] type [arguments] { … }`, names, headers, objects and instances.
#include "language_fixture.h"

#include <doctest/doctest.h>

using namespace language_test;

TEST_CASE("heads of definitions") {
    const auto head = [](const std::string& text) {
        const auto l = loadBody(text);
        INFO(text, "\n", l->human());
        CHECK(l->tree.definitions.size() == 1);
        const Definition& d = l->tree.definitions.at(0);
        return d.name + "/" + std::string(d.type ? d.type->name : "?");
    };
    CHECK(head("camera { }") == "/perspective");
    CHECK(head("camera main { }") == "main/perspective");
    CHECK(head("camera main perspective { }") == "main/perspective");
    CHECK(head("light sky { power 1 W }") == "/sky");
    CHECK(head("light rim quad { power 1 W }") == "rim/quad");
    CHECK(head("light sun sun { power 1 W }") == "sun/sun");
    CHECK(head("shape sphere") == "/sphere");
    CHECK(head("shape lens sphere") == "lens/sphere");
    CHECK(head("shape \"Cube 1\" sphere") == "Cube 1/sphere");
    CHECK(head("shape \"sphere\"") == "/sphere");
    CHECK(head("shape mesh \"sphere\"") == "/mesh"); // a file called `sphere`
    CHECK(head("shape sphere mesh") == "sphere/mesh");
}

TEST_CASE("heads with mistakes") {
    CHECK(loadBody("light quadd { power 1 W }")->get("E0205").label == "did you mean `quad`?");
    CHECK(loadBody("light key quadd { power 1 W }")->get("E0205").label == "did you mean `quad`?");
    CHECK(loadBody("camera perspectiv { }")->codes() == "E0205");
    CHECK(loadBody("shape ball { radius 1 }")->codes() == "E0211");
    CHECK(loadBody("shape { radius 1 }")->codes() == "E0211");
    CHECK(loadBody("shape mehs \"a.ply\"")->get("E0205").label == "did you mean `mesh`?");
    CHECK(loadBody("sphere { radius 1 }")->get("E0215").help == "`sphere` is a type: write `shape sphere`");
    CHECK(loadBody("bsdf a diffuse")->get("E0215").help == "did you mean `material`?");
    CHECK(loadBody("shap sphere")->get("E0215").help == "did you mean `shape`?");
    CHECK(loadBody("camera a&b { }")->codes() == "E0209");
    CHECK(loadBody("shape sphere 3")->get("E0306").message == "`shape sphere` takes no arguments");
    CHECK(loadBody("shape sphere size=3")->codes() == "E0210");
    CHECK(loadBody("object { shape sphere }")->codes() == "E0209");
    CHECK(loadBody("group a b { }")->codes() == "E0306");
    CHECK(loadBody("group { camera { } }")->codes() == "E0212");
    CHECK(loadBody("group { transform { scale 2 }; transform { scale 2 } }")->codes() == "E0208");
}

TEST_CASE("words of later versions are located errors") {
    CHECK(loadBody("shape sphere { at 0 s { radius 1 } }")->codes() == "E0206");
    CHECK(loadBody("light sky { radiance image \"a.exr\" }")->codes() == "E0206");
}

TEST_CASE("private nodes are ignored") {
    CHECK(loadBody("x-tool { anything 1 2 }\nshape sphere { x-id 3 }\ngroup { x-y }")->codes().empty());
}

TEST_CASE("the header") {
    CHECK(load("shape sphere")->codes() == "W0501");
    CHECK(load("shape sphere")->get("W0501").fixes.at(0).replacement == "scene 1\n");
    CHECK(load("")->codes() == "W0501");
    CHECK(load("scene 2")->codes() == "E0501");
    CHECK(load("scene")->codes() == "E0503");
    CHECK(load("scene one")->codes() == "E0503");
    CHECK(load("shape sphere\nscene 1")->codes() == "E0502");
    CHECK(load("scene 1\nscene 1")->codes() == "E0502");
    CHECK(load("scene 1 lenght=mm")->get("E0503").help == "did you mean `length`?");
    CHECK(load("scene 1 length=s")->codes() == "E0503");
    CHECK(load("scene 1 up=x")->codes() == "E0503");
    CHECK(load("scene 1 rgb=srgb")->codes() == "E0315");
    CHECK(load("scene 1 rgb=acescgg")->get("E0315").help == "did you mean `acescg`?");
    const auto l = load("scene 1 length=mm rgb=acescg up=z minor=3\ncamera { from 1 2 3; lens 0.01 m }");
    CHECK(l->codes().empty());
    CHECK(l->tree.header.zUp);
    CHECK(l->tree.header.rgb == RgbSpaceName::linAp1);
    CHECK(l->params["camera"].from == Vec3d{1 * 0.001, 2 * 0.001, 3 * 0.001});
    CHECK(l->params["camera"].lens == 0.01);
}

TEST_CASE("names: forward references, kinds, duplicates") {
    const auto l =
        loadBody("shape a sphere { material glass }\nmaterial glass dielectric\nlight glass quad { power 1 W }");
    CHECK(l->codes().empty());
    CHECK(l->resolver.references == std::vector<std::string>{"glass"});
    CHECK(loadBody("shape a sphere\nshape a sphere")->codes() == "E0203");
    CHECK(loadBody("shape a sphere\ngroup { shape a sphere }")->codes() == "E0203");
    const auto wrong = loadBody("shape sphere { material lamp }\nlight lamp quad { power 1 W }");
    CHECK(wrong->get("E0202").label == "this names a light");
    CHECK(loadBody("material diffuse diffuse { reflectance 0.5 }\nshape sphere { material diffuse }")->codes() ==
          "W0202");
}

TEST_CASE("slots: name, type, inline definition") {
    const auto refs = [](const std::string& slot) {
        const auto l =
            loadBody("material skin diffuse\nshape sphere { material skin }\nshape plane { material " + slot + " }");
        return l->codes().empty() ? l->resolver.references.at(1) : l->codes();
    };
    CHECK(refs("skin") == "skin");
    CHECK(refs("diffuse") == "(diffuse)");
    CHECK(refs("diffuse { roughness 0.5 }") == "(diffuse)");
    CHECK(refs("skin { roughness 0.5 }") == "E0214");
    CHECK(refs("skinn") == "E0202");
    CHECK(refs("diffus { roughness 0.5 }") == "E0205");
    CHECK(refs("difuse") == "E0202");
    CHECK(refs("") == "E0306");
    CHECK(refs("5") == "E0314");
    CHECK(refs("{ roughness 0.5 }") == "E0211");
}

TEST_CASE("objects and instances") {
    CHECK(loadBody("object eye { shape sphere }\ninstance eye { transform { scale 2 } }")->codes().empty());
    const auto wrong = loadBody("object eye { shape sphere }\ninstance eyes\ninstance eye");
    CHECK(wrong->get("E0202").label == "did you mean `eye`?");
    CHECK(loadBody("shape eye sphere\ninstance eye")->get("E0202").help.starts_with("`eye` is a shape"));
    CHECK(loadBody("instance { transform { scale 2 } }")->codes() == "E0209");
    CHECK(loadBody("object a { shape sphere }\ninstance a { color 3 }")->codes() == "E0201");
    const auto cycle = loadBody("object a { instance b }\nobject b { group { instance a } }\ninstance a");
    CHECK(cycle->codes() == "E0213");
    CHECK(cycle->get("E0213").notes.at(0) == "the chain is a → b → a");
    CHECK(loadBody("object a { instance a }\ninstance a")->codes() == "E0213");
    // A diamond is no cycle.
    CHECK(loadBody("object a { shape sphere }\nobject b { instance a; instance a }\nobject c { instance a; instance b "
                   "}\ninstance c")
              ->codes()
              .empty());
}

TEST_CASE("a chain of many objects does not exhaust the stack") {
    std::string text;
    for (int i = 0; i < 50000; ++i)
        text += "object o" + std::to_string(i) + " { instance o" + std::to_string(i + 1) + " }\n";
    CHECK(loadBody(text + "object o50000 { shape sphere }\ninstance o0")->codes().empty());
}

TEST_CASE("unused definitions warn, unless an error may be the reason") {
    CHECK(loadBody("material a diffuse")->get("W0201").message == "material `a` is never used");
    CHECK(loadBody("object a { shape sphere }")->codes() == "W0201");
    CHECK(loadBody("spectrum paper 0.8")->codes() == "W0201");
    CHECK(loadBody("material paint diffuse\nshape sphere { material paintt }")->codes() == "E0202");
    CHECK(loadBody("material paint diffuse\nshap sphere { material paint }")->codes() == "E0215");
}
