// Textures in the place of spectra and numbers.
#include "language_fixture.h"
#include "schema/describe.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <random>

using namespace language_test;

namespace {

std::unique_ptr<Loaded> material(const std::string& body, const std::string& before = "") {
    return loadBody(before + "\nmaterial m diffuse { " + body + " }\nshape sphere { material m }");
}
const Params& of(const Loaded& l) { return l.params.at("material m"); }
const Texture* someTexture() { return reinterpret_cast<const Texture*>(RecordingResolver::kTexture); }

const std::string kWood = "texture wood noise { scale 1 }";

} // namespace

TEST_CASE("a texture may stand for a spectrum or a number, by name or in place") {
    const auto named = material("paint wood; gloss wood", kWood);
    CHECK(named->codes().empty());
    CHECK(of(*named).paint.texture == someTexture());
    CHECK(!of(*named).paint.curve);
    CHECK(of(*named).gloss.texture == someTexture());
    CHECK(named->text(of(*named).paint.span) == "paint wood");
    CHECK(named->resolver.textures == std::vector<std::string>{"wood", "wood as a number"});

    const auto inlined = material("paint image \"wood.png\" space=data; gloss noise { scale 2 cm; odd 0.5 }");
    CHECK(inlined->codes().empty());
    CHECK(of(*inlined).paint.texture == someTexture());
    CHECK(inlined->resolver.textures == std::vector<std::string>{"(image)", "(noise) as a number"});

    CHECK(material("gloss noise")->resolver.textures == std::vector<std::string>{"(noise) as a number"});
    const auto onLine = loadBody(kWood + "\nmaterial m diffuse paint=wood gloss=noise\nshape sphere { material m }");
    CHECK(onLine->codes().empty());
    CHECK(onLine->resolver.textures == std::vector<std::string>{"wood", "(noise) as a number"});
    CHECK(
        loadBody("param rough 0.5\nmaterial m diffuse { gloss $rough }\nshape sphere { material m }")->codes().empty());
}

TEST_CASE("texturable fields take what they took before") {
    const auto plain = material("paint rgb 0.1 0.2 0.3; gloss 40 %");
    CHECK(plain->codes().empty());
    CHECK(of(*plain).paint.curve);
    CHECK(!of(*plain).paint.texture);
    CHECK(of(*plain).gloss.value == doctest::Approx(0.4));
    CHECK(plain->text(of(*plain).gloss.span) == "gloss 40 %");
    CHECK(of(*material("gloss \"1/3\"")).gloss.value == doctest::Approx(1. / 3));
    CHECK(of(*material("paint ink", "spectrum ink 0.2")).paint.curve);
    CHECK(of(*material("")).gloss.value == 0.25); // the member's own
    CHECK(material("gloss 1.5")->codes() == "E0303");
    CHECK(material("paint rgb 2 0 0")->codes() == "E0304");
    CHECK(material("paint")->codes() == "E0306");
    CHECK(material("gloss")->codes() == "E0306");
    CHECK(material("paint 0.5 space=data")->codes() == "E0210");
    CHECK(material("gloss 0.5 { scale 1 }")->codes() == "E0214");
}

TEST_CASE("names win over types, and a name of two things is refused") {
    const auto hidden = material("paint noise", "texture noise noise { scale 1 }");
    CHECK(hidden->codes() == "W0202");
    CHECK(hidden->resolver.textures == std::vector<std::string>{"noise"});
    // With arguments or a block a type is meant.
    CHECK(material("paint noise { scale 2 }", "texture noise noise { scale 1 }")->resolver.textures ==
          std::vector<std::string>{"(noise)"});

    const auto both = material("paint wood", "spectrum wood 0.5\n" + kWood);
    CHECK(both->codes() == "E0730");
    CHECK(both->get("E0730").message == "`wood` names a spectrum and a texture");
    CHECK(both->text(both->get("E0730").span) == "wood");
    REQUIRE(both->get("E0730").related.size() == 2);
    CHECK(both->text(both->get("E0730").related[1].span) == "wood");
    CHECK(material("gloss wood", "spectrum wood 0.5\n" + kWood)->resolver.textures ==
          std::vector<std::string>{"wood as a number"}); // no spectrum can stand there
}

TEST_CASE("wrong names of textures are located and explained") {
    const auto near = material("paint wod", kWood);
    CHECK(near->codes() == "E0202");
    CHECK(near->get("E0202").message == "no spectrum or texture is named `wod`");
    CHECK(near->get("E0202").label == "did you mean `wood`?");
    CHECK(near->text(near->get("E0202").related.at(0).span) == "wood");
    CHECK(material("paint inc", "spectrum ink 0.2")->get("E0202").label == "did you mean `ink`?");
    CHECK(material("gloss nosie")->get("E0202").label == "did you mean `noise`?");
    const auto none = material("gloss zzzzzz");
    CHECK(none->get("E0202").message == "no texture is named `zzzzzz`");
    CHECK(none->get("E0202").help == "write a number, the name of a texture, or one of `noise` or `image`");
    CHECK(material("paint wood { scale 2 }", kWood)->codes() == "E0214");
    CHECK(material("paint wood space=data", kWood)->codes() == "E0214");
    CHECK(material("gloss m")->codes() == "E0202"); // a material
}

TEST_CASE("the manual says where a texture may stand") {
    const TypeTable types = testTypes();
    CHECK(explain(types, "diffuse.paint").text.find("or a texture") != std::string::npos);
    CHECK(explain(types, "diffuse.roughness").text.find("texture") == std::string::npos);
    CHECK(schemaListing(types).find("material diffuse gloss number [fraction] min=0 max=1 texturable") !=
          std::string::npos);
    CHECK(schemaJson(types).find("\"texturable\":true") != std::string::npos);
    const auto pages = referencePages(types);
    const auto page = std::ranges::find(pages, "material.md", &ReferencePage::file);
    REQUIRE(page != pages.end());
    CHECK(page->text.find("a number, or a texture") == std::string::npos); // it is also a fraction
    CHECK(page->text.find("a spectrum from 0 to 1, or a texture") != std::string::npos);
}

TEST_CASE("anything in the place of a texture is bound or refused, with a place in the file") {
    const std::vector<std::string> words = {
        "wood",    "noise",      "image",       "\"x.png\"",    "rgb", "0.5", "1e999", "-1",    "%",
        "ink",     "space=data", "{ scale 2 }", "{ odd wood }", "{",   "}",   "$p",    "#true", "m",
        "scale=2", "metal",      "\"1/0\"",     "table",        "400", "nan", "-",     "\"\""};
    std::mt19937 random(11);
    for (int i = 0; i < 3000; ++i) {
        std::string value;
        for (unsigned n = random() % 5; n > 0; --n) value += " " + words[random() % words.size()];
        const auto l = material((random() % 2 ? "paint" : "gloss") + value, kWood + "\nspectrum ink 0.2\nparam p 0.5");
        CAPTURE(value);
        for (const Diagnostic& d : l->diagnostics.all()) CHECK(d.span.valid());
        if (l->diagnostics.hasErrors() || !l->params.contains("material m")) continue;
        const Params& p = of(*l);
        CHECK((!p.paint.texture || !p.paint.curve));
        CHECK((value.empty() || p.paint.span.valid() || p.gloss.span.valid()));
    }
}
