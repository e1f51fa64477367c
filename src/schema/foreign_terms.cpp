#include "schema/foreign_words.h"

#include <algorithm>
#include <cctype>
#include <string>

namespace abbe::schema {

namespace {

// "AreaLight", "area_light" and "area-light" are "area light"; a last word that says only what kind of thing it is
// goes.
std::string normal(std::string_view words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const auto c = static_cast<unsigned char>(words[i]);
        if (std::isalnum(c))
            text += static_cast<char>(std::tolower(c));
        else if (!text.empty() && text.back() != ' ')
            text += ' ';
    }
    while (text.ends_with(' ')) text.pop_back();
    return text;
}

std::string squeezed(std::string_view words) {
    std::string text = normal(words);
    std::erase(text, ' ');
    return text;
}

const ForeignTerm* findSqueezed(const std::string& letters) {
    const auto terms = foreignTerms();
    const auto found = std::ranges::find_if(terms, [&](const ForeignTerm& t) { return squeezed(t.term) == letters; });
    return found == terms.end() ? nullptr : &*found;
}

} // namespace

const ForeignTerm* findForeignTerm(std::string_view words) {
    std::string letters = squeezed(words);
    if (const ForeignTerm* term = findSqueezed(letters)) return term;
    for (const std::string_view tail : {"node", "shader", "bsdf", "material", "light", "texture", "lamp", "s"})
        if (letters.ends_with(tail))
            if (const ForeignTerm* term = findSqueezed(letters.substr(0, letters.size() - tail.size()))) return term;
    return nullptr;
}

} // namespace abbe::schema
