#include "schema/binding.h"
#include "schema/file_path.h"
#include "schema/measure.h"
#include "schema/suggest.h"

#include <algorithm>
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
            const MeasureReader reader(measureOf(field_), tree_.header, diagnostics_);
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
        const MeasureReader reader(measure, tree_.header, diagnostics_);
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

} // namespace abbe::schema
