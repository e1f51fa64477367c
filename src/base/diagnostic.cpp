#include "base/diagnostic.h"

#include <fmt/format.h>

namespace abbe {

namespace {
constexpr const char* kNotListed = "W0199";
}

void Diagnostics::count(Severity severity, std::size_t number) {
    (severity == Severity::error ? errors_ : warnings_) += number;
}

Diagnostic& Diagnostics::add(Diagnostic d) {
    count(d.severity, 1);
    std::size_t& listed = listed_[d.code];
    if (listed < kMostOfACode) {
        ++listed;
        return list_.emplace_back(std::move(d));
    }
    if (listed == kMostOfACode && d.code != kNotListed) {
        ++listed;
        warning(kNotListed, d.span, fmt::format("{} is reported more than {} times", d.code, kMostOfACode),
                "from here on it is counted, but not listed");
    }
    return unlisted_ = std::move(d);
}

void Diagnostics::addAll(const Diagnostics& others) {
    std::size_t errors = others.errors_, warnings = others.warnings_;
    for (const Diagnostic& d : others.list_) {
        add(d);
        --(d.severity == Severity::error ? errors : warnings);
    }
    count(Severity::error, errors);
    count(Severity::warning, warnings);
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
