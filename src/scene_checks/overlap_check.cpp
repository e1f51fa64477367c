// Whether two solids of one priority cross. Along a line through both, solids that lie in one another or apart have
// stretches inside that do, too: stretches that overlap in part tell of solids that do so. Lines are drawn through the
// box that both share, which is the smaller, the smaller the overlap, so that few lines find it. What touches, or lies
// in one another with faces in common, has stretches that are nested to within rounding.
#include "scene_checks/checks.h"
#include "scene_checks/wording.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::checks {

namespace {

struct Pair {
    std::size_t a = 0, b = 0;
    Bounds3 box; // that both share
};

// Equal where it matters: overlapping bodies of one glass look like one.
bool sameSubstance(const Material& a, const Material& b) {
    if (&a == &b) return true;
    if (a.interior() != b.interior() || a.absorption() != b.absorption()) return false;
    constexpr double kNothing = 1e-4; // no ray is bent by as much as a pixel
    return std::ranges::all_of(std::array{450., 550., 650.},
                               [&](double nm) { return std::abs(a.ior()->at(nm) - b.ior()->at(nm)) < kNothing; });
}

Bounds3 common(const Bounds3& a, const Bounds3& b) { return {max(a.lower, b.lower), min(a.upper, b.upper)}; }

bool mayCross(const Solid& a, const Solid& b) {
    return a.material->priority() == b.material->priority() && a.shape->bounds().overlaps(b.shape->bounds()) &&
           (std::isfinite(a.shape->area()) || std::isfinite(b.shape->area())) &&
           !sameSubstance(*a.material, *b.material);
}

// In the order of the lower ends along x: each is compared with those that have not ended before.
std::vector<Pair> pairsOf(const std::vector<Solid>& solids) {
    std::vector<std::size_t> order;
    for (std::size_t i = 0; i < solids.size(); ++i)
        if (solids[i].sound && !solids[i].insideObject) order.push_back(i);
    std::ranges::sort(order, {}, [&](std::size_t i) { return solids[i].shape->bounds().lower.x; });
    std::vector<Pair> pairs;
    std::vector<std::size_t> active;
    for (const std::size_t i : order) {
        const Bounds3 box = solids[i].shape->bounds();
        std::erase_if(active, [&](std::size_t j) { return solids[j].shape->bounds().upper.x < box.lower.x; });
        for (const std::size_t j : active) {
            if (pairs.size() == kMostOverlapPairs) return pairs;
            if (mayCross(solids[j], solids[i]))
                pairs.push_back({std::min(i, j), std::max(i, j), common(box, solids[j].shape->bounds())});
        }
        active.push_back(i);
    }
    return pairs;
}

// A point of both where one is entered and the other left first.
std::optional<double> crossing(const std::vector<Stretch>& first, const std::vector<Stretch>& second,
                               double tolerance) {
    const auto holds = [&](Stretch outer, Stretch inner) {
        return inner.from >= outer.from - tolerance && inner.to <= outer.to + tolerance;
    };
    for (const Stretch a : first)
        for (const Stretch b : second) {
            const Stretch both{std::max(a.from, b.from), std::min(a.to, b.to)};
            if (both.length() > tolerance && !holds(a, b) && !holds(b, a)) return (both.from + both.to) / 2;
        }
    return std::nullopt;
}

// A place where they cross, after three lines have found that they do.
std::optional<Vec3> placeOfCrossing(const SolidTree& tree, const Pair& pair, std::uint32_t lines) {
    constexpr int kWitnesses = 3;
    const double tolerance = 1e-4 * static_cast<double>(length(pair.box.diagonal()));
    int found = 0;
    for (std::uint32_t i = 1; i <= lines; ++i) {
        const EvenPoint u = evenPoint(i);
        const Vec3 through = u.within(pair.box), direction = directionOf(u.u[3], u.u[4]);
        const auto [first, second] = tree.inside(pair.a, pair.b, through, direction);
        if (!first || !second) continue;
        if (const auto at = crossing(*first, *second, tolerance); at && ++found == kWitnesses)
            return through + direction * static_cast<float>(*at);
    }
    return std::nullopt;
}

void warnOfOverlap(const Solid& a, const Solid& b, Vec3 where, const BuiltScene& built, const schema::SceneTree& tree,
                   Diagnostics& diagnostics) {
    const Span span = placeOf(b.shape, built);
    auto& warning = diagnostics.warning(
        "W0608", span,
        fmt::format("{} and {} overlap, and both have the priority {}", quotedName(a.shape, built),
                    quotedName(b.shape, built), a.material->priority()),
        fmt::format("overlaps the other one around {}", pointText(where, built, tree.headerOf(span))));
    warning.related.push_back({placeOf(a.shape, built), "the other one"});
    warning.notes.push_back("in the overlap a ray is in the one that it entered last, so what fills it depends on the "
                            "side from which it is seen");
    warning.help = fmt::format("say which of them fills it: `priority {}` in its material", a.material->priority() + 1);
}

} // namespace

void checkOverlaps(const std::vector<Solid>& solids, const BuiltScene& built, const schema::SceneTree& tree,
                   Diagnostics& diagnostics) {
    const std::vector<Pair> pairs = pairsOf(solids);
    if (pairs.empty()) return;
    constexpr std::uint32_t kLeast = 64, kMost = 4096;
    const auto lines = std::clamp(kMostOverlapLines / static_cast<std::uint32_t>(pairs.size()), kLeast, kMost);
    std::vector<std::size_t> chosen;
    for (const Pair& pair : pairs) {
        chosen.push_back(pair.a);
        chosen.push_back(pair.b);
    }
    std::ranges::sort(chosen);
    chosen.erase(std::ranges::unique(chosen).begin(), chosen.end());
    const SolidTree together(solids, chosen);
    for (const Pair& pair : pairs)
        if (const auto where = placeOfCrossing(together, pair, lines))
            warnOfOverlap(solids[pair.a], solids[pair.b], *where, built, tree, diagnostics);
}

} // namespace abbe::checks
