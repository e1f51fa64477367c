#include "io/ply_vertices.h"

#include "io/ply_cursor.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

bool PlyColumns::has(std::string_view name) const {
    const auto found = std::ranges::find(names, name);
    return found != names.end() && present[static_cast<std::size_t>(found - names.begin())];
}

namespace {

constexpr std::size_t kUnknown = ~std::size_t{0};

// For each property of the file where its value goes; the first one of a name counts.
std::vector<std::size_t> targetsOf(const PlyElement& e, PlyColumns& columns) {
    std::vector<std::size_t> targets;
    columns.present.assign(columns.names.size(), false);
    columns.count = e.count;
    for (const PlyProperty& p : e.properties) {
        const auto found = std::ranges::find(columns.names, p.name);
        const auto i = static_cast<std::size_t>(found - columns.names.begin());
        const bool taken = !p.listCount && found != columns.names.end() && !columns.present[i];
        targets.push_back(taken ? i : kUnknown);
        if (taken) columns.present[i] = true;
    }
    return targets;
}

} // namespace

void visitPlyVertices(std::string_view bytes, const std::string& name, std::vector<std::string_view> properties,
                      const PlyColumnsVisitor& begin, const PlyVertexVisitor& visit) {
    const PlyHeader header = parsePlyHeader(bytes, name, PlyContent::points);
    PlyCursor cursor(header, bytes, name);
    PlyColumns columns{std::move(properties), {}, 0};
    for (const PlyElement& e : header.elements) {
        if (e.name != "vertex") {
            cursor.skip(e);
            continue;
        }
        const std::vector<std::size_t> targets = targetsOf(e, columns);
        begin(columns);
        std::vector<double> values(columns.names.size(), 0.0);
        for (std::uint64_t i = 0; i < e.count; ++i) {
            for (std::size_t k = 0; k < targets.size(); ++k) {
                if (targets[k] == kUnknown) {
                    cursor.skip(e.properties[k]);
                    continue;
                }
                const double value = values[targets[k]] = cursor.scalar(e.properties[k].type);
                if (!std::isfinite(value))
                    cursor.fail(fmt::format("`{}` of vertex {} is not finite", e.properties[k].name.substr(0, 40), i));
            }
            if (!visit(i, values)) return;
        }
        return;
    }
}

} // namespace abbe
