#include "schema/binding.h"
#include "schema/describe.h"
#include "schema/expression.h"
#include "schema/measure.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <limits>

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
    const Header& header = context.tree.headerOf(entry.span());
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
    reportAt(
        context.diagnostics, entry.value(0), "E0305", fmt::format("`{}` must be a whole number", name),
        fmt::format("is {}", entry.value(0).kind == ValueKind::number ? std::string(entry.value(0).text) : plain(x)));
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
    const std::string unusual = unusualBareNumber(field, entry, context.tree.headerOf(entry.span()));
    if (!unusual.empty()) measure.remedy = fmt::format("write `{}`", unusual);
    const MeasureReader reader(measure, context.tree.headerOf(entry.span()), context.diagnostics);
    if (field.type == FieldType::integer) return bindInteger(reader, entry, context, field.name);
    const std::size_t count = field.type == FieldType::vector2 ? 2 : field.type == FieldType::vector3 ? 3 : 1;
    const auto row = reader.row(entry, 0, count);
    if (!row) return std::nullopt;
    const auto& v = row->values;
    if (!unusual.empty()) {
        auto& warning = context.diagnostics.warning(
            "W0301", entry.span(), fmt::format("`{}` is {} {}", field.name, plain(v[0]), siUnit(row->scale.dimension)),
            "a number without a unit");
        warning.help = fmt::format("write `{}`", unusual);
        const Span last = entry.value(entry.count() - 1).span;
        warning.fixes.push_back({{last.file, last.end, last.end}, fmt::format(" {}", field.usualUnit)});
    }
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

namespace {

constexpr double kLargestIndex = std::numeric_limits<std::uint32_t>::max() - 1.0;

class ListBinder {
  public:
    ListBinder(const FieldInfo& field, const Entry& entry, const BindContext& context)
        : field_(field), entry_(entry), header_(context.tree.headerOf(entry.span())), diagnostics_(context.diagnostics),
          reader_(measureOf(field), header_, context.diagnostics) {}

    std::optional<BoundValue> points() {
        std::vector<double> flat; // of one row: those of a large mesh together would take as much as its points
        std::vector<Vec3d> points;
        if (entry_.node()) points.reserve(entry_.node()->packedRows());
        const auto take = [&] {
            for (std::size_t i = 0; i + 2 < flat.size(); i += 3) points.push_back({flat[i], flat[i + 1], flat[i + 2]});
            flat.clear();
        };
        if (!collect(3, flat, take)) return std::nullopt;
        return points;
    }

    std::optional<BoundValue> numbers() {
        std::vector<double> flat;
        if (!collect(1, flat)) return std::nullopt;
        return flat;
    }

    std::optional<BoundValue> namedNumbers() {
        if (!entry_.node() || entry_.count() == 0 || !entry_.value(0).isText()) {
            report(diagnostics_, entry_.span(), "E0306", fmt::format("`{}` needs a name and numbers", field_.name),
                   "the name comes first")
                .help = fmt::format("for example `{}`", field_.example);
            return std::nullopt;
        }
        NamedNumbers result{std::string(entry_.value(0).text), {}, entry_.span()};
        const Entry rest(*entry_.node(), 1);
        if (!ListBinder(field_, rest, header_, diagnostics_, reader_).collect(1, result.values)) return std::nullopt;
        return result;
    }

    std::optional<BoundValue> indexRows() {
        if (!entry_.hasBlock() || entry_.count() > 0) {
            report(diagnostics_, entry_.span(), "E0309", fmt::format("`{}` needs a block of rows", field_.name),
                   "write one row per face: `{ - 0 1 2; - 0 2 3 }`");
            return std::nullopt;
        }
        IndexRows rows;
        if (const std::size_t count = entry_.node()->packedRows(); count > 0) {
            const std::size_t corners = (*entry_.node()->children().begin()).valueCount(); // mostly those of all
            rows.counts.reserve(count);
            rows.indices.reserve(count * std::min<std::size_t>(corners, 4));
        }
        for (const Node child : entry_.node()->children())
            if (!isRow(child) || !addFace(child, rows)) return std::nullopt;
        if (rows.counts.empty()) return empty();
        return rows;
    }

    std::optional<BoundValue> sharpRow() {
        SharpRow row;
        row.span = entry_.span();
        for (std::size_t i = 0; i < entry_.count(); ++i)
            if (!addIndex(entry_.value(i), row.vertices)) return std::nullopt;
        if (row.vertices.empty()) return empty();
        for (const Key& key : entry_.keys()) {
            if (key.name != "sharpness") {
                report(diagnostics_, key.nameSpan, "E0210", fmt::format("`{}` has no key `{}`", field_.name, key.name),
                       "its key is `sharpness=`");
                return std::nullopt;
            }
            const auto sharpness = plainNumber(key.value);
            if (!sharpness) return std::nullopt;
            if (!(*sharpness >= 0)) {
                reportAt(diagnostics_, key.value, "E0303", "a sharpness is a number from 0 on",
                         "10 is infinitely sharp");
                return std::nullopt;
            }
            row.sharpness = *sharpness;
        }
        return row;
    }

    std::optional<BoundValue> table() {
        TableRows table;
        table.span = entry_.span();
        table.scale = reader_.defaultScale().factor;
        if (entry_.count() > 1 || !entry_.hasBlock()) {
            report(diagnostics_, entry_.span(), "E0309", fmt::format("`{}` needs a block of rows", field_.name),
                   "only a unit may stand before it")
                .help = fmt::format("for example `{}`", field_.example);
            return std::nullopt;
        }
        if (entry_.count() == 1) {
            const auto scale = reader_.unit(entry_.value(0));
            if (!scale) return std::nullopt;
            table.scale = scale->factor;
        }
        for (const Node child : entry_.node()->children()) {
            if (field_.namedRows ? !isNamedRow(child) : !isRow(child)) return std::nullopt;
            TableRow& row = table.rows.emplace_back();
            row.span = child.headSpan();
            if (field_.namedRows) row.cells.push_back({std::nullopt, std::string(child.name()), child.nameSpan()});
            for (std::size_t i = 0; i < child.valueCount(); ++i) {
                const Value value = child.value(i);
                TableCell& cell = row.cells.emplace_back();
                cell.span = place(value);
                if (value.kind == ValueKind::number || isComputed(value)) {
                    const auto number = plainNumber(value);
                    if (!number) return std::nullopt;
                    cell.number = *number;
                } else {
                    cell.text = value.text;
                }
            }
        }
        if (table.rows.empty()) return empty();
        return table;
    }

  private:
    ListBinder(const FieldInfo& field, const Entry& entry, const Header& header, Diagnostics& diagnostics,
               const MeasureReader& reader)
        : field_(field), entry_(entry), header_(header), diagnostics_(diagnostics), reader_(reader) {}

    std::optional<BoundValue> empty() {
        auto& d =
            report(diagnostics_, entry_.span(), "E0306", fmt::format("`{}` needs numbers", field_.name), "has none");
        if (!field_.example.empty()) d.help = fmt::format("for example `{}`", field_.example);
        return std::nullopt;
    }

    bool isNamedRow(const Node& node) {
        if (!node.hasBlock() && node.keys().empty()) return true;
        report(diagnostics_, node.headSpan(), "E0309",
               fmt::format("a row of `{}` is a word and what follows it", field_.name), "no block and no keys")
            .help = fmt::format("for example `{}`", field_.example);
        return false;
    }

    bool isRow(const Node& node) {
        if (node.name() == "-" && !node.hasBlock() && node.keys().empty()) return true;
        report(diagnostics_, node.headSpan(), "E0309", fmt::format("`{}` holds rows of numbers", field_.name),
               "a row begins with `-`: `- 0 1 2`");
        return false;
    }

    // All numbers of the line or of its rows, in SI units; each row a multiple of `step` long. What `take` does is done
    // after every row.
    template <typename Take> bool collect(std::size_t step, std::vector<double>& out, Take take) {
        bool any = false;
        if (!entry_.hasBlock()) {
            if (!append(entry_, step, out)) return false;
            any = !out.empty();
            take();
        } else {
            if (entry_.count() > 0) {
                report(diagnostics_, entry_.span(), "E0306",
                       fmt::format("`{}` takes numbers in its line or in rows", field_.name), "not both");
                return false;
            }
            for (const Node child : entry_.node()->children()) {
                if (!isRow(child) || !append(Entry(child), step, out)) return false;
                any = any || !out.empty();
                take();
            }
        }
        if (any) return true;
        empty();
        return false;
    }
    bool collect(std::size_t step, std::vector<double>& out) {
        return collect(step, out, [] {});
    }

    bool append(const Entry& row, std::size_t step, std::vector<double>& out) {
        const std::size_t before = out.size();
        if (!reader_.append(row, 0, out)) return false;
        const std::size_t added = out.size() - before;
        if (added % step == 0 && (added > 0 || !row.node() || row.name() != "-")) return true;
        report(diagnostics_, row.span(), "E0306", fmt::format("a point has {} coordinates", step),
               added == 1 ? "has one number" : fmt::format("has {} numbers", added));
        return false;
    }

    bool addFace(const Node& row, IndexRows& rows) {
        if (row.allNumbers()) return addPackedFace(row, row.numbers(), rows);
        const std::size_t count = row.valueCount();
        if (count < 3) return fewVertices(row, count);
        for (std::size_t i = 0; i < count; ++i)
            if (!addIndex(row.value(i), rows.indices)) return false;
        rows.counts.push_back(static_cast<std::uint32_t>(count));
        return true;
    }

    bool addPackedFace(const Node& row, const PackedNumbers& numbers, IndexRows& rows) {
        if (numbers.size() < 3) return fewVertices(row, numbers.size());
        std::size_t i = 0;
        for (const double index : numbers) {
            if (!isIndex(index)) return badIndex(row.value(i), index);
            rows.indices.push_back(static_cast<std::uint32_t>(index));
            ++i;
        }
        rows.counts.push_back(static_cast<std::uint32_t>(numbers.size()));
        return true;
    }

    bool fewVertices(const Node& row, std::size_t count) {
        report(diagnostics_, row.headSpan(), "E0309", "a face needs at least three vertices",
               fmt::format("has {}", count));
        return false;
    }

    static bool isIndex(double x) { return x >= 0 && x == std::floor(x) && x <= kLargestIndex; }

    // A number as it is written, or what its text comes to; not a number where it is neither. Nothing after a
    // diagnostic.
    std::optional<double> plainNumber(const Value& value) {
        if (!isComputed(value)) return value.kind == ValueKind::number ? value.number : std::nan("");
        constexpr std::array plain = {Dimension::none};
        const Measure measure{field_.name, plain, -HUGE_VAL, HUGE_VAL, {}, {}};
        return MeasureReader(measure, header_, diagnostics_).number(value);
    }

    bool addIndex(const Value& value, std::vector<std::uint32_t>& out) {
        const auto number = plainNumber(value);
        if (!number) return false;
        if (!isIndex(*number)) return badIndex(value, *number);
        out.push_back(static_cast<std::uint32_t>(*number));
        return true;
    }

    bool badIndex(const Value& value, double number) {
        const std::string_view why = std::isnan(number)       ? "not a number"
                                     : number < 0             ? "is negative"
                                     : number > kLargestIndex ? "is too large"
                                                              : "is not a whole number";
        reportAt(diagnostics_, value, "E0309", "a vertex index is a whole number from 0 on", std::string(why));
        return false;
    }

    const FieldInfo& field_;
    const Entry& entry_;
    const Header& header_;
    Diagnostics& diagnostics_;
    MeasureReader reader_;
};

} // namespace

std::optional<BoundValue> bindList(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    ListBinder binder(field, entry, context);
    if (field.type == FieldType::sharpRow) return binder.sharpRow();
    if (field.type == FieldType::namedNumbers) return binder.namedNumbers();
    if (field.type == FieldType::table) return binder.table();
    if (field.type == FieldType::points) return binder.points();
    return field.type == FieldType::numbers ? binder.numbers() : binder.indexRows();
}

} // namespace abbe::schema
