#include "schema/binding.h"
#include "schema/measure.h"

#include <cmath>
#include <fmt/format.h>
#include <limits>

namespace abbe::schema {

namespace {

constexpr double kLargestIndex = std::numeric_limits<std::uint32_t>::max() - 1.0;

class ListBinder {
  public:
    ListBinder(const FieldInfo& field, const Entry& entry, const BindContext& context)
        : field_(field), entry_(entry), header_(context.tree.header), diagnostics_(context.diagnostics),
          reader_(measureOf(field), context.tree.header, context.diagnostics) {}

    std::optional<BoundValue> points() {
        std::vector<double> flat;
        if (!collect(3, flat)) return std::nullopt;
        std::vector<Vec3d> points(flat.size() / 3);
        for (std::size_t i = 0; i < points.size(); ++i) points[i] = {flat[3 * i], flat[3 * i + 1], flat[3 * i + 2]};
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
            if (key.value.kind != ValueKind::number || !(key.value.number >= 0)) {
                reportAt(diagnostics_, key.value, "E0303", "a sharpness is a number from 0 on",
                         "10 is infinitely sharp");
                return std::nullopt;
            }
            row.sharpness = key.value.number;
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
                if (value.kind == ValueKind::number)
                    cell.number = value.number;
                else
                    cell.text = value.text;
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

    // All numbers of the line or of its rows, in SI units; each row a multiple of `step` long.
    bool collect(std::size_t step, std::vector<double>& out) {
        if (!entry_.hasBlock()) {
            if (!append(entry_, step, out)) return false;
        } else {
            if (entry_.count() > 0) {
                report(diagnostics_, entry_.span(), "E0306",
                       fmt::format("`{}` takes numbers in its line or in rows", field_.name), "not both");
                return false;
            }
            for (const Node child : entry_.node()->children())
                if (!isRow(child) || !append(Entry(child), step, out)) return false;
        }
        if (!out.empty()) return true;
        empty();
        return false;
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
        const std::size_t count = row.valueCount();
        if (count < 3) {
            report(diagnostics_, row.headSpan(), "E0309", "a face needs at least three vertices",
                   fmt::format("has {}", count));
            return false;
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (row.allNumbers() && isIndex(row.numbers()[i])) // the fast path of packed rows
                rows.indices.push_back(static_cast<std::uint32_t>(row.numbers()[i]));
            else if (!addIndex(row.value(i), rows.indices))
                return false;
        }
        rows.counts.push_back(static_cast<std::uint32_t>(count));
        return true;
    }

    static bool isIndex(double x) { return x >= 0 && x == std::floor(x) && x <= kLargestIndex; }

    bool addIndex(const Value& value, std::vector<std::uint32_t>& out) {
        if (value.kind != ValueKind::number || !isIndex(value.number)) return badIndex(value);
        out.push_back(static_cast<std::uint32_t>(value.number));
        return true;
    }

    bool badIndex(const Value& value) {
        const bool isNumber = value.kind == ValueKind::number;
        const std::string_view why = !isNumber                      ? "not a number"
                                     : value.number < 0             ? "is negative"
                                     : value.number > kLargestIndex ? "is too large"
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
