// The grammar that editors colour scene files by. Kinds, types, properties, units and words come from the tables, so a
// misspelt property has no colour.
#include "base/text.h"
#include "schema/describe.h"
#include "schema/spectrum_reader.h"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace abbe::schema {

namespace {

// In an order that stays the same.
using WordList = std::set<std::string_view>;

// What ends a word, and where a node begins; in the regular expressions of Oniguruma.
constexpr std::string_view kWordStops = R"((?=[\s;{}()=]|$))";
constexpr std::string_view kNodeBegin = R"((?:^|(?<=[;{}]))\s*)";
constexpr std::string_view kNumberPattern = R"([+-]?\d[\d_]*(?:\.\d[\d_]*)?(?:[eE][+-]?\d[\d_]*)?)";
constexpr std::string_view kNamePattern = R"([A-Za-z_][\w.:-]*)";

std::string anyWordOf(const WordList& words) {
    std::string text;
    for (const std::string_view word : words) {
        if (!text.empty()) text += '|';
        for (const char c : word) text += c == '.' || c == '+' ? fmt::format("\\{}", c) : std::string(1, c);
    }
    return "(?:" + text + ")";
}

void addFieldWords(const std::vector<FieldInfo>& fields, WordList& names, WordList& words) {
    for (const FieldInfo& field : fields) {
        names.insert(field.name);
        words.insert(field.choices.begin(), field.choices.end());
        for (const FieldKey& key : field.keys) words.insert(key.choices.begin(), key.choices.end());
        addFieldWords(field.block, names, words);
    }
}

struct Vocabulary {
    WordList kinds, types, properties, words{"on", "off"}, units, forms;

    explicit Vocabulary(const TypeTable& table) {
        for (int i = 0; i <= static_cast<int>(Kind::render); ++i) kinds.insert(keyword(static_cast<Kind>(i)));
        for (const TypeInfo& type : table.all()) {
            types.insert(type.name);
            addFieldWords(type.fields, properties, words);
        }
        for (const LanguageWord& word : languageWords())
            if (word.name == "transform")
                for (const WordPart& part : word.parts) properties.insert(part.name);
        for (const std::string_view word : {"transform", "at", "n", "k"}) properties.insert(word);
        for (int i = 1; i <= static_cast<int>(Dimension::pixels); ++i) {
            const auto spelt = spellings(static_cast<Dimension>(i));
            units.insert(spelt.begin(), spelt.end());
        }
        for (const SpectrumForm& form : spectrumForms()) forms.insert(form.name);
        for (const std::string_view kind : kinds) properties.erase(kind);
        for (const std::string_view type : types) words.erase(type);
    }
};

// A rule of one expression, whose groups have these names; group 0 is the whole match.
std::string grammarRule(const std::string& match, std::initializer_list<std::pair<int, std::string_view>> captures) {
    std::string text;
    for (const auto& [group, name] : captures)
        text += fmt::format(R"({}"{}": {{"name": "{}.abbe-scene"}})", text.empty() ? "" : ", ", group, name);
    return fmt::format("{{\"match\": {}, \"captures\": {{{}}}}}", jsonText(match), text);
}

std::string grammarSpan(std::string_view name, std::string_view begin, std::string_view end, std::string_view inside) {
    return fmt::format(R"({{"name": "{}.abbe-scene", "begin": {}, "end": {}, "patterns": [{}]}})", name,
                       jsonText(begin), jsonText(end), inside);
}

std::string grammarComments() {
    return grammarRule(R"(//.*$)", {{0, "comment.line.double-slash"}}) + ",\n    " +
           grammarSpan("comment.block", R"(/\*)", R"(\*/)", R"({"include": "#block-comment"})") + ",\n    " +
           grammarRule(R"(/-)", {{0, "keyword.operator.disabled"}});
}

std::string grammarStrings() {
    const std::string escape =
        grammarRule(R"(\\(?:[nrt"\\bfs\s]|u\{[0-9A-Fa-f]{1,6}\}))", {{0, "constant.character.escape"}}) + ", " +
        grammarRule(R"(\\.)", {{0, "invalid.illegal.escape"}});
    return grammarSpan("string.quoted.raw", R"x((#+)")x", R"("\1)", "") + ",\n    " +
           grammarSpan("string.quoted.triple", R"(""")", R"(""")", escape) + ",\n    " +
           grammarSpan("string.quoted.double", R"(")", R"("|$)", escape);
}

std::string grammarNodes(const Vocabulary& v) {
    const std::string notType = fmt::format("(?!{}{})", anyWordOf(v.types), kWordStops);
    return grammarRule(fmt::format("{}(scene){}", kNodeBegin, kWordStops), {{1, "keyword.control"}}) + ",\n    " +
           grammarRule(fmt::format("{}(param)\\s+({})", kNodeBegin, kNamePattern),
                       {{1, "keyword.control"}, {2, "variable.parameter"}}) +
           ",\n    " +
           grammarRule(fmt::format("{}({})(?:\\s+{}({}))?{}", kNodeBegin, anyWordOf(v.kinds), notType, kNamePattern,
                                   kWordStops),
                       {{1, "storage.type"}, {2, "entity.name"}}) +
           ",\n    " +
           grammarRule(fmt::format("{}({}){}", kNodeBegin, anyWordOf(v.properties), kWordStops),
                       {{1, "support.type.property-name"}}) +
           ",\n    " + grammarRule(fmt::format("{}(-)(?=\\s)", kNodeBegin), {{1, "punctuation.definition.list"}});
}

// Behind the first word of a node.
std::string grammarValues(const Vocabulary& v) {
    constexpr std::string_view kBefore = R"((?<=[\s=]))";
    const auto word = [&](const WordList& words, std::string_view name) {
        return grammarRule(fmt::format("{}{}{}", kBefore, anyWordOf(words), kWordStops), {{0, name}}) + ",\n    ";
    };
    return grammarRule(R"(\$[^\s;{}()="\\/]+)", {{0, "variable.parameter"}}) + ",\n    " +
           grammarRule(fmt::format("({})(=)", kNamePattern),
                       {{1, "entity.other.attribute-name"}, {2, "keyword.operator.assignment"}}) +
           ",\n    " +
           grammarRule(R"(#(?:true|false|null|-?inf|nan))" + std::string(kWordStops), {{0, "constant.language"}}) +
           ",\n    " +
           grammarRule(fmt::format(R"({}(0x[\dA-Fa-f_]+|0o[0-7_]+|0b[01_]+|{})(?:[ \t]+({}))?{})", kBefore,
                                   kNumberPattern, anyWordOf(v.units), kWordStops),
                       {{1, "constant.numeric"}, {2, "keyword.other.unit"}}) +
           ",\n    " +
           grammarRule(fmt::format(R"((?<=")[ \t]+({}){})", anyWordOf(v.units), kWordStops),
                       {{1, "keyword.other.unit"}}) +
           ",\n    " + word(v.types, "entity.name.type") + word(v.forms, "support.function") +
           word(v.units, "keyword.other.unit") +
           grammarRule(fmt::format("{}{}{}", kBefore, anyWordOf(v.words), kWordStops), {{0, "support.constant"}});
}

} // namespace

std::string textMateGrammar(const TypeTable& table) {
    const Vocabulary v(table);
    return fmt::format(R"({{
  "$schema": "https://raw.githubusercontent.com/martinring/tmlanguage/master/tmlanguage.json",
  "information_for_contributors": ["Made by `abbe reference textmate`: change the tables of the program instead."],
  "name": "Abbe scene",
  "scopeName": "source.abbe-scene",
  "fileTypes": ["scene"],
  "patterns": [
    {},
    {},
    {},
    {}
  ],
  "repository": {{
    "block-comment": {}
  }}
}}
)",
                       grammarComments(), grammarStrings(), grammarNodes(v), grammarValues(v),
                       grammarSpan("comment.block", R"(/\*)", R"(\*/)", R"({"include": "#block-comment"})"));
}

} // namespace abbe::schema
