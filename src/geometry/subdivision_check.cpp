#include "geometry/subdivision_check.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace abbe {

namespace {

constexpr std::uint32_t kMaxValence = 65535;
constexpr float kLargestCoordinate = 1e15f;
constexpr std::size_t kMaxCorners = 0x3fffffff; // the library counts with int

class CageCheck {
  public:
    explicit CageCheck(const SubdivisionCage& cage) : cage_(cage) {}

    std::optional<std::string> run() {
        using Step = bool (CageCheck::*)();
        for (const Step step : {&CageCheck::sizes, &CageCheck::numbers, &CageCheck::faces, &CageCheck::valences,
                                &CageCheck::textures, &CageCheck::creases, &CageCheck::cornersAndHoles})
            if (!(this->*step)()) return fault_;
        return std::nullopt;
    }

  private:
    template <typename... Args> bool fail(fmt::format_string<Args...> text, Args&&... args) {
        fault_ = fmt::format(text, std::forward<Args>(args)...);
        return false;
    }

    bool sizes() {
        if (cage_.faceSizes.empty()) return fail("the cage has no faces");
        if (cage_.corners.size() > kMaxCorners || cage_.positions.size() > kMaxCorners)
            return fail("the cage has more than {} corners", kMaxCorners);
        std::size_t corners = 0;
        for (std::size_t f = 0; f < cage_.faceSizes.size(); ++f) {
            const std::uint32_t n = cage_.faceSizes[f];
            if (n < 3) return fail("face {} has {} corners", f, n);
            if (n > kMaxValence) return fail("face {} has {} corners, more than {}", f, n, kMaxValence);
            if (n != 3 && cage_.scheme == SubdivisionCage::Scheme::loop)
                return fail("face {} has {} corners, but Loop subdivision needs triangles", f, n);
            corners += n;
        }
        if (corners != cage_.corners.size())
            return fail("{} corners are listed, {} are needed", cage_.corners.size(), corners);
        return true;
    }

    bool numbers() {
        const auto inReach = [](float x) { return std::abs(x) < kLargestCoordinate; }; // false for NaN
        for (std::size_t i = 0; i < cage_.positions.size(); ++i) {
            const Vec3 p = cage_.positions[i];
            if (!inReach(p.x) || !inReach(p.y) || !inReach(p.z))
                return fail("vertex {} is not finite or farther than 1e15 m", i);
        }
        for (std::size_t i = 0; i < cage_.uvs.size(); ++i)
            if (!inReach(cage_.uvs[i].x) || !inReach(cage_.uvs[i].y))
                return fail("texture vertex {} is not finite or beyond 1e15", i);
        return true;
    }

    bool faces() {
        std::vector<std::uint32_t> sorted;
        std::size_t first = 0;
        for (std::size_t f = 0; f < cage_.faceSizes.size(); ++f) {
            sorted.assign(cage_.corners.begin() + static_cast<std::ptrdiff_t>(first),
                          cage_.corners.begin() + static_cast<std::ptrdiff_t>(first + cage_.faceSizes[f]));
            first += cage_.faceSizes[f];
            std::sort(sorted.begin(), sorted.end());
            if (sorted.back() >= cage_.positions.size())
                return fail("face {} names vertex {}, but there are {} points", f, sorted.back(),
                            cage_.positions.size());
            const auto twice = std::adjacent_find(sorted.begin(), sorted.end());
            if (twice != sorted.end()) return fail("face {} has vertex {} twice", f, *twice);
        }
        return true;
    }

    bool valences() {
        // A vertex has at most two edges per face at it.
        std::vector<std::uint32_t> faces(cage_.positions.size());
        for (const std::uint32_t v : cage_.corners)
            if (++faces[v] > kMaxValence / 2) return fail("more than {} faces meet at vertex {}", kMaxValence / 2, v);
        return true;
    }

    bool textures() {
        if (cage_.uvCorners.empty()) return true;
        if (cage_.uvCorners.size() != cage_.corners.size())
            return fail("{} texture corners for {} corners", cage_.uvCorners.size(), cage_.corners.size());
        for (std::size_t i = 0; i < cage_.uvCorners.size(); ++i)
            if (cage_.uvCorners[i] >= cage_.uvs.size())
                return fail("corner {} names texture vertex {}, but there are {}", i, cage_.uvCorners[i],
                            cage_.uvs.size());
        return true;
    }

    static std::uint64_t edge(std::uint32_t a, std::uint32_t b) {
        return static_cast<std::uint64_t>(std::min(a, b)) << 32 | std::max(a, b);
    }

    bool creases() {
        if (cage_.creases.empty()) return true;
        std::vector<std::uint64_t> edges;
        edges.reserve(cage_.corners.size());
        std::size_t first = 0;
        for (const std::uint32_t n : cage_.faceSizes) {
            for (std::uint32_t i = 0; i < n; ++i)
                edges.push_back(edge(cage_.corners[first + i], cage_.corners[first + (i + 1) % n]));
            first += n;
        }
        std::sort(edges.begin(), edges.end());
        for (const SubdivisionCage::Crease& c : cage_.creases) {
            if (!std::binary_search(edges.begin(), edges.end(), edge(c.a, c.b)))
                return fail("a crease runs from vertex {} to {}, which is no edge of a face", c.a, c.b);
            if (!(c.sharpness >= 0)) return fail("the crease from vertex {} to {} has a negative sharpness", c.a, c.b);
        }
        return backToBack();
    }

    // OpenSubdiv 3.5 writes past its tables where two faces share two edges at a vertex and one of these is a crease.
    bool backToBack() {
        std::vector<std::uint64_t> creased;
        for (const SubdivisionCage::Crease& c : cage_.creases)
            if (c.sharpness > 0) creased.push_back(edge(c.a, c.b));
        std::sort(creased.begin(), creased.end());
        std::vector<std::array<std::uint32_t, 3>>
            seen; // a vertex, its end of a crease, its other edge in the same face
        std::size_t first = 0;
        for (const std::uint32_t n : cage_.faceSizes) {
            for (std::uint32_t i = 0; i < n; ++i) {
                const std::uint32_t v = cage_.corners[first + i];
                const std::uint32_t before = cage_.corners[first + (i + n - 1) % n];
                const std::uint32_t after = cage_.corners[first + (i + 1) % n];
                if (std::binary_search(creased.begin(), creased.end(), edge(v, before)))
                    seen.push_back({v, before, after});
                if (std::binary_search(creased.begin(), creased.end(), edge(v, after)))
                    seen.push_back({v, after, before});
            }
            first += n;
        }
        std::sort(seen.begin(), seen.end());
        const auto twice = std::adjacent_find(seen.begin(), seen.end());
        if (twice == seen.end()) return true;
        return fail("a crease ends at vertex {}, where two faces lie back to back", (*twice)[0]);
    }

    bool cornersAndHoles() {
        for (const SubdivisionCage::Corner& c : cage_.sharpCorners) {
            if (c.vertex >= cage_.positions.size())
                return fail("a corner names vertex {}, but there are {} points", c.vertex, cage_.positions.size());
            if (!(c.sharpness >= 0)) return fail("the corner at vertex {} has a negative sharpness", c.vertex);
        }
        for (const std::uint32_t f : cage_.holes)
            if (f >= cage_.faceSizes.size())
                return fail("a hole names face {}, but there are {} faces", f, cage_.faceSizes.size());
        return true;
    }

    const SubdivisionCage& cage_;
    std::string fault_;
};

} // namespace

std::optional<std::string> findFault(const SubdivisionCage& cage) { return CageCheck(cage).run(); }

} // namespace abbe
