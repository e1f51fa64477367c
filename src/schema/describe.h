// The language described from its tables: what a field takes, `abbe explain`, and data for editors. The pages of
// docs/reference are made in schema/reference_pages.h.
#pragma once

#include "schema/type.h"

#include <string>
#include <string_view>
#include <vector>

namespace abbe::schema {

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

// Kinds, types, properties, spectra and units as JSON, for editors and exporters.
std::string schemaJson(const TypeTable&);

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

} // namespace abbe::schema
