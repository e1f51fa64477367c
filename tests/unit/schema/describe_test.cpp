#include "schema/describe.h"
#include "schema/scene_tree.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <fstream>
#include <iterator>

using namespace abbe;
using namespace abbe::schema;

namespace {

struct Lens {
    double lens = 0;
    std::optional<double> fov;
    Choice filter;
};

TypeTable table() {
    TypeTable types;
    types.add({Kind::camera,
               "perspective",
               "A camera.",
               "camera { lens 50 mm }",
               true,
               {field(FieldType::quantity, "lens", &Lens::lens)
                    .doc("Focal length.")
                    .example("lens 50 mm")
                    .byDefault("50 mm")
                    .unit({Dimension::length})
                    .range(0.0001, 10)
                    .synonyms({"focal-length"}),
                field(FieldType::quantity, "fov", &Lens::fov)
                    .doc("Full angle | horizontal.")
                    .unit({Dimension::angle})
                    .range(kPiD / 180, kPiD)
                    .group("field of view"),
                field(FieldType::choice, "filter", &Lens::filter)
                    .doc("Says \"which\".")
                    .choices({"box", "tent"})
                    .required()}});
    return types;
}

bool has(const std::string& text, std::string_view part) { return text.find(part) != std::string::npos; }

} // namespace

TEST_CASE("explanations by kind, type, property, unit, form and code") {
    const TypeTable types = table();
    for (const char* query :
         {"camera", "perspective", "camera.perspective", "camera.lens", "camera.perspective.lens", "perspective.lens",
          "lens", "units", "unit nits", "nits", "spectrum", "blackbody", "E0310", "W0201", "instance"}) {
        CAPTURE(query);
        CHECK(explain(types, query).found);
    }
    const std::string lens = explain(types, "camera.lens").text;
    CHECK(has(lens, "Focal length."));
    CHECK(has(lens, "50 mm"));
    CHECK(has(lens, "between 0.0001 and 10 m"));
    CHECK(has(lens, "`focal-length`"));
    CHECK(has(explain(types, "camera.fov").text, "between 1 and 180 deg"));
    CHECK(has(explain(types, "camera.filter").text, "`box` or `tent`"));
    CHECK(has(explain(types, "unit klx").text, "1000 lx"));
}

TEST_CASE("a kind is explained with the properties of its plain type") {
    const std::string camera = explain(table(), "camera").text;
    CHECK(has(camera, "camera [NAME] [TYPE] { … }"));
    CHECK(has(camera, "Focal length. [50 mm]"));
    CHECK(has(camera, "*filter"));
    CHECK(has(explain(table(), "transform").text, "rotate"));
    CHECK(has(explain(table(), "rotate").text, "rotate y 45 deg"));
    CHECK(has(explain(table(), "length").text, "scene 1 length=cm"));
    CHECK(has(explain(table(), "param").text, "$NAME"));
}

TEST_CASE("types that share a property are told together") {
    const TypeTable types = table();
    TypeInfo other = types.all()[0];
    other.name = "spherical";
    other.isDefault = false;
    TypeTable two;
    two.add(types.all()[0]);
    two.add(other);
    const std::string lens = explain(two, "lens").text;
    CHECK(has(lens, "camera perspective, camera spherical: lens"));
    CHECK(lens.find("Focal length.") == lens.rfind("Focal length."));
}

TEST_CASE("the language is introduced by a whole scene and its kinds") {
    const std::string text = explainLanguage(table());
    CHECK(has(text, "scene 1\n"));
    CHECK(has(text, "  film        The picture: its size, its layers and its file\n"));
    const auto words = explainableWords(table());
    for (const char* word : {"camera", "camera.lens", "camera.perspective", "blackbody", "transform", "units"})
        CHECK(std::ranges::find(words, word) != words.end());
    for (const std::string& word : words) {
        CAPTURE(word);
        CHECK((word == "presets" || word == "library" || explain(table(), word).found)); // those come with the program
    }
}

TEST_CASE("explanations of unknown words suggest near ones") {
    const TypeTable types = table();
    CHECK(!explain(types, "camera.lense").found);
    CHECK(has(explain(types, "camera.lense").text, "did you mean `camera.lens`?"));
    CHECK(has(explain(types, "focal-length").text, "did you mean `camera.lens`?"));
    CHECK(has(explain(types, "blackbodi").text, "did you mean `blackbody`?"));
    CHECK(!explain(types, "").found);
    CHECK(!explain(types, ".").found);
    CHECK(!explain(types, "unit").found);
    CHECK(!explain(types, "a.b.c.d").found);
}

TEST_CASE("the listing has a line for every field") {
    CHECK(schemaListing(table()) == "camera perspective default\n"
                                    "camera perspective lens quantity [length] default=\"50 mm\" min=0.0001 max=10\n"
                                    "camera perspective fov quantity [angle] min=0.017453292519943295 "
                                    "max=3.141592653589793 group=\"field of view\"\n"
                                    "camera perspective filter choice |box |tent required\n");
}

TEST_CASE("Markdown and JSON are escaped") {
    const auto pages = referencePages(table());
    const auto camera = std::ranges::find(pages, "camera.md", &ReferencePage::file);
    REQUIRE(camera != pages.end());
    CHECK(has(camera->text, "Full angle \\| horizontal."));
    const std::string json = schemaJson(table());
    CHECK(has(json, R"("doc":"Says \"which\".")"));
    CHECK(has(json, R"("default":"50 mm")"));
    int depth = 0, lowest = 0;
    bool inString = false;
    for (std::size_t i = 0; i < json.size(); ++i) {
        if (json[i] == '"' && json[i - 1] != '\\') inString = !inString;
        if (inString) continue;
        depth += json[i] == '{' || json[i] == '[' ? 1 : json[i] == '}' || json[i] == ']' ? -1 : 0;
        lowest = std::min(lowest, depth);
    }
    CHECK(depth == 0);
    CHECK(lowest == 0);
    CHECK(!inString);
}

TEST_CASE("every code of resolving and binding is explained") {
    for (const char* code : {"E0201", "E0202", "E0203", "E0205", "E0206", "E0207", "E0208", "E0209", "E0210", "E0211",
                             "E0212", "E0213", "E0214", "E0215", "W0201", "W0202", "E0301", "E0302", "E0303", "E0304",
                             "E0305", "E0306", "E0307", "E0308", "E0309", "E0310", "E0311", "E0312", "E0313", "E0314",
                             "E0315", "E0401", "E0402", "E0501", "E0502", "E0503", "W0501"}) {
        CAPTURE(code);
        CHECK(explain(TypeTable{}, code).found);
    }
}

TEST_CASE("the page of diagnostics is up to date (abbe explain codes > docs/language/diagnostics.md)") {
    std::ifstream file(ABBE_SOURCE_DIR "/docs/language/diagnostics.md");
    const std::string page{std::istreambuf_iterator<char>(file), {}};
    CHECK(page == diagnosticsMarkdown());
}
