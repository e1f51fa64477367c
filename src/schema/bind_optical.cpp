#include "schema/binding.h"
#include "schema/spectrum_reader.h"
#include "schema/suggest.h"

#include <array>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

constexpr std::array kPlain = {Dimension::none};

std::optional<BoundValue> bindMetal(const Entry& entry, const BindContext& context) {
    const Value name = entry.value(1);
    const ComplexIndex index = context.resolver.metal(name.text, place(name), context.diagnostics);
    return index.n && index.k ? std::optional<BoundValue>(index) : std::nullopt;
}

const Curve* bindPart(const Node& node, SpectrumRole role, const BindContext& context) {
    const SpectrumUse use{node.name(), role, kPlain};
    const auto value = readSpectrum(use, Entry(node), context.tree, context.diagnostics);
    return value ? context.resolver.curve(*value, role, context.diagnostics) : nullptr;
}

// `{ n table …; k table … }`
std::optional<BoundValue> bindParts(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    ComplexIndex index;
    Span n, k;
    for (const Node node : entry.node()->children()) {
        const bool isN = node.name() == "n";
        if (!isN && node.name() != "k") {
            report(context.diagnostics, node.nameSpan(), "E0201",
                   fmt::format("`{}` has no property `{}`", field.name, node.name()), "unknown property")
                .help = "its properties are `n` and `k`";
            return std::nullopt;
        }
        Span& seen = isN ? n : k;
        if (seen.valid()) {
            report(context.diagnostics, node.headSpan(), "E0208", fmt::format("`{}` is given twice", node.name()),
                   "second")
                .related.push_back({seen, "first"});
            return std::nullopt;
        }
        seen = node.headSpan();
        // The index of a metal is nothing like a glass's: silver's is 0.05.
        (isN ? index.n : index.k) = bindPart(node, SpectrumRole::unbounded, context);
        if (!(isN ? index.n : index.k)) return std::nullopt;
    }
    if (index.n && index.k) return index;
    report(context.diagnostics, entry.span(), "E0207", fmt::format("`{}` needs `n` and `k`", field.name),
           index.n   ? "`k` is missing"
           : index.k ? "`n` is missing"
                     : "both are missing");
    return std::nullopt;
}

std::optional<BoundValue> bindComplexIndex(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    const bool metal = entry.count() == 2 && entry.value(0).text == "metal" && entry.value(1).isText();
    if (metal && !entry.hasBlock()) return bindMetal(entry, context);
    if (entry.count() == 0 && entry.hasBlock()) return bindParts(field, entry, context);
    report(context.diagnostics, entry.span(), "E0311",
           fmt::format("`{}` needs the complex index of a metal", field.name),
           "write `metal Au` or a block with `n` and `k`");
    return std::nullopt;
}

} // namespace

std::optional<BoundValue> bindOptical(const FieldInfo& field, const Entry& entry, const BindContext& context) {
    if (field.type == FieldType::complexIndex) return bindComplexIndex(field, entry, context);
    const auto value = readSpectrum(useOf(field), entry, context.tree, context.diagnostics);
    if (!value) return std::nullopt;
    const Curve* const curve = context.resolver.curve(*value, field.role, context.diagnostics);
    return curve ? std::optional<BoundValue>(curve) : std::nullopt;
}

} // namespace abbe::schema
