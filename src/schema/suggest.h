// Words for messages: what may have been meant, and lists of choices.
#pragma once

#include "schema/type.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::schema {

// Edits (insert, delete, replace, swap of neighbours) from `a` to `b`, letter case ignored: the
// optimal-string-alignment form of the Damerau-Levenshtein distance.
std::size_t editDistance(std::string_view a, std::string_view b);

// The field that `word` probably means: another renderer's name for it, else the nearest name or synonym; or null.
const FieldInfo* suggestField(const TypeInfo&, std::string_view word);

// The kind that `word` probably means ("bsdf" -> material), or nothing.
std::optional<Kind> suggestKind(std::string_view word);

// The spelling of the unit that `word` probably means, among those of `dimensions` first; or empty.
std::string_view suggestUnit(std::string_view word, std::span<const Dimension> dimensions);

// "`a`, `b` and `c`" with the given last link; long lists end in "…".
std::string quotedList(std::span<const std::string_view> words, std::string_view link = "and");

// "did you mean `word`?", or empty for an empty word.
std::string didYouMean(std::string_view word);

// The names of all types of a kind, in the order of the table.
std::vector<std::string_view> typeNames(const TypeTable&, Kind);

// "lens (focal length, e.g. `50 mm`)": name, doc and example of a field for a suggestion.
std::string fieldHint(const FieldInfo&);

} // namespace abbe::schema
