#include "scene/shape_displacement.h"

#include "base/diagnostic.h"

#include <cmath>
#include <fmt/format.h>
#include <set>

namespace abbe {

namespace {

// Tiles without a file that faces of the cage lie in, by the middle of the face.
std::set<int> uncoveredTiles(const SubdivisionCage& cage, const Texture& map) {
    std::set<int> tiles;
    std::size_t first = 0;
    for (const std::uint32_t size : cage.faceSizes) {
        Vec2 sum;
        for (std::size_t i = 0; i < size; ++i) sum = sum + cage.uvs[cage.uvCorners[first + i]];
        first += size;
        const Vec2 middle = sum * (1 / static_cast<float>(size));
        if (!map.covers(middle))
            tiles.insert(1001 + static_cast<int>(std::floor(middle.x)) + 10 * static_cast<int>(std::floor(middle.y)));
    }
    return tiles;
}

bool fits(const Displacement& d, const SubdivisionCage& cage, Span span, Diagnostics& diagnostics) {
    if (d.map->channels() < d.channels()) {
        diagnostics.error("E0671", span, "a vector displacement needs a map with three channels", "the map has one");
        return false;
    }
    const bool image = d.map->needsUv();
    if (!image && d.space != Displacement::Space::tangent) return true;
    if (cage.uvCorners.empty()) {
        diagnostics
            .error("E0670", span,
                   image ? "an image displaces along texture coordinates, and this cage has none"
                         : "a displacement in tangent space needs texture coordinates, and this cage has none",
                   "nothing says where the map lies")
            .help = "give the cage `vt` in its OBJ file or `uvs`, or displace with `map noise`, which needs none";
        return false;
    }
    const std::set<int> missing = uncoveredTiles(cage, *d.map);
    if (missing.empty()) return true;
    diagnostics.error(
        "E0672", span, fmt::format("the map has no tile {}", *missing.begin()),
        missing.size() == 1
            ? "faces of this shape lie in it"
            : fmt::format("faces of this shape lie in it and in {} others that are missing", missing.size() - 1));
    return false;
}

} // namespace

std::optional<DisplacementChoice> chooseDisplacement(const DisplacementParams& p, const Texture* map,
                                                     const SubdivisionCage& cage, Diagnostics& diagnostics) {
    DisplacementChoice choice;
    if (!p.displacement) return choice;
    const Span span = p.displacement->span;
    if (!map) {
        if (p.displacementMap.valid()) return std::nullopt; // reported
        diagnostics.error("E0207", span, "`displacement` needs a `map`", "is missing here").help =
            "for example `displacement 2 mm { map noise { scale 1 cm } }`";
        return std::nullopt;
    }
    const bool vector = p.displacementKind && p.displacementKind->word == "vector";
    if (p.displacementSpace && !vector) {
        diagnostics.error("E0310", span, "`space` belongs to vector displacement", "this one is scalar").help =
            "write `kind vector`, or leave `space` out: a scalar moves along the normal";
        return std::nullopt;
    }
    Displacement& d = choice.displacement;
    d.space = !vector                                                        ? Displacement::Space::normal
              : p.displacementSpace && p.displacementSpace->word == "object" ? Displacement::Space::object
                                                                             : Displacement::Space::tangent;
    d.amount = p.displacement->value;
    d.midpoint = p.midpoint.value_or(vector ? 0 : 0.5);
    d.map = map;
    choice.moves = d.amount != 0;
    if (!fits(d, cage, span, diagnostics)) return std::nullopt;
    return choice;
}

} // namespace abbe
