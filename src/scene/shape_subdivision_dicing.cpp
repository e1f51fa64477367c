#include "scene/shape_subdivision.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

std::string millions(std::uint64_t n) {
    return n < 1'000'000 ? fmt::format("{} triangles", n)
                         : fmt::format("{:.1f} million triangles", static_cast<double>(n) * 1e-6);
}

} // namespace

std::optional<Dicing> dicingOf(const schema::Quantity& q, Diagnostics& diagnostics) {
    Dicing dicing;
    dicing.rate = q.value;
    dicing.mode = q.dimension == schema::Dimension::pixels   ? Dicing::Mode::pixels
                  : q.dimension == schema::Dimension::length ? Dicing::Mode::length
                                                             : Dicing::Mode::level;
    const bool level = dicing.mode == Dicing::Mode::level;
    if (!q.keys.empty() && dicing.mode != Dicing::Mode::pixels) {
        diagnostics.error("E0210", q.span, "`camera=` belongs to `dicing` in pixels", "no pixels are measured here")
            .help = "write `dicing 0.5 px camera=main`, or leave it out";
        return std::nullopt;
    }
    if (level && (q.value != std::floor(q.value) || q.value > SubdivisionSurface::kMaxLevel)) {
        diagnostics
            .error("E0303", q.span, "without a unit `dicing` is a level, a whole number from 0 to 10",
                   fmt::format("is {:g}", q.value))
            .help = "for the length of edges write `dicing 0.5 px` or `dicing 2 mm`";
        return std::nullopt;
    }
    if (!level && !(q.value > 0)) {
        diagnostics.error("E0303", q.span, "`dicing` must be above 0", "is 0");
        return std::nullopt;
    }
    return dicing;
}

std::string describe(const DicingPlan& plan) {
    return fmt::format("{} in {:.0f} MiB", millions(plan.triangles), static_cast<double>(plan.bytes) / (1 << 20));
}

void warnOfBudget(const SubdivisionSurface& surface, const Dicing& dicing, const DicingPlan& plan, double memory,
                  Span span, Diagnostics& diagnostics, const Displacement* displacement) {
    const DicingPlan asked = surface.plan(dicing, ~std::uint64_t{0}, displacement);
    const std::string rate = dicing.mode == Dicing::Mode::level
                                 ? fmt::format("level {:g} instead of {:g}",
                                               std::max(0.0, dicing.rate - std::log2(plan.coarser)), dicing.rate)
                             : dicing.mode == Dicing::Mode::pixels
                                 ? fmt::format("{:.3g} px instead of {:g} px", dicing.rate * plan.coarser, dicing.rate)
                                 : fmt::format("{:.3g} m instead of {:g} m", dicing.rate * plan.coarser, dicing.rate);
    diagnostics
        .warning("W0661", span,
                 fmt::format("`dicing` would make {}, more than the {:g} MiB of `memory`", describe(asked), memory),
                 fmt::format("diced at {}: {}", rate, describe(plan)))
        .help = "raise `memory`, or ask for coarser `dicing`";
}

} // namespace abbe
