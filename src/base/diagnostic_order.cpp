#include "base/diagnostic_order.h"

#include <algorithm>
#include <tuple>

namespace abbe {

std::vector<const Diagnostic*> sortedByPlace(const Diagnostics& diagnostics) {
    std::vector<const Diagnostic*> sorted;
    for (const Diagnostic& d : diagnostics.all()) sorted.push_back(&d);
    const auto place = [](const Diagnostic* d) { return std::tuple(d->span.valid(), d->span.file, d->span.begin); };
    std::stable_sort(sorted.begin(), sorted.end(), [&](auto* a, auto* b) { return place(a) < place(b); });
    return sorted;
}

} // namespace abbe
