#include "base/memory_limit.h"
#include "io/file.h"
#include "io/mesh_file.h"
#include "io/ply_format.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <string_view>

namespace abbe {

namespace {

class PlyParser {
  public:
    PlyParser(std::string_view bytes, const std::string& name)
        : header_(parsePlyHeader(bytes, name)), cursor_(header_, bytes, name) {}

    MeshFile parse();
    CageFile parseCage();

  private:
    void read();
    void vertices(const PlyElement&);
    bool packedVertices(const PlyElement&);
    void faces(const PlyElement&);
    bool packedFaces(const PlyElement&);
    void store(PlyRole, float);
    void findAttributes(const PlyElement&);
    void keepAttributes();
    void corners(const PlyProperty&);

    PlyHeader header_;
    PlyCursor cursor_;

    MeshFile file_;
    std::vector<std::uint32_t> corners_, faceSizes_; // where the polygons are not in the mesh yet
    struct Column {
        std::size_t property; // of the vertices
        MeshAttribute attribute;
        double scale;
    };
    std::vector<Column> columns_; // properties without a role, in their order
    bool asCage_ = false;         // polygons stay as they are
};

// 8 and 16 bits without sign are shares of the largest value, as colours are written.
void PlyParser::findAttributes(const PlyElement& e) {
    for (std::size_t i = 0; i < e.properties.size(); ++i) {
        const PlyProperty& p = e.properties[i];
        if (p.listCount || p.role != PlyRole::none || p.name.empty()) continue;
        const double scale = p.type == PlyScalar::uint8 ? 1 / 255.0 : p.type == PlyScalar::uint16 ? 1 / 65535.0 : 1;
        columns_.push_back({i, {p.name, 1, {}}, scale});
    }
}

// `red`, `green` and `blue` are one attribute: `color`.
void PlyParser::keepAttributes() {
    auto& attributes = file_.mesh.attributes;
    const auto column = [this](std::string_view name) {
        return std::ranges::find_if(columns_, [&](const Column& c) { return c.attribute.name == name; });
    };
    const auto red = column("red"), green = column("green"), blue = column("blue"), none = columns_.end();
    const bool colored = red != none && green != none && blue != none;
    if (colored) {
        MeshAttribute& color = attributes.emplace_back(MeshAttribute{"color", 3, {}});
        color.values.reserve(3 * red->attribute.values.size());
        for (std::size_t i = 0; i < red->attribute.values.size(); ++i)
            for (const auto& c : {red, green, blue}) color.values.push_back(c->attribute.values[i]);
    }
    for (auto c = columns_.begin(); c != none; ++c)
        if (!colored || (c != red && c != green && c != blue)) attributes.push_back(std::move(c->attribute));
}

void PlyParser::store(PlyRole role, float value) {
    MeshData& m = file_.mesh;
    switch (role) {
    case PlyRole::none:
        return;
    case PlyRole::x:
        m.positions.back().x = value;
        return;
    case PlyRole::y:
        m.positions.back().y = value;
        return;
    case PlyRole::z:
        m.positions.back().z = value;
        return;
    case PlyRole::nx:
        m.normals.back().x = value;
        return;
    case PlyRole::ny:
        m.normals.back().y = value;
        return;
    case PlyRole::nz:
        m.normals.back().z = value;
        return;
    case PlyRole::u:
        m.uvs.back().x = value;
        return;
    case PlyRole::v:
        m.uvs.back().y = value;
        return;
    }
}

// What nearly all large files have: x y z, perhaps nx ny nz and u v, as single precision in the byte order of the
// machine. False, with nothing read, for others, and where a number is not finite: the usual way says which one.
bool PlyParser::packedVertices(const PlyElement& e) {
    const bool usual = std::ranges::all_of(e.properties, [](const PlyProperty& p) {
        return !p.listCount && p.type == PlyScalar::float32 && p.role != PlyRole::none;
    });
    const std::size_t stride = e.properties.size() * sizeof(float);
    const char* p = usual ? cursor_.packed(e.count, stride) : nullptr;
    if (!p) return false;
    MeshData& m = file_.mesh;
    std::array<std::size_t, kPlyRoles> at{}; // bytes behind p
    for (std::size_t i = 0; i < e.properties.size(); ++i)
        at[static_cast<std::size_t>(e.properties[i].role)] = i * sizeof(float);
    const auto number = [&](PlyRole role) {
        float value;
        std::memcpy(&value, p + at[static_cast<std::size_t>(role)], sizeof value);
        return value;
    };
    float sum = 0; // of products with 0: not 0 if one of them is not finite
    for (std::uint64_t i = 0; i < e.count; ++i, p += stride) {
        const Vec3 position{number(PlyRole::x), number(PlyRole::y), number(PlyRole::z)};
        m.positions.push_back(position);
        sum += 0 * position.x + 0 * position.y + 0 * position.z;
        if (header_.normals) {
            const Vec3 normal{number(PlyRole::nx), number(PlyRole::ny), number(PlyRole::nz)};
            m.normals.push_back(normal);
            sum += 0 * normal.x + 0 * normal.y + 0 * normal.z;
        }
        if (header_.uvs) {
            const Vec2 uv{number(PlyRole::u), number(PlyRole::v)};
            m.uvs.push_back(uv);
            sum += 0 * uv.x + 0 * uv.y;
        }
    }
    if (sum == 0) {
        cursor_.pass(p);
        return true;
    }
    m.positions.clear(), m.normals.clear(), m.uvs.clear();
    return false;
}

void PlyParser::vertices(const PlyElement& e) {
    MeshData& m = file_.mesh;
    findAttributes(e);
    requireMemory(static_cast<double>(e.count) *
                  static_cast<double>(sizeof(Vec3) * (header_.normals ? 2 : 1) + sizeof(Vec2) * (header_.uvs ? 1 : 0) +
                                      sizeof(float) * columns_.size()));
    for (Column& column : columns_) column.attribute.values.reserve(e.count);
    m.positions.reserve(e.count + 2);
    if (header_.normals) m.normals.reserve(e.count);
    if (header_.uvs) m.uvs.reserve(e.count);
    if (packedVertices(e)) return;
    for (std::uint64_t i = 0; i < e.count; ++i) {
        m.positions.emplace_back();
        if (header_.normals) m.normals.emplace_back();
        if (header_.uvs) m.uvs.emplace_back();
        auto column = columns_.begin();
        for (std::size_t k = 0; k < e.properties.size(); ++k) {
            const PlyProperty& p = e.properties[k];
            if (p.listCount) {
                cursor_.skip(p);
                continue;
            }
            const bool kept = column != columns_.end() && column->property == k;
            const auto value = static_cast<float>(cursor_.scalar(p.type) * (kept ? column->scale : 1));
            const bool isNormal = p.role >= PlyRole::nx && p.role <= PlyRole::nz, isTexture = p.role >= PlyRole::u;
            if ((p.role == PlyRole::none && !kept) || (isNormal && !header_.normals) || (isTexture && !header_.uvs))
                continue;
            if (!std::isfinite(value))
                cursor_.fail(fmt::format("`{}` of vertex {} is not finite", p.name.substr(0, 40), i));
            if (kept)
                (column++)->attribute.values.push_back(value);
            else
                store(p.role, value);
        }
    }
}

void PlyParser::corners(const PlyProperty& p) {
    const std::uint64_t n = cursor_.listLength(p);
    for (std::uint64_t k = 0; k < n; ++k) {
        const double index = cursor_.scalar(p.type);
        if (!(index >= 0) || !(index < static_cast<double>(header_.vertexCount)) || index != std::floor(index))
            cursor_.fail(fmt::format("vertex {} of only {}", index, header_.vertexCount));
        corners_.push_back(static_cast<std::uint32_t>(index));
    }
    if (n >= 3) {
        faceSizes_.push_back(static_cast<std::uint32_t>(n));
    } else {
        corners_.resize(corners_.size() - n);
        ++file_.ignoredFaces;
    }
}

// The same for faces: a length of one byte and 32-bit numbers of vertices that were read before, straight into the
// mesh. Whatever is wrong is found again by the usual way, which says where.
bool PlyParser::packedFaces(const PlyElement& e) {
    if (asCage_ || e.properties.size() != 1 || file_.mesh.positions.size() != header_.vertexCount) return false;
    const PlyProperty& list = e.properties[0];
    if (*list.listCount != PlyScalar::uint8 || (list.type != PlyScalar::int32 && list.type != PlyScalar::uint32))
        return false;
    const char* p = cursor_.packed(e.count, 1);
    if (!p) return false;
    MeshData& m = file_.mesh;
    m.triangles.reserve(e.count);
    std::array<std::uint32_t, 255> corners;
    bool right = true;
    for (std::uint64_t i = 0; i < e.count && right; ++i) {
        const std::size_t n = p < cursor_.end() ? static_cast<unsigned char>(*p++) : 256;
        right = n <= corners.size() && static_cast<std::size_t>(cursor_.end() - p) >= n * sizeof(std::uint32_t);
        if (!right) break;
        std::memcpy(corners.data(), p, n * sizeof(std::uint32_t));
        p += n * sizeof(std::uint32_t);
        for (std::size_t k = 0; k < n; ++k) right &= corners[k] < header_.vertexCount; // a negative one is too large
        if (n < 3)
            ++file_.ignoredFaces;
        else
            right = right && addPolygon(m, std::span(corners).first(n));
    }
    if (right)
        cursor_.pass(p);
    else
        m.triangles.clear(), m.quads.clear(), file_.ignoredFaces = 0;
    return right;
}

void PlyParser::faces(const PlyElement& e) {
    const PlyProperty* cornerList = nullptr;
    for (const PlyProperty& p : e.properties)
        if (!cornerList && p.listCount && (p.name == "vertex_indices" || p.name == "vertex_index")) cornerList = &p;
    if (!cornerList) cursor_.failHere("the faces have no `vertex_indices`");
    requireMemory(static_cast<double>(e.count) * 4 * sizeof(std::uint32_t));
    if (packedFaces(e)) return;
    faceSizes_.reserve(e.count);
    corners_.reserve(3 * e.count);
    for (std::uint64_t i = 0; i < e.count; ++i)
        for (const PlyProperty& p : e.properties) {
            if (&p == cornerList)
                corners(p);
            else
                cursor_.skip(p);
        }
}

void PlyParser::read() {
    for (const PlyElement& e : header_.elements) {
        if (e.name == "vertex")
            vertices(e);
        else if (e.name == "face")
            faces(e);
        else
            cursor_.skip(e);
    }
    if (faceSizes_.empty() && file_.mesh.triangles.empty() && file_.mesh.quads.empty())
        cursor_.failHere("there are no faces");
}

CageFile PlyParser::parseCage() {
    asCage_ = true;
    read();
    keepAttributes();
    CageFile file;
    file.ignoredFaces = file_.ignoredFaces;
    file.cage.positions = std::move(file_.mesh.positions);
    file.cage.uvs = std::move(file_.mesh.uvs);
    file.cage.attributes = std::move(file_.mesh.attributes);
    if (!file.cage.uvs.empty()) file.cage.uvCorners = corners_;
    file.cage.corners = std::move(corners_);
    file.cage.faceSizes = std::move(faceSizes_);
    return file;
}

MeshFile PlyParser::parse() {
    read();
    keepAttributes();
    std::size_t next = 0;
    for (std::uint32_t size : faceSizes_) {
        if (!addPolygon(file_.mesh, std::span(corners_).subspan(next, size)))
            cursor_.failHere(fmt::format("a concave polygon with more than {} corners", kMaxConcaveCorners));
        next += size;
    }
    file_.groups.push_back({"", "", 0, file_.mesh.triangles.size(), 0, file_.mesh.quads.size()});
    return std::move(file_);
}

} // namespace

MeshFile parsePly(std::string_view bytes, const std::string& name) { return PlyParser(bytes, name).parse(); }

CageFile parsePlyCage(std::string_view bytes, const std::string& name) { return PlyParser(bytes, name).parseCage(); }

CageFile readPlyCage(const std::string& path) { return parsePlyCage(LargeFile(path).bytes(), path); }

MeshFile readPly(const std::string& path) { return parsePly(LargeFile(path).bytes(), path); }

} // namespace abbe
