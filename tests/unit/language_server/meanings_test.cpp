// What the words of a text mean, for everything that the language has; and that no place in a text is too much to ask.
#include "language_server/features.h"
#include "schema/describe.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <fstream>
#include <sstream>
#include <string>

namespace abbe::lsp::test {
namespace {

namespace fs = std::filesystem;

const Language& language() {
    static const Language made;
    return made;
}

// The word at the first occurrence of `word` in the text, at or after `from`.
const Meaning* meaningOf(const Analysis& analysis, std::string_view word, std::size_t from = 0) {
    const std::size_t at = analysis.text().find(word, from);
    REQUIRE(at != std::string_view::npos);
    for (const Meaning& m : analysis.meanings())
        if (m.span.begin == at) return &m;
    return nullptr;
}

std::string fileText(const fs::path& path) {
    std::ifstream file(path);
    std::stringstream text;
    text << file.rdbuf();
    return text.str();
}

std::vector<fs::path> shippedScenes() {
    std::vector<fs::path> scenes;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(ABBE_SOURCE_DIR) / "scenes"))
        if (entry.path().extension() == ".scene") scenes.push_back(entry.path());
    REQUIRE(scenes.size() > 40);
    return scenes;
}

// Names of nodes that no word of the language is expected to stand for.
bool isPrivate(std::string_view name) { return name == "-" || name.starts_with("x-"); }

void requireKnown(const Analysis& analysis, schema::NodeRange nodes, const std::string& where) {
    for (const schema::Node node : nodes) {
        if (isPrivate(node.name())) continue;
        const Meaning* const m = analysis.meaningAt(node.nameSpan().begin);
        INFO(where << ": `" << std::string(node.name()) << "`");
        CHECK(m);
        if (m) CHECK((m->span == node.nameSpan() || m->span.begin == node.nameSpan().begin));
        const bool table = m && m->field && m->field->namedRows; // whose rows begin with words of their own
        if (!table) requireKnown(analysis, node.children(), where);
    }
}

TEST_CASE("every word that begins a node means something: in all examples of the tables and all shipped scenes") {
    for (const schema::TypeInfo& type : language().types.all()) {
        const std::string text = "scene 1\n" + std::string(type.example) + "\n";
        const Analysis analysis(language(), "/nowhere/a.scene", text);
        requireKnown(analysis, analysis.document().roots(), text);
        for (const schema::FieldInfo& field : type.fields) {
            if (schema::keyword(type.kind) == "instances") continue;
            const std::string block = "scene 1\n" + std::string(keyword(type.kind)) + " a " + std::string(type.name) +
                                      " { " + std::string(field.example) + " }\n";
            const Analysis inBlock(language(), "/nowhere/a.scene", block);
            requireKnown(inBlock, inBlock.document().roots(), block);
        }
    }
    for (const fs::path& path : shippedScenes()) {
        const Analysis analysis(language(), path, fileText(path));
        requireKnown(analysis, analysis.document().roots(), path.string());
    }
}

TEST_CASE("every property of every type is offered in its block, and explained") {
    for (const schema::TypeInfo& type : language().types.all()) {
        const std::string head = "scene 1\n" + std::string(keyword(type.kind)) + " " + std::string(type.name) + " { ";
        const std::string text = head + " }\n", uri = "file:///nowhere/a.scene";
        const Analysis analysis(language(), "/nowhere/a.scene", text);
        if (type.fields.empty() || keyword(type.kind) == "instances") continue;
        const TextLines lines(text);
        const Json items = completion({uri, analysis, lines, Encoding::utf8}, head.size(), false)["items"];
        for (const schema::FieldInfo& field : type.fields) {
            const auto found =
                std::ranges::find_if(items, [&](const Json& item) { return item["label"] == field.name; });
            INFO(text << std::string(field.name));
            REQUIRE(found != items.end());
            CHECK((*found)["documentation"]["value"].get<std::string>().find(field.doc) != std::string::npos);
        }
    }
}

TEST_CASE("names of definitions are found wherever they are used") {
    const Analysis analysis(language(), "/nowhere/a.scene", R"(scene 1
param which gold
material gold conductor
material horn diffuse
medium fog homogeneous { phase henyey-greenstein g=0.5 }
texture grain noise
spectrum red 0.5
shape hill plane
camera main { focus on=hill }
shape quad { material $which; interior fog }
shape sphere { material mix { first gold; second diffuse { reflectance red } } }
shape subdivision "a.obj" { material horn group=horns; material gold; dicing 1 px camera=main }
material coat openpbr { base-color grain; specular-roughness grain }
object seat { shape sphere { material gold } }
instances seat { scatter 5; over hill }
instance seat
phase forward henyey-greenstein
medium smoke homogeneous { phase mix { part forward weight=0.5; part isotropic } }
atmosphere fog
)");
    const auto uses = [&](std::string_view word, std::size_t from) {
        const Meaning* const m = meaningOf(analysis, word, from);
        REQUIRE(m);
        return analysis.occurrences(*m).size();
    };
    const auto at = [&](std::string_view text) { return analysis.text().find(text); };
    CHECK(uses("gold", at("gold conductor")) == 5); // with that in the parameter
    CHECK(uses("horn", at("horn diffuse")) == 2);
    CHECK(uses("fog", at("fog homogeneous")) == 3);
    CHECK(uses("grain", at("grain noise")) == 3);
    CHECK(uses("red", at("red 0.5")) == 2);
    CHECK(uses("hill", at("hill plane")) == 3);
    CHECK(uses("main", at("main {")) == 2);
    CHECK(uses("seat", at("seat {")) == 3);
    CHECK(uses("which", at("which gold")) == 2);
    CHECK(uses("forward", at("forward henyey")) == 2);
    REQUIRE(meaningOf(analysis, "diffuse { reflectance red"));
    CHECK(meaningOf(analysis, "g=0.5")->sense == Sense::property);
    CHECK(meaningOf(analysis, "diffuse { reflectance red")->sense == Sense::type);
}

// Every place of a text is asked about; nothing throws, whatever the text.
void askEverywhere(const std::string& text) {
    const std::string uri = "file:///nowhere/a.scene";
    const Analysis analysis(language(), "/nowhere/a.scene", text);
    const TextLines lines(text);
    const View view{uri, analysis, lines, Encoding::utf16};
    for (std::size_t at = 0; at <= text.size(); ++at) {
        CHECK(completion(view, at, false).contains("items"));
        hover(view, at, {});
        definitionOf(view, at);
    }
    symbols(view);
    foldings(view);
    semanticTokens(view);
}

TEST_CASE("a scene can be asked about at every place, cut off anywhere") {
    const std::string text = fileText(fs::path(ABBE_SOURCE_DIR) / "scenes/gold-ring/gold-ring.scene");
    for (std::size_t length = 0; length < text.size(); length += 41) askEverywhere(text.substr(0, length));
}

} // namespace
} // namespace abbe::lsp::test
