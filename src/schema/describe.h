// The language described from its tables: `abbe explain`, the generated reference, and data for editors.
#pragma once

#include "schema/type.h"

#include <string>
#include <string_view>

namespace abbe::schema {

struct Explanation {
    bool found = false; // false: `text` says what may have been meant
    std::string text;   // lines, each with its end
};

// Explains `camera`, `light.quad`, `camera.lens`, `light.quad.power`, `dielectric`, `lens`, `spectrum`, `blackbody`,
// `units`, `unit nits`, `nits`, a code such as `E0310`, `codes` (the whole page of them), `presets`, `preset gold`,
// `gold`, or `library` (the page of presets).
Explanation explain(const TypeTable&, std::string_view query);

// The reference manual: every kind, type, property, spectrum form and unit, as Markdown.
std::string schemaMarkdown(const TypeTable&);

// Every diagnostic code with its explanation, as Markdown: docs/language/diagnostics.md.
std::string diagnosticsMarkdown();

// The same as schemaMarkdown as JSON, for editors and exporters.
std::string schemaJson(const TypeTable&);

// One line per field with name, type, units, default and range: compared with a golden file, so that every change of
// the language is seen.
std::string schemaListing(const TypeTable&);

// "a length", "three numbers", "a spectrum from 0 to 1", "one of `a` and `b`": what a field takes.
std::string describeField(const FieldInfo&);

// "between 0 and 1", in the unit a reader expects; empty without bounds.
std::string describeRange(const FieldInfo&);

} // namespace abbe::schema
