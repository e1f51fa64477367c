#include "app/identity.h"
#include "binding/bindings.h"
#include "commands/program.h"
#include "parser/parse.h"
#include "parser/presets.h"
#include "scene/registry.h"
#include "schema/describe.h"
#include "schema/scene_tree.h"
#include "schema/suggest.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <optional>
#include <string>
#include <vector>

namespace abbe::python {

namespace nb = nanobind;

namespace {

// Types and presets, made once.
const schema::TypeTable& typeTable() {
    static const auto made = [] {
        struct Made {
            SourceMap sources; // that the presets' texts are in
            schema::TypeTable types;
        };
        static Made all;
        Diagnostics none;
        all.types = makeTypeTable();
        addPresets(all.types, all.sources, none);
        return &all.types;
    }();
    return *made;
}

std::string suggestProperty(const std::string& kind, const std::string& type, const std::string& word) {
    const auto found = schema::findKind(kind);
    const schema::TypeInfo* const info = found ? typeTable().find(*found, type) : nullptr;
    const schema::FieldInfo* const field = info ? schema::suggestField(*info, word) : nullptr;
    return field ? std::string(field->name) : std::string();
}

std::string suggestWord(const std::string& word, const std::vector<std::string>& candidates) {
    const std::vector<std::string_view> views(candidates.begin(), candidates.end());
    return std::string(schema::nearest(word, views));
}

// As `abbe fmt` has it. Throws where the text has errors, whose first one it names.
std::string layOutText(const std::string& text) {
    SourceMap sources;
    Diagnostics diagnostics;
    const FileId file = sources.add("<scene>", text);
    parse(sources, file, {}, diagnostics);
    for (const Diagnostic& d : diagnostics.all())
        if (d.severity == Severity::error) throw nb::value_error((d.code + ": " + d.message).c_str());
    return formatted(text);
}

bool sameScene(const std::string& a, const std::string& b) {
    SourceMap sources;
    Diagnostics diagnostics;
    const auto first = parse(sources, sources.add("a", a), {}, diagnostics);
    const auto second = parse(sources, sources.add("b", b), {}, diagnostics);
    return !diagnostics.hasErrors() && sameMeaning(*first, *second);
}

} // namespace

void bindLanguage(nb::module_& m) {
    m.def("schema_json", [] { return schema::schemaJson(typeTable()); });
    m.def("explain", [](const std::string& word) -> std::optional<std::string> {
        const schema::Explanation explanation = schema::explain(typeTable(), word);
        return explanation.found ? std::optional(explanation.text) : std::nullopt;
    });
    m.def("suggest_property", &suggestProperty);
    m.def("suggest_word", &suggestWord);
    m.def("lay_out", &layOutText);
    m.def("same_scene", &sameScene);
    m.def("version", [] { return std::string(versionNumber()); });
    m.def("run_program", [](const std::vector<std::string>& words) {
        std::vector<const char*> views;
        views.reserve(words.size());
        for (const std::string& word : words) views.push_back(word.c_str());
        const nb::gil_scoped_release free;
        return runProgram(views);
    });
}

} // namespace abbe::python
