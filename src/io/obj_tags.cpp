#include "io/mesh_file.h"
#include "io/number_scan.h"

#include <array>
#include <fmt/format.h>
#include <vector>

namespace abbe {

namespace {

struct Tag {
    std::string_view name;
    std::vector<std::int64_t> integers;
    std::vector<double> numbers;
    std::vector<std::string_view> words;
};

class TagReader {
  public:
    explicit TagReader(std::string_view text) : p_(text.data()), end_(p_ + text.size()) {}

    std::optional<std::string> read(Tag& tag) {
        tag.name = word();
        if (tag.name.empty()) return "a tag without a name";
        const std::string_view counts = word();
        std::array<std::uint64_t, 3> n{};
        const char* c = counts.data();
        const char* last = c + counts.size();
        for (std::size_t i = 0; i < 3; ++i) {
            const auto count = scanNumber<std::uint64_t>(c, last);
            if (!count || (i < 2 ? c == last || *c++ != '/' : c != last)) return "the counts of a tag are like `2/1/0`";
            n[i] = *count;
        }
        for (const std::uint64_t count : n) // every value takes two characters
            if (count > static_cast<std::uint64_t>(end_ - p_)) return "a tag counts more values than its line holds";
        for (std::uint64_t i = 0; i < n[0]; ++i)
            if (!value(tag.integers)) return fault("whole number");
        for (std::uint64_t i = 0; i < n[1]; ++i)
            if (!value(tag.numbers)) return fault("number");
        for (std::uint64_t i = 0; i < n[2]; ++i) {
            tag.words.push_back(word());
            if (tag.words.back().empty()) return "a word is missing in a tag";
        }
        if (!word().empty()) return "more values in a tag than it counts";
        return std::nullopt;
    }

  private:
    std::string_view word() {
        while (p_ < end_ && static_cast<unsigned char>(*p_) <= ' ') ++p_;
        const char* start = p_;
        while (p_<end_&& static_cast<unsigned char>(*p_)> ' ') ++p_;
        return last_ = {start, static_cast<std::size_t>(p_ - start)};
    }

    template <typename T> bool value(std::vector<T>& out) {
        const std::string_view w = word();
        const char* p = w.data();
        const auto x = scanNumber<T>(p, w.data() + w.size());
        if (!x || p != w.data() + w.size()) return false;
        out.push_back(*x);
        return true;
    }

    std::string fault(std::string_view what) const {
        return last_.empty() ? fmt::format("a {} is missing in a tag", what)
                             : fmt::format("`{}` is not a {} of a tag", last_.substr(0, 40), what);
    }

    const char* p_;
    const char* end_;
    std::string_view last_;
};

bool inRange(std::int64_t i, std::size_t count) { return i >= 0 && static_cast<std::uint64_t>(i) < count; }

// Sharpness of the i-th edge or corner: one for each, or one for all. Negative ones mean smooth.
float sharpness(const Tag& tag, std::size_t i) {
    const double s = tag.numbers.size() > 1 ? tag.numbers[i] : tag.numbers[0];
    return static_cast<float>(s > 0 ? std::min(s, 1e6) : 0);
}

std::optional<std::string> crease(const Tag& tag, CageFile& file) {
    const std::size_t ends = tag.integers.size();
    if (ends < 2) return "a crease needs two vertices";
    const std::size_t edges = ends - 1;
    if (tag.numbers.size() != 1 && tag.numbers.size() != edges) return "a crease needs a sharpness";
    for (std::size_t i = 0; i < edges; ++i) {
        const std::int64_t a = tag.integers[i], b = tag.integers[i + 1];
        for (const std::int64_t v : {a, b})
            if (!inRange(v, file.cage.positions.size()))
                return fmt::format("a crease names vertex {}, but there are {} (from 0)", v,
                                   file.cage.positions.size());
        file.cage.creases.push_back({static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), sharpness(tag, i)});
    }
    return std::nullopt;
}

std::optional<std::string> corner(const Tag& tag, CageFile& file) {
    if (tag.integers.empty()) return "a corner needs a vertex";
    if (tag.numbers.size() != 1 && tag.numbers.size() != tag.integers.size()) return "a corner needs a sharpness";
    for (std::size_t i = 0; i < tag.integers.size(); ++i) {
        const std::int64_t v = tag.integers[i];
        if (!inRange(v, file.cage.positions.size()))
            return fmt::format("a corner names vertex {}, but there are {} (from 0)", v, file.cage.positions.size());
        file.cage.sharpCorners.push_back({static_cast<std::uint32_t>(v), sharpness(tag, i)});
    }
    return std::nullopt;
}

std::optional<std::string> hole(const Tag& tag, CageFile& file) {
    for (const std::int64_t f : tag.integers) {
        if (!inRange(f, file.cage.faceSizes.size()))
            return fmt::format("a hole names face {}, but there are {} (from 0)", f, file.cage.faceSizes.size());
        file.cage.holes.push_back(static_cast<std::uint32_t>(f));
    }
    return std::nullopt;
}

// The one integer of an option, below `count`.
std::optional<std::int64_t> option(const Tag& tag, std::int64_t count) {
    if (tag.integers.size() != 1 || tag.integers[0] < 0 || tag.integers[0] >= count) return std::nullopt;
    return tag.integers[0];
}

std::optional<std::string> boundary(const Tag& tag, CageFile& file) {
    using Boundary = SubdivisionCage::Boundary;
    constexpr std::array meaning{Boundary::none, Boundary::edgeAndCorner, Boundary::edgeOnly};
    const auto n = option(tag, meaning.size());
    if (!n) return "`interpolateboundary` is 0, 1 or 2";
    file.cage.boundary = meaning[static_cast<std::size_t>(*n)];
    file.statesBoundary = true;
    return std::nullopt;
}

std::optional<std::string> faceVarying(const Tag& tag, CageFile& file) {
    const auto n = option(tag, 6);
    if (!n) return "`facevaryinginterpolateboundary` is 0 to 5";
    file.cage.faceVarying = static_cast<SubdivisionCage::FaceVarying>(*n);
    file.statesFaceVarying = true;
    return std::nullopt;
}

std::optional<std::string> creaseMethod(const Tag& tag, CageFile& file) {
    if (tag.words.size() != 1 || (tag.words[0] != "normal" && tag.words[0] != "chaikin"))
        return "`creasemethod` is `normal` or `chaikin`";
    file.cage.creasing =
        tag.words[0] == "chaikin" ? SubdivisionCage::Creasing::chaikin : SubdivisionCage::Creasing::uniform;
    file.statesCreasing = true;
    return std::nullopt;
}

std::optional<std::string> smoothTriangles(const Tag& tag, CageFile& file) {
    if (tag.words.size() != 1 || (tag.words[0] != "catmark" && tag.words[0] != "smooth"))
        return "`smoothtriangles` is `catmark` or `smooth`";
    file.cage.smoothTriangles = tag.words[0] == "smooth";
    return std::nullopt;
}

struct Rule {
    std::string_view name;
    std::optional<std::string> (*apply)(const Tag&, CageFile&);
};
constexpr std::array kRules{Rule{"crease", crease},
                            Rule{"corner", corner},
                            Rule{"hole", hole},
                            Rule{"interpolateboundary", boundary},
                            Rule{"facevaryinginterpolateboundary", faceVarying},
                            Rule{"creasemethod", creaseMethod},
                            Rule{"smoothtriangles", smoothTriangles}};

} // namespace

std::optional<std::string> applyObjTag(std::string_view text, CageFile& file) {
    Tag tag;
    if (auto fault = TagReader(text).read(tag)) return fault;
    for (const Rule& rule : kRules)
        if (rule.name == tag.name) return rule.apply(tag, file);
    if (file.ignoredTags++ == 0) file.ignoredTag = tag.name;
    return std::nullopt;
}

} // namespace abbe
