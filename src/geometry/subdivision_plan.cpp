#include "base/check.h"
#include "base/parallel.h"
#include "geometry/subdivision_limit.h"

#include <algorithm>
#include <cmath>

namespace abbe {

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

} // namespace abbe
