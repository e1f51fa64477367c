#include "schema/entry.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::schema {

void mergeOnce(Diagnostics& diagnostics, const Diagnostics& found) {
    const auto same = [](const Diagnostic& a, const Diagnostic& b) {
        return a.span.begin == b.span.begin && a.span.end == b.span.end && a.span.file == b.span.file &&
               a.code == b.code && a.message == b.message;
    };
    for (const Diagnostic& d : found.all()) {
        const auto& known = diagnostics.all();
        if (std::ranges::none_of(known, [&](const Diagnostic& k) { return same(k, d); })) diagnostics.add(d);
    }
}

Diagnostic& report(Diagnostics& diagnostics, Span span, std::string_view code, std::string message, std::string label) {
    return diagnostics.error(std::string(code), span, std::move(message), std::move(label));
}

Diagnostic& reportAt(Diagnostics& diagnostics, const Value& value, std::string_view code, std::string message,
                     std::string label) {
    Diagnostic& d = report(diagnostics, place(value), code, std::move(message), std::move(label));
    if (value.use.valid()) d.related.push_back({value.span, "the parameter's value is here"});
    return d;
}

std::string headText(const Node& node) {
    std::string text(node.name());
    for (std::size_t i = 0; i < node.valueCount(); ++i) {
        const Value value = node.value(i);
        const std::string_view quote = value.kind == ValueKind::string ? "\"" : "";
        text += fmt::format(" {0}{1}{0}", quote, value.text);
    }
    return text;
}

std::string title(const Definition& definition) {
    const std::string_view kind = keyword(definition.kind);
    if (!definition.name.empty()) return fmt::format("`{} {}`", kind, definition.name);
    if (!definition.type || definition.type->isDefault) return fmt::format("`{}`", kind);
    return fmt::format("`{} {}`", kind, definition.type->name);
}

} // namespace abbe::schema
