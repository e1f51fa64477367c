#include "io/file_bytes.h"
#include "io/mesh_file.h"
#include "io/number_scan.h"

#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <optional>
#include <string_view>

namespace abbe {

namespace {

enum class Encoding { text, littleEndian, bigEndian };
enum class Scalar : std::uint8_t { int8, uint8, int16, uint16, int32, uint32, float32, float64 };

std::size_t sizeOf(Scalar s) {
    constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[static_cast<std::size_t>(s)];
}

std::optional<Scalar> scalarNamed(std::string_view name) {
    struct Name {
        std::string_view text;
        Scalar scalar;
    };
    constexpr std::array<Name, 16> names{{{"char", Scalar::int8},
                                          {"int8", Scalar::int8},
                                          {"uchar", Scalar::uint8},
                                          {"uint8", Scalar::uint8},
                                          {"short", Scalar::int16},
                                          {"int16", Scalar::int16},
                                          {"ushort", Scalar::uint16},
                                          {"uint16", Scalar::uint16},
                                          {"int", Scalar::int32},
                                          {"int32", Scalar::int32},
                                          {"uint", Scalar::uint32},
                                          {"uint32", Scalar::uint32},
                                          {"float", Scalar::float32},
                                          {"float32", Scalar::float32},
                                          {"double", Scalar::float64},
                                          {"float64", Scalar::float64}}};
    for (const Name& n : names)
        if (n.text == name) return n.scalar;
    return std::nullopt;
}

// Where a vertex property goes.
enum class Role : std::uint8_t { none, x, y, z, nx, ny, nz, u, v };
constexpr std::size_t kRoles = 9;

Role roleNamed(std::string_view name) {
    constexpr std::array<std::pair<std::string_view, Role>, 14> names{{{"x", Role::x},
                                                                       {"y", Role::y},
                                                                       {"z", Role::z},
                                                                       {"nx", Role::nx},
                                                                       {"ny", Role::ny},
                                                                       {"nz", Role::nz},
                                                                       {"u", Role::u},
                                                                       {"v", Role::v},
                                                                       {"s", Role::u},
                                                                       {"t", Role::v},
                                                                       {"texture_u", Role::u},
                                                                       {"texture_v", Role::v},
                                                                       {"texture_s", Role::u},
                                                                       {"texture_t", Role::v}}};
    for (const auto& [text, role] : names)
        if (text == name) return role;
    return Role::none;
}

struct Property {
    std::string name;
    Scalar type = Scalar::float32;
    std::optional<Scalar> listCount; // the type of a list's length
    Role role = Role::none;
};

struct Element {
    std::string name;
    std::uint64_t count = 0;
    std::vector<Property> properties;
};

template <typename T> T load(const char* p, bool swap) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), p, sizeof(T));
    if (swap)
        for (std::size_t i = 0; i < sizeof(T) / 2; ++i) std::swap(bytes[i], bytes[sizeof(T) - 1 - i]);
    return std::bit_cast<T>(bytes);
}

// Every PLY integer is exact in double.
double loadScalar(Scalar type, const char* p, bool swap) {
    switch (type) {
    case Scalar::int8:
        return load<std::int8_t>(p, swap);
    case Scalar::uint8:
        return load<std::uint8_t>(p, swap);
    case Scalar::int16:
        return load<std::int16_t>(p, swap);
    case Scalar::uint16:
        return load<std::uint16_t>(p, swap);
    case Scalar::int32:
        return load<std::int32_t>(p, swap);
    case Scalar::uint32:
        return load<std::uint32_t>(p, swap);
    case Scalar::float32:
        return static_cast<double>(load<float>(p, swap));
    case Scalar::float64:
        return load<double>(p, swap);
    }
    return 0;
}

class PlyParser {
  public:
    PlyParser(std::string_view bytes, const std::string& name)
        : begin_(bytes.data()), p_(begin_), end_(begin_ + bytes.size()), name_(name) {}

    MeshFile parse();

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw IoError(fmt::format("cannot read `{}`: byte {}: {}", name_, p_ - begin_, what));
    }
    std::uint64_t left() const { return static_cast<std::uint64_t>(end_ - p_); }

    std::vector<std::string_view> headerLine();
    void header();
    void elementLine(const std::vector<std::string_view>&);
    void propertyLine(const std::vector<std::string_view>&);
    void checkHeader();
    std::uint64_t smallestSize(const Element&) const;

    double scalar(Scalar);
    double textScalar();
    std::uint64_t listLength(const Property&);
    void vertices(const Element&);
    void faces(const Element&);
    void skip(const Property&);
    void store(Role, float);
    void corners(const Property&);

    const char* begin_;
    const char* p_;
    const char* end_;
    const std::string& name_;
    Encoding encoding_ = Encoding::text;
    bool swap_ = false;
    std::vector<Element> elements_;
    std::uint64_t vertexCount_ = 0;
    bool anyNormal_ = false, anyTexture_ = false;

    MeshFile file_;
    std::vector<std::uint32_t> corners_, faceSizes_;
};

// The words of the next line of the header.
std::vector<std::string_view> PlyParser::headerLine() {
    const char* start = p_;
    while (p_ < end_ && *p_ != '\n' && *p_ != '\r') ++p_;
    if (p_ == end_) fail("the header does not end");
    const char* last = p_;
    p_ += *p_ == '\r' && p_ + 1 < end_ && p_[1] == '\n' ? 2 : 1;
    std::vector<std::string_view> words;
    while (start < last) {
        while (start < last && (*start == ' ' || *start == '\t')) ++start;
        const char* word = start;
        while (start < last && *start != ' ' && *start != '\t') ++start;
        if (start > word) words.emplace_back(word, static_cast<std::size_t>(start - word));
    }
    return words;
}

void PlyParser::header() {
    const auto magic = headerLine();
    if (magic.size() != 1 || magic[0] != "ply") fail("it does not begin with `ply`");
    bool hasFormat = false;
    for (;;) {
        const auto words = headerLine();
        if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
        if (words[0] == "end_header") break;
        if (words[0] == "format" && words.size() == 3) {
            if (words[1] == "ascii")
                encoding_ = Encoding::text;
            else if (words[1] == "binary_little_endian")
                encoding_ = Encoding::littleEndian;
            else if (words[1] == "binary_big_endian")
                encoding_ = Encoding::bigEndian;
            else
                fail(fmt::format("unknown format `{}`", words[1].substr(0, 40)));
            hasFormat = true;
        } else if (words[0] == "element") {
            elementLine(words);
        } else if (words[0] == "property") {
            propertyLine(words);
        } else {
            fail(fmt::format("unknown header line `{}`", words[0].substr(0, 40)));
        }
    }
    if (!hasFormat) fail("the header states no format");
    swap_ = (encoding_ == Encoding::bigEndian) == (std::endian::native == std::endian::little);
}

void PlyParser::elementLine(const std::vector<std::string_view>& words) {
    if (words.size() != 3) fail("an element needs a name and a count");
    Element e{std::string(words[1]), 0, {}};
    const char* p = words[2].data();
    const auto count = scanNumber<std::uint64_t>(p, p + words[2].size());
    if (!count || p != words[2].data() + words[2].size())
        fail(fmt::format("`{}` is not a count", words[2].substr(0, 40)));
    for (const Element& other : elements_)
        if (other.name == e.name) fail(fmt::format("the element `{}` comes twice", e.name.substr(0, 40)));
    e.count = *count;
    elements_.push_back(std::move(e));
}

void PlyParser::propertyLine(const std::vector<std::string_view>& words) {
    if (elements_.empty()) fail("a property before the first element");
    const bool list = words.size() == 5 && words[1] == "list";
    if (!list && words.size() != 3) fail("a property needs a type and a name");
    Property property;
    property.name = std::string(words.back());
    const auto typeOf = [this](std::string_view word) {
        const auto type = scalarNamed(word);
        if (!type) fail(fmt::format("unknown type `{}`", word.substr(0, 40)));
        return *type;
    };
    property.type = typeOf(words[words.size() - 2]);
    if (list) {
        property.listCount = typeOf(words[2]);
        if (*property.listCount >= Scalar::float32) fail("the length of a list must be an integer");
    }
    elements_.back().properties.push_back(std::move(property));
}

// Bytes that one entry takes at the least: no count in the header may promise more than the file holds.
std::uint64_t PlyParser::smallestSize(const Element& e) const {
    std::uint64_t size = 0;
    for (const Property& p : e.properties)
        size += encoding_ == Encoding::text ? 2 : p.listCount ? sizeOf(*p.listCount) : sizeOf(p.type);
    return size;
}

void PlyParser::checkHeader() {
    bool hasVertices = false, hasFaces = false;
    std::uint64_t needed = 0;
    for (Element& e : elements_) {
        const std::uint64_t size = smallestSize(e);
        if (size == 0 && e.count > 0) fail(fmt::format("the element `{}` has no properties", e.name.substr(0, 40)));
        // The last number of a text file may end with the file.
        if (size > 0 && e.count > (left() + 1 - std::min(needed, left() + 1)) / size)
            fail(fmt::format("{} entries of `{}` are more than the file holds", e.count, e.name.substr(0, 40)));
        needed += size * e.count;
        hasFaces |= e.name == "face";
        if (e.name != "vertex") continue;
        hasVertices = true;
        vertexCount_ = e.count;
        std::array<bool, kRoles> seen{};
        for (Property& p : e.properties) {
            p.role = p.listCount ? Role::none : roleNamed(p.name);
            bool& first = seen[static_cast<std::size_t>(p.role)];
            if (first) p.role = Role::none;
            first = true;
        }
        const auto has = [&seen](Role r) { return seen[static_cast<std::size_t>(r)]; };
        if (!has(Role::x) || !has(Role::y) || !has(Role::z)) fail("the vertices have no x, y and z");
        anyNormal_ = has(Role::nx) && has(Role::ny) && has(Role::nz);
        anyTexture_ = has(Role::u) && has(Role::v);
    }
    if (!hasVertices) fail("there are no vertices");
    if (!hasFaces) fail("there are no faces");
    if (vertexCount_ > 0xfffffffeu) fail("more vertices than 32 bits can count");
}

double PlyParser::textScalar() {
    while (p_ < end_ && static_cast<unsigned char>(*p_) <= ' ') ++p_;
    if (p_ == end_) fail("the file ends too early");
    const char* start = p_;
    const auto value = scanNumber<double>(p_, end_);
    if (!value || (p_<end_&& static_cast<unsigned char>(*p_)> ' ')) {
        p_ = start;
        fail("this is not a number that fits");
    }
    return *value;
}

double PlyParser::scalar(Scalar type) {
    if (encoding_ == Encoding::text) return textScalar();
    const std::size_t size = sizeOf(type);
    if (left() < size) fail("the file ends too early");
    const double value = loadScalar(type, p_, swap_);
    p_ += size;
    return value;
}

std::uint64_t PlyParser::listLength(const Property& p) {
    const char* start = p_;
    const double n = scalar(*p.listCount);
    const std::uint64_t itemSize = encoding_ == Encoding::text ? 1 : sizeOf(p.type);
    if (!(n >= 0) || n != std::floor(n) || n > static_cast<double>(left() / itemSize + 1)) {
        p_ = start;
        fail(fmt::format("a list of {} entries is more than the file holds", n));
    }
    return static_cast<std::uint64_t>(n);
}

void PlyParser::store(Role role, float value) {
    MeshData& m = file_.mesh;
    switch (role) {
    case Role::none:
        return;
    case Role::x:
        m.positions.back().x = value;
        return;
    case Role::y:
        m.positions.back().y = value;
        return;
    case Role::z:
        m.positions.back().z = value;
        return;
    case Role::nx:
        m.normals.back().x = value;
        return;
    case Role::ny:
        m.normals.back().y = value;
        return;
    case Role::nz:
        m.normals.back().z = value;
        return;
    case Role::u:
        m.uvs.back().x = value;
        return;
    case Role::v:
        m.uvs.back().y = value;
        return;
    }
}

void PlyParser::vertices(const Element& e) {
    MeshData& m = file_.mesh;
    m.positions.reserve(e.count + 2);
    if (anyNormal_) m.normals.reserve(e.count);
    if (anyTexture_) m.uvs.reserve(e.count);
    for (std::uint64_t i = 0; i < e.count; ++i) {
        m.positions.emplace_back();
        if (anyNormal_) m.normals.emplace_back();
        if (anyTexture_) m.uvs.emplace_back();
        for (const Property& p : e.properties) {
            if (p.listCount) {
                skip(p);
                continue;
            }
            const char* start = p_;
            const auto value = static_cast<float>(scalar(p.type));
            const bool isNormal = p.role >= Role::nx && p.role <= Role::nz, isTexture = p.role >= Role::u;
            if (p.role == Role::none || (isNormal && !anyNormal_) || (isTexture && !anyTexture_)) continue;
            if (!std::isfinite(value)) {
                p_ = start;
                fail(fmt::format("`{}` of vertex {} is not finite", p.name.substr(0, 40), i));
            }
            store(p.role, value);
        }
    }
}

void PlyParser::corners(const Property& p) {
    const std::uint64_t n = listLength(p);
    for (std::uint64_t k = 0; k < n; ++k) {
        const char* start = p_;
        const double index = scalar(p.type);
        if (!(index >= 0) || !(index < static_cast<double>(vertexCount_)) || index != std::floor(index)) {
            p_ = start;
            fail(fmt::format("vertex {} of only {}", index, vertexCount_));
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

void PlyParser::faces(const Element& e) {
    const Property* cornerList = nullptr;
    for (const Property& p : e.properties)
        if (!cornerList && p.listCount && (p.name == "vertex_indices" || p.name == "vertex_index")) cornerList = &p;
    if (!cornerList) fail("the faces have no `vertex_indices`");
    faceSizes_.reserve(e.count);
    corners_.reserve(3 * e.count);
    for (std::uint64_t i = 0; i < e.count; ++i)
        for (const Property& p : e.properties) {
            if (isCorners(p))
                corners(p);
            else if (p.listCount)
                for (std::uint64_t n = listLength(p); n > 0; --n) scalar(p.type);
            else
                scalar(p.type);
        }
}

void PlyParser::skip(const Property& p) {
    for (std::uint64_t n = p.listCount ? listLength(p) : 1; n > 0; --n) scalar(p.type);
}

MeshFile PlyParser::parse() {
    header();
    checkHeader();
    for (const Element& e : elements_) {
        if (e.name == "vertex")
            vertices(e);
        else if (e.name == "face")
            faces(e);
        else
            skip(e);
    }
    if (faceSizes_.empty()) fail("there are no faces");
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

MeshFile readPly(const std::string& path) { return parsePly(readFileBytes(path), path); }

} // namespace abbe
