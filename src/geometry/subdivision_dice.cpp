#include "base/check.h"
#include "base/parallel.h"
#include "geometry/subdivision_layout.h"
#include "geometry/subdivision_pattern.h"

#include <algorithm>

namespace abbe {

namespace {

using Impl = SubdivisionSurface::Impl;

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
