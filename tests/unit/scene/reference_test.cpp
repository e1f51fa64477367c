// docs/reference and what `abbe explain` shows: every property is described, every example is what the program accepts,
// and the pages in the repository are those that the tables make.
#include "scene_test_fixture.h"
#include "schema/describe.h"
#include "spectrum/curve.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <regex>
#include <set>
#include <sstream>
#include <unistd.h>

namespace abbe::test {

namespace {

using schema::FieldInfo;
using schema::Kind;
using schema::TypeInfo;
namespace fs = std::filesystem;

schema::TypeTable tableWithPresets(SourceMap& sources) {
    schema::TypeTable table = makeTypeTable();
    Diagnostics diagnostics;
    addPresets(table, sources, diagnostics);
    return table;
}

// Everything that an example may name is there.
class AgreeableResolver final : public schema::Resolver {
  public:
    const Curve* curve(const schema::SpectrumValue&, schema::SpectrumRole, Diagnostics&) override { return &one_; }
    schema::ComplexIndex metal(std::string_view, Span, Diagnostics&) override { return {&one_, &one_}; }
    schema::Reference reference(const schema::Definition&, Diagnostics&) override { return {0}; }
    const Texture* texture(const schema::TextureRequest&, Diagnostics&) override { return nullptr; }

  private:
    ConstantCurve one_{1};
};

// Values are checked and go nowhere.
void forget(FieldInfo& field) {
    static int nowhere;
    field.store = [](void*, const schema::BoundValue&) {};
    if (field.append) field.append = [](void*, double, Span) -> void* { return &nowhere; };
    for (FieldInfo& inner : field.block) forget(inner);
}

schema::TypeTable forgetfulTable() {
    const schema::TypeTable real = makeTypeTable();
    schema::TypeTable table;
    for (TypeInfo type : real.all()) {
        for (FieldInfo& field : type.fields) forget(field);
        table.add(std::move(type));
    }
    return table;
}

// What examples refer to by name.
constexpr std::string_view kNamed = R"(
material skin diffuse; material horn diffuse; material glass diffuse; material gold diffuse; material wood diffuse
texture pores checker; texture picture checker; texture grain checker
phase forward isotropic; phase haze isotropic; phase fog isotropic
medium fog homogeneous; medium haze homogeneous; medium milk homogeneous
shape hero sphere; shape ground quad; camera main
object pebble { shape sphere }
)";

// A folder in which there is every file that examples name. They are not read, only looked for.
class ExampleFolder {
  public:
    ExampleFolder() : path_(fs::temp_directory_path() / ("abbe-examples-" + std::to_string(::getpid()))) {
        fs::create_directories(path_);
    }
    ~ExampleFolder() { fs::remove_all(path_); }
    ExampleFolder(const ExampleFolder&) = delete;
    ExampleFolder& operator=(const ExampleFolder&) = delete;

    void addFilesOf(const std::string& text) const {
        static const std::regex name("\"([^\"]*\\.[a-z0-9]+)\"");
        for (std::sregex_iterator it(text.begin(), text.end(), name), end; it != end; ++it) {
            const std::string file = std::regex_replace((*it)[1].str(), std::regex("<UDIM>"), "1001");
            fs::create_directories((path_ / file).parent_path());
            std::ofstream(path_ / file) << "400 0.5\n700 0.5\n";
        }
    }
    const fs::path& path() const { return path_; }

  private:
    fs::path path_;
};

// What is wrong with the last definition of the text; empty if nothing is.
std::string faultsOf(const std::string& text, const ExampleFolder& folder) {
    static const schema::TypeTable table = forgetfulTable();
    folder.addFilesOf(text);
    SourceMap sources;
    Diagnostics diagnostics;
    const FileId file = sources.add("example", std::string("scene 1\n") + std::string(kNamed) + text);
    const auto document = parse(sources, file, {}, diagnostics);
    const auto tree = schema::resolve(document, table, folder.path(), diagnostics);
    AgreeableResolver resolver;
    int nowhere = 0;
    if (!tree.definitions.empty()) bind(tree.definitions.back(), tree, table, resolver, &nowhere, diagnostics);
    Diagnostics errors; // that much stays unused is no fault
    for (const Diagnostic& d : diagnostics.all())
        if (d.severity == Severity::error) errors.add(d);
    return formatShort(errors, sources);
}

// The example with what must be given besides: one property of each group.
std::string withRequired(const std::vector<FieldInfo>& fields, const FieldInfo& shown, const std::string& example) {
    std::string body = example;
    std::set<std::string_view> stated = {shown.group};
    for (const FieldInfo& field : fields)
        if (field.required && field.name != shown.name && (field.group.empty() || stated.insert(field.group).second))
            body += "; " + std::string(field.example);
    return body;
}

std::string definitionOf(const TypeInfo& type, const std::string& body) {
    const std::string kind(keyword(type.kind));
    if (type.kind == Kind::instances) return kind + " pebble { " + body + " }";
    return kind + (type.isDefault ? "" : " " + std::string(type.name)) + " { " + body + " }";
}

// The code in the cells below the heading `Abbe` of a page's tables.
std::vector<std::string> ourWords(const std::string& page) {
    std::vector<std::string> words;
    std::size_t column = 0;
    std::istringstream lines(page);
    for (std::string line; std::getline(lines, line);) {
        if (!line.starts_with('|')) column = 0;
        std::size_t at = 0;
        std::string cell;
        std::istringstream cells(line);
        for (; std::getline(cells, cell, '|'); ++at) {
            if (cell == " Abbe ") column = at;
            if (column == 0 || at != column) continue;
            for (std::size_t begin = 0; (begin = cell.find('`', begin)) != std::string::npos; ++begin) {
                const std::size_t end = cell.find('`', begin + 1);
                words.push_back(cell.substr(begin + 1, end - begin - 1));
                begin = end;
            }
        }
    }
    return words;
}

// Whether a word, or a word with its value, means something: a flag, a kind and its type, a type, or a property of one.
bool isOurs(const std::string& text, const schema::TypeTable& table, const ExampleFolder& folder) {
    const std::string word = text.substr(0, text.find(' '));
    const std::string rest = word.size() < text.size() ? text.substr(word.size() + 1) : "";
    if (word.starts_with("--") || word == "abbe" || word == "space=data") return true;
    if (const auto kind = schema::findKind(word); kind && !rest.empty())
        return table.find(*kind, rest.substr(0, rest.find(' '))) != nullptr;
    bool named = false;
    for (const TypeInfo& type : table.all()) {
        named = named || type.name == word;
        const FieldInfo* field = type.find(word);
        if (field &&
            (rest.empty() || faultsOf(definitionOf(type, withRequired(type.fields, *field, text)), folder) == ""))
            return true;
    }
    return rest.empty() && (named || explain(table, word).found);
}

std::string contentsOf(const fs::path& path) {
    std::ifstream file(path);
    return {std::istreambuf_iterator<char>(file), {}};
}

} // namespace

TEST_CASE("every property is described and has an example that the program accepts") {
    const ExampleFolder folder;
    const schema::TypeTable table = makeTypeTable();
    for (const TypeInfo& type : table.all())
        for (const FieldInfo& field : type.fields) {
            const std::string example(field.example);
            INFO(definitionOf(type, example));
            CHECK(field.doc.size() > 5);
            CHECK(field.doc.ends_with('.'));
            CHECK(example.starts_with(field.name));
            CHECK(faultsOf(definitionOf(type, withRequired(type.fields, field, example)), folder) == "");
            for (const FieldInfo& inner : field.block) {
                INFO(std::string(inner.name));
                CHECK(inner.doc.ends_with('.'));
                CHECK(std::string_view(inner.example).starts_with(inner.name));
                const std::string body = withRequired(field.block, inner, std::string(inner.example));
                const std::string outer = example.substr(0, example.find('{')) + " { " + body + " }";
                CHECK(faultsOf(definitionOf(type, withRequired(type.fields, field, outer)), folder) == "");
            }
        }
}

TEST_CASE("a wrong example is found") {
    const ExampleFolder folder;
    CHECK(faultsOf("camera { lens 50 mm }", folder) == "");
    CHECK(faultsOf("camera { lens 50 kg }", folder) != "");
    CHECK(faultsOf("shape box { size 1 2 }", folder) != "");
    CHECK(faultsOf("shape sphere { material nothing-of-that-name }", folder) != "");
}

TEST_CASE("the examples of kinds and words are sound") {
    std::set<std::string> codes;
    for (int i = 0; i <= static_cast<int>(Kind::render); ++i) {
        const auto& about = schema::kindText(static_cast<Kind>(i));
        CHECK(about.kind == static_cast<Kind>(i));
        CHECK(about.head.starts_with(keyword(about.kind)));
        const std::string eye = about.kind == Kind::camera ? "" : "camera { from 0 0 5; look-at 0 0 0 }\n";
        const auto scene = TestScene::parse("scene 1\n" + eye + kSky + std::string(about.example) + "\n");
        CHECK_MESSAGE(!scene.diagnostics().hasErrors(), scene.report());
    }
    for (const schema::LanguageWord& word : schema::languageWords()) {
        if (word.name == "include") continue; // of a file: tests/language/layers_test.cpp
        const bool header = word.name == "scene";
        const std::string first = header ? std::string(word.example) : "scene 1";
        const auto scene = TestScene::parse(first + "\ncamera { from 0 3 3; look-at 0 0 0 }\n" + kSky +
                                            "shape sphere\n" + (header ? "" : std::string(word.example)) + "\n");
        CHECK_MESSAGE(!scene.diagnostics().hasErrors(), scene.report());
    }
    const auto first = TestScene::parse(std::string(schema::firstScene()));
    CHECK(first.report() == "");
}

TEST_CASE("what pages for users of other renderers say of Abbe is understood") {
    const ExampleFolder folder;
    const schema::TypeTable table = makeTypeTable();
    std::size_t words = 0;
    for (const char* page : {"blender.md", "arnold.md", "pbrt.md", "mitsuba.md"}) {
        for (const std::string& text : ourWords(contentsOf(fs::path(ABBE_SOURCE_DIR) / "docs/coming_from" / page))) {
            ++words;
            CHECK_MESSAGE(isOurs(text, table, folder), page, ": ", text);
        }
    }
    CHECK(words > 300);
    CHECK_FALSE(isOurs("lense", table, folder));
    CHECK_FALSE(isOurs("lens 50 kg", table, folder));
    CHECK_FALSE(isOurs("light quod", table, folder));
}

TEST_CASE("docs/reference is what the tables say") {
    SourceMap sources;
    const auto pages = referencePages(tableWithPresets(sources));
    const fs::path folder = fs::path(ABBE_SOURCE_DIR) / "docs" / "reference";
    std::set<std::string> expected, there;
    for (const schema::ReferencePage& page : pages) {
        expected.insert(page.file);
        CHECK_MESSAGE(contentsOf(folder / page.file) == page.text, "docs/reference/", page.file,
                      " is out of date: `abbe reference pages docs/reference` writes it");
    }
    for (const auto& entry : fs::directory_iterator(folder)) there.insert(entry.path().filename().string());
    CHECK(there == expected);
}

} // namespace abbe::test
