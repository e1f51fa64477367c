#include "schema/definition_reader.h"

#include "schema/entry.h"
#include "schema/foreign_words.h"
#include "schema/layers.h"
#include "schema/preset_library.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

bool isPlacement(Kind kind) { return kind == Kind::instance || kind == Kind::instances || kind == Kind::atmosphere; }

bool isTyped(Kind kind) {
    return kind != Kind::group && kind != Kind::object && !isPlacement(kind) && kind != Kind::spectrum;
}

bool isLetter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

bool isBareName(std::string_view name) {
    const auto inside = [](char c) {
        return isLetter(c) || (c >= '0' && c <= '9') || c == '.' || c == ':' || c == '-';
    };
    return !name.empty() && isLetter(name[0]) && std::ranges::all_of(name, inside);
}

std::vector<Value> valuesFrom(const Node& node, std::size_t first) {
    std::vector<Value> values;
    for (std::size_t i = first; i < node.valueCount(); ++i) values.push_back(node.value(i));
    return values;
}

std::vector<Key> keysOf(const Node& node) { return {node.keys().begin(), node.keys().end()}; }

std::vector<Node> childrenOf(const Node& node) {
    std::vector<Node> nodes;
    for (const Node child : node.children()) nodes.push_back(child);
    return nodes;
}

} // namespace

void reportPlanned(std::string_view word, Span span, Diagnostics& diagnostics) {
    report(diagnostics, span, "E0206", fmt::format("`{}` is not available in this version", word),
           "a word of the language without an implementation yet");
}

void DefinitionReader::unknownKind(const Node& node) const {
    auto& d = report(diagnostics_, node.nameSpan(), "E0215",
                     fmt::format("`{}` is not a kind of definition", node.name()), "unknown kind");
    if (std::string advice = adviceForControl(node.name()); !advice.empty()) {
        d.message = fmt::format("scenes have no `{}`: they say what there is, not what to do", node.name());
        d.help = std::move(advice);
        return;
    }
    for (const TypeInfo& type : table_.all())
        if (type.name == node.name()) {
            d.help = fmt::format("`{}` is a type: write `{} {}`", type.name, keyword(type.kind), type.name);
            return;
        }
    if (isTransformStep(node.name())) {
        d.help =
            fmt::format("a step of `transform {{ {} }}` in a shape, a light, a group or an instance", headText(node));
        return;
    }
    if (const auto kind = suggestKind(node.name())) {
        d.help = didYouMean(keyword(*kind));
        return;
    }
    std::vector<std::string_view> kinds;
    for (int i = 0; i <= static_cast<int>(Kind::render); ++i) kinds.push_back(keyword(static_cast<Kind>(i)));
    d.help = "the kinds are " + quotedList(kinds);
}

void DefinitionReader::unknownType(Kind kind, const Value& word) const {
    const auto names = typeNames(table_, kind);
    auto meant = foreignType(table_, kind, word.text);
    if (meant.empty()) meant = nearest(word.text, names);
    auto& d = reportAt(diagnostics_, word, "E0205", fmt::format("`{}` has no type `{}`", keyword(kind), word.text),
                       meant.empty() ? "unknown type" : didYouMean(meant));
    if (!names.empty()) d.help = fmt::format("the types of `{}` are {}", keyword(kind), quotedList(names));
}

void DefinitionReader::setName(Definition& definition, const Value& word) const {
    definition.name = prefix_ + std::string(word.text);
    definition.nameSpan = word.span;
    if (word.kind == ValueKind::string && !word.text.empty()) return;
    if (!isBareName(word.text))
        report(diagnostics_, word.span, "E0209", fmt::format("`{}` cannot be a name", word.text),
               "a name starts with a letter and holds letters, digits and `_ . : -`; others stand in quotes");
}

// The kind stands without a type and has no default one.
void DefinitionReader::missingType(Definition& definition, const Value* word) const {
    const std::string_view kind = keyword(definition.kind);
    const auto names = typeNames(table_, definition.kind);
    const bool likeType =
        word && (!nearest(word->text, names).empty() || !foreignType(table_, definition.kind, word->text).empty());
    if (likeType) return unknownType(definition.kind, *word);
    auto& d = report(diagnostics_, word ? place(*word) : definition.nameSpan, "E0211",
                     fmt::format("`{}` needs a type", kind), word ? "not a type" : "write its type behind the word");
    d.help = fmt::format("the types of `{}` are {}", kind, quotedList(names));
    if (word)
        d.notes.push_back(fmt::format("a name comes before the type: `{} {} {}`", kind, word->text,
                                      names.empty() ? "type" : names[0]));
}

namespace {

// Whether the word behind a type is its argument, as in `preset gold`: a single one, where there are words for it.
bool takesWord(const TypeInfo& type, const Node& head) {
    if (head.valueCount() > 2) return false; // `mesh ball "ball.ply"`
    const auto word = std::ranges::find(type.fields, 0, &FieldInfo::argument);
    if (word == type.fields.end()) return false;
    return word->type == FieldType::text || word->type == FieldType::file || word->type == FieldType::choice ||
           word->type == FieldType::reference || word->type == FieldType::spectrum;
}

} // namespace

// One word after the kind is the type, two are name and type, in either order where one of them is no type. A single
// word that is no type names a definition of the default type, unless it looks like a mistyped type. Returns the number
// of values used; the first one is a text.
std::size_t DefinitionReader::nameAndType(const Node& node, Definition& definition) const {
    const Kind kind = definition.kind;
    const auto types = typeNames(table_, kind);
    const Value first = node.value(0);
    const Value second = node.valueCount() > 1 ? node.value(1) : Value{};
    const TypeInfo* const firstType = table_.find(kind, first.text);
    const TypeInfo* const secondType = second.isText() ? table_.find(kind, second.text) : nullptr;
    const bool secondIsWord = second.kind == ValueKind::word;

    if (secondType && (!firstType || secondIsWord)) { // `light sun sun`; but in `mesh "mesh"` the string is a file
        setName(definition, first);
        definition.type = secondType;
        return 2;
    }
    if (firstType) {
        definition.type = firstType;
        if (!secondIsWord || takesWord(*firstType, node)) return 1;
        setName(definition, second); // `light quad key`
        return 2;
    }
    const bool likeType = !nearest(first.text, types).empty();
    if (secondIsWord || (second.isText() && !likeType && node.valueCount() > 2)) {
        if (likeType && nearest(second.text, types).empty()) { // `shape mehs ball.ply`
            unknownType(kind, first);
            return 1;
        }
        setName(definition, first);
        unknownType(kind, second);
        return 2;
    }
    if (!likeType && table_.defaultOf(kind)) { // `camera main`
        setName(definition, first);
        definition.type = table_.defaultOf(kind);
    } else {
        missingType(definition, &first);
    }
    return 1;
}

void DefinitionReader::typedHead(const Node& node, Definition& definition) const {
    const bool hasText = node.valueCount() > 0 && !node.allNumbers() && node.value(0).isText();
    std::size_t used = 0;
    if (hasText) {
        used = nameAndType(node, definition);
    } else {
        definition.type = table_.defaultOf(definition.kind);
        if (!definition.type) missingType(definition, nullptr);
    }
    definition.arguments = valuesFrom(node, used);
}

// `spectrum NAME form …`: the form and its numbers stay in the arguments.
void DefinitionReader::spectrumHead(const Node& node, Definition& definition) const {
    if (node.valueCount() == 0 || node.allNumbers() || !node.value(0).isText()) {
        report(diagnostics_, node.headSpan(), "E0209", "`spectrum` needs a name",
               "write `spectrum name rgb 0.8 0.2 0.1`, say");
        definition.arguments = valuesFrom(node, 0);
        return;
    }
    setName(definition, node.value(0));
    definition.arguments = valuesFrom(node, 1);
}

// `group [name]`, `object name`, `instance object-name`, `instances object-name`, `atmosphere medium-name`.
void DefinitionReader::containerHead(const Node& node, Definition& definition) const {
    const std::string_view kind = keyword(definition.kind);
    const std::size_t count = node.valueCount();
    const bool named = count > 0 && !node.allNumbers() && node.value(0).isText();
    if (named && isPlacement(definition.kind)) {
        definition.target = prefix_ + std::string(node.value(0).text);
        definition.targetSpan = place(node.value(0));
    } else if (named) {
        setName(definition, node.value(0));
    } else if (definition.kind != Kind::group) {
        report(diagnostics_, node.nameSpan(), "E0209", fmt::format("`{}` needs a name", kind),
               definition.kind == Kind::object       ? "write `object name { … }`"
               : definition.kind == Kind::atmosphere ? "the name of the medium that it places everywhere"
                                                     : "the name of the object it places");
    }
    if (count > (named ? 1u : 0u))
        reportAt(diagnostics_, node.value(named ? 1 : 0), "E0306", fmt::format("`{}` takes one name", kind),
                 "unexpected");
    for (const Key& key : node.keys())
        report(diagnostics_, key.nameSpan, "E0210", fmt::format("`{}` has no key `{}`", kind, key.name), "unknown key");
}

void DefinitionReader::containerBlock(const Node& node, Definition& definition) const {
    Span transform, visible;
    std::vector<Node> steps;
    for (const Node child : node.children()) {
        if (isTransformStep(child.name()) && definition.kind != Kind::atmosphere) {
            steps.push_back(child);
        } else if (definition.kind == Kind::atmosphere) {
            if (!child.name().starts_with("x-"))
                report(diagnostics_, child.nameSpan(), "E0201",
                       fmt::format("`atmosphere` has no property `{}`", child.name()), "unknown property")
                    .help = "what it is made of is said by its medium; `volume … atmosphere` is thinner with height";
        } else if (child.name() == "transform" || child.name() == "visible-to") {
            Span& first = child.name() == "transform" ? transform : visible;
            if (first.valid()) {
                auto& d = report(diagnostics_, child.headSpan(), "E0208",
                                 fmt::format("`{}` is given twice", child.name()), "second");
                d.related.push_back({first, "first"});
            } else {
                definition.properties.push_back(child);
            }
            first = child.headSpan();
        } else if (definition.kind == Kind::instance && !child.name().starts_with("x-")) {
            report(diagnostics_, child.nameSpan(), "E0201",
                   fmt::format("`instance` has no property `{}`", child.name()), "unknown property")
                .help = "an instance takes `transform { … }` and `visible-to`";
        } else if (definition.kind != Kind::instance) {
            read(child, definition.children, Place::group);
        }
    }
    if (!steps.empty())
        reportLooseSteps(fmt::format("`{}`", keyword(definition.kind)), steps, transform.valid(), diagnostics_);
}

void DefinitionReader::read(const Node& node, std::vector<Definition>& out, Place where) const {
    const std::string_view word = node.name();
    if (word.starts_with("x-")) return; // private data of other tools
    if (word == "param") {              // top-level parameters are the parser's
        if (where == Place::group)
            report(diagnostics_, node.headSpan(), "E0212", "`param` belongs at the top level", "not in a group");
        return;
    }
    if (isLayerWord(word)) {
        report(diagnostics_, node.nameSpan(), "E0232", fmt::format("`{}` belongs at the top level of a file", word),
               "not in a group");
        return;
    }
    if (word == "at") return reportPlanned("at (motion)", node.nameSpan(), diagnostics_);
    const auto kind = findKind(word);
    if (!kind) return unknownKind(node);
    const bool single = *kind == Kind::camera || *kind == Kind::film || *kind == Kind::render;
    if (where == Place::group && (single || *kind == Kind::atmosphere)) {
        report(diagnostics_, node.headSpan(), "E0212", fmt::format("`{}` belongs at the top level", word),
               "not in a group");
        return;
    }
    Definition definition;
    definition.kind = *kind;
    definition.nameSpan = node.nameSpan();
    definition.span = node.headSpan();
    definition.damaged = node.damaged();
    // What a syntax error left of a head is no new error.
    Diagnostics ignored;
    const DefinitionReader quiet(table_, ignored, prefix_);
    const DefinitionReader& head = node.damaged() ? quiet : *this;
    if (*kind == Kind::spectrum)
        head.spectrumHead(node, definition);
    else if (isTyped(*kind))
        head.typedHead(node, definition);
    else
        head.containerHead(node, definition);
    if (*kind == Kind::instances) definition.type = table_.defaultOf(*kind);
    if (*kind == Kind::spectrum || isTyped(*kind) || *kind == Kind::instances) {
        if (*kind != Kind::instances) definition.keys = keysOf(node); // a container's keys have been reported
        definition.properties = childrenOf(node);
        if (isPreset(definition.type)) expandPreset(definition, table_, head.diagnostics_);
    } else {
        containerBlock(node, definition);
    }
    out.push_back(std::move(definition));
}

std::optional<Definition> DefinitionReader::readInline(Kind kind, const Node& property) const {
    Definition definition;
    definition.kind = kind;
    definition.nameSpan = property.nameSpan();
    definition.span = property.headSpan();
    const bool hasWord = property.valueCount() > 0 && !property.allNumbers() && property.value(0).isText();
    if (hasWord) {
        const Value word = property.value(0);
        definition.nameSpan = place(word);
        definition.type = table_.find(kind, word.text);
        if (!definition.type) {
            unknownType(kind, word);
            return std::nullopt;
        }
    } else {
        definition.type = table_.defaultOf(kind);
        if (!definition.type) {
            missingType(definition, nullptr);
            return std::nullopt;
        }
    }
    definition.arguments = valuesFrom(property, hasWord ? 1 : 0);
    definition.keys = keysOf(property);
    definition.properties = childrenOf(property);
    if (isPreset(definition.type)) {
        expandPreset(definition, table_, diagnostics_);
        if (!definition.type) return std::nullopt;
    }
    return definition;
}

std::span<const std::string_view> transformSteps() {
    static constexpr auto steps =
        std::to_array<std::string_view>({"translate", "rotate", "scale", "matrix", "look-at"});
    return steps;
}

bool isTransformStep(std::string_view word) {
    return std::ranges::find(transformSteps(), word) != transformSteps().end();
}

void reportLooseSteps(std::string_view owner, const std::vector<Node>& steps, bool given, Diagnostics& diagnostics) {
    const Node& first = steps.front();
    constexpr std::size_t kShown = 8;
    const std::span shown = std::span(steps).first(std::min(steps.size(), kShown));
    std::string block;
    for (const Node& step : shown) block += (block.empty() ? "" : "; ") + headText(step);
    if (shown.size() < steps.size()) block += "; …";
    Diagnostic& d = report(diagnostics, first.nameSpan(), "E0201",
                           fmt::format("{} has no property `{}`", owner, first.name()), "a step of a transform");
    for (const Node& step : shown.subspan(1)) d.related.push_back({step.nameSpan(), "another one"});
    d.help = given ? fmt::format("write `{}` into the block of its `transform`", block)
                   : fmt::format("write `transform {{ {} }}`", block);
    // `scale 2` of a light may be meant as a factor of its amount.
    const bool certain = first.name() == "translate" || first.name() == "rotate";
    if (!given && certain && steps.size() == 1 && !first.damaged() && !first.hasBlock()) {
        d.fixes.push_back({{first.nameSpan().file, first.nameSpan().begin, first.nameSpan().begin}, "transform { "});
        d.fixes.push_back({{first.headSpan().file, first.headSpan().end, first.headSpan().end}, " }"});
    }
}

} // namespace abbe::schema
