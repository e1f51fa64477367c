// What the field tables do not say: what each kind is for, and the words of the language that are neither kind, type
// nor property. For `abbe explain` and the reference.
#pragma once

#include "schema/type.h"

#include <span>
#include <string_view>
#include <vector>

namespace abbe::schema {

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
