#include "base/diagnostic_fixes.h"

#include "base/diagnostic_order.h"

#include <algorithm>
#include <map>

namespace abbe {

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
