// Subdivision surfaces with keys: one plan dices the cage at every step.
#include "scene/shape_deform.h"
#include "scene/shape_subdivision.h"

#include <fmt/format.h>

namespace abbe {

namespace {

// What a further step adds to a triangle, vertices and acceleration structure (docs/performance.md).
constexpr double kBytesPerStep = 70;

// The share of the memory that is left for what a still surface takes.
double stillMemory(double memory, std::size_t steps) {
    const double still = static_cast<double>(SubdivisionSurface::kBytesPerTriangle);
    return std::max(1.0, memory * still / (still + kBytesPerStep * static_cast<double>(steps - 1)));
}

} // namespace

std::unique_ptr<const Shape> placeCageKeys(SubdivisionCage cage, const CageKeys& keys, Interval shutter,
                                           const Displacement* displacement, Dicing dicing, double memory,
                                           const Transform& place, Span span, Diagnostics& diagnostics,
                                           std::vector<DicedSurface::Face>* faces) {
    const KeyGrid grid = gridOf(keys.times, shutter);
    const auto pointsAt = [&](std::size_t step) {
        return stateAt(
            keys, grid.steps[step], [](const std::vector<Vec3>& p) -> const auto& { return p; });
    };
    warnOffGrid(
        grid, [&](std::size_t i) -> const auto& { return keys.states[i]; }, pointsAt, place, span, diagnostics);
    cage.positions = pointsAt(0); // which chooses the rates, for all times
    dicing.place = place;
    const SubdivisionSurface surface(cage);
    const double least = stillMemory(memory, grid.steps.size());
    const DicingPlan plan = surface.plan(dicing, static_cast<std::uint64_t>(least * (1 << 20)), displacement);
    if (plan.coarser > 1) warnOfBudget(surface, dicing, plan, least, span, diagnostics, displacement);
    try {
        std::vector<MeshStep> steps;
        MeshData mesh;
        for (std::size_t i = 0; i < grid.steps.size(); ++i) {
            DicedSurface diced = surface.dice(plan, pointsAt(i), displacement);
            steps.push_back({std::move(diced.mesh.positions), std::move(diced.mesh.normals)});
            if (i > 0) continue;
            mesh = std::move(diced.mesh);
            *faces = std::move(diced.faces);
        }
        return placeMeshSteps(std::move(mesh), std::move(steps), place, span, diagnostics);
    } catch (const std::bad_alloc&) {
        diagnostics.error("E0404", span, "the diced surface does not fit into memory",
                          fmt::format("{} at {} steps of time", describe(plan), grid.steps.size()));
        return nullptr;
    }
}

} // namespace abbe
