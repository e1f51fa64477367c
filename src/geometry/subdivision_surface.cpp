#include "geometry/subdivision_surface.h"

#include "base/check.h"
#include "base/parallel.h"
#include "geometry/subdivision_layout.h"
#include "geometry/subdivision_limit.h"

#include <algorithm>
#include <array>
#include <cmath>
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

namespace {

using Impl = SubdivisionSurface::Impl;

// Pieces that each edge asks for, as a real number: its length, or its size in pixels, over the rate. Seen along its
// limit curve, or where displacement takes that; an edge is measured in its first face.
class EdgeMeasure {
  public:
    EdgeMeasure(const Impl& s, const Dicing& dicing, const Displacement* displacement)
        : surface_(s), dicing_(dicing), displacement_(displacement) {}

    std::vector<double> run() {
        const auto edgeCount = static_cast<std::size_t>(surface_.level().GetNumEdges());
        constexpr std::size_t block = 64;
        const auto faces = static_cast<std::size_t>(surface_.faceCount());
        std::vector<double> pieces(edgeCount, 1);
        std::vector<int> owner(edgeCount, -1);
        for (std::size_t f = faces; f-- > 0;)
            if (surface_.hasSurface[f])
                for (const int e : surface_.level().GetFaceEdges(static_cast<int>(f)))
                    owner[static_cast<std::size_t>(e)] = static_cast<int>(f);
        parallelFor((faces + block - 1) / block, [&](std::size_t b) {
            FaceEvaluator face(surface_);
            for (std::size_t f = b * block; f < std::min(faces, (b + 1) * block); ++f) {
                if (!surface_.hasSurface[f]) continue;
                face.setFace(static_cast<int>(f), displacement_ && !surface_.uvCorners.empty());
                const auto edges = surface_.level().GetFaceEdges(static_cast<int>(f));
                for (int i = 0; i < edges.size(); ++i)
                    if (const auto e = static_cast<std::size_t>(edges[i]); owner[e] == static_cast<int>(f))
                        pieces[e] = edge(face, i);
            }
        });
        return pieces;
    }

  private:
    double edge(const FaceEvaluator& face, int i) const {
        int samples = 4;
        double pieces = along(face, i, samples);
        // What displaces may be finer than four samples: as many as there will be pieces.
        while (displacement_ && pieces > samples && samples < kMostSamples) {
            samples = std::min(kMostSamples, 4 * samples);
            pieces = along(face, i, samples);
        }
        return pieces;
    }

    double along(const FaceEvaluator& face, int i, int samples) const {
        double sum = 0;
        Vec3 last;
        for (int k = 0; k <= samples; ++k) {
            float uv[2];
            face.parameterization().GetEdgeCoord(i, static_cast<float>(k) / static_cast<float>(samples), uv);
            Vec3 p = displacement_ ? face.displaced(uv[0], uv[1], *displacement_).place() : face.position(uv[0], uv[1]);
            if (dicing_.place) p = Vec3(dicing_.place->point(Vec3d(p)));
            if (k > 0) {
                const double l = static_cast<double>(length(p - last));
                const double unit = dicing_.pixelSize ? std::min(dicing_.pixelSize(last), dicing_.pixelSize(p)) : 1;
                sum += l / (dicing_.rate * unit); // infinite at the camera itself: the largest rate then
            }
            last = p;
        }
        return sum;
    }

    static constexpr int kMostSamples = 256;
    const Impl& surface_;
    const Dicing& dicing_;
    const Displacement* displacement_;
};

std::uint64_t trianglesOf(const Impl& s, const std::vector<int>& rates) {
    std::uint64_t sum = 0;
    for (int f = 0; f < s.faceCount(); ++f) {
        if (!s.hasSurface[static_cast<std::size_t>(f)]) continue;
        const auto edges = s.level().GetFaceEdges(f);
        const auto rate = [&](int i) { return static_cast<std::uint64_t>(rates[static_cast<std::size_t>(edges[i])]); };
        if (edges.size() == 4) {
            sum += 2 * std::max(rate(0), rate(2)) * std::max(rate(1), rate(3));
            continue;
        }
        std::uint64_t largest = 0;
        for (int i = 0; i < edges.size(); ++i) largest = std::max(largest, rate(i));
        const auto n = static_cast<std::uint64_t>(edges.size());
        // Triangles of Loop; else n quads of half the rate.
        sum += s.scheme == osd::Sdc::SCHEME_LOOP ? largest * largest : std::max(n, n * largest * largest / 2);
    }
    return sum;
}

} // namespace

DicingPlan SubdivisionSurface::plan(const Dicing& dicing, std::uint64_t maxBytes,
                                    const Displacement* displacement) const {
    ABBE_CHECK(dicing.rate > 0 || dicing.mode == Dicing::Mode::level);
    const auto edges = static_cast<std::size_t>(impl_->level().GetNumEdges());
    const bool level = dicing.mode == Dicing::Mode::level;
    const std::vector<double> wanted =
        level ? std::vector<double>(edges, std::exp2(dicing.rate)) : EdgeMeasure(*impl_, dicing, displacement).run();
    DicingPlan plan;
    plan.edgeRates.resize(edges);
    const auto take = [&](double coarser) {
        plan.coarser = coarser;
        bool lowest = true;
        for (std::size_t e = 0; e < edges; ++e) {
            const double pieces = std::min(std::ceil(wanted[e] / coarser), static_cast<double>(kMaxRate));
            plan.edgeRates[e] = pieces >= 1 ? static_cast<int>(pieces) : 1; // NaN: 1
            lowest = lowest && plan.edgeRates[e] == 1;
        }
        plan.triangles = trianglesOf(*impl_, plan.edgeRates);
        plan.bytes = plan.triangles * (displacement ? kDisplacedBytesPerTriangle : kBytesPerTriangle);
        return plan.bytes <= maxBytes || lowest;
    };
    if (take(1)) return plan;
    // The number falls with the square of the factor, but not where edges are at the largest or the smallest rate.
    double coarser = 1;
    do
        coarser *= level ? 2
                         : std::max(1.05, std::sqrt(static_cast<double>(plan.bytes) /
                                                    static_cast<double>(std::max<std::uint64_t>(maxBytes, 1))));
    while (!take(coarser));
    return plan;
}

namespace {

class Dicer {
  public:
    Dicer(const Impl& s, const DicingPlan& plan, const CagePoints& points, const Displacement* displacement)
        : surface_(s), points_(points), plan_(plan), displacement_(displacement), layout_(s, plan.edgeRates),
          faces_(static_cast<std::size_t>(s.faceCount())),
          block_(std::clamp<std::size_t>(faces_ / (16 * static_cast<std::size_t>(threadCount())), 1, 64)) {}

    DicedSurface run() {
        place();
        forBlocks([&](std::size_t begin, std::size_t end) {
            FaceEvaluator face(surface_, points_);
            PatternMaker maker;
            std::vector<int> rates;
            std::vector<std::uint32_t> around;
            for (std::size_t f = begin; f < end; ++f)
                if (surface_.hasSurface[f]) dice(f, face, maker, rates, around);
        });
        // Faces on two sides of a crease find the same point up to rounding: rays would slip through the difference.
        if (displacement_) joinDisplaced();
        for (const DicedSeam& seam : layout_.seams)
            std::copy_n(out_.mesh.positions.begin() + seam.original, seam.count,
                        out_.mesh.positions.begin() + seam.copy);
        out_.seams = std::move(layout_.seams);
        out_.faces.reserve(starts_.size());
        for (const Start& start : starts_) out_.faces.push_back({start.triangles, start.quads});
        return std::move(out_);
    }

  private:
    // What displacement does to a vertex on the boundary of a face; after joining, sums over those in one place.
    struct Moved {
        Vec3 position, direction;
        float length = 0;
        std::uint32_t count = 0;
    };
    struct Start {
        std::uint64_t inside = 0, triangles = 0, quads = 0;
    };

    template <typename Body> void forBlocks(const Body& body) {
        parallelFor((faces_ + block_ - 1) / block_,
                    [&](std::size_t b) { body(b * block_, std::min(faces_, (b + 1) * block_)); });
    }

    void ratesOf(std::size_t f, std::vector<int>& rates) const {
        rates.clear();
        for (const int e : surface_.level().GetFaceEdges(static_cast<int>(f)))
            rates.push_back(plan_.edgeRates[static_cast<std::size_t>(e)]);
    }

    // Counts what every face makes, and gives each its place in the mesh.
    void place() {
        starts_.resize(faces_ + 1);
        forBlocks([&](std::size_t begin, std::size_t end) {
            PatternMaker maker;
            std::vector<int> rates;
            for (std::size_t f = begin; f < end; ++f) {
                if (!surface_.hasSurface[f]) continue;
                ratesOf(f, rates);
                const FacePattern& p = maker.pattern({surface_.scheme, static_cast<int>(rates.size())}, rates);
                starts_[f + 1] = {p.inside(), p.triangles.size(), p.quads.size()};
            }
        });
        starts_[0].inside = layout_.vertexCount;
        for (std::size_t f = 0; f < faces_; ++f) {
            starts_[f + 1].inside += starts_[f].inside;
            starts_[f + 1].triangles += starts_[f].triangles;
            starts_[f + 1].quads += starts_[f].quads;
        }
        const Start& all = starts_[faces_];
        ABBE_CHECK(all.inside < 0xffffffffu);
        MeshData& m = out_.mesh;
        m.positions.reserve(all.inside + 2); // Embree reads 16 bytes
        m.positions.resize(all.inside);
        m.normals.resize(all.inside);
        if (textured()) m.uvs.resize(all.inside);
        if (displacement_ && !layout_.seams.empty()) moved_.resize(layout_.vertexCount);
        for (const auto& a : surface_.attributes)
            m.attributes.push_back(
                {a.name, a.channels, std::vector<float>(all.inside * static_cast<std::size_t>(a.channels))});
        m.triangles.resize(all.triangles);
        m.quads.resize(all.quads);
    }

    bool textured() const { return !surface_.uvCorners.empty(); }

    void evaluate(const FaceEvaluator& face, Vec2 at, std::uint32_t vertex) {
        face.attributes(at.x, at.y, out_.mesh.attributes, vertex);
        if (displacement_) return evaluateDisplaced(face, at, vertex);
        const LimitPoint p = face.point(at.x, at.y);
        out_.mesh.positions[vertex] = p.position;
        out_.mesh.normals[vertex] = p.normal;
        if (textured()) out_.mesh.uvs[vertex] = face.texture(at.x, at.y);
    }

    void evaluateDisplaced(const FaceEvaluator& face, Vec2 at, std::uint32_t vertex) {
        const DisplacedLimit d = face.displaced(at.x, at.y, *displacement_);
        out_.mesh.positions[vertex] = d.place();
        out_.mesh.normals[vertex] = Vec3(d.moved.normal);
        if (textured()) out_.mesh.uvs[vertex] = d.texture;
        if (vertex < moved_.size())
            moved_[vertex] = {Vec3(d.position), Vec3(d.moved.direction), static_cast<float>(d.moved.length), 1};
    }

    // The faces at a seam move its points to different places: all go to the mean, else rays would slip through.
    void joinDisplaced() {
        const auto each = [](const std::vector<DicedSeam>& seams, const auto& body) {
            for (const DicedSeam& seam : seams)
                for (std::uint32_t i = 0; i < seam.count; ++i) body(seam.copy + i, seam.original + i);
        };
        each(layout_.seams, [&](std::uint32_t copy, std::uint32_t original) {
            Moved& sum = moved_[original];
            sum.direction += moved_[copy].direction;
            sum.length += moved_[copy].length;
            ++sum.count;
        });
        each(layout_.seams, [&](std::uint32_t, std::uint32_t original) {
            out_.mesh.positions[original] = meanPlace(moved_[original]);
        });
        std::vector<Vec3>& normals = out_.mesh.normals;
        each(layout_.smoothSeams,
             [&](std::uint32_t copy, std::uint32_t original) { normals[original] += normals[copy]; });
        each(layout_.smoothSeams, [&](std::uint32_t, std::uint32_t original) {
            if (const float l = length(normals[original]); l > 0) normals[original] = normals[original] / l;
        });
        each(layout_.smoothSeams,
             [&](std::uint32_t copy, std::uint32_t original) { normals[copy] = normals[original]; });
    }

    Vec3 meanPlace(const Moved& sum) const {
        const auto count = static_cast<float>(sum.count);
        const float l = length(sum.direction);
        if (displacement_->space != Displacement::Space::normal) return sum.position + sum.direction / count;
        if (!(l > 1e-3f * count)) return sum.position; // normals that cancel: a blade's edge stays
        return sum.position + sum.direction * (sum.length / (count * l));
    }

    void dice(std::size_t f, FaceEvaluator& face, PatternMaker& maker, std::vector<int>& rates,
              std::vector<std::uint32_t>& around) {
        face.setFace(static_cast<int>(f), textured());
        ratesOf(f, rates);
        const FacePattern& p = maker.pattern(face.parameterization(), rates);
        around.clear();
        std::size_t next = 0;
        for (std::uint32_t i = 0; i < rates.size(); ++i) {
            const std::uint32_t c = surface_.firstCorner[f] + i;
            around.push_back(layout_.cornerVertex[c]);
            if (layout_.cornerLeads[c]) evaluate(face, p.points[next], around.back());
            ++next;
            const auto inside = static_cast<std::uint32_t>(rates[i] - 1);
            for (std::uint32_t k = 0; k < inside; ++k, ++next) {
                around.push_back(layout_.sideFirst[c] + (layout_.sideReversed[c] ? inside - 1 - k : k));
                if (layout_.sideLeads[c]) evaluate(face, p.points[next], around.back());
            }
        }
        ABBE_DCHECK(next == p.boundary);
        const auto first = static_cast<std::uint32_t>(starts_[f].inside);
        for (std::size_t i = 0; i < p.inside(); ++i)
            evaluate(face, p.points[p.boundary + i], first + static_cast<std::uint32_t>(i));
        join(f, p, around);
    }

    void join(std::size_t f, const FacePattern& p, const std::vector<std::uint32_t>& around) {
        const auto boundary = static_cast<std::uint32_t>(p.boundary);
        const auto first = static_cast<std::uint32_t>(starts_[f].inside);
        const auto vertex = [&](int i) {
            const auto k = static_cast<std::uint32_t>(i);
            return k < boundary ? around[k] : first + (k - boundary);
        };
        auto triangle = out_.mesh.triangles.begin() + static_cast<std::ptrdiff_t>(starts_[f].triangles);
        for (const auto& t : p.triangles) *triangle++ = {vertex(t[0]), vertex(t[1]), vertex(t[2])};
        auto quad = out_.mesh.quads.begin() + static_cast<std::ptrdiff_t>(starts_[f].quads);
        for (const auto& q : p.quads) *quad++ = {vertex(q[0]), vertex(q[1]), vertex(q[2]), vertex(q[3])};
    }

    const Impl& surface_;
    const CagePoints& points_;
    const DicingPlan& plan_;
    const Displacement* displacement_;
    std::vector<Moved> moved_; // if there are seams
    SubdivisionLayout layout_;
    std::size_t faces_, block_;
    std::vector<Start> starts_; // of each face, and one past the last
    DicedSurface out_;
};

} // namespace

DicedSurface SubdivisionSurface::dice(const DicingPlan& plan, const Displacement* displacement) const {
    ABBE_CHECK(plan.edgeRates.size() == static_cast<std::size_t>(impl_->level().GetNumEdges()));
    return Dicer(*impl_, plan, impl_->points, displacement).run();
}

DicedSurface SubdivisionSurface::dice(const DicingPlan& plan, std::span<const Vec3> points,
                                      const Displacement* displacement) const {
    ABBE_CHECK(plan.edgeRates.size() == static_cast<std::size_t>(impl_->level().GetNumEdges()));
    ABBE_CHECK(points.size() == impl_->points.offsets.size());
    return Dicer(*impl_, plan, CagePoints(points), displacement).run();
}

} // namespace abbe
