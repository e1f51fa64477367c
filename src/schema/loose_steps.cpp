#include "schema/loose_steps.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace abbe::schema {

std::span<const std::string_view> transformSteps() {
    static constexpr auto steps =
        std::to_array<std::string_view>({"translate", "rotate", "scale", "matrix", "look-at"});
    return steps;
}

bool isTransformStep(std::string_view word) {
    return std::ranges::find(transformSteps(), word) != transformSteps().end();
}

void reportLooseSteps(std::string_view owner, const std::vector<Node>& steps, bool given, Diagnostics& diagnostics) {
    const Node& first = steps.front();
    constexpr std::size_t kShown = 8;
    const std::span shown = std::span(steps).first(std::min(steps.size(), kShown));
    std::string block;
    for (const Node& step : shown) block += (block.empty() ? "" : "; ") + headText(step);
    if (shown.size() < steps.size()) block += "; …";
    Diagnostic& d = report(diagnostics, first.nameSpan(), "E0201",
                           fmt::format("{} has no property `{}`", owner, first.name()), "a step of a transform");
    for (const Node& step : shown.subspan(1)) d.related.push_back({step.nameSpan(), "another one"});
    d.help = given ? fmt::format("write `{}` into the block of its `transform`", block)
                   : fmt::format("write `transform {{ {} }}`", block);
    // `scale 2` of a light may be meant as a factor of its amount.
    const bool certain = first.name() == "translate" || first.name() == "rotate";
    if (!given && certain && steps.size() == 1 && !first.damaged() && !first.hasBlock()) {
        d.fixes.push_back({{first.nameSpan().file, first.nameSpan().begin, first.nameSpan().begin}, "transform { "});
        d.fixes.push_back({{first.headSpan().file, first.headSpan().end, first.headSpan().end}, " }"});
    }
}

} // namespace abbe::schema
