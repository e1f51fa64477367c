#include "binding/diagnostic_records.h"

#include "base/diagnostic_format.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::python {

namespace {

DiagnosticRecord recordOf(const Diagnostic& d, const SourceMap& sources) {
    DiagnosticRecord record;
    record.error = d.severity == Severity::error;
    record.code = d.code;
    record.message = d.message;
    if (d.span.valid()) {
        record.file = sources.path(d.span.file);
        const LineColumn begin = sources.lineColumn(d.span.file, d.span.begin);
        const LineColumn end = sources.lineColumn(d.span.file, d.span.end);
        record.line = begin.line;
        record.column = begin.column;
        record.endLine = end.line;
        record.endColumn = end.column;
    }
    record.label = d.label;
    record.notes = d.notes;
    for (const Label& related : d.related) {
        if (!related.span.valid()) continue;
        const LineColumn at = sources.lineColumn(related.span.file, related.span.begin);
        record.notes.push_back(
            fmt::format("{}:{}:{}: {}", sources.path(related.span.file), at.line, at.column, related.text));
    }
    record.help = d.help;
    return record;
}

} // namespace

void DiagnosticLog::add(const Diagnostics& diagnostics, const SourceMap& sources) {
    if (diagnostics.all().empty()) return;
    const std::string text = formatHuman(diagnostics, sources);
    const std::scoped_lock lock(mutex_);
    for (const Diagnostic* d : sortedByPlace(diagnostics)) records_.push_back(recordOf(*d, sources));
    text_ += text;
}

std::vector<DiagnosticRecord> DiagnosticLog::records() const {
    const std::scoped_lock lock(mutex_);
    return records_;
}

std::string DiagnosticLog::text() const {
    const std::scoped_lock lock(mutex_);
    return text_;
}

bool DiagnosticLog::hasErrors() const {
    const std::scoped_lock lock(mutex_);
    return std::ranges::any_of(records_, &DiagnosticRecord::error);
}

} // namespace abbe::python
