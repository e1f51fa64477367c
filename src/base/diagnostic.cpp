#include "base/diagnostic.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <tuple>

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

std::vector<const Diagnostic*> sortedByPlace(const Diagnostics& diagnostics) {
    std::vector<const Diagnostic*> sorted;
    for (const Diagnostic& d : diagnostics.all()) sorted.push_back(&d);
    const auto place = [](const Diagnostic* d) { return std::tuple(d->span.valid(), d->span.file, d->span.begin); };
    std::stable_sort(sorted.begin(), sorted.end(), [&](auto* a, auto* b) { return place(a) < place(b); });
    return sorted;
}

namespace {

// Accepted fixes by where they begin. Two that touch at an empty span count as overlapping, because their order would
// matter.
using Accepted = std::map<std::uint32_t, const FixIt*>;

bool overlaps(const Accepted& accepted, const FixIt& fix) {
    const auto next = accepted.lower_bound(fix.span.begin);
    if (next != accepted.end() && (next->first < fix.span.end || next->first == fix.span.begin)) return true;
    return next != accepted.begin() && std::prev(next)->second->span.end > fix.span.begin;
}

} // namespace

FixResult applyFixes(std::string_view text, FileId file, const Diagnostics& diagnostics) {
    FixResult result;
    Accepted accepted;
    for (const Diagnostic* d : sortedByPlace(diagnostics)) {
        const bool blocked = std::any_of(d->fixes.begin(), d->fixes.end(), [&](const FixIt& fix) {
            return fix.span.file != file || fix.span.end > text.size() || overlaps(accepted, fix);
        });
        if (blocked || d->fixes.empty()) continue;
        for (const FixIt& fix : d->fixes) accepted.emplace(fix.span.begin, &fix);
        ++result.applied;
    }
    std::size_t copied = 0;
    for (const auto& [begin, fix] : accepted) {
        if (begin < copied) continue; // within another one of the same diagnostic
        result.text.append(text.substr(copied, begin - copied)).append(fix->replacement);
        copied = fix->span.end;
    }
    result.text.append(text.substr(copied));
    return result;
}

} // namespace abbe
