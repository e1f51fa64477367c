#include "io/ply_format.h"

#include "io/file.h"
#include "io/number_scan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <utility>

namespace abbe {

std::size_t sizeOf(PlyScalar s) {
    constexpr std::array<std::size_t, 8> sizes{1, 1, 2, 2, 4, 4, 4, 8};
    return sizes[static_cast<std::size_t>(s)];
}

namespace {

constexpr std::size_t kMaxElements = 1000;

std::optional<PlyScalar> scalarNamed(std::string_view name) {
    struct Name {
        std::string_view text;
        PlyScalar scalar;
    };
    constexpr std::array<Name, 16> names{{{"char", PlyScalar::int8},
                                          {"int8", PlyScalar::int8},
                                          {"uchar", PlyScalar::uint8},
                                          {"uint8", PlyScalar::uint8},
                                          {"short", PlyScalar::int16},
                                          {"int16", PlyScalar::int16},
                                          {"ushort", PlyScalar::uint16},
                                          {"uint16", PlyScalar::uint16},
                                          {"int", PlyScalar::int32},
                                          {"int32", PlyScalar::int32},
                                          {"uint", PlyScalar::uint32},
                                          {"uint32", PlyScalar::uint32},
                                          {"float", PlyScalar::float32},
                                          {"float32", PlyScalar::float32},
                                          {"double", PlyScalar::float64},
                                          {"float64", PlyScalar::float64}}};
    for (const Name& n : names)
        if (n.text == name) return n.scalar;
    return std::nullopt;
}

PlyRole roleNamed(std::string_view name) {
    constexpr std::array<std::pair<std::string_view, PlyRole>, 14> names{{{"x", PlyRole::x},
                                                                          {"y", PlyRole::y},
                                                                          {"z", PlyRole::z},
                                                                          {"nx", PlyRole::nx},
                                                                          {"ny", PlyRole::ny},
                                                                          {"nz", PlyRole::nz},
                                                                          {"u", PlyRole::u},
                                                                          {"v", PlyRole::v},
                                                                          {"s", PlyRole::u},
                                                                          {"t", PlyRole::v},
                                                                          {"texture_u", PlyRole::u},
                                                                          {"texture_v", PlyRole::v},
                                                                          {"texture_s", PlyRole::u},
                                                                          {"texture_t", PlyRole::v}}};
    for (const auto& [text, role] : names)
        if (text == name) return role;
    return PlyRole::none;
}

class HeaderParser {
  public:
    HeaderParser(std::string_view bytes, const std::string& name, PlyContent content)
        : begin_(bytes.data()), p_(begin_), end_(begin_ + bytes.size()), name_(name), content_(content) {}

    PlyHeader parse() {
        lines();
        check();
        header_.bodyOffset = static_cast<std::size_t>(p_ - begin_);
        return std::move(header_);
    }

  private:
    [[noreturn]] void fail(const std::string& what) const {
        throw IoError(fmt::format("cannot read `{}`: byte {}: {}", name_, p_ - begin_, what));
    }
    std::vector<std::string_view> headerLine();
    void lines();
    void formatLine(const std::vector<std::string_view>&);
    void elementLine(const std::vector<std::string_view>&);
    void propertyLine(const std::vector<std::string_view>&);
    void check();
    void checkVertices(PlyElement&);
    std::uint64_t smallestSize(const PlyElement&) const;

    const char* begin_;
    const char* p_;
    const char* end_;
    const std::string& name_;
    PlyContent content_;
    PlyHeader header_;
};

// The words of the next line of the header.
std::vector<std::string_view> HeaderParser::headerLine() {
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

void HeaderParser::lines() {
    const auto magic = headerLine();
    if (magic.size() != 1 || magic[0] != "ply") fail("it does not begin with `ply`");
    bool hasFormat = false;
    for (;;) {
        const auto words = headerLine();
        if (words.empty() || words[0] == "comment" || words[0] == "obj_info") continue;
        if (words[0] == "end_header") break;
        if (words[0] == "format") {
            formatLine(words);
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
}

void HeaderParser::formatLine(const std::vector<std::string_view>& words) {
    constexpr std::array<std::pair<std::string_view, PlyEncoding>, 3> names{
        {{"ascii", PlyEncoding::text},
         {"binary_little_endian", PlyEncoding::littleEndian},
         {"binary_big_endian", PlyEncoding::bigEndian}}};
    if (words.size() != 3) fail("a format needs a name and a version");
    for (const auto& [text, encoding] : names)
        if (words[1] == text) {
            header_.encoding = encoding;
            return;
        }
    fail(fmt::format("unknown format `{}`", words[1].substr(0, 40)));
}

void HeaderParser::elementLine(const std::vector<std::string_view>& words) {
    if (words.size() != 3) fail("an element needs a name and a count");
    PlyElement e{std::string(words[1]), 0, {}};
    const char* p = words[2].data();
    const auto count = scanNumber<std::uint64_t>(p, p + words[2].size());
    if (!count || p != words[2].data() + words[2].size())
        fail(fmt::format("`{}` is not a count", words[2].substr(0, 40)));
    if (header_.elements.size() == kMaxElements) fail("too many elements");
    for (const PlyElement& other : header_.elements)
        if (other.name == e.name) fail(fmt::format("the element `{}` comes twice", e.name.substr(0, 40)));
    e.count = *count;
    header_.elements.push_back(std::move(e));
}

void HeaderParser::propertyLine(const std::vector<std::string_view>& words) {
    if (header_.elements.empty()) fail("a property before the first element");
    const bool list = words.size() == 5 && words[1] == "list";
    if (!list && words.size() != 3) fail("a property needs a type and a name");
    PlyProperty property;
    property.name = std::string(words.back());
    const auto typeOf = [this](std::string_view word) {
        const auto type = scalarNamed(word);
        if (!type) fail(fmt::format("unknown type `{}`", word.substr(0, 40)));
        return *type;
    };
    property.type = typeOf(words[words.size() - 2]);
    if (list) {
        property.listCount = typeOf(words[2]);
        if (*property.listCount >= PlyScalar::float32) fail("the length of a list must be an integer");
    }
    header_.elements.back().properties.push_back(std::move(property));
}

// Bytes that one entry takes at the least: no count in the header may promise more than the file holds.
std::uint64_t HeaderParser::smallestSize(const PlyElement& e) const {
    std::uint64_t size = 0;
    for (const PlyProperty& p : e.properties)
        size += header_.encoding == PlyEncoding::text ? 2 : p.listCount ? sizeOf(*p.listCount) : sizeOf(p.type);
    return size;
}

void HeaderParser::checkVertices(PlyElement& e) {
    std::array<bool, kPlyRoles> seen{};
    for (PlyProperty& p : e.properties) {
        const PlyRole role = p.listCount ? PlyRole::none : roleNamed(p.name);
        if (!std::exchange(seen[static_cast<std::size_t>(role)], true)) p.role = role;
    }
    const auto has = [&seen](PlyRole r) { return seen[static_cast<std::size_t>(r)]; };
    if (!has(PlyRole::x) || !has(PlyRole::y) || !has(PlyRole::z)) fail("the vertices have no x, y and z");
    if (e.count > 0xfffffffeu) fail("more vertices than 32 bits can count");
    header_.vertexCount = e.count;
    header_.normals = has(PlyRole::nx) && has(PlyRole::ny) && has(PlyRole::nz);
    header_.uvs = has(PlyRole::u) && has(PlyRole::v);
}

void HeaderParser::check() {
    bool hasVertices = false, hasFaces = false;
    // The last number of a text file may end with the file.
    std::uint64_t left = static_cast<std::uint64_t>(end_ - p_) + 1;
    for (PlyElement& e : header_.elements) {
        const std::uint64_t size = smallestSize(e);
        if (size == 0 && e.count > 0) fail(fmt::format("the element `{}` has no properties", e.name.substr(0, 40)));
        if (size > 0 && e.count > left / size)
            fail(fmt::format("{} entries of `{}` are more than the file holds", e.count, e.name.substr(0, 40)));
        left -= size * e.count;
        hasFaces |= e.name == "face";
        if (e.name == "vertex") {
            hasVertices = true;
            checkVertices(e);
        }
    }
    if (!hasVertices) fail("there are no vertices");
    if (!hasFaces && content_ == PlyContent::mesh) fail("there are no faces");
}

} // namespace

PlyHeader parsePlyHeader(std::string_view bytes, const std::string& name, PlyContent content) {
    return HeaderParser(bytes, name, content).parse();
}

namespace {

template <typename T> double load(const char* p, bool swap) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), p, sizeof(T));
    if (swap) std::reverse(bytes.begin(), bytes.end());
    return static_cast<double>(std::bit_cast<T>(bytes));
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
        return load<float>(p, swap);
    case PlyScalar::float64:
        break;
    }
    return load<double>(p, swap);
}

} // namespace

PlyCursor::PlyCursor(const PlyHeader& header, std::string_view bytes, const std::string& name)
    : begin_(bytes.data()), p_(begin_ + header.bodyOffset), end_(begin_ + bytes.size()), last_(p_), name_(name),
      text_(header.encoding == PlyEncoding::text),
      swap_((header.encoding == PlyEncoding::bigEndian) == (std::endian::native == std::endian::little)) {}

void PlyCursor::failAt(const char* place, const std::string& what) const {
    throw IoError(fmt::format("cannot read `{}`: byte {}: {}", name_, place - begin_, what));
}

double PlyCursor::textScalar() {
    while (p_ < end_ && static_cast<unsigned char>(*p_) <= ' ') ++p_;
    last_ = p_;
    if (p_ == end_) fail("the file ends too early");
    const auto value = scanNumber<double>(p_, end_);
    const bool ended = p_ == end_ || static_cast<unsigned char>(*p_) <= ' ';
    if (!value || !ended) fail("this is not a number that fits");
    return *value;
}

double PlyCursor::scalar(PlyScalar type) {
    if (text_) return textScalar();
    last_ = p_;
    const std::size_t size = sizeOf(type);
    if (left() < size) fail("the file ends too early");
    p_ += size;
    return loadScalar(type, last_, swap_);
}

std::uint64_t PlyCursor::listLength(const PlyProperty& p) {
    const double n = scalar(*p.listCount);
    const std::uint64_t itemSize = text_ ? 1 : sizeOf(p.type);
    if (!(n >= 0) || n != std::floor(n) || n > static_cast<double>(left() / itemSize + 1))
        fail(fmt::format("a list of {} entries is more than the file holds", n));
    return static_cast<std::uint64_t>(n);
}

void PlyCursor::skip(const PlyProperty& p) {
    for (std::uint64_t n = p.listCount ? listLength(p) : 1; n > 0; --n) scalar(p.type);
}

void PlyCursor::skip(const PlyElement& e) {
    for (std::uint64_t i = 0; i < e.count; ++i)
        for (const PlyProperty& p : e.properties) skip(p);
}

} // namespace abbe
