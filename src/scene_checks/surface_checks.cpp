#include "render/light.h"
#include "scene_checks/checks.h"
#include "scene_checks/wording.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numeric>
#include <unordered_set>

namespace abbe::checks {

std::vector<Solid> refractingSolids(const BuiltScene& built) {
    std::vector<Solid> solids;
    std::unordered_set<const Shape*> known;
    for (const SurfaceUse& use : built.scene.surfaces) {
        if (!use.shape || !use.material || !use.material->ior() || !known.insert(use.shape).second) continue;
        Solid solid{use.shape, use.material, use.insideObject, readFaces(*use.shape)};
        solids.push_back(std::move(solid));
    }
    return solids;
}

namespace {

std::string edgeCount(const OpenEdges& edges) {
    const auto number = [](std::uint64_t n, std::string_view what) {
        return fmt::format("{} {} {}", n, n == 1 ? "edge" : "edges", what);
    };
    if (edges.open == 0) return number(edges.turned, "between faces that are turned against each other");
    if (edges.turned == 0) return number(edges.open, "of a single face");
    return fmt::format("{}, {}", number(edges.open, "of a single face"),
                       number(edges.turned, "between faces turned against each other"));
}

void warnOfHoles(const Solid& solid, const BuiltScene& built, const schema::SceneTree& tree, Diagnostics& diagnostics) {
    const Span span = placeOf(solid.shape, built);
    const OpenEdges& edges = solid.faces.edges;
    auto& warning = diagnostics.warning(
        "W0605", span, fmt::format("{} refracts light, but is not closed", quotedName(solid.shape, built)),
        edgeCount(edges));
    const auto& [a, b] = solid.faces.ends.front();
    const Vec3 origin = solid.insideObject ? Vec3(built.scene.origin) : Vec3();
    warning.notes.push_back(
        fmt::format("one of them runs from {} to {}{}", pointText(a - origin, built, tree.headerOf(span)),
                    pointText(b - origin, built, tree.headerOf(span)), solid.insideObject ? " of the object" : ""));
    warning.help = edges.open > 0 ? "close it, or use `thin-dielectric` for a pane without thickness"
                                  : "turn the faces so that all go round counter-clockwise seen from outside";
}

// A cavity of a solid may be a shape of its own that looks inwards.
bool isCavity(const Solid& solid, const std::vector<Solid>& all) {
    const Bounds3 inner = solid.shape->bounds();
    return std::ranges::any_of(all, [&](const Solid& other) {
        const Bounds3 outer = other.shape->bounds();
        return other.shape != solid.shape && other.insideObject == solid.insideObject && other.faces.volume >= 0 &&
               outer.contains(inner.lower) && outer.contains(inner.upper);
    });
}

} // namespace

namespace {

bool isBefore(Vec3 p, Vec3 q) { return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z; }

// Several shapes may close each other: the wall of a glass that ends where the drink begins. Takes out the edges that
// run between vertices of another one, and returns whether any are left.
bool stillOpen(Solid& solid, const std::vector<Solid>& all) {
    auto& ends = solid.faces.ends;
    for (const Solid& other : all) {
        if (other.shape == solid.shape || other.insideObject != solid.insideObject || other.faces.vertices.empty() ||
            !other.shape->bounds().overlaps(solid.shape->bounds()))
            continue;
        std::vector<Vec3> vertices(other.faces.vertices.begin(), other.faces.vertices.end());
        std::ranges::sort(vertices, isBefore);
        std::erase_if(ends, [&](const std::array<Vec3, 2>& edge) {
            return std::ranges::all_of(edge, [&](Vec3 p) { return std::ranges::binary_search(vertices, p, isBefore); });
        });
    }
    return !ends.empty();
}

// What is no mesh is tried with lines.
void checkFormulas(std::vector<Solid>& solids, const BuiltScene& built, Diagnostics& diagnostics) {
    constexpr double kChance = 0.05; // of lines that rounding sends past a rim
    std::vector<std::size_t> chosen;
    for (std::size_t i = 0; i < solids.size(); ++i)
        if (solids[i].faces.kind == FaceReport::Kind::analytic && std::isfinite(solids[i].shape->area()))
            chosen.push_back(i);
    if (chosen.empty()) return;
    const SolidTree tree(solids, chosen);
    for (const std::size_t i : chosen) {
        solids[i].sound = tree.openShare(i) < kChance;
        if (solids[i].sound) continue;
        diagnostics
            .warning("W0605", placeOf(solids[i].shape, built),
                     fmt::format("{} refracts light, but is not closed", quotedName(solids[i].shape, built)),
                     "light goes in that never comes out")
            .help = "use `thin-dielectric` for what has no thickness; `caps on` closes a cylinder or cone";
    }
}

} // namespace

void checkSurfaces(std::vector<Solid>& solids, const BuiltScene& built, const schema::SceneTree& tree,
                   Diagnostics& diagnostics) {
    checkFormulas(solids, built, diagnostics);
    for (Solid& solid : solids) {
        if (solid.faces.kind != FaceReport::Kind::faces) continue;
        if (!solid.faces.edges.closed()) {
            solid.sound = false;
            // Where there is an interior, W0694 has said it.
            if (!solid.material->interior() && stillOpen(solid, solids)) warnOfHoles(solid, built, tree, diagnostics);
            continue;
        }
        if (solid.faces.volume >= 0) continue;
        solid.sound = false;
        if (isCavity(solid, solids)) continue;
        const std::string name = quotedName(solid.shape, built);
        diagnostics
            .warning("W0606", placeOf(solid.shape, built), fmt::format("{} is inside out", name),
                     "its faces look inwards")
            .help = "reverse the order of the corners of its faces: counter-clockwise seen from outside; as it is, "
                    "light that enters is taken to leave";
    }
}

namespace {

// Whether the light leaves on one side, which is that of the normals.
bool emitsOutwardsAlone(const Light& light) {
    const PlacedLight* const placed = light.asPlaced();
    const auto origin = !placed ? std::nullopt : placed->sampleOrigin(0, {0.5f, 0.5f}, Wavelengths::sample(0.5f), 0);
    return origin && origin->sides == LightOrigin::Sides::front;
}

} // namespace

void checkEmittingSides(const BuiltScene& built, Diagnostics& diagnostics) {
    for (const auto& light : built.scene.lights) {
        const Span span = placeOf(light.get(), built);
        if (!span.valid() || !emitsOutwardsAlone(*light)) continue;
        for (const SurfaceUse& use : built.scene.surfaces) {
            if (!use.shape || placeOf(use.shape, built) != span) continue;
            const FaceReport faces = readFaces(*use.shape);
            if (faces.kind != FaceReport::Kind::faces || !faces.edges.closed() || faces.volume >= 0) break;
            diagnostics
                .warning("W0607", span, fmt::format("{} emits light inwards alone", quotedName(use.shape, built)),
                         "its faces look inwards, and the other side is dark")
                .help = "reverse the order of the corners of its faces: counter-clockwise seen from outside";
            break;
        }
    }
}

namespace {

// The first of some solids around the camera; `none` is their number.
std::size_t around(Vec3 eye, const std::vector<Solid>& solids, const std::vector<std::size_t>& candidates) {
    if (candidates.empty()) return solids.size();
    const SolidTree tree(solids, candidates);
    const auto found = std::ranges::find_if(candidates, [&](std::size_t i) { return tree.contains(i, eye); });
    return found == candidates.end() ? solids.size() : *found;
}

void warnOfSolidAround(const Solid& solid, double index, const BuiltScene& built, Diagnostics& diagnostics) {
    auto& warning = diagnostics.warning("W0609", built.cameraSpan,
                                        fmt::format("the camera is inside of {}", quotedName(solid.shape, built)),
                                        fmt::format("it looks through a solid of index {:.3g}", index));
    warning.help = "move the camera or the shape, or make the camera's `from` right if a unit is missing";
    warning.related.push_back({placeOf(solid.shape, built), "this shape"});
}

} // namespace

bool checkAroundCamera(const std::vector<Solid>& solids, const BuiltScene& built, Diagnostics& diagnostics) {
    constexpr double kHeliumLine = 587.6; // nm
    constexpr double kLiquids = 1.4;      // a camera may well be under water
    const Vec3 eye = built.scene.eye;
    const auto indexOf = [&](const Solid& solid) { return solid.material->ior()->at(kHeliumLine); };
    std::vector<std::size_t> candidates;
    for (std::size_t i = 0; i < solids.size(); ++i)
        if (solids[i].sound && !solids[i].insideObject && indexOf(solids[i]) > kLiquids &&
            solids[i].shape->bounds().contains(eye))
            candidates.push_back(i);
    if (const std::size_t i = around(eye, solids, candidates); i < solids.size())
        warnOfSolidAround(solids[i], indexOf(solids[i]), built, diagnostics);

    std::vector<Solid> bodies;
    for (const SurfaceUse& use : built.scene.surfaces)
        if (use.shape && use.material && !use.insideObject && use.material->isOpaque() &&
            std::isfinite(use.shape->area()) && use.shape->bounds().contains(eye))
            bodies.push_back({use.shape, use.material, false, {}, true});
    candidates.resize(bodies.size());
    std::iota(candidates.begin(), candidates.end(), std::size_t{0});
    return around(eye, bodies, candidates) < bodies.size();
}

} // namespace abbe::checks
