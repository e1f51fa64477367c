// Words of other programs in the blocks of the real types: only what means the same is repaired, and what does not is
// shown with its value.
#include "base/diagnostic.h"
#include "base/diagnostic_format.h"
#include "parser/parse.h"
#include "scene/build.h"
#include "scene/registry.h"

#include <algorithm>
#include <doctest/doctest.h>

using namespace abbe;

namespace {

struct RepairedScene {
    std::string help, label, text;
    std::string codes;
};

RepairedScene repair(const std::string& body) {
    const std::string text = "scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\nlight sky { radiance 1 }\n";
    SourceMap sources;
    Diagnostics diagnostics;
    const schema::TypeTable types = makeTypeTable();
    const FileId file = sources.add("test.scene", text + body);
    const auto document = parse(sources, file, {}, diagnostics);
    const schema::SceneTree tree = schema::resolve(document, types, ".", diagnostics);
    BuildOptions options;
    options.geometry = false;
    buildScene(tree, types, options, diagnostics);
    RepairedScene result;
    for (const Diagnostic& d : diagnostics.all()) {
        if (d.code == "W0201") continue;
        result.codes += (result.codes.empty() ? "" : " ") + d.code;
        result.help = d.help;
        result.label = d.label;
    }
    result.text = applyFixes(sources.text(file), file, diagnostics).text.substr(text.size());
    return result;
}

} // namespace

TEST_CASE("the meaning of what is repaired stays") {
    struct Case {
        const char *body, *help;
    };
    for (const Case& c : {
             Case{"material m dielectric { alpha 0.1 }",
                  "`alpha 0.1` is `roughness 0.316`: roughness is the square root of the width α"},
             Case{"material m conductor { index metal Au; glossiness 0.9 }",
                  "`glossiness 0.9` is `roughness 0.1`: roughness is 1 − glossiness"},
             Case{"material m openpbr { glossiness 0.9 }",
                  "`glossiness 0.9` is `specular-roughness 0.1`: roughness is 1 − glossiness"},
             Case{"light environment \"tests/snippets/any.exr\" { gain 2 }",
                  "`gain 2` is `exposure 1 stops`: each stop doubles, so it is the logarithm to base 2"},
             Case{"light environment \"tests/snippets/any.exr\" { strength 2 }",
                  "`strength 2` is `luminance 146000 nits`: a white pixel that is rendered as 1 has 72 983 nits"},
             Case{"light quad { lumens 800 }", "`lumens 800` is `power 800 lm`: the unit stands behind the number"},
             Case{"light quad { temperature 3200; luminance 5 nits }",
                  "`temperature 3200` is `color blackbody 3200 K`: the spectrum of a black body"},
         }) {
        const RepairedScene r = repair(c.body);
        CHECK(r.help == c.help);
        CHECK(r.text == c.body);
    }
    for (const char* body : {"light environment \"tests/snippets/any.exr\" { strength 2 }",
                             "light point { strength 2 }", "light quad { strength 2 }", "light spot { strength 2 }",
                             "shape sphere { to-world 1 }", "light quad { scale 2; luminance 5 nits }"})
        CHECK_MESSAGE(repair(body).text == body, body);
}

TEST_CASE("another program's word for the same thing is replaced") {
    const auto repaired = [](const std::string& body) { return repair(body).text; };
    CHECK(repaired("material m dielectric { attenuation-depth 3 cm }") ==
          "material m dielectric { attenuation-distance 3 cm }");
    CHECK(repaired("material m diffuse { albedo 0.3 }") == "material m diffuse { reflectance 0.3 }");
    CHECK(repaired("material m openpbr { baseColor rgb 0.3 0.2 0.1 }") ==
          "material m openpbr { base-color rgb 0.3 0.2 0.1 }");
    CHECK(repaired("material m diffuse { reflectanse 0.3 }") == "material m diffuse { reflectance 0.3 }");
}

TEST_CASE("a number without a unit that was hardly meant in metres") {
    std::string fixed;
    const auto first = [&](const std::string& camera) {
        SourceMap sources;
        Diagnostics diagnostics;
        const schema::TypeTable types = makeTypeTable();
        const auto document = parse(sources, sources.add("test.scene", camera), {}, diagnostics);
        const schema::SceneTree tree = schema::resolve(document, types, ".", diagnostics);
        BuildOptions options;
        options.geometry = false;
        buildScene(tree, types, options, diagnostics);
        fixed = applyFixes(sources.text(FileId{0}), FileId{0}, diagnostics).text;
        const auto d = std::ranges::find_if(diagnostics.all(), [](const Diagnostic& x) { return x.code != "E0610"; });
        return d == diagnostics.all().end() ? "" : d->code + ": " + d->message + ": " + d->help;
    };
    CHECK(first("scene 1\ncamera { lens 50 }") == "W0301: `lens` is 50 m: write `lens 50 mm`");
    CHECK(fixed == "scene 1\ncamera { lens 50 mm }");
    CHECK(first("scene 1\ncamera { lens 500 }").find("E0303") == 0);
    CHECK(first("scene 1\ncamera { lens 500 }").find("write `lens 500 mm`") != std::string::npos);
    CHECK(first("scene 1\ncamera { sensor 36 24 }") == "W0301: `sensor` is 36 m: write `sensor 36 24 mm`");
    CHECK(fixed == "scene 1\ncamera { sensor 36 24 mm }");
    CHECK(first("scene 1 length=mm\ncamera { lens 50 }") == "");
    CHECK(first("scene 1\ncamera { lens 0.05 }") == "");
    CHECK(first("scene 1\ncamera { lens 50 m }") == "");
    CHECK(fixed == "scene 1\ncamera { lens 50 m }");
}
