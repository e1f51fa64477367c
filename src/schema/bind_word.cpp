#include "schema/binding.h"
#include "schema/definition_reader.h"
#include "schema/entry.h"
#include "schema/expression.h"
#include "schema/files.h"
#include "schema/foreign_words.h"
#include "schema/measure.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

class WordBinder {
  public:
    WordBinder(const FieldInfo& field, const Entry& entry, const SceneTree& tree, Diagnostics& diagnostics)
        : field_(field), entry_(entry), tree_(tree), diagnostics_(diagnostics) {}

    std::optional<BoundValue> toggle() {
        if (entry_.count() == 0) return fault(entry_.span(), "E0308", "needs `on` or `off`", "has no value");
        if (!single()) return std::nullopt;
        const Value value = entry_.value(0);
        if (value.kind == ValueKind::boolean) return value.boolean;
        if (value.text == "on" || value.text == "off") return value.text == "on";
        const bool yes = value.text == "true" || value.text == "yes" || value.text == "1";
        const bool no = value.text == "false" || value.text == "no" || value.text == "0";
        auto& d = reportAt(diagnostics_, value, "E0308", fmt::format("`{}` needs `on` or `off`", field_.name),
                           yes  ? "write `on`"
                           : no ? "write `off`"
                                : "neither `on` nor `off`");
        if ((yes || no) && !value.use.valid()) d.fixes.push_back({value.span, yes ? "on" : "off"});
        return std::nullopt;
    }

    std::optional<BoundValue> choice() {
        if (entry_.count() == 0) {
            fault(entry_.span(), "E0306", "needs a word", "has no value", choicesHelp());
            return std::nullopt;
        }
        const Value word = entry_.value(0);
        if (!known(word)) return std::nullopt;
        Choice result{std::string(word.text), std::nullopt};
        if (entry_.count() > 1) {
            const MeasureReader reader(measureOf(field_), tree_.headerOf(entry_.span()), diagnostics_);
            const auto row = reader.row(entry_, 1, 1);
            if (!row) return std::nullopt;
            result.number = row->values[0];
        }
        return result;
    }

    std::optional<BoundValue> words() {
        if (entry_.count() == 0) {
            fault(entry_.span(), "E0306", "needs a word", "has no value", choicesHelp());
            return std::nullopt;
        }
        Words result{{}, entry_.span()};
        for (std::size_t i = 0; i < entry_.count(); ++i) {
            const Value word = entry_.value(i);
            if (!known(word)) return std::nullopt;
            const bool alone = word.text == "none" && entry_.count() > 1;
            if (alone || std::ranges::find(result.words, word.text) != result.words.end()) {
                reportAt(diagnostics_, word, "E0306", fmt::format("`{}` takes each word once", field_.name),
                         alone ? "`none` stands alone" : "said twice");
                return std::nullopt;
            }
            result.words.emplace_back(word.text);
        }
        return result;
    }

    std::optional<BoundValue> text() {
        const bool isFile = field_.type == FieldType::file;
        if (entry_.count() == 0) {
            if (std::ranges::any_of(field_.keys, &FieldKey::value)) return textByKey();
            return fault(entry_.span(), "E0306", isFile ? "needs the name of a file" : "needs a text", "has no value");
        }
        if (!single()) return std::nullopt;
        const Value value = entry_.value(0);
        if (!value.isText()) {
            reportAt(diagnostics_, value, "E0314", fmt::format("`{}` needs a text", field_.name), "write it in quotes");
            return std::nullopt;
        }
        Text result{std::string(value.text), {}, place(value)};
        const bool goodKeys = keys(result);
        if (isFile) {
            const auto path = findFile(value, tree_, diagnostics_, field_.tiles);
            if (!path) return std::nullopt;
            result.value = path->string();
        }
        return goodKeys ? std::optional<BoundValue>(std::move(result)) : std::nullopt;
    }

  private:
    std::optional<BoundValue> fault(Span span, std::string_view code, std::string_view what, std::string label,
                                    std::string help = {}) {
        auto& d = report(diagnostics_, span, code, fmt::format("`{}` {}", field_.name, what), std::move(label));
        d.help =
            help.empty() && !field_.example.empty() ? fmt::format("for example `{}`", field_.example) : std::move(help);
        return std::nullopt;
    }

    std::string choicesHelp() const {
        return field_.choices.empty() ? std::string() : "the choices are " + quotedList(field_.choices);
    }

    bool known(const Value& word) {
        if (!word.isText()) {
            reportAt(diagnostics_, word, "E0314", fmt::format("`{}` needs a word", field_.name), "not a word").help =
                choicesHelp();
            return false;
        }
        if (field_.choices.empty() || std::ranges::find(field_.choices, word.text) != field_.choices.end()) return true;
        const auto meant = nearest(word.text, field_.choices);
        reportAt(diagnostics_, word, "E0307", fmt::format("`{}` has no choice `{}`", field_.name, word.text),
                 meant.empty() ? "unknown choice" : didYouMean(meant))
            .help = choicesHelp();
        return false;
    }

    bool single() {
        if (entry_.count() == 1) return true;
        reportAt(diagnostics_, entry_.value(1), "E0306", fmt::format("`{}` takes one value", field_.name),
                 "unexpected");
        return false;
    }

    // `density grid=smoke`, or nothing at all: an empty text.
    std::optional<BoundValue> textByKey() {
        Text result{{}, {}, entry_.span()};
        if (!keys(result)) return std::nullopt;
        return result;
    }

    bool keys(Text& result) {
        bool good = true;
        for (const Key& key : entry_.keys()) {
            const auto known = std::ranges::find(field_.keys, key.name, &FieldKey::name);
            if (known == field_.keys.end())
                good = unknownKey(key);
            else if (known->value)
                good = valueKey(key, result) && good;
            else if (known->number)
                good = numberKey(key, *known, result) && good;
            else if (!known->choices.empty() &&
                     std::ranges::find(known->choices, key.value.text) == known->choices.end())
                good = unknownKeyChoice(key, known->choices);
            else
                result.keys.emplace_back(key.name, key.value.text);
        }
        return good;
    }

    bool valueKey(const Key& key, Text& result) {
        if (entry_.count() > 0) {
            report(diagnostics_, key.nameSpan, "E0306", fmt::format("`{}` takes one value", field_.name),
                   fmt::format("`{}=` says it again", key.name));
            return false;
        }
        if (!key.value.isText()) {
            reportAt(diagnostics_, key.value, "E0314", fmt::format("`{}=` needs a text", key.name),
                     "write it in quotes");
            return false;
        }
        result.value = key.value.text;
        result.span = place(key.value);
        return true;
    }

    bool numberKey(const Key& key, const FieldKey& known, Text& result) {
        const Measure measure{known.name, field_.dimensions, known.lower, known.upper, {}, field_.example};
        const MeasureReader reader(measure, tree_.headerOf(entry_.span()), diagnostics_);
        const auto value = reader.number(key.value);
        if (!value || !reader.inRange(*value, {}, key.value)) return false;
        result.keys.emplace_back(key.name, fmt::format("{}", *value));
        return true;
    }

    bool unknownKey(const Key& key) {
        std::vector<std::string_view> names;
        for (const FieldKey& k : field_.keys) names.push_back(k.name);
        const auto meant = nearest(key.name, names);
        auto& d =
            report(diagnostics_, key.nameSpan, "E0210", fmt::format("`{}` has no key `{}`", field_.name, key.name),
                   meant.empty() ? "unknown key" : didYouMean(meant));
        if (!names.empty()) d.help = "its keys are " + quotedList(names);
        return false;
    }

    bool unknownKeyChoice(const Key& key, const std::vector<std::string_view>& choices) {
        const auto meant = nearest(key.value.text, choices);
        reportAt(diagnostics_, key.value, "E0307", fmt::format("`{}` has no choice `{}`", key.name, key.value.text),
                 meant.empty() ? "unknown choice" : didYouMean(meant))
            .help = "the choices are " + quotedList(choices);
        return false;
    }

    const FieldInfo& field_;
    const Entry& entry_;
    const SceneTree& tree_;
    Diagnostics& diagnostics_;
};

} // namespace

std::optional<BoundValue> bindWord(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    WordBinder binder(field, entry, context.tree, context.diagnostics);
    if (field.type == FieldType::toggle) return binder.toggle();
    if (field.type == FieldType::words) return binder.words();
    return field.type == FieldType::choice ? binder.choice() : binder.text();
}

std::optional<Words> bindWords(const FieldInfo& field, const Node& property, const SceneTree& tree,
                               Diagnostics& diagnostics) {
    const auto value = WordBinder(field, Entry(property), tree, diagnostics).words();
    return value ? std::optional(std::get<Words>(*value)) : std::nullopt;
}

namespace {

void unknownName(Kind kind, const Value& word, const BindContext& context) {
    const std::string message = fmt::format("no {} is named `{}`", keyword(kind), word.text);
    for (int i = 0; i <= static_cast<int>(Kind::render); ++i)
        if (const Definition* other = context.tree.find(static_cast<Kind>(i), word.text, place(word))) {
            auto& d = reportAt(context.diagnostics, word, "E0202", message,
                               fmt::format("this names {} {}",
                                           other->kind == Kind::object || other->kind == Kind::instance ? "an" : "a",
                                           keyword(other->kind)));
            d.related.push_back({other->nameSpan, "defined here"});
            return;
        }
    auto meant = context.tree.nearestName({&kind, 1}, word.text, place(word));
    const auto types = typeNames(context.table, kind);
    if (meant.empty()) meant = foreignType(context.table, kind, word.text);
    if (meant.empty()) meant = nearest(word.text, types);
    auto& d = reportAt(context.diagnostics, word, "E0202", message, meant.empty() ? "unknown name" : didYouMean(meant));
    context.tree.noteRemoved(kind, word.text, place(word), d);
    if (const Definition* definition = context.tree.find(kind, meant, place(word)))
        d.related.push_back({definition->nameSpan, "defined here"});
    else if (meant.empty())
        d.help = fmt::format("the types of `{}` are {}", keyword(kind), quotedList(types));
}

// The key `group=` of an entry, if its field has one.
const Key* groupKey(const FieldInfo& field, const Entry& entry) {
    if (field.keys.empty()) return nullptr;
    const auto found = std::ranges::find(entry.keys(), field.keys[0].name, &Key::name);
    return found == entry.keys().end() ? nullptr : &*found;
}

std::optional<BoundValue> valid(Reference reference, const Key* group) {
    if (!reference.valid()) return std::nullopt;
    if (!group) return reference;
    return GroupReference{reference, std::string(group->value.text), place(group->value)};
}

} // namespace

namespace {

std::optional<double> weightOf(const Key& key, const Entry& entry, const BindContext& context) {
    if (isComputed(key.value)) {
        constexpr std::array plainNumber = {Dimension::none};
        const Measure measure{key.name, plainNumber, 0, HUGE_VAL, {}, {}};
        const MeasureReader reader(measure, context.tree.headerOf(entry.span()), context.diagnostics);
        const auto weight = reader.number(key.value);
        return weight && reader.inRange(*weight, {}, key.value) ? weight : std::nullopt;
    }
    if (key.value.kind == ValueKind::number && key.value.number >= 0 && std::isfinite(key.value.number))
        return key.value.number;
    reportAt(context.diagnostics, key.value, "E0303", fmt::format("`{}=` is a number of at least 0", key.name),
             "not such a number");
    return std::nullopt;
}

} // namespace

std::optional<BoundValue> bindWeighted(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    const Key* const key = groupKey(field, entry);
    std::optional<double> weight = 1;
    if (key) weight = weightOf(*key, entry, context);
    const auto bound = bindReference(field, entry, context);
    if (!bound || !weight) return std::nullopt;
    WeightedReference result{{}, *weight, entry.span()};
    if (const auto* one = std::get_if<GroupReference>(&*bound))
        result.reference = one->reference;
    else
        result.reference = std::get<Reference>(*bound);
    return result;
}

std::optional<BoundValue> bindPlace(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    if (entry.keys().empty()) {
        const auto value = bindNumeric(field, entry, context);
        if (!value) return std::nullopt;
        return Location{std::get<double>(*value), {}, entry.span()};
    }
    const Key& key = entry.keys()[0];
    if (key.name != "on" || entry.keys().size() > 1) {
        const Key& wrong = key.name != "on" ? key : entry.keys()[1];
        report(context.diagnostics, wrong.nameSpan, wrong.name == "on" ? "E0208" : "E0210",
               fmt::format("`{}` takes one key, `on=`", field.name), "unexpected");
        return std::nullopt;
    }
    if (entry.count() > 0) {
        reportAt(context.diagnostics, entry.value(0), "E0306",
                 fmt::format("`{}` takes a distance or `on=`", field.name), "not both");
        return std::nullopt;
    }
    if (!key.value.isText()) {
        reportAt(context.diagnostics, key.value, "E0314", "`on=` needs the name of a shape", "not a name");
        return std::nullopt;
    }
    if (!context.tree.find(Kind::shape, key.value.text, place(key.value))) {
        unknownName(Kind::shape, key.value, context);
        return std::nullopt;
    }
    return Location{std::nullopt, context.tree.fullName(place(key.value), key.value.text), place(key.value)};
}

// A bare word is first a defined name, then a type; with arguments or a block it is always a type.
std::optional<BoundValue> bindReference(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    const Kind kind = field.referenceKind;
    const Key* const group = groupKey(field, entry);
    const bool bare = entry.count() == 1 && !entry.hasBlock() && entry.keys().size() == (group ? 1 : 0);
    if (entry.count() == 0 && !entry.hasBlock()) {
        report(context.diagnostics, entry.span(), "E0306",
               fmt::format("`{}` needs the name or the type of a {}", field.name, keyword(kind)), "has no value");
        return std::nullopt;
    }
    const Value first = entry.count() > 0 ? entry.value(0) : Value{};
    if (entry.count() > 0 && !first.isText()) {
        reportAt(context.diagnostics, first, "E0314",
                 fmt::format("`{}` needs the name or the type of a {}", field.name, keyword(kind)), "not a name");
        return std::nullopt;
    }
    if (bare) {
        if (const Definition* named = context.tree.find(kind, first.text, place(first)))
            return valid(context.resolver.reference(*named, context.diagnostics), group);
        if (!context.table.find(kind, first.text)) {
            unknownName(kind, first, context);
            return std::nullopt;
        }
    }
    const bool isName = entry.count() > 0 && !context.table.find(kind, first.text);
    if (isName && entry.keys().size() > (group ? 1u : 0u)) {
        const Key& key = &entry.keys()[0] == group ? entry.keys()[1] : entry.keys()[0];
        report(context.diagnostics, key.nameSpan, "E0210",
               fmt::format("`{}` has no key `{}` here", field.name, key.name), "unknown key");
        return std::nullopt;
    }
    if (isName && !bare && context.tree.find(kind, first.text, place(first))) {
        reportAt(context.diagnostics, first, "E0214",
                 fmt::format("`{}` is a name: it takes no arguments and no block", first.text),
                 fmt::format("write `{} {}` alone", field.name, first.text));
        return std::nullopt;
    }
    const DefinitionReader reader(context.table, context.diagnostics);
    if (!entry.node()) return std::nullopt;
    auto inlined = reader.readInline(kind, *entry.node());
    if (!inlined) return std::nullopt;
    if (group) std::erase_if(inlined->keys, [&](const Key& key) { return key.name == group->name; });
    return valid(context.resolver.reference(*inlined, context.diagnostics), group);
}

} // namespace abbe::schema
