#include "guiding/guide_training.h"

namespace abbe {

namespace {

constexpr std::size_t kLeastVertices = 64; // of a cell
constexpr int kSweeps = 6;                 // of light from cell to cell

} // namespace

GivenOff::GivenOff(std::span<const PilotVertex> vertices) : vertices_(vertices), cells_(vertices.size(), kNone) {
    std::vector<SpaceTree::Place> places;
    for (std::uint32_t i = 0; i < vertices.size(); ++i)
        if (vertices[i].spreads) places.push_back({vertices[i].p, vertices[i].face, i});
    const SpaceTree tree(places, kLeastVertices);
    for (std::uint32_t cell = 0; cell < tree.leaves(); ++cell)
        for (const SpaceTree::Place& place : tree.members(places, cell)) cells_[place.number] = cell;
    for (int sweep = 0; sweep < kSweeps; ++sweep) spread(tree.leaves());
}

float GivenOff::arriving(std::size_t vertex) const {
    const PilotVertex& v = vertices_[vertex];
    if (!v.goesOn) return v.beyond;
    const std::size_t next = vertex + 1;
    const bool known = cells_[next] != kNone && !radiance_.empty();
    return v.beyond + vertices_[next].emission + (known ? radiance_[cells_[next]] : byItself(next));
}

// What the one path has found.
float GivenOff::byItself(std::size_t vertex) const {
    return vertices_[vertex].lit + vertices_[vertex].carried * arriving(vertex);
}

void GivenOff::spread(std::size_t cells) {
    std::vector<double> sums(cells);
    std::vector<std::uint32_t> counts(cells);
    for (std::size_t i = 0; i < vertices_.size(); ++i) {
        if (cells_[i] == kNone) continue;
        sums[cells_[i]] += static_cast<double>(byItself(i));
        ++counts[cells_[i]];
    }
    radiance_.resize(cells);
    for (std::size_t c = 0; c < cells; ++c) radiance_[c] = counts[c] > 0 ? static_cast<float>(sums[c] / counts[c]) : 0;
}

} // namespace abbe
