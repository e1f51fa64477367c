// The language described from its tables: what a field takes, `abbe explain`, and data for editors. docs/reference.
#pragma once

#include "schema/type.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::schema {

class Document;

struct Explanation {
    bool found = false; // false: `text` says what may have been meant
    std::string text;   // lines, each with its end
};

// Explains `camera`, `light.quad`, `camera.lens`, `light.quad.power`, `dielectric`, `lens`, `scene`, `transform`,
// `spectrum`, `blackbody`, `units`, `unit nits`, `nits`, a code such as `E0310`, `codes` (the whole page of them),
// `presets`, `preset gold`, `gold`, or `library` (the page of presets).
Explanation explain(const TypeTable&, std::string_view query);

// For who knows nothing yet: a whole scene, the kinds, and what else can be asked for.
std::string explainLanguage(const TypeTable&);

// What explain() can be asked for, without units and codes: "camera", "camera.perspective", "camera.lens", "gold".
// Sorted; for completion in shells.
std::vector<std::string> explainableWords(const TypeTable&);

// Every diagnostic code with its explanation, as Markdown: docs/language/diagnostics.md.
std::string diagnosticsMarkdown();

// Everything that a scene can say, as JSON for editors and exporters: kinds, types, properties, words, spectra, units,
// the names of data and presets, diagnostics (docs/editors.md).
std::string schemaJson(const TypeTable&);

// A TextMate grammar, by which editors colour scene files.
std::string textMateGrammar(const TypeTable&);

// One line per field with name, type, units, default and range: compared with a golden file, so that every change of
// the language is seen.
std::string schemaListing(const TypeTable&);

// "a length", "three numbers", "a spectrum from 0 to 1", "one of `a` and `b`": what a field takes.
std::string describeField(const FieldInfo&);
// "a spectrum from 0 to 1".
std::string_view describe(SpectrumRole);

// "between 0 and 1", in the unit a reader expects; empty without bounds.
std::string describeRange(const FieldInfo&);

// The units that may follow a field's numbers; none for plain numbers.
std::vector<std::string_view> unitsOf(const FieldInfo&);
// What a number without a unit means: "deg", "the header's length".
std::string_view meaningWithoutUnit(Dimension);

// The spelling of a unit that is offered first for its dimension and scale, which `abbe fmt` writes: "nits" for
// "cd-per-m2", "um" for "µm", "stops" for "EV". Empty for what is no unit.
std::string_view canonicalUnit(std::string_view unit);

// The text of a document, its units behind numbers in that spelling; nothing else changes, no number in particular. A
// word that some definition has for a name is left as it is, as it may be meant.
std::string withCanonicalUnits(std::string_view text, const Document&);

// docs/reference/: the language as pages of Markdown, made from the field tables alone. `abbe reference pages DIR`
// writes them, and a test says when those in the repository are not what the tables say.

struct ReferencePage {
    std::string file; // "camera.md"
    std::string text;
};

// README.md, a page for each kind, scene.md and units.md. The table should have its presets.
std::vector<ReferencePage> referencePages(const TypeTable&);

// What the field tables do not say: what each kind is for, and the words of the language that are neither kind, type
// nor property. For `abbe explain` and the reference.

struct KindText {
    Kind kind;
    std::string_view doc;     // what it is for, whole sentences
    std::string_view head;    // how a definition begins: "light [NAME] TYPE { … }"
    std::string_view example; // whole definitions that parse
};
const KindText& kindText(Kind);

// A key of the header, a step of a transform.
struct WordPart {
    std::string_view name;
    std::string_view takes;
    std::string_view defaultText; // empty: none
    std::string_view doc;
    std::string_view example;
};

struct LanguageWord {
    std::string_view name;
    std::string_view doc;
    std::string_view example; // whole definitions or lines of a file that parse
    std::vector<WordPart> parts;
};
// `scene`, `param`, `transform`, `at`.
std::span<const LanguageWord> languageWords();

// A whole scene that shows something, for who sees the language for the first time.
std::string_view firstScene();

} // namespace abbe::schema
