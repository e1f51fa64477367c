#include "schema/suggest.h"

#include "schema/scene_tree.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

constexpr std::size_t kLongestWord = 64; // nobody mistypes longer ones by a third; bounds the work on hostile input

char lower(char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c; }

bool equalIgnoringCase(std::string_view a, std::string_view b) {
    return std::ranges::equal(a, b, [](char x, char y) { return lower(x) == lower(y); });
}

std::size_t editLimit(std::string_view word) { return word.size() < 2 ? 0 : std::max<std::size_t>(1, word.size() / 3); }

// Names that other renderers give to our kinds.
constexpr auto kKindSynonyms = std::to_array<std::pair<std::string_view, Kind>>({
    {"bsdf", Kind::material},
    {"bxdf", Kind::material},
    {"shader", Kind::material},
    {"emitter", Kind::light},
    {"lamp", Kind::light},
    {"lightsource", Kind::light},
    {"sensor", Kind::camera},
    {"geometry", Kind::shape},
    {"primitive", Kind::shape},
    {"integrator", Kind::render},
    {"sampler", Kind::render},
    {"renderer", Kind::render},
    {"options", Kind::render},
    {"output", Kind::film},
    {"image", Kind::film},
    {"color", Kind::spectrum},
    {"colour", Kind::spectrum},
});

constexpr auto kUnitSynonyms = std::to_array<std::pair<std::string_view, std::string_view>>({
    {"meter", "m"},       {"meters", "m"},        {"metre", "m"},   {"metres", "m"},    {"inch", "in"},
    {"inches", "in"},     {"feet", "ft"},         {"foot", "ft"},   {"micron", "um"},   {"microns", "um"},
    {"degree", "deg"},    {"degrees", "deg"},     {"°", "deg"},     {"radian", "rad"},  {"radians", "rad"},
    {"turns", "turn"},    {"sec", "s"},           {"second", "s"},  {"seconds", "s"},   {"minute", "min"},
    {"minutes", "min"},   {"hour", "h"},          {"hours", "h"},   {"kelvin", "K"},    {"watt", "W"},
    {"watts", "W"},       {"lumen", "lm"},        {"lumens", "lm"}, {"candela", "cd"},  {"lux", "lx"},
    {"nit", "nits"},      {"stop", "stops"},      {"percent", "%"}, {"pixel", "px"},    {"pixels", "px"},
    {"W/m2", "W-per-m2"}, {"cd/m2", "cd-per-m2"}, {"1/m", "per-m"}, {"1/cm", "per-cm"}, {"1/mm", "per-mm"},
});

} // namespace

std::size_t editDistance(std::string_view a, std::string_view b) {
    std::vector<std::size_t> before(b.size() + 1), previous(b.size() + 1), current(b.size() + 1);
    for (std::size_t j = 0; j <= b.size(); ++j) previous[j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i) {
        current[0] = i;
        for (std::size_t j = 1; j <= b.size(); ++j) {
            const bool same = lower(a[i - 1]) == lower(b[j - 1]);
            current[j] = std::min({previous[j] + 1, current[j - 1] + 1, previous[j - 1] + (same ? 0 : 1)});
            const bool swapped =
                i > 1 && j > 1 && lower(a[i - 1]) == lower(b[j - 2]) && lower(a[i - 2]) == lower(b[j - 1]);
            if (swapped) current[j] = std::min(current[j], before[j - 2] + 1);
        }
        std::swap(before, previous);
        std::swap(previous, current);
    }
    return previous[b.size()];
}

std::string_view nearest(std::string_view word, const std::vector<std::string_view>& candidates) {
    if (word.size() > kLongestWord) return {};
    std::string_view best;
    std::size_t bestDistance = editLimit(word) + 1;
    for (const std::string_view candidate : candidates) {
        const std::size_t difference =
            candidate.size() > word.size() ? candidate.size() - word.size() : word.size() - candidate.size();
        if (difference >= bestDistance) continue;
        const std::size_t distance = editDistance(word, candidate);
        // A candidate that shares no letter is a coincidence of two short words.
        if (distance >= bestDistance || distance >= std::max(word.size(), candidate.size())) continue;
        best = candidate;
        bestDistance = distance;
    }
    return best;
}

const FieldInfo* suggestField(const TypeInfo& type, std::string_view word) {
    std::vector<std::string_view> names, synonyms;
    for (const FieldInfo& field : type.fields) {
        names.push_back(field.name);
        for (const std::string_view synonym : field.synonyms) {
            if (equalIgnoringCase(synonym, word)) return &field;
            synonyms.push_back(synonym);
        }
    }
    if (const std::string_view name = nearest(word, names); !name.empty()) return type.find(name);
    const std::string_view synonym = nearest(word, synonyms);
    if (synonym.empty()) return nullptr;
    for (const FieldInfo& field : type.fields)
        if (std::ranges::find(field.synonyms, synonym) != field.synonyms.end()) return &field;
    return nullptr;
}

std::optional<Kind> suggestKind(std::string_view word) {
    for (const auto& [synonym, kind] : kKindSynonyms)
        if (equalIgnoringCase(synonym, word)) return kind;
    std::vector<std::string_view> names;
    for (int i = 0; i <= static_cast<int>(Kind::render); ++i) names.push_back(keyword(static_cast<Kind>(i)));
    return findKind(nearest(word, names));
}

std::string_view suggestUnit(std::string_view word, std::span<const Dimension> dimensions) {
    for (const auto& [synonym, unit] : kUnitSynonyms)
        if (equalIgnoringCase(synonym, word)) return unit;
    std::vector<std::string_view> fitting;
    for (const Dimension d : dimensions) fitting.insert(fitting.end(), spellings(d).begin(), spellings(d).end());
    return nearest(word, fitting);
}

std::string quotedList(std::span<const std::string_view> words, std::string_view link) {
    constexpr std::size_t kMost = 24;
    const std::size_t shown = std::min(words.size(), kMost);
    std::string text;
    for (std::size_t i = 0; i < shown; ++i) {
        const bool last = i + 1 == words.size();
        if (i > 0) text += last ? fmt::format(" {} ", link) : ", ";
        text += fmt::format("`{}`", words[i]);
    }
    return shown < words.size() ? text + ", …" : text;
}

std::string didYouMean(std::string_view word) {
    return word.empty() ? std::string() : fmt::format("did you mean `{}`?", word);
}

std::vector<std::string_view> typeNames(const TypeTable& table, Kind kind) {
    std::vector<std::string_view> names;
    for (const TypeInfo* type : table.of(kind)) names.push_back(type->name);
    return names;
}

std::string fieldHint(const FieldInfo& field) {
    std::string_view doc = field.doc.substr(0, field.doc.find_first_of(".;:"));
    std::string text(doc);
    // "Focal length" reads better in lower case; "IOR" and "GGX" do not.
    if (text.size() > 1 && !std::isupper(static_cast<unsigned char>(text[1]))) text[0] = lower(text[0]);
    std::string_view example = field.example;
    if (example.starts_with(field.name)) example.remove_prefix(std::min(example.size(), field.name.size() + 1));
    if (text.empty()) return fmt::format("`{}`", field.name);
    return example.empty() ? fmt::format("`{}` ({})", field.name, text)
                           : fmt::format("`{}` ({}, e.g. `{}`)", field.name, text, example);
}

} // namespace abbe::schema
