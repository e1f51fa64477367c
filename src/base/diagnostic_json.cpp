#include "base/diagnostic_format.h"
#include "base/diagnostic_order.h"
#include "base/json_text.h"

#include <fmt/format.h>

namespace abbe {

namespace {

// LSP counts lines from 0 and characters in UTF-16 units.
std::string position(const SourceMap& sources, FileId file, std::uint32_t offset) {
    return fmt::format("{{\"line\":{},\"character\":{}}}", sources.lineColumn(file, offset).line - 1,
                       sources.utf16Column(file, offset));
}

std::string range(const SourceMap& sources, Span span) {
    return fmt::format("{{\"start\":{},\"end\":{}}}", position(sources, span.file, span.begin),
                       position(sources, span.file, span.end));
}

std::string relatedInformation(const Diagnostic& d, const SourceMap& sources) {
    std::string list;
    for (const Label& label : d.related) {
        if (!label.span.valid()) continue;
        list += fmt::format("{}{{\"location\":{{\"uri\":{},\"range\":{}}},\"message\":{}}}", list.empty() ? "" : ",",
                            jsonText(sources.path(label.span.file)), range(sources, label.span), jsonText(label.text));
    }
    return list;
}

std::string extraData(const Diagnostic& d, const SourceMap& sources) {
    std::string notes, fixes;
    for (const std::string& note : d.notes) notes += fmt::format("{}{}", notes.empty() ? "" : ",", jsonText(note));
    for (const FixIt& fix : d.fixes)
        fixes += fmt::format("{}{{\"range\":{},\"newText\":{}}}", fixes.empty() ? "" : ",", range(sources, fix.span),
                             jsonText(fix.replacement));
    return fmt::format("{{\"label\":{},\"notes\":[{}],\"help\":{},\"fixes\":[{}]}}", jsonText(d.label), notes,
                       jsonText(d.help), fixes);
}

} // namespace

std::string formatJson(const Diagnostics& diagnostics, const SourceMap& sources) {
    std::string list;
    for (const Diagnostic* d : sortedByPlace(diagnostics)) {
        list += list.empty() ? "\n" : ",\n";
        const std::string path = d->span.valid() ? jsonText(sources.path(d->span.file)) : "null";
        const std::string place = d->span.valid() ? range(sources, d->span)
                                                  : "{\"start\":{\"line\":0,\"character\":0},\"end\":{\"line\":0,"
                                                    "\"character\":0}}";
        const std::string message = d->label.empty() ? d->message : fmt::format("{} ({})", d->message, d->label);
        list += fmt::format("{{\"path\":{},\"range\":{},\"severity\":{},\"code\":{},\"source\":\"abbe\",\"message\":{},"
                            "\"relatedInformation\":[{}],\"data\":{}}}",
                            path, place, d->severity == Severity::error ? 1 : 2, jsonText(d->code), jsonText(message),
                            relatedInformation(*d, sources), extraData(*d, sources));
    }
    return fmt::format("[{}{}]\n", list, list.empty() ? "" : "\n");
}

} // namespace abbe
