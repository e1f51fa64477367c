// What people who know other programs ask for: "area light", "sky texture", "clamping". Unlike the words of
// foreign_words.h these stand in no scene.
#pragma once

#include <span>
#include <string_view>

namespace abbe::schema {

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
