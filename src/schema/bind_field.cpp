#include "schema/binding.h"
#include "schema/describe.h"
#include "schema/measure.h"
#include "schema/suggest.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

bool takesBlock(const FieldInfo& field) {
    if (!field.block.empty()) return true;
    switch (field.type) {
    case FieldType::points:
    case FieldType::numbers:
    case FieldType::indexRows:
    case FieldType::spectrum: // rows of a table
    case FieldType::complexIndex:
    case FieldType::reference:
    case FieldType::weighted:
    case FieldType::transform:
    case FieldType::table:
    case FieldType::moments:
    case FieldType::stop:
    case FieldType::namedNumbers:
        return true;
    default:
        return false;
    }
}

// Keys are read by those who know them: texts, spectra (`space=`) and inline definitions.
bool readsKeys(FieldType type) {
    return type == FieldType::text || type == FieldType::file || type == FieldType::spectrum ||
           type == FieldType::sharpRow || type == FieldType::reference || type == FieldType::weighted ||
           type == FieldType::place || type == FieldType::stop;
}

bool checkBlockAndKeys(const FieldInfo& field, const Entry& entry, Diagnostics& diagnostics) {
    if (entry.hasBlock() && !takesBlock(field)) {
        report(diagnostics, entry.span(), "E0214", fmt::format("`{}` takes no block", field.name), "remove the block");
        return false;
    }
    if (readsKeys(field.type)) return true;
    for (const Key& key : entry.keys()) {
        if (std::ranges::find(field.keys, key.name, &FieldKey::name) != field.keys.end()) continue;
        report(diagnostics, key.nameSpan, "E0210", fmt::format("`{}` has no key `{}`", field.name, key.name),
               "unknown key");
        return false;
    }
    return true;
}

std::optional<BoundValue> bindTransformField(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    if (!entry.hasBlock() || entry.count() > 0) {
        report(context.diagnostics, entry.span(), "E0313", fmt::format("`{}` needs a block of steps", field.name),
               "write `{ rotate y 45 deg; translate 0 1 0 }`, say");
        return std::nullopt;
    }
    const std::size_t before = context.diagnostics.errorCount();
    const Header& header = context.tree.header;
    const KeyedTransform transform = field.canMove ? bindMotion(*entry.node(), header, context.diagnostics)
                                                   : bindTransform(*entry.node(), header, context.diagnostics);
    return context.diagnostics.errorCount() > before ? std::nullopt : std::optional<BoundValue>(transform);
}

std::optional<BoundValue> bindInteger(const MeasureReader& reader, const Entry& entry, const BindContext& context,
                                      std::string_view name) {
    constexpr double kExact = 9007199254740992.0; // 2^53: beyond it doubles skip integers
    const auto row = reader.row(entry, 0, 1);
    if (!row) return std::nullopt;
    const double x = row->values[0];
    if (x == std::floor(x) && std::abs(x) <= kExact) return static_cast<std::int64_t>(x);
    reportAt(context.diagnostics, entry.value(0), "E0305", fmt::format("`{}` must be a whole number", name),
             fmt::format("is {}", entry.value(0).text));
    return std::nullopt;
}

bool startsWithWord(const Entry& entry) { return entry.count() > 0 && entry.value(0).kind == ValueKind::word; }

// One of the words that may stand in the place of a number.
std::optional<BoundValue> bindWordForNumber(const FieldInfo& field, const Entry& entry, Diagnostics& diagnostics) {
    const Value word = entry.value(0);
    if (std::ranges::find(field.choices, word.text) == field.choices.end()) {
        const auto meant = nearest(word.text, field.choices);
        reportAt(diagnostics, word, "E0307", fmt::format("`{}` has no choice `{}`", field.name, word.text),
                 meant.empty() ? "unknown choice" : didYouMean(meant))
            .help = fmt::format("it takes {}; for example `{}`", describeField(field), field.example);
        return std::nullopt;
    }
    if (entry.count() == 1) return Choice{std::string(word.text), std::nullopt};
    reportAt(diagnostics, entry.value(1), "E0306", fmt::format("`{} {}` takes no more values", field.name, word.text),
             "unexpected");
    return std::nullopt;
}

// "lens 50 mm" for `lens 50`, which would be 50 m; empty for what is usual.
std::string unusualBareNumber(const FieldInfo& field, const Entry& entry, const Header& header) {
    if (field.usualUnit.empty() || field.dimensions[0] != Dimension::length) return {};
    std::string written(field.name);
    bool unusual = false;
    for (std::size_t i = 0; i < entry.count(); ++i) {
        const Value value = entry.value(i);
        if (value.kind != ValueKind::number || value.use.valid()) return {};
        unusual |= value.number * header.length > field.usual;
        written += fmt::format(" {}", value.text);
    }
    return unusual ? fmt::format("{} {}", written, field.usualUnit) : std::string();
}

std::vector<std::pair<std::string, std::string>> textKeys(const Entry& entry) {
    std::vector<std::pair<std::string, std::string>> keys;
    for (const Key& key : entry.keys()) keys.emplace_back(key.name, key.value.text);
    return keys;
}

} // namespace

std::optional<BoundValue> bindNumeric(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    if (!field.choices.empty() && startsWithWord(entry)) return bindWordForNumber(field, entry, context.diagnostics);
    Measure measure = measureOf(field);
    const std::string unusual = unusualBareNumber(field, entry, context.tree.header);
    if (!unusual.empty()) measure.remedy = fmt::format("write `{}`", unusual);
    const MeasureReader reader(measure, context.tree.header, context.diagnostics);
    if (field.type == FieldType::integer) return bindInteger(reader, entry, context, field.name);
    const std::size_t count = field.type == FieldType::vector2 ? 2 : field.type == FieldType::vector3 ? 3 : 1;
    const auto row = reader.row(entry, 0, count);
    if (!row) return std::nullopt;
    const auto& v = row->values;
    if (!unusual.empty())
        context.diagnostics
            .warning("W0301", entry.span(),
                     fmt::format("`{}` is {} {}", field.name, plain(v[0]), siUnit(row->scale.dimension)),
                     "a number without a unit")
            .help = fmt::format("write `{}`", unusual);
    switch (field.type) {
    case FieldType::quantity:
        return Quantity{v[0], row->scale.dimension, entry.span(), textKeys(entry)};
    case FieldType::vector2:
        return Vec2d{v[0], v[1]};
    case FieldType::vector3:
        return Vec3d{v[0], v[1], v[2]};
    default:
        return v[0];
    }
}

std::optional<BoundValue> bindField(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    return field.texturable ? bindTextured(field, entry, context) : bindUntextured(field, entry, context);
}

std::optional<BoundValue> bindUntextured(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    if (!checkBlockAndKeys(field, entry, context.diagnostics)) return std::nullopt;
    switch (field.type) {
    case FieldType::integer:
    case FieldType::number:
    case FieldType::quantity:
    case FieldType::vector2:
    case FieldType::vector3:
        return bindNumeric(field, entry, context);
    case FieldType::toggle:
    case FieldType::choice:
    case FieldType::words:
    case FieldType::text:
    case FieldType::file:
        return bindWord(field, entry, context);
    case FieldType::points:
    case FieldType::numbers:
    case FieldType::indexRows:
    case FieldType::sharpRow:
    case FieldType::table:
    case FieldType::namedNumbers:
        return bindList(field, entry, context);
    case FieldType::spectrum:
    case FieldType::complexIndex:
        return bindOptical(field, entry, context);
    case FieldType::place:
        return bindPlace(field, entry, context);
    case FieldType::reference:
        return bindReference(field, entry, context);
    case FieldType::weighted:
        return bindWeighted(field, entry, context);
    case FieldType::transform:
        return bindTransformField(field, entry, context);
    case FieldType::stop:
        return bindStop(field, entry, context);
    case FieldType::moments:
        break; // several values: bind() itself
    }
    return std::nullopt;
}

} // namespace abbe::schema
