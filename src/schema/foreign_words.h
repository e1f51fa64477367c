// What words of other programs come to in ours. Only where that is certain may a word be replaced without asking.
#pragma once

#include "schema/scene_tree.h"

#include <span>
#include <string>
#include <string_view>

namespace abbe::schema {

// Whether `word` is `meant` with at most one wrong, missing, additional or swapped letter, or written with other
// separators and capitals, `base_color` for `base-color`. Short words are not: too many lie near to each other.
bool isMisspelling(std::string_view word, std::string_view meant);

// A property that a type does not have, as a property `meant` that it has.
struct ForeignProperty {
    bool certain = false; // the name alone can be replaced, and the value stays
    std::string help;     // "`alpha 0.1` is `roughness 0.316`: …"; empty if nothing is known but the name
};
ForeignProperty translate(const TypeInfo&, const FieldInfo& meant, const Node& written);

// What to do about a property that no property here stands for, a switch of shadows for example; empty if unknown.
std::string adviceFor(const TypeInfo&, std::string_view word);

// What a scene has in place of a loop or a condition, `for` for example; empty for other words.
std::string adviceForControl(std::string_view word);

// A type of another program, as one of ours: "principled" -> openpbr. Nothing is certain about its properties.
std::string_view foreignType(const TypeTable&, Kind, std::string_view word);

// What people who know other programs ask `abbe explain` for: "area light", "sky texture", "clamping". Unlike the words
// above these stand in no scene.
struct ForeignTerm {
    std::string_view term;  // small letters, words apart by one space: "area light"
    std::string_view where; // "Blender, Arnold"
    std::string_view here;  // what it is here, one or two sentences
    std::string_view topic; // that explain() knows best about it: "light.quad"; empty: none
};

// All of them, by their letters.
std::span<const ForeignTerm> foreignTerms();
// Capitals and the separators between words do not matter, nor whether the word "node", "shader" or "bsdf" stands
// behind it. Null if there is none.
const ForeignTerm* findForeignTerm(std::string_view words);

} // namespace abbe::schema
