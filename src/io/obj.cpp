#include "io/file.h"
#include "io/mesh_file.h"
#include "io/number_scan.h"
#include "math/hash.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <string_view>

namespace abbe {

namespace {

constexpr std::int32_t kNone = -1;

// A face corner as the file states it: positions in the lists of v, vt and vn, from 0; kNone if left out.
struct Corner {
    std::int32_t v = kNone, vt = kNone, vn = kNone;
    bool operator==(const Corner&) const = default;
};

std::uint64_t hashOfCorner(const Corner& c) {
    const auto word = [](std::int32_t i) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(i)); };
    return combine64(combine64(word(c.v), word(c.vt)), word(c.vn));
}

class ObjParser {
  public:
    ObjParser(std::string_view text, const std::string& name)
        : p_(text.data()), end_(text.data() + text.size()), name_(name) {}

    MeshFile parse();
    CageFile parseCage();

  private:
    [[noreturn]] void fail(const std::string& what) const { fail(line_, what); }
    [[noreturn]] void fail(std::uint64_t line, const std::string& what) const {
        throw IoError(fmt::format("cannot read `{}`: line {}: {}", name_, line, what));
    }

    bool atLineEnd();
    std::string_view word();
    std::string_view restOfLine();
    void skipLine();
    float number(const char* what);

    void statement(std::string_view keyword);
    void vertex();
    void texture();
    void face();
    Corner corner();
    std::int32_t index(std::size_t count, const char* list);
    void beginGroup();

    void read();
    void checkForward() const;
    std::uint32_t vertexOf(MeshData&, Corner);
    void buildFaces(MeshFile&);

    const char* p_;
    const char* end_;
    const std::string& name_;
    std::uint64_t line_ = 1;

    std::vector<Vec3> v_, vn_;
    std::vector<Vec2> vt_;
    std::vector<Corner> corners_;
    std::vector<std::uint32_t> faceSizes_;
    std::vector<std::uint64_t> largeFaceLines_; // of faces with more than four corners, in order
    bool anyTexture_ = false, anyNormal_ = false;
    std::uint64_t ignoredFaces_ = 0;

    // Faces may name vertices that come later; whether they do is known at the end.
    struct Forward {
        std::uint64_t line;
        std::int64_t number;
        char list; // 'v', 't', 'n'
    };
    std::vector<Forward> forward_;

    struct Section {
        std::string name, material;
        std::size_t firstFace;
    };
    std::string object_, group_, material_;
    std::vector<Section> sections_;

    struct TagLine {
        std::uint64_t line;
        std::string_view text;
    };
    std::vector<TagLine> tags_; // of subdivision surfaces

    // Vertices already made, by what was joined: lists in a table of hashes, as one position may be in any number.
    struct Joined {
        Corner corner;
        std::uint32_t next;
    };
    std::vector<std::uint32_t> firstJoined_;
    std::vector<Joined> joined_; // as many as vertices
};

// The length of the line end at `p`: \n, \r\n or \r; 0 if there is none.
int lineEnd(const char* p, const char* end) {
    if (p >= end) return 0;
    if (*p == '\n') return 1;
    if (*p != '\r') return 0;
    return p + 1 < end && p[1] == '\n' ? 2 : 1;
}

// Moves over blanks and continued lines; true at the end of the line, or at a comment.
bool ObjParser::atLineEnd() {
    while (p_ < end_) {
        if (*p_ == ' ' || *p_ == '\t') {
            ++p_;
        } else if (*p_ == '\\') {
            const int length = lineEnd(p_ + 1, end_);
            if (length == 0) return false;
            p_ += 1 + length;
            ++line_;
        } else {
            return *p_ == '\n' || *p_ == '\r' || *p_ == '#';
        }
    }
    return true;
}

// To the start of the next line. Comments are not continued, other lines that nobody reads are.
void ObjParser::skipLine() {
    const bool comment = p_ < end_ && *p_ == '#';
    while (p_ < end_ && lineEnd(p_, end_) == 0) {
        const int continued = *p_ == '\\' && !comment ? lineEnd(p_ + 1, end_) : 0;
        if (continued > 0) ++line_;
        p_ += 1 + continued;
    }
    if (p_ < end_) {
        p_ += lineEnd(p_, end_);
        ++line_;
    }
}

std::string_view ObjParser::word() {
    const char* start = p_;
    while (p_<end_&& static_cast<unsigned char>(*p_)> ' ' && *p_ != '\\') ++p_;
    return {start, static_cast<std::size_t>(p_ - start)};
}

std::string_view ObjParser::restOfLine() {
    const char* start = p_;
    while (p_ < end_ && *p_ != '\n' && *p_ != '\r') ++p_;
    const char* last = p_;
    while (last > start && (last[-1] == ' ' || last[-1] == '\t')) --last;
    return {start, static_cast<std::size_t>(last - start)};
}

float ObjParser::number(const char* what) {
    if (atLineEnd()) fail(fmt::format("a number is missing: {}", what));
    const char* start = p_;
    // By way of double: programs write numbers below the smallest float, which are 0 here.
    const auto value = scanNumber<double>(p_, end_);
    const bool separate = p_ >= end_ || static_cast<unsigned char>(*p_) <= ' ' || *p_ == '\\' || *p_ == '#';
    if (!value || !separate) {
        p_ = start;
        fail(fmt::format("`{}` is not a number that fits", word().substr(0, 40)));
    }
    const auto rounded = static_cast<float>(*value);
    if (!std::isfinite(rounded)) fail(fmt::format("{} is not finite", what));
    return rounded;
}

void ObjParser::vertex() {
    const float x = number("x"), y = number("y"), z = number("z");
    v_.push_back({x, y, z});
    // A weight, or a colour after the position, as some programs write: read for its form, not used.
    for (int extra = 0; !atLineEnd(); ++extra) {
        if (extra == 4) fail("too many numbers after `v`");
        number("the number after the position");
    }
}

void ObjParser::texture() {
    const float u = number("u");
    const float v = atLineEnd() ? 0 : number("v");
    vt_.push_back({u, v});
    if (!atLineEnd()) number("w");
}

// One number of a corner. `count` entries of the list have been read so far.
std::int32_t ObjParser::index(std::size_t count, const char* list) {
    const char* start = p_;
    const auto n = scanNumber<std::int64_t>(p_, end_);
    if (!n) {
        p_ = start;
        fail(fmt::format("`{}` is not a {} number", word().substr(0, 40), list));
    }
    const auto size = static_cast<std::int64_t>(count);
    const std::int64_t position = *n > 0 ? *n - 1 : size + *n;
    if (*n == 0) fail(fmt::format("{} numbers start at 1", list));
    if (position < 0) fail(fmt::format("{} {} of only {} so far", list, *n, count));
    if (position >= std::numeric_limits<std::int32_t>::max()) fail(fmt::format("{} {} is too large", list, *n));
    if (position >= size) forward_.push_back({line_, *n, list[0] == 'v' ? 'v' : list[0] == 't' ? 't' : 'n'});
    return static_cast<std::int32_t>(position);
}

// v, v/vt, v//vn or v/vt/vn.
Corner ObjParser::corner() {
    Corner c;
    c.v = index(v_.size(), "vertex");
    if (p_ < end_ && *p_ == '/') {
        ++p_;
        if (p_ < end_ && *p_ != '/') c.vt = index(vt_.size(), "texture vertex");
        if (p_ < end_ && *p_ == '/') {
            ++p_;
            c.vn = index(vn_.size(), "normal");
        }
    }
    if (p_<end_&& static_cast<unsigned char>(*p_)> ' ' && *p_ != '\\' && *p_ != '#')
        fail(fmt::format("`{}` after a face corner", word().substr(0, 40)));
    anyTexture_ |= c.vt != kNone;
    anyNormal_ |= c.vn != kNone;
    return c;
}

void ObjParser::face() {
    const std::size_t first = corners_.size();
    const std::uint64_t line = line_;
    while (!atLineEnd()) corners_.push_back(corner());
    const std::size_t count = corners_.size() - first;
    if (count == 0) fail("a face without corners");
    if (count < 3) {
        corners_.resize(first);
        ++ignoredFaces_;
        return;
    }
    faceSizes_.push_back(static_cast<std::uint32_t>(count));
    if (count > 4) largeFaceLines_.push_back(line);
}

void ObjParser::beginGroup() {
    Section section{group_.empty() ? object_ : group_, material_, faceSizes_.size()};
    if (!sections_.empty() && sections_.back().firstFace == faceSizes_.size())
        sections_.back() = std::move(section);
    else
        sections_.push_back(std::move(section));
}

void ObjParser::statement(std::string_view keyword) {
    if (keyword == "v") {
        vertex();
    } else if (keyword == "vt") {
        texture();
    } else if (keyword == "vn") {
        const float x = number("x"), y = number("y"), z = number("z");
        vn_.push_back({x, y, z});
    } else if (keyword == "f" || keyword == "fo") {
        face();
    } else if (keyword == "g" || keyword == "o" || keyword == "usemtl") {
        atLineEnd();
        std::string& target = keyword == "g" ? group_ : keyword == "o" ? object_ : material_;
        target = std::string(restOfLine());
        if (keyword == "o") group_.clear();
        beginGroup();
    } else if (keyword == "t") {
        tags_.push_back({line_, restOfLine()});
    } else if (keyword == "l" || keyword == "p" || keyword == "s" || keyword == "mtllib" || keyword == "mg" ||
               keyword == "usemap" || keyword == "maplib" || keyword == "bevel" || keyword == "c_interp" ||
               keyword == "d_interp" || keyword == "lod" || keyword == "shadow_obj" || keyword == "trace_obj") {
        skipLine();
        return;
    } else {
        // Of a file that is perhaps none of these nothing is quoted.
        const std::string what = v_.empty() ? "it" : fmt::format("`{}`", keyword.substr(0, 40));
        fail(what + " is not a statement of polygon meshes");
    }
    if (!atLineEnd()) fail(fmt::format("`{}` at the end of the statement", word().substr(0, 40)));
    skipLine();
}

void ObjParser::checkForward() const {
    for (const Forward& f : forward_) {
        const std::size_t count = f.list == 'v' ? v_.size() : f.list == 't' ? vt_.size() : vn_.size();
        const char* list = f.list == 'v' ? "vertex" : f.list == 't' ? "texture vertex" : "normal";
        if (f.number > static_cast<std::int64_t>(count))
            fail(f.line, fmt::format("{} {} of only {}", list, f.number, count));
    }
}

// The vertex of a corner: made when the combination of position, texture vertex and normal is new.
std::uint32_t ObjParser::vertexOf(MeshData& mesh, Corner c) {
    constexpr std::uint32_t none = 0xffffffffu;
    if (firstJoined_.empty()) firstJoined_.assign(std::bit_ceil(v_.size() + corners_.size() / 8), none);
    std::uint32_t& first = firstJoined_[hashOfCorner(c) & (firstJoined_.size() - 1)];
    for (std::uint32_t i = first; i != none; i = joined_[i].next)
        if (joined_[i].corner == c) return i;
    const auto vertex = static_cast<std::uint32_t>(joined_.size());
    mesh.positions.push_back(v_[c.v]);
    if (anyTexture_) mesh.uvs.push_back(c.vt == kNone ? Vec2{} : vt_[c.vt]);
    if (anyNormal_) mesh.normals.push_back(c.vn == kNone ? Vec3{} : vn_[c.vn]);
    joined_.push_back({c, first});
    return first = vertex;
}

void ObjParser::buildFaces(MeshFile& file) {
    MeshData& mesh = file.mesh;
    const bool plain = !anyTexture_ && !anyNormal_;
    if (plain) mesh.positions = std::move(v_);
    std::vector<std::uint32_t> polygon;
    std::size_t next = 0, large = 0, section = 0;
    const auto closeGroup = [&] {
        if (file.groups.empty()) return;
        MeshGroup& g = file.groups.back();
        g.triangleCount = mesh.triangles.size() - g.firstTriangle;
        g.quadCount = mesh.quads.size() - g.firstQuad;
    };
    for (std::size_t f = 0; f < faceSizes_.size(); ++f) {
        if (section < sections_.size() && sections_[section].firstFace == f) {
            closeGroup();
            file.groups.push_back({std::move(sections_[section].name), std::move(sections_[section].material),
                                   mesh.triangles.size(), 0, mesh.quads.size(), 0});
            ++section;
        }
        polygon.clear();
        for (std::uint32_t i = 0; i < faceSizes_[f]; ++i) {
            const Corner c = corners_[next++];
            polygon.push_back(plain ? static_cast<std::uint32_t>(c.v) : vertexOf(mesh, c));
        }
        const std::uint64_t line = polygon.size() > 4 ? largeFaceLines_[large++] : 0;
        if (!addPolygon(mesh, polygon))
            fail(line, fmt::format("a concave polygon with more than {} corners", kMaxConcaveCorners));
    }
    closeGroup();
}

void ObjParser::read() {
    sections_.push_back({"", "", 0});
    while (p_ < end_) {
        if (atLineEnd()) {
            skipLine();
            continue;
        }
        const std::string_view keyword = word();
        if (keyword.empty()) fail("a character that does not belong here");
        statement(keyword);
    }
    if (faceSizes_.empty())
        throw IoError(fmt::format("cannot read `{}`: {}", name_,
                                  v_.empty() ? "there is no mesh in it" : "it has vertices but no faces"));
    checkForward();
}

MeshFile ObjParser::parse() {
    read();
    MeshFile file;
    file.ignoredFaces = ignoredFaces_;
    buildFaces(file);
    return file;
}

CageFile ObjParser::parseCage() {
    read();
    CageFile file;
    file.ignoredFaces = ignoredFaces_;
    SubdivisionCage& cage = file.cage;
    cage.positions = std::move(v_);
    cage.faceSizes = std::move(faceSizes_);
    cage.corners.reserve(corners_.size());
    for (const Corner& c : corners_) cage.corners.push_back(static_cast<std::uint32_t>(c.v));
    if (anyTexture_) {
        const auto none = static_cast<std::uint32_t>(vt_.size()); // corners without one share the texture vertex (0, 0)
        cage.uvs = std::move(vt_);
        cage.uvs.emplace_back();
        cage.uvCorners.reserve(corners_.size());
        for (const Corner& c : corners_)
            cage.uvCorners.push_back(c.vt == kNone ? none : static_cast<std::uint32_t>(c.vt));
    }
    for (Section& section : sections_)
        if (section.firstFace < cage.faceSizes.size())
            file.groups.push_back({std::move(section.name), section.firstFace});
    for (const TagLine& tag : tags_)
        if (const auto fault = applyObjTag(tag.text, file)) fail(tag.line, *fault);
    return file;
}

} // namespace

MeshFile parseObj(std::string_view text, const std::string& name) { return ObjParser(text, name).parse(); }

CageFile parseObjCage(std::string_view text, const std::string& name) { return ObjParser(text, name).parseCage(); }

CageFile readObjCage(const std::string& path) { return parseObjCage(readFileBytes(path), path); }

MeshFile readObj(const std::string& path) { return parseObj(readFileBytes(path), path); }

} // namespace abbe
