// Mistakes that come with habits from other programs: what the diagnostic proposes, and what it repairs.
#include "base/diagnostic.h"
#include "language_fixture.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

using namespace language_test;

namespace {

std::string fixedBody(const std::string& body) {
    const auto l = loadBody(body);
    const std::string text = "scene 1\n" + body;
    return applyFixes(text, FileId{0}, l->diagnostics).text.substr(8);
}

std::unique_ptr<Loaded> inSphere(const std::string& property) {
    return loadBody("shape ball sphere { " + property + " }");
}
std::unique_ptr<Loaded> inPaint(const std::string& property) {
    return loadBody("material m diffuse { " + property + " }\nshape sphere { material m }");
}

} // namespace

TEST_CASE("type before name is taken, too") {
    for (const auto& [text, name, type] : std::vector<std::array<std::string, 3>>{
             {"light quad key { power 1 W }", "key", "quad"},
             {"light key quad { power 1 W }", "key", "quad"},
             {"shape sphere ball", "ball", "sphere"},
             {"camera perspective main { }", "main", "perspective"},
             {"material diffuse red", "red", "diffuse"},
             {"texture image wood \"a\"", "wood", "image"},
             {"texture image wood", "", "image"}, // the word may be the argument
             {"light sun sky { power 1 W }", "sun", "sky"},
         }) {
        const auto l = loadBody(text);
        CHECK_MESSAGE(l->tree.definitions.at(0).name == name, text);
        REQUIRE(l->tree.definitions.at(0).type);
        CHECK_MESSAGE(l->tree.definitions.at(0).type->name == type, text);
        CHECK_MESSAGE(!l->diagnostics.hasErrors(), text << "\n" << l->human());
    }
    CHECK(loadBody("shape sphere a&b")->codes() == "E0209");
}

TEST_CASE("what is repaired means the same") {
    CHECK(fixedBody("camera { lense 50 mm }") == "camera { lens 50 mm }");
    CHECK(fixedBody("camera { lookAt 0 0 1 }") == "camera { look-at 0 0 1 }");
    CHECK(fixedBody("camera { focal-length 50 mm }") == "camera { lens 50 mm }");
    CHECK(fixedBody("camera { focal-length 50 }") == "camera { focal-length 50 }"); // millimetres there, metres here
    CHECK(fixedBody("camera { fovy 40 deg }") == "camera { fovy 40 deg }");         // another angle
    CHECK(fixedBody("camera { f-stop 2.8 cm }") == "camera { f-stop 2.8 cm }");
    CHECK(fixedBody("camera { senors 36 24 mm }") == "camera { senors 36 24 mm }"); // two letters
    CHECK(fixedBody("shape sphere { r 2 }") == "shape sphere { radius 2 }");
    CHECK(fixedBody("render { spp 16 }") == "render { samples 16 }");
    CHECK(fixedBody("material m diffuse { Kd 0.5 }") == "material m diffuse { reflectance 0.5 }");
    CHECK(fixedBody("material m diffuse { roughness 30 % }") == "material m diffuse { roughness 0.3 }");
    CHECK(fixedBody("param r1 1\nshape sphere { radius $r2 }") == "param r1 1\nshape sphere { radius $r2 }");
}

TEST_CASE("steps of a transform outside of its block") {
    const auto one = inSphere("rotate y 45 deg");
    CHECK(one->codes() == "E0201");
    CHECK(one->get("E0201").help == "write `transform { rotate y 45 deg }`");
    CHECK(fixedBody("shape sphere { rotate y 45 deg }") == "shape sphere { transform { rotate y 45 deg } }");
    const auto two = inSphere("translate 0 1 0; radius 1; rotate y 45 deg");
    CHECK(two->codes() == "E0201");
    CHECK(two->get("E0201").help == "write `transform { translate 0 1 0; rotate y 45 deg }`");
    CHECK(two->get("E0201").fixes.empty());
    CHECK(inSphere("transform { scale 2 }; rotate y 45 deg")->get("E0201").help ==
          "write `rotate y 45 deg` into the block of its `transform`");
    CHECK(loadBody("group { translate 0 1 0; shape sphere }")->get("E0201").help ==
          "write `transform { translate 0 1 0 }`");
    CHECK(loadBody("object a { shape sphere }\ninstance a { translate 0 1 0 }")->codes() == "E0201");
    CHECK(loadBody("rotate y 45 deg")->get("E0215").help.starts_with("a step of `transform { rotate y 45 deg }`"));
    CHECK(inPaint("rotate y 45 deg")->get("E0201").help.starts_with("its properties are")); // nothing that turns
}

TEST_CASE("colours of pictures") {
    const auto hex = inPaint("paint \"#c0b0a0\"");
    CHECK(hex->codes() == "E0202");
    CHECK(hex->get("E0202").label == "write `srgb \"#c0b0a0\"`");
    CHECK(hex->get("E0202").help == "in linear numbers of Rec. 709 it is `rgb 0.527 0.434 0.352`");
    CHECK(inPaint("reflectance \"#c0b0a0\"")->get("E0202").label == "write `srgb \"#c0b0a0\"`");
    CHECK(fixedBody("material m diffuse { paint \"#c0b0a0\" }") == "material m diffuse { paint srgb \"#c0b0a0\" }");
    CHECK(fixedBody("material m diffuse { reflectance 191 153 102 }") ==
          "material m diffuse { reflectance 191 153 102 }");
    CHECK(fixedBody("material m diffuse { reflectance 0.8 0.2 0.1 }") ==
          "material m diffuse { reflectance rgb 0.8 0.2 0.1 }");
    const std::string divided = "numbers of a picture or colour picker, divided by 255, are `srgb 0.749 0.6 0.4`; if "
                                "they are linear, `rgb 0.749 0.6 0.4`";
    CHECK(inPaint("reflectance rgb 191 153 102")->get("E0304").help == divided);
    CHECK(inPaint("reflectance srgb 191 153 102")->get("E0303").help == divided);
    CHECK(inPaint("reflectance 191 153 102")->get("E0306").help == divided);
    CHECK(inPaint("reflectance rgb 60 40 20")
              ->get("E0304")
              .help.ends_with("percent, divided by 100, are `rgb 0.6 0.4 0.2`"));
    CHECK(inPaint("reflectance rgb 1.2 0.8 0.7")->get("E0304").help.empty());
}

TEST_CASE("a picture in the place of a spectrum or number") {
    const auto wood = inPaint("paint \"wood.png\"");
    CHECK(wood->codes() == "E0202");
    CHECK(wood->get("E0202").label == "write `image \"wood.png\"`");
    CHECK(fixedBody("material m diffuse { paint \"wood.png\" }") == "material m diffuse { paint image \"wood.png\" }");
    CHECK(fixedBody("material m diffuse { gloss \"wear.EXR\" }") ==
          "material m diffuse { gloss image \"wear.EXR\" space=data }");
}

TEST_CASE("what is computed stands in quotes") {
    const auto twice = loadBody("param r 2 cm\nshape sphere { radius $r*2 }");
    CHECK(twice->codes() == "E0204");
    CHECK(twice->get("E0204").label == "write `\"$r * 2\"`");
    CHECK(fixedBody("param r 2 cm\nshape sphere { radius $r*2 }") ==
          "param r 2 cm\nshape sphere { radius \"$r * 2\" }");
    CHECK(loadBody("param r 2\nshape sphere { radius $r-0.5 }")->get("E0204").label == "write `\"$r - 0.5\"`");
    CHECK(loadBody("param two-words 2\nshape sphere { radius $two-words }")->codes().empty());
    CHECK(loadBody("param a 2\nparam b $a\nshape sphere { radius $b }")->get("E0223").label == "write `\"$a\"`");
    CHECK(inSphere("radius 2*3")->get("E0117").label == "what is to be computed stands in quotes: `\"$r * 2\"`");
    CHECK(inSphere("radius 2 * 3")->human().find("what is to be computed stands in quotes") != std::string::npos);
}

TEST_CASE("types of other programs") {
    const auto wanted = [](const std::string& text) { return loadBody(text)->get("E0205").label; };
    CHECK(wanted("material a lambert { reflectance 0.5 }") == "did you mean `diffuse`?");
    CHECK(wanted("material a glass { ior 1.5 }") == "did you mean `dielectric`?");
    CHECK(wanted("material a metal { roughness 0.1 }") == "did you mean `conductor`?");
    CHECK(wanted("material glossy { roughness 0.1 }") == "did you mean `conductor`?");
    CHECK(wanted("light key area { power 1 W }") == "did you mean `quad`?");
    CHECK(loadBody("shape sphere { material glass }")->get("E0202").label == "did you mean `dielectric`?");
    CHECK(inSphere("cast-shadow off")->get("E0201").help.find("casts them") != std::string::npos);
}
