#include "parser/parameters.h"

#include "parser/characters.h"
#include "parser/tokens.h"
#include "parser/value_scanner.h"
#include "schema/expression.h"
#include "schema/foreign_words.h"
#include "schema/scene_tree.h"

#include <fmt/format.h>

namespace abbe {

std::optional<ParameterOverride> readOverride(SourceMap& sources, std::string_view nameAndValue,
                                              Diagnostics& diagnostics) {
    const std::size_t equals = nameAndValue.find('=');
    const std::string_view name = nameAndValue.substr(0, equals);
    if (equals == std::string_view::npos || name.empty() || equals + 1 == nameAndValue.size()) {
        const FileId file = sources.add("-D", std::string(nameAndValue));
        const Span all{file, 0, static_cast<std::uint32_t>(nameAndValue.size())};
        diagnostics.error("E0222", all, "a parameter is given as `-D name=value`",
                          equals == std::string_view::npos ? "no `=`"
                          : name.empty()                   ? "no name"
                                                           : "no value");
        return std::nullopt;
    }
    return ParameterOverride{std::string(name),
                             sources.add(fmt::format("-D {}", name), std::string(nameAndValue.substr(equals + 1)))};
}

} // namespace abbe

namespace abbe::parser {

void reportUnused(const schema::Document::Parameter& p, Diagnostics& diagnostics) {
    if (p.used || p.values().empty()) return; // without a value: reported
    diagnostics.warning("W0205", p.nameSpan, fmt::format("parameter `{}` is never used", p.name),
                        fmt::format("no `${}` in this file", p.name));
}

using schema::Document;
using schema::Value;
using schema::ValueKind;
using Parameter = Document::Parameter;

namespace {

// Enough for a matrix. A bound keeps parameters from multiplying the size of a scene.
constexpr std::size_t kMostValues = 16;

// Removes what cannot be a parameter's value, with an error.
void checkValues(std::vector<Value>& values, Diagnostics& diagnostics) {
    std::erase_if(values, [&](const Value& v) {
        const bool nested = v.kind == ValueKind::word && v.text.starts_with('$');
        if (nested) {
            const std::string text = fmt::format("\"{}\"", v.text);
            auto& d = diagnostics.error("E0223", v.span, "a parameter that is made of another one stands in quotes",
                                        fmt::format("write `{}`", text));
            d.fixes.push_back({v.span, text});
        }
        return nested;
    });
    if (values.size() <= kMostValues) return;
    diagnostics.error("E0222", join(values[kMostValues].span, values.back().span),
                      fmt::format("a parameter has at most {} values", kMostValues),
                      fmt::format("{} too many", values.size() - kMostValues));
    values.resize(kMostValues);
}

// `0 deg`
bool hasUnit(const std::vector<Value>& values) {
    return values.size() == 2 && values[0].kind == ValueKind::number && values[1].isText();
}

std::vector<Value> valuesOf(const schema::Node& node) {
    std::vector<Value> values;
    for (std::size_t i = 0; i < node.valueCount(); ++i) values.push_back(node.value(i));
    return values;
}

} // namespace

void defineParameter(Document& document, std::uint32_t index, Diagnostics& diagnostics) {
    const schema::Node node = document.node(index);
    std::vector<Value> values = valuesOf(node);
    if (values.empty() || !values[0].isText() || values[0].text.starts_with('$')) {
        if (!node.damaged() || !values.empty())
            diagnostics.error("E0222", values.empty() ? node.nameSpan() : values[0].span, "a parameter needs a name",
                              "write `param name value`");
        return;
    }
    Parameter parameter;
    parameter.name = values[0].text;
    parameter.nameSpan = values[0].span;
    values.erase(values.begin());
    if (values.size() > 1 && values.back().kind == ValueKind::string) {
        parameter.doc = values.back().text;
        values.pop_back();
    }
    if (values.empty() && !node.damaged())
        diagnostics.error("E0222", parameter.nameSpan, fmt::format("the parameter `{}` has no value", parameter.name),
                          "a value must follow");
    if (node.hasBlock() || !node.keys().empty())
        diagnostics.error("E0222", node.headSpan(), "a parameter has neither a block nor keys",
                          node.hasBlock() ? "remove the block" : "remove the keys");
    if (!values.empty()) {
        const Span all = join(values.front().span, values.back().span);
        parameter.defaultText = document.source.substr(all.begin, all.end - all.begin);
    }
    checkValues(values, diagnostics);
    parameter.written = std::move(values);
    document.parameters.push_back(std::move(parameter));
}

ParameterTable::ParameterTable(Document& document, Diagnostics& diagnostics)
    : document_(document), diagnostics_(diagnostics) {
    std::vector<Parameter> kept;
    for (Parameter& p : document.parameters) {
        if (const auto [first, isNew] = index_.emplace(p.name, kept.size()); isNew)
            kept.push_back(std::move(p));
        else
            diagnostics
                .error("E0220", p.nameSpan, fmt::format("parameter `{}` is defined twice", p.name), "second definition")
                .related.push_back({kept[first->second].nameSpan, "the first definition is here"});
    }
    document.parameters = std::move(kept);
    used_.resize(document.parameters.size());
}

Parameter* ParameterTable::find(std::string_view name) {
    const auto found = index_.find(name);
    return found == index_.end() ? nullptr : &document_.parameters[found->second];
}

std::string_view ParameterTable::nearest(std::string_view name) {
    if (document_.parameters.size() > 1000 || ++searches_ > 100) return {}; // takes long, and helps no one any more
    std::vector<std::string_view> names;
    for (const Parameter& p : document_.parameters) names.push_back(p.name);
    return schema::nearest(name, names);
}

std::string ParameterTable::listNames() const {
    const std::vector<Parameter>& all = document_.parameters;
    if (all.empty()) return "the scene has no parameters";
    std::string list = all.size() == 1 ? "its parameter is" : "its parameters are";
    for (std::size_t i = 0; i < all.size() && i < 12; ++i)
        list += fmt::format("{} `{}`", i > 0 ? "," : "", all[i].name);
    return list + (all.size() > 12 ? ", …" : "");
}

void ParameterTable::override(const ParseOptions& options, const SourceMap& sources) {
    if (options.outer)
        for (Parameter& p : document_.parameters)
            if (const auto* const values = options.outer(p.name)) p.given = *values;
    for (const ParameterOverride& given : options.overrides) {
        const std::string_view value = sources.text(given.value);
        const SourceText text{given.value, value.data(), value.data() + value.size()};
        if (Parameter* const parameter = find(given.name)) {
            parameter->given = readValues(text, *parameter);
            if (given.ifThere && parameter->given.size() == 1 && hasUnit(parameter->written))
                parameter->given.push_back(parameter->written[1]);
            checkValues(parameter->given, diagnostics_);
            continue;
        }
        if (given.ifThere || options.layered) continue;
        const std::string_view near = nearest(given.name);
        diagnostics_
            .error("E0221", text.span(text.begin, text.end), fmt::format("the scene has no parameter `{}`", given.name),
                   near.empty() ? std::string{} : fmt::format("did you mean `-D {}={}`?", near, value))
            .help = listNames();
    }
}

// The values of an override. A parameter that holds one text takes everything as a text, so that file names need no
// quotes inside the shell's quotes.
std::vector<Value> ParameterTable::readValues(const SourceText& text, const Parameter& parameter) {
    SyntaxErrors errors(text, diagnostics_);
    std::vector<Value> values;
    if (!checkCharacters(errors)) return values;
    const bool asText = parameter.written.size() == 1 && parameter.written[0].kind == ValueKind::string;
    if (asText && *text.begin != '"' && *text.begin != '#') {
        Value value;
        value.kind = ValueKind::string;
        value.text = between(text.begin, text.end);
        value.span = text.span(text.begin, text.end);
        return {value};
    }
    ValueScanner scanner(errors, document_);
    for (const char* p = skipLineSpace(text.begin, errors); p < text.end; p = skipLineSpace(p, errors)) {
        p = scanner.scan(p, Place::argument);
        values.insert(values.end(), scanner.values().begin(), scanner.values().end());
    }
    return values;
}

// "$r * 2" of `$r*2`, and a minus only where a parameter stands in front of it.
std::string spaced(std::string_view word, std::size_t minus) {
    std::string text;
    for (std::size_t i = 0; i < word.size(); ++i) {
        const bool sign = std::string_view("*+/").find(word[i]) != std::string_view::npos || i == minus;
        text += sign ? fmt::format(" {} ", word[i]) : std::string(1, word[i]);
    }
    return text;
}

// `$r*2`: says that what is computed stands in quotes. False where it is none.
bool ParameterTable::reportExpression(const Value& word, std::string_view text) {
    const std::size_t sign = text.find_first_of("*+^");
    const std::size_t end = sign == std::string_view::npos ? text.rfind('-') : sign;
    Parameter* const parameter = end == std::string_view::npos ? nullptr : find(text.substr(0, end));
    if (parameter == nullptr && sign == std::string_view::npos) return false; // `$two-words`
    if (parameter != nullptr) used_[static_cast<std::size_t>(parameter - document_.parameters.data())] = true;
    const std::string quoted = fmt::format("\"{}\"", spaced(word.text, end + 1));
    Diagnostic& d = diagnostics_.error("E0204", word.span, "what is to be computed stands in quotes",
                                       fmt::format("write `{}`", quoted));
    d.fixes.push_back({word.span, quoted});
    return true;
}

// The parameter that `word` names, or null after a diagnostic.
const Parameter* ParameterTable::lookUp(const Value& word) {
    const std::string_view name = word.text.substr(1);
    if (const auto found = index_.find(name); found != index_.end()) {
        used_[found->second] = true;
        return &document_.parameters[found->second];
    }
    if (reportExpression(word, name)) return nullptr;
    const std::string_view near = nearest(name);
    Diagnostic& d = diagnostics_.error("E0204", word.span, fmt::format("no parameter is named `{}`", name),
                                       near.empty() ? "unknown parameter" : fmt::format("did you mean `${}`?", near));
    if (!near.empty() && schema::isMisspelling(name, near)) d.fixes.push_back({word.span, fmt::format("${}", near)});
    return nullptr;
}

void ParameterTable::replaceKey(Document::NodeRecord& node, std::uint32_t key) {
    Value& value = document_.keys[node.firstKey + key].value;
    const Parameter* const parameter = lookUp(value);
    const std::size_t count = parameter == nullptr ? 0 : parameter->values().size();
    node.damaged |= count != 1;
    if (count > 1)
        diagnostics_
            .error("E0224", value.span, "a key takes one value",
                   fmt::format("`{}` has {} values", parameter->name, count))
            .related.push_back({parameter->nameSpan, "defined here"});
    if (count != 1) return;
    const Span use = value.span;
    value = parameter->values()[0];
    value.use = use;
}

// Writes all values of the node again, behind the last ones, with those of parameters in the places of their names.
void ParameterTable::replaceValues(Document::NodeRecord& node) {
    const auto first = static_cast<std::uint32_t>(document_.values.size());
    for (std::uint32_t i = 0; i < node.valueCount; ++i) {
        const Value word = document_.values[node.firstValue + i];
        const bool isUse = word.kind == ValueKind::word && word.text.starts_with('$');
        const Parameter* const parameter = isUse ? lookUp(word) : nullptr;
        if (parameter == nullptr) document_.values.push_back(word);
        node.damaged |= isUse && (parameter == nullptr || parameter->values().empty());
        if (parameter == nullptr) continue;
        for (Value value : parameter->values()) {
            value.use = word.span;
            document_.values.push_back(value);
        }
    }
    node.firstValue = first;
    node.valueCount = static_cast<std::uint32_t>(document_.values.size()) - first;
}

void ParameterTable::substitute(std::span<const ParameterUse> uses) {
    std::uint32_t lastNode = Document::kNone;
    for (const ParameterUse& use : uses) {
        Document::NodeRecord& node = document_.nodes[use.node];
        if (use.key) {
            replaceKey(node, use.index);
        } else if (use.node != lastNode) {
            lastNode = use.node;
            replaceValues(node);
        }
    }
    noteTexts();
    for (std::size_t i = 0; i < used_.size(); ++i) document_.parameters[i].used = used_[i];
}

void ParameterTable::warnOfUnused() const {
    for (const Parameter& p : document_.parameters) reportUnused(p, diagnostics_);
}

// `$name` in texts that are computed where they stand for numbers.
void ParameterTable::noteTexts() {
    if (document_.parameters.empty()) return;
    for (const Value& value : document_.values) noteText(value);
    for (const schema::Key& key : document_.keys) noteText(key.value);
    for (const Parameter& p : document_.parameters)
        for (const Value& value : p.values()) noteText(value);
}

void ParameterTable::noteText(const Value& value) {
    if (!schema::isComputed(value)) return;
    constexpr std::size_t kLongestName = 200;
    const std::string_view text = value.text;
    for (std::size_t at = text.find('$'); at != std::string_view::npos; at = text.find('$', at + 1)) {
        std::size_t end = schema::endOfName(text, at + 1);
        if (end - at > kLongestName) continue;
        while (end > at + 1) { // `$a-1` uses `a` unless a parameter is called so
            if (const auto found = index_.find(text.substr(at + 1, end - at - 1)); found != index_.end()) {
                used_[found->second] = document_.parameters[found->second].inText = true;
                break;
            }
            const std::size_t minus = text.substr(0, end).rfind('-');
            if (minus == std::string_view::npos || minus <= at) break;
            end = minus;
        }
    }
}

} // namespace abbe::parser
