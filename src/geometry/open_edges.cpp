#include "geometry/open_edges.h"

#include <algorithm>
#include <numeric>

namespace abbe {

namespace {

std::vector<std::uint32_t> welded(std::span<const Vec3> positions) {
    std::vector<std::uint32_t> order(positions.size()), result(positions.size());
    std::iota(order.begin(), order.end(), 0u);
    const auto before = [&](std::uint32_t a, std::uint32_t b) {
        const Vec3 p = positions[a], q = positions[b];
        return p.x != q.x ? p.x < q.x : p.y != q.y ? p.y < q.y : p.z < q.z;
    };
    std::ranges::sort(order, before);
    for (std::size_t i = 0; i < order.size(); ++i)
        result[order[i]] = i > 0 && !before(order[i - 1], order[i]) ? result[order[i - 1]] : order[i];
    return result;
}

} // namespace

EdgeCounter::EdgeCounter(std::span<const Vec3> positions, std::size_t sides)
    : positions_(positions), weld_(welded(positions)) {
    edges_.reserve(sides);
}

void EdgeCounter::add(std::span<const std::uint32_t> corners) {
    std::uint32_t before = weld_[corners.back()];
    for (const std::uint32_t corner : corners) {
        const std::uint32_t now = weld_[corner];
        if (now != before) edges_.push_back({std::min(before, now), std::max(before, now), before < now ? 1 : -1});
        before = now;
    }
}

OpenEdges EdgeCounter::count(std::vector<std::array<Vec3, 2>>* ends) {
    std::ranges::sort(edges_, [](const Edge& a, const Edge& b) { return a.a != b.a ? a.a < b.a : a.b < b.b; });
    OpenEdges result;
    for (std::size_t i = 0; i < edges_.size();) {
        std::size_t end = i;
        int sum = 0;
        for (; end < edges_.size() && edges_[end].a == edges_[i].a && edges_[end].b == edges_[i].b; ++end)
            sum += edges_[end].side;
        const bool open = end == i + 1, turned = !open && sum != 0;
        result.open += open;
        result.turned += turned;
        if (open || turned) {
            const std::array<Vec3, 2> both{positions_[edges_[i].a], positions_[edges_[i].b]};
            if (!result.first) result.first = both;
            if (ends) ends->push_back(both);
        }
        i = end;
    }
    return result;
}

OpenEdges openEdges(const MeshData& mesh) {
    EdgeCounter counter(mesh.positions, 3 * mesh.triangles.size() + 4 * mesh.quads.size());
    for (const auto& t : mesh.triangles) counter.add(t);
    for (const auto& q : mesh.quads) counter.add(q);
    return counter.count();
}

OpenEdges openEdges(const SubdivisionCage& cage) {
    EdgeCounter counter(cage.positions);
    std::size_t first = 0;
    for (std::size_t face = 0; face < cage.faceSizes.size(); ++face) {
        const std::size_t size = cage.faceSizes[face];
        if (std::ranges::find(cage.holes, face) == cage.holes.end())
            counter.add(std::span(cage.corners).subspan(first, size));
        first += size;
    }
    return counter.count();
}

} // namespace abbe
