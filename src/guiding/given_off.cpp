#include "guiding/guide_training.h"

#include <algorithm>

namespace abbe {

namespace {

constexpr std::size_t kLeastVertices = 32; // of a cell
constexpr int kSweeps = 6;                 // of light from cell to cell

// Of vertices that keep the light that is found there, and of all in media.
std::vector<SpaceTree::Place> placesOf(std::span<const PilotVertex> vertices) {
    std::vector<SpaceTree::Place> places;
    places.reserve(vertices.size());
    for (std::uint32_t i = 0; i < vertices.size(); ++i)
        if (vertices[i].spreads || vertices[i].face == kInMedium)
            places.push_back({vertices[i].p, vertices[i].face, i});
    return places;
}

} // namespace

GivenOff::GivenOff(std::span<const PilotVertex> vertices) : GivenOff(vertices, placesOf(vertices)) {}

GivenOff::GivenOff(std::span<const PilotVertex> vertices, std::vector<SpaceTree::Place> places)
    : vertices_(vertices), tree_(places, kLeastVertices), cells_(vertices.size(), kNone) {
    for (std::uint32_t cell = 0; cell < tree_.leaves(); ++cell)
        for (const SpaceTree::Place& place : tree_.members(places, cell)) cells_[place.number] = cell;
    spread(tree_.leaves());
}

float GivenOff::arriving(std::size_t vertex) const {
    const Source from = source(vertex);
    return from.known + (from.cell == kNone ? 0 : from.share * radiance_[from.cell]);
}

// From vertices that keep no light, as mirrors do, on to the first one that does.
GivenOff::Source GivenOff::source(std::size_t vertex) const {
    Source from;
    for (from.share = 1;; ++vertex) {
        const PilotVertex& v = vertices_[vertex];
        from.known += from.share * v.beyond;
        if (!v.goesOn) return from;
        const PilotVertex& next = vertices_[vertex + 1];
        from.known += from.share * next.emission;
        if (next.spreads) {
            from.cell = cells_[vertex + 1];
            return from;
        }
        from.known += from.share * next.lit;
        from.share *= next.carried;
    }
}

// Sweeps over all vertices with a cell: what they give off is what they scatter of light that was found there, and a
// share of what the cell gives off from which they got the rest. In the first sweep that is what the path itself found.
void GivenOff::spread(std::size_t cells) {
    std::vector<Source> sources; // of what a vertex gives off
    std::vector<std::uint32_t> owners;
    std::vector<float> found(vertices_.size()); // what a vertex gives off by its path alone
    for (std::size_t i = vertices_.size(); i-- > 0;) {
        const PilotVertex& v = vertices_[i];
        found[i] = v.lit + v.carried * (v.beyond + (v.goesOn ? vertices_[i + 1].emission + found[i + 1] : 0));
        if (cells_[i] == kNone) continue;
        Source s = source(i);
        s.known = v.lit + v.carried * s.known;
        s.share *= v.carried;
        sources.push_back(s);
        owners.push_back(cells_[i]);
    }
    std::vector<double> sums(cells), counts(cells);
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
        if (cells_[i] == kNone) continue;
        sums[cells_[i]] += static_cast<double>(found[i]);
        ++counts[cells_[i]];
    }
    radiance_.resize(cells);
    for (int sweep = 1;; ++sweep) {
        for (std::size_t c = 0; c < cells; ++c)
            radiance_[c] = counts[c] > 0 ? static_cast<float>(sums[c] / counts[c]) : 0;
        if (sweep == kSweeps) break;
        std::ranges::fill(sums, 0.0);
        for (std::size_t i = 0; i < sources.size(); ++i) {
            const Source& s = sources[i];
            sums[owners[i]] += static_cast<double>(s.cell == kNone ? s.known : s.known + s.share * radiance_[s.cell]);
        }
    }
}

} // namespace abbe
