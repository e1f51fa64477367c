#include "schema/binding.h"
#include "schema/definition_reader.h"
#include "schema/foreign_words.h"
#include "schema/suggest.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

void unknownName(Kind kind, const Value& word, const BindContext& context) {
    const std::string message = fmt::format("no {} is named `{}`", keyword(kind), word.text);
    for (int i = 0; i <= static_cast<int>(Kind::render); ++i)
        if (const Definition* other = context.tree.find(static_cast<Kind>(i), word.text)) {
            auto& d = reportAt(context.diagnostics, word, "E0202", message,
                               fmt::format("this names {} {}",
                                           other->kind == Kind::object || other->kind == Kind::instance ? "an" : "a",
                                           keyword(other->kind)));
            d.related.push_back({other->nameSpan, "defined here"});
            return;
        }
    auto meant = context.tree.nearestName({&kind, 1}, word.text);
    const auto types = typeNames(context.table, kind);
    if (meant.empty()) meant = foreignType(context.table, kind, word.text);
    if (meant.empty()) meant = nearest(word.text, types);
    auto& d = reportAt(context.diagnostics, word, "E0202", message, meant.empty() ? "unknown name" : didYouMean(meant));
    if (const Definition* definition = context.tree.find(kind, meant))
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

std::optional<BoundValue> bindWeighted(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    const Key* const key = groupKey(field, entry);
    const bool sound =
        !key || (key->value.kind == ValueKind::number && key->value.number >= 0 && std::isfinite(key->value.number));
    if (!sound)
        reportAt(context.diagnostics, key->value, "E0303", fmt::format("`{}=` is a number of at least 0", key->name),
                 "not such a number");
    const auto bound = bindReference(field, entry, context);
    if (!bound || !sound) return std::nullopt;
    WeightedReference result{{}, key ? key->value.number : 1, entry.span()};
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
    if (!context.tree.find(Kind::shape, key.value.text)) {
        unknownName(Kind::shape, key.value, context);
        return std::nullopt;
    }
    return Location{std::nullopt, std::string(key.value.text), place(key.value)};
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
        if (const Definition* named = context.tree.find(kind, first.text))
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
    if (isName && !bare && context.tree.find(kind, first.text)) {
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
