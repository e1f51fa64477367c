#include "io/ply_points.h"

#include "base/memory_limit.h"
#include "io/array_geometry.h"
#include "io/file.h"
#include "io/ply_format.h"

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

namespace {

class PointReader {
  public:
    PointReader(std::string_view bytes, const std::string& name)
        : header_(parsePlyHeader(bytes, name, PlyContent::points)), cursor_(header_, bytes, name) {}

    PointFile read() {
        for (const PlyElement& e : header_.elements) {
            if (e.name == "vertex")
                vertices(e);
            else if (e.name == "curve" || e.name == "strand")
                strands(e);
            else
                cursor_.skip(e);
        }
        checkSizes();
        return std::move(file_);
    }

  private:
    void vertices(const PlyElement&);
    void store(const PlyProperty&, float value, float radiusScale);
    void strands(const PlyElement&);
    void pointList(const PlyProperty&);
    void pointCount(const PlyProperty&);
    void checkSizes();

    PlyHeader header_;
    PlyCursor cursor_;
    PointFile file_;
    bool byIndex_ = false;
};

// What the value of a property called so must be multiplied by to be the radius; 0 for other properties.
float radiusScaleOf(const PlyProperty& p) {
    if (p.listCount) return 0;
    return p.name == "radius" ? 1.f : p.name == "width" ? 0.5f : 0.f;
}

void PointReader::store(const PlyProperty& p, float value, float radiusScale) {
    Vec3& at = file_.positions.back();
    if (p.role == PlyRole::x) at.x = value;
    if (p.role == PlyRole::y) at.y = value;
    if (p.role == PlyRole::z) at.z = value;
    if (header_.normals && p.role == PlyRole::nx) file_.normals.back().x = value;
    if (header_.normals && p.role == PlyRole::ny) file_.normals.back().y = value;
    if (header_.normals && p.role == PlyRole::nz) file_.normals.back().z = value;
    if (radiusScale > 0) {
        if (value < 0) cursor_.fail(fmt::format("`{}` of vertex {} is negative", p.name, file_.positions.size() - 1));
        file_.radii.back() = value * radiusScale;
    }
}

void PointReader::vertices(const PlyElement& e) {
    const PlyProperty* radius = nullptr;
    for (const PlyProperty& p : e.properties)
        if (!radius && radiusScaleOf(p) > 0) radius = &p;
    requireMemory(static_cast<double>(e.count) * (2 * sizeof(Vec3) + sizeof(float)));
    file_.positions.reserve(e.count);
    if (header_.normals) file_.normals.reserve(e.count);
    if (radius) file_.radii.reserve(e.count);
    for (std::uint64_t i = 0; i < e.count; ++i) {
        file_.positions.emplace_back();
        if (header_.normals) file_.normals.emplace_back();
        if (radius) file_.radii.emplace_back();
        for (const PlyProperty& p : e.properties) {
            if (p.listCount || (p.role == PlyRole::none && &p != radius)) {
                cursor_.skip(p);
                continue;
            }
            const auto value = static_cast<float>(cursor_.scalar(p.type));
            if (!std::isfinite(value))
                cursor_.fail(fmt::format("`{}` of vertex {} is not finite", p.name.substr(0, 40), i));
            store(p, value, &p == radius ? radiusScaleOf(p) : 0);
        }
    }
}

void PointReader::pointList(const PlyProperty& p) {
    const std::uint64_t n = cursor_.listLength(p);
    for (std::uint64_t k = 0; k < n; ++k) {
        const double index = cursor_.scalar(p.type);
        if (!(index >= 0) || !(index < static_cast<double>(header_.vertexCount)) || index != std::floor(index))
            cursor_.fail(fmt::format("vertex {} of only {}", index, header_.vertexCount));
        file_.strandPoints.push_back(static_cast<std::uint32_t>(index));
    }
    file_.strandSizes.push_back(static_cast<std::uint32_t>(n));
}

void PointReader::pointCount(const PlyProperty& p) {
    const double n = cursor_.scalar(p.type);
    if (!(n >= 0) || !(n <= static_cast<double>(header_.vertexCount)) || n != std::floor(n))
        cursor_.fail(fmt::format("a strand of {} points out of {}", n, header_.vertexCount));
    file_.strandSizes.push_back(static_cast<std::uint32_t>(n));
}

void PointReader::strands(const PlyElement& e) {
    const PlyProperty* points = nullptr;
    for (const PlyProperty& p : e.properties) {
        const bool isList = p.listCount && (p.name == "vertex_indices" || p.name == "vertex_index");
        if (!points && (isList || (!p.listCount && p.name == "count"))) points = &p;
    }
    if (!points) cursor_.fail(fmt::format("`{}` has neither a list `vertex_indices` nor a number `count`", e.name));
    byIndex_ = points->listCount.has_value();
    requireMemory(static_cast<double>(e.count) * sizeof(std::uint32_t));
    file_.strandSizes.reserve(e.count);
    for (std::uint64_t i = 0; i < e.count; ++i)
        for (const PlyProperty& p : e.properties) {
            if (&p != points)
                cursor_.skip(p);
            else if (byIndex_)
                pointList(p);
            else
                pointCount(p);
        }
}

void PointReader::checkSizes() {
    if (byIndex_ || file_.strandSizes.empty()) return;
    std::uint64_t sum = 0;
    for (const std::uint32_t size : file_.strandSizes) sum += size;
    if (sum != header_.vertexCount)
        cursor_.fail(fmt::format("the strands have {} points, but there are {}", sum, header_.vertexCount));
}

} // namespace

PointFile parsePlyPoints(std::string_view bytes, const std::string& name) { return PointReader(bytes, name).read(); }

PointFile readPlyPoints(const std::string& path) {
    if (const auto arrays = findArrays(path)) return pointsOf(*arrays, path);
    return parsePlyPoints(readFileBytes(path), path);
}

} // namespace abbe
