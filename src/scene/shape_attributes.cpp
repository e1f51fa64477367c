// What is written in place for the points of meshes and cages.
#include "scene/shape_types.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

bool addAttributes(const std::vector<schema::NamedNumbers>& stated, bool ofFile, std::size_t points,
                   std::vector<MeshAttribute>& to, Diagnostics& diagnostics) {
    for (const schema::NamedNumbers& one : stated) {
        const auto fault = [&](std::string message, std::string label) -> Diagnostic& {
            return diagnostics.error("E0737", one.span, std::move(message), std::move(label));
        };
        if (ofFile) {
            fault("`attribute` belongs to `points`", "here the points are those of a file").help =
                "a PLY file has attributes of its own: its vertex properties";
            return false;
        }
        if (std::ranges::find(to, one.name, &MeshAttribute::name) != to.end()) {
            fault(fmt::format("the attribute `{}` is there twice", one.name), "for the second time");
            return false;
        }
        const std::size_t count = one.values.size();
        if (count != points && count != 3 * points) {
            fault(fmt::format("the attribute `{}` has {} numbers for {} points", one.name, count, points),
                  fmt::format("one for each are {}, three are {}", points, 3 * points));
            return false;
        }
        MeshAttribute& made = to.emplace_back(MeshAttribute{one.name, count == points ? 1 : 3, {}});
        for (const double x : one.values) made.values.push_back(static_cast<float>(x));
        if (std::ranges::all_of(made.values, [](float x) { return std::isfinite(x); })) continue;
        fault(fmt::format("the attribute `{}` has a number that is too large", one.name), "beyond 3e38");
        return false;
    }
    return true;
}

bool addPointData(const MeshParams& params, bool ofFile, MeshData& mesh, Span span, Diagnostics& diagnostics) {
    const std::vector<double>& uvs = params.uvs;
    if (!uvs.empty() && ofFile) {
        diagnostics.error("E0611", span, "`uvs` belong to `points`: a file has its own", "damaged mesh");
        return false;
    }
    if (!uvs.empty() && uvs.size() != 2 * mesh.positions.size()) {
        diagnostics.error("E0611", span,
                          fmt::format("`uvs` are two numbers for each point, but there are {} for {} points",
                                      uvs.size(), mesh.positions.size()),
                          "damaged mesh");
        return false;
    }
    for (std::size_t i = 0; i < uvs.size(); i += 2)
        mesh.uvs.push_back({static_cast<float>(uvs[i]), static_cast<float>(uvs[i + 1])});
    return addAttributes(params.attributes, ofFile, mesh.positions.size(), mesh.attributes, diagnostics);
}

} // namespace abbe
