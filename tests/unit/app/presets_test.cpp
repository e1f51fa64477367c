// `preset NAME`: the library of materials and media.
#include "base/diagnostic_format.h"
#include "parser/parse.h"
#include "parser/presets.h"
#include "scene/build.h"
#include "scene/registry.h"
#include "schema/describe.h"
#include "schema/preset_library.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <fstream>
#include <set>
#include <sstream>

using namespace abbe;

namespace {

struct Loaded {
    SourceMap sources;
    Diagnostics diagnostics;
    schema::TypeTable types = makeTypeTable();
    schema::SceneTree tree;

    explicit Loaded(const std::string& body, bool build = false, const std::string& define = {}) {
        const FileId file = sources.add(
            "test.scene", "scene 1\ncamera { from 0 0 5; look-at 0 0 0 }\nlight sky { radiance 1 }\n" + body);
        ParseOptions options;
        if (!define.empty())
            if (auto override = readOverride(sources, define, diagnostics))
                options.overrides.push_back(std::move(*override));
        const auto document = parse(sources, file, options, diagnostics);
        addPresets(types, sources, diagnostics);
        tree = schema::resolve(document, types, ".", diagnostics);
        BuildOptions settings;
        settings.geometry = false;
        if (build) buildScene(tree, types, settings, diagnostics);
    }

    const Diagnostic& first() const {
        REQUIRE(!diagnostics.all().empty());
        return diagnostics.all()[0];
    }
    std::string text(Span span) const { return std::string(sources.text(span)); }
    std::string human() const { return formatHuman(diagnostics, sources); }
};

// The values of a property as they stand in the files: "0.3"; several times: "0.3 | 0.4".
std::string valueOf(const schema::Definition& d, std::string_view name) {
    std::string text;
    for (const schema::Node& node : d.properties) {
        if (node.name() != name) continue;
        if (!text.empty()) text += " | ";
        for (std::size_t i = 0; i < node.valueCount(); ++i)
            text += (i > 0 ? " " : "") + std::string(node.value(i).text);
    }
    return text;
}

} // namespace

TEST_CASE("a preset stands for its definition in the library") {
    const Loaded l("material ring preset gold\nshape sphere { material ring }");
    INFO(l.human());
    CHECK(l.diagnostics.all().empty());
    const schema::Definition* const ring = l.tree.find(schema::Kind::material, "ring");
    REQUIRE(ring);
    REQUIRE(ring->type);
    CHECK(ring->type->name == "conductor");
    CHECK(valueOf(*ring, "index") == "metal Au");
    CHECK(valueOf(*ring, "roughness") == "0.12");
    CHECK(valueOf(*ring, "x-doc").empty());
    CHECK(ring->arguments.empty());
}

TEST_CASE("what the scene says wins") {
    const Loaded block("material ring preset gold { roughness 0.3 }\nshape sphere { material ring }", true);
    INFO(block.human());
    CHECK(block.diagnostics.all().empty());
    CHECK(valueOf(*block.tree.find(schema::Kind::material, "ring"), "roughness") == "0.3");
    CHECK(valueOf(*block.tree.find(schema::Kind::material, "ring"), "index") == "metal Au");
    // As a key on the line, which binding would otherwise see twice.
    const Loaded key("material ring preset gold roughness=0.3\nshape sphere { material ring }", true);
    INFO(key.human());
    CHECK(key.diagnostics.all().empty());
    CHECK(valueOf(*key.tree.find(schema::Kind::material, "ring"), "roughness").empty());
    // Another way to say the same: the library's goes.
    const Loaded group("material pane preset cobalt-glass { attenuation-color 0.5 }\nshape sphere { material pane }",
                       true);
    INFO(group.human());
    CHECK(group.diagnostics.all().empty());
    CHECK(valueOf(*group.tree.find(schema::Kind::material, "pane"), "absorption").empty());
    // What the type does not have is said where the scene says it.
    const Loaded wrong("material ring preset gold { roughnes 0.3 }\nshape sphere { material ring }", true);
    CHECK(wrong.first().code == "E0201");
    CHECK(wrong.text(wrong.first().span) == "roughnes");
}

TEST_CASE("in slots, and for media") {
    const Loaded l("shape cup sphere { center 9 0 0; material preset milk }\nshape sphere { material boundary; "
                   "interior preset milk }\n"
                   "medium thin preset milk { scattering 20 per-m }\n"
                   "shape ball sphere { center 3 0 0; material preset gold { roughness 0 }; }\n"
                   "shape drop sphere { center 6 0 0; material preset water; interior thin }",
                   true);
    INFO(l.human());
    CHECK(l.diagnostics.all().empty());
}

TEST_CASE("unknown presets") {
    const auto check = [](const std::string& body, std::string_view code, std::string_view at, std::string_view label) {
        const Loaded l(body, true);
        INFO(l.human());
        CHECK(l.first().code == code);
        CHECK(l.text(l.first().span) == at);
        CHECK(l.first().label == label);
        CHECK(l.diagnostics.errorCount() == 1);
    };
    check("shape sphere { material preset golt }", "E0771", "golt", "did you mean `gold`?");
    check("material ring preset golt\nshape sphere { material ring }", "E0771", "golt", "did you mean `gold`?");
    check("material ring preset xyzzy-plugh\nshape sphere { material ring }", "E0771", "xyzzy-plugh", "unknown name");
    check("shape sphere { material preset gold; interior preset gold }", "E0771", "gold",
          "this is a material of the library");
    check("material ring preset\nshape sphere { material ring }", "E0770", "ring", "write it behind the word");
    check("material ring preset 3\nshape sphere { material ring }", "E0770", "3", "write it behind the word");
    check("shape sphere { material preset gold 0.3 }", "E0306", "0.3", "unexpected");
}

TEST_CASE("the name may be a parameter") {
    const std::string body = "param metal gold\nshape sphere { material preset $metal }";
    CHECK(Loaded(body, true).diagnostics.all().empty());
    CHECK(Loaded(body, true, "metal=copper").diagnostics.all().empty());
    const Loaded wrong(body, true, "metal=coper");
    CHECK(wrong.first().code == "E0771");
    CHECK(wrong.text(wrong.first().span) == "$metal");
}

TEST_CASE("every preset builds without a word, and says what it is and where its figures come from") {
    const Loaded empty("");
    REQUIRE(empty.types.presets());
    const auto presets = empty.types.presets()->all();
    std::set<std::pair<schema::Kind, std::string_view>> names;
    std::size_t materials = 0;
    for (const schema::Preset& preset : presets) {
        INFO(preset.name);
        materials += preset.kind == schema::Kind::material ? 1 : 0;
        CHECK(names.emplace(preset.kind, preset.name).second);
        CHECK(!preset.group.empty());
        CHECK(preset.doc.ends_with('.'));
        CHECK(preset.source.ends_with('.'));
        const std::string name(preset.name);
        const bool material = preset.kind == schema::Kind::material;
        const Loaded l("shape sphere { material " +
                           (material ? "preset " + name : "boundary; interior preset " + name) + " }",
                       true);
        INFO(l.human());
        CHECK(l.diagnostics.all().empty());
        // Behind every medium is a material of the name.
        CHECK(empty.types.presets()->find(schema::Kind::material, name));
    }
    CHECK(materials >= 60);
}

TEST_CASE("names in the library are its own") {
    // Words of the library that a scene happens to define: they must not get into presets.
    const Loaded l("spectrum metal 0.5\nspectrum table 0.5\nspectrum glass 0.5\nspectrum measured 0.5\n"
                   "phase isotropic henyey-greenstein 0.9\n"
                   "material a preset gold\nmaterial b preset cobalt-glass\nmaterial c preset red-paint\n"
                   "shape sphere { material a }\nshape b sphere { center 3 0 0; material b }\n"
                   "shape c sphere { center 6 0 0; material c }",
                   true);
    INFO(l.human());
    CHECK(!l.diagnostics.hasErrors());
}

TEST_CASE("presets are explained, and the page about them is up to date") {
    const Loaded l("");
    CHECK(schema::explain(l.types, "presets").text.find("\n  gold ") != std::string::npos);
    const schema::Explanation gold = schema::explain(l.types, "preset gold");
    CHECK(gold.found);
    CHECK(gold.text.find("index metal Au") != std::string::npos);
    CHECK(gold.text.find("Johnson and Christy 1972") != std::string::npos);
    CHECK(schema::explain(l.types, "milk").text.find("medium preset milk") != std::string::npos);
    CHECK(schema::explain(l.types, "cobalt-glas").text.find("did you mean `cobalt-glass`?") != std::string::npos);
    std::ifstream page(ABBE_SOURCE_DIR "/docs/materials_library.md");
    std::stringstream written;
    written << page.rdbuf();
    CHECK_MESSAGE(written.str() == schema::explain(l.types, "library").text,
                  "abbe explain library > docs/materials_library.md");
}
