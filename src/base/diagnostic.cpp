#include "base/diagnostic.h"

#include <fmt/format.h>

namespace abbe {

Diagnostic& Diagnostics::add(Diagnostic d) {
    if (d.severity == Severity::error) ++errors_;
    return list_.emplace_back(std::move(d));
}

Diagnostic& Diagnostics::error(std::string code, Span span, std::string message, std::string label) {
    return add({Severity::error, std::move(code), std::move(message), span, std::move(label), {}, {}, {}, {}});
}

Diagnostic& Diagnostics::warning(std::string code, Span span, std::string message, std::string label) {
    return add({Severity::warning, std::move(code), std::move(message), span, std::move(label), {}, {}, {}, {}});
}

SceneError::SceneError(Diagnostics d)
    : std::runtime_error(fmt::format("the scene has {} errors", d.errorCount())), diagnostics_(std::move(d)) {}

} // namespace abbe
