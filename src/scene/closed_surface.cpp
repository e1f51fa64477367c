#include "scene/closed_surface.h"

#include "scene/shape_builder.h"

#include <algorithm>
#include <fmt/format.h>
#include <numeric>
#include <span>

namespace abbe {

namespace {

// One number for all vertices in one place.
std::vector<std::uint32_t> welded(const std::vector<Vec3>& positions) {
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

class EdgeCounter {
  public:
    explicit EdgeCounter(const std::vector<Vec3>& positions) : weld_(welded(positions)) {}

    void add(std::span<const std::uint32_t> corners) {
        std::uint32_t before = weld_[corners.back()];
        for (const std::uint32_t corner : corners) {
            const std::uint32_t now = weld_[corner];
            if (now != before) edges_.push_back({std::min(before, now), std::max(before, now), before < now ? 1 : -1});
            before = now;
        }
    }
    OpenEdges count() {
        std::ranges::sort(edges_, [](const Edge& a, const Edge& b) { return a.a != b.a ? a.a < b.a : a.b < b.b; });
        OpenEdges result;
        for (std::size_t i = 0; i < edges_.size();) {
            std::size_t end = i;
            int sum = 0;
            for (; end < edges_.size() && edges_[end].a == edges_[i].a && edges_[end].b == edges_[i].b; ++end)
                sum += edges_[end].side;
            result.open += end == i + 1;
            result.turned += end > i + 1 && sum != 0;
            i = end;
        }
        return result;
    }

  private:
    struct Edge {
        std::uint32_t a, b;
        int side;
    };
    std::vector<std::uint32_t> weld_;
    std::vector<Edge> edges_;
};

} // namespace

OpenEdges openEdges(const MeshData& mesh) {
    EdgeCounter counter(mesh.positions);
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

// Media fill what has an inside: a plane has one, below it; a disk has none.
void ShapeBuilder::checkInterior(LoadedShape& shape) {
    if (!shape.sound || !materials.holdsMedium(shape.common)) return;
    const bool own = shape.common.interior.valid();
    Span span = shape.definition->span;
    for (const schema::Node& property : shape.definition->properties)
        if (property.name() == (own ? "interior" : "material")) span = property.nameSpan();
    const schema::Reference material = shape.common.material;
    if (own && material.valid() && materials[material].interior()) {
        scene.diagnostics.error("E0725", span, "this shape is filled twice", "its material fills it already").help =
            "take a `dielectric` for the surface of an `interior`";
        shape.sound = false;
        return;
    }
    if (own && material.valid() && materials[material].isOpaque())
        scene.diagnostics.warning("W0695", span, "nothing is seen of this `interior`", "the material lets no light in")
            .help = "a medium needs a surface that light passes: `dielectric`, or `boundary` for a body without one";
    const std::string_view type = shape.definition->type->name;
    if (const std::string_view open = shape.openBecause; !open.empty()) {
        scene.diagnostics.error("E0645", span, fmt::format("this `{}` cannot hold a medium", type), std::string(open))
            .help = "a medium fills closed shapes: a sphere, a box, a cylinder with caps, a mesh without holes";
        shape.sound = false;
        return;
    }
    const OpenEdges edges = shape.mesh ? openEdges(*shape.mesh) : shape.cageEdges;
    if (edges.closed()) return;
    const auto number = [](std::uint64_t n, std::string_view what) {
        return fmt::format("{} {}", n, n == 1 ? fmt::format("edge {}", what) : fmt::format("edges {}", what));
    };
    scene.diagnostics
        .warning("W0694", span, fmt::format("this `{}` is not closed, but holds a medium", type),
                 edges.open == 0     ? number(edges.turned, "between faces that are turned against each other")
                 : edges.turned == 0 ? number(edges.open, "of a single face")
                                     : fmt::format("{}, {}", number(edges.open, "of a single face"),
                                                   number(edges.turned, "between faces turned against each other")))
        .help = "light that enters through a face and leaves through a hole takes the medium along";
}

} // namespace abbe
