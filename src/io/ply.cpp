#include "io/cage_file.h"
#include "io/file_bytes.h"
#include "io/mesh_file.h"
#include "io/number_scan.h"
#include "io/ply_header.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <optional>
#include <string_view>

namespace abbe {

namespace {

template <typename T> T load(const char* p, bool swap) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), p, sizeof(T));
    if (swap)
        for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
    return std::bit_cast<T>(bytes);
}

// Every PLY integer is exact in double.
double loadScalar(PlyScalar type, const char* p, bool swap) {
    switch (type) {
    case PlyScalar::int8:
        return load<std::int8_t>(p, swap);
    case PlyScalar::uint8:
        return load<std::uint8_t>(p, swap);
    case PlyScalar::int16:
        return load<std::int16_t>(p, swap);
    case PlyScalar::uint16:
        return load<std::uint16_t>(p, swap);
    case PlyScalar::int32:
        return load<std::int32_t>(p, swap);
    case PlyScalar::uint32:
        return load<std::uint32_t>(p, swap);
    case PlyScalar::float32:
        return static_cast<double>(load<float>(p, swap));
    case PlyScalar::float64:
        return load<double>(p, swap);
    }
    return 0;
}

class PlyParser {
  public:
    PlyParser(std::string_view bytes, const std::string& name)
        : header_(parsePlyHeader(bytes, name)), begin_(bytes.data()), p_(begin_ + header_.bodyOffset),
          end_(begin_ + bytes.size()), name_(name),
          swap_((header_.encoding == PlyEncoding::bigEndian) == (std::endian::native == std::endian::little)) {}

    MeshFile parse();
    CageFile parseCage();

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw IoError(fmt::format("cannot read `{}`: byte {}: {}", name_, p_ - begin_, what));
    }
    std::uint64_t left() const { return static_cast<std::uint64_t>(end_ - p_); }
    bool isText() const { return header_.encoding == PlyEncoding::text; }

    // Where the next number begins, for messages: behind the blanks of a text file.
    const char* next() {
        while (isText() && p_ < end_ && static_cast<unsigned char>(*p_) <= ' ') ++p_;
        return p_;
    }
    double scalar(PlyScalar);
    double textScalar();
    std::uint64_t listLength(const PlyProperty&);
    void read();
    void vertices(const PlyElement&);
    void faces(const PlyElement&);
    void skip(const PlyProperty&);
    void store(PlyRole, float);
    void corners(const PlyProperty&);

    PlyHeader header_;
    const char* begin_;
    const char* p_;
    const char* end_;
    const std::string& name_;
    bool swap_;

    MeshFile file_;
    std::vector<std::uint32_t> corners_, faceSizes_;
};

double PlyParser::textScalar() {
    const char* start = next();
    if (p_ == end_) fail("the file ends too early");
    const auto value = scanNumber<double>(p_, end_);
    if (!value || (p_<end_&& static_cast<unsigned char>(*p_)> ' ')) {
        p_ = start;
        fail("this is not a number that fits");
    }
    return *value;
}

double PlyParser::scalar(PlyScalar type) {
    if (isText()) return textScalar();
    const std::size_t size = sizeOf(type);
    if (left() < size) fail("the file ends too early");
    const double value = loadScalar(type, p_, swap_);
    p_ += size;
    return value;
}

std::uint64_t PlyParser::listLength(const PlyProperty& p) {
    const char* start = next();
    const double n = scalar(*p.listCount);
    const std::uint64_t itemSize = isText() ? 1 : sizeOf(p.type);
    if (!(n >= 0) || n != std::floor(n) || n > static_cast<double>(left() / itemSize + 1)) {
        p_ = start;
        fail(fmt::format("a list of {} entries is more than the file holds", n));
    }
    return static_cast<std::uint64_t>(n);
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

void PlyParser::vertices(const PlyElement& e) {
    MeshData& m = file_.mesh;
    m.positions.reserve(e.count + 2);
    if (header_.normals) m.normals.reserve(e.count);
    if (header_.uvs) m.uvs.reserve(e.count);
    for (std::uint64_t i = 0; i < e.count; ++i) {
        m.positions.emplace_back();
        if (header_.normals) m.normals.emplace_back();
        if (header_.uvs) m.uvs.emplace_back();
        for (const PlyProperty& p : e.properties) {
            if (p.listCount) {
                skip(p);
                continue;
            }
            const char* start = next();
            const auto value = static_cast<float>(scalar(p.type));
            const bool isNormal = p.role >= PlyRole::nx && p.role <= PlyRole::nz, isTexture = p.role >= PlyRole::u;
            if (p.role == PlyRole::none || (isNormal && !header_.normals) || (isTexture && !header_.uvs)) continue;
            if (!std::isfinite(value)) {
                p_ = start;
                fail(fmt::format("`{}` of vertex {} is not finite", p.name.substr(0, 40), i));
            }
            store(p.role, value);
        }
    }
}

void PlyParser::corners(const PlyProperty& p) {
    const std::uint64_t n = listLength(p);
    for (std::uint64_t k = 0; k < n; ++k) {
        const char* start = next();
        const double index = scalar(p.type);
        if (!(index >= 0) || !(index < static_cast<double>(header_.vertexCount)) || index != std::floor(index)) {
            p_ = start;
            fail(fmt::format("vertex {} of only {}", index, header_.vertexCount));
        }
        corners_.push_back(static_cast<std::uint32_t>(index));
    }
    if (n >= 3) {
        faceSizes_.push_back(static_cast<std::uint32_t>(n));
    } else {
        corners_.resize(corners_.size() - n);
        ++file_.ignoredFaces;
    }
}

void PlyParser::faces(const PlyElement& e) {
    const PlyProperty* cornerList = nullptr;
    for (const PlyProperty& p : e.properties)
        if (!cornerList && p.listCount && (p.name == "vertex_indices" || p.name == "vertex_index")) cornerList = &p;
    if (!cornerList) fail("the faces have no `vertex_indices`");
    faceSizes_.reserve(e.count);
    corners_.reserve(3 * e.count);
    for (std::uint64_t i = 0; i < e.count; ++i)
        for (const PlyProperty& p : e.properties) {
            if (&p == cornerList)
                corners(p);
            else
                skip(p);
        }
}

void PlyParser::skip(const PlyProperty& p) {
    for (std::uint64_t n = p.listCount ? listLength(p) : 1; n > 0; --n) scalar(p.type);
}

void PlyParser::read() {
    for (const PlyElement& e : header_.elements) {
        if (e.name == "vertex")
            vertices(e);
        else if (e.name == "face")
            faces(e);
        else
            for (std::uint64_t i = 0; i < e.count; ++i)
                for (const PlyProperty& p : e.properties) skip(p);
    }
    if (faceSizes_.empty()) fail("there are no faces");
}

CageFile PlyParser::parseCage() {
    read();
    CageFile file;
    file.ignoredFaces = file_.ignoredFaces;
    file.cage.positions = std::move(file_.mesh.positions);
    file.cage.uvs = std::move(file_.mesh.uvs);
    if (!file.cage.uvs.empty()) file.cage.uvCorners = corners_;
    file.cage.corners = std::move(corners_);
    file.cage.faceSizes = std::move(faceSizes_);
    return file;
}

MeshFile PlyParser::parse() {
    read();
    std::size_t next = 0;
    for (std::uint32_t size : faceSizes_) {
        if (!addPolygon(file_.mesh, std::span(corners_).subspan(next, size)))
            fail(fmt::format("a concave polygon with more than {} corners", kMaxConcaveCorners));
        next += size;
    }
    file_.groups.push_back({"", "", 0, file_.mesh.triangles.size(), 0, file_.mesh.quads.size()});
    return std::move(file_);
}

} // namespace

MeshFile parsePly(std::string_view bytes, const std::string& name) { return PlyParser(bytes, name).parse(); }

CageFile parsePlyCage(std::string_view bytes, const std::string& name) { return PlyParser(bytes, name).parseCage(); }

CageFile readPlyCage(const std::string& path) { return parsePlyCage(readFileBytes(path), path); }

MeshFile readPly(const std::string& path) { return parsePly(readFileBytes(path), path); }

} // namespace abbe
