// Seen from a point: what a shape's sampler promises, by tracing rays at the shape.
#pragma once

#include "geometry/embree_scene_builder.h"
#include "render/shape.h"
#include "support/chi_square.h"
#include "support/statistics.h"

#include <array>
#include <memory>
#include <utility>
#include <vector>

namespace abbe::test {

inline std::unique_ptr<Intersector> intersectorOf(const Shape& shape) {
    EmbreeSceneBuilder builder;
    builder.addShape(shape, {});
    return builder.build();
}

// All directions, or the cone about a shape's bounds if the point is outside of their sphere: (x, y) in the unit
// square, uniform per solid angle.
class DirectionSquare {
  public:
    DirectionSquare(const Bounds3& bounds, Vec3 from) {
        const Vec3d d = Vec3d(bounds.centre()) - Vec3d(from);
        const double radius = 1.0001 * static_cast<double>(bounds.radius()), distance = length(d);
        axis_ = distance > 0 ? normalize(d) : Vec3d(0, 0, 1);
        const double sine = radius / distance;
        oneMinusCos_ = distance > radius ? sine * sine / (1 + std::sqrt(1 - sine * sine)) : 2;
        const Vec3d other = std::abs(axis_.x) < 0.6 ? Vec3d(1, 0, 0) : Vec3d(0, 1, 0);
        x_ = normalize(cross(other, axis_));
        y_ = cross(axis_, x_);
    }
    double solidAngle() const { return 2 * kPiD * oneMinusCos_; }
    Vec3d direction(double x, double y) const {
        const double h = x * oneMinusCos_, r = std::sqrt(h * (2 - h)), phi = 2 * kPiD * y;
        return x_ * (r * std::cos(phi)) + y_ * (r * std::sin(phi)) + axis_ * (1 - h);
    }
    Vec2d square(Vec3d w) const {
        const Vec3d e = w - axis_; // |e|² / 2 = 1 - cos, exact for small angles
        const double phi = std::atan2(dot(w, y_), dot(w, x_)) / (2 * kPiD);
        return {0.5 * lengthSquared(e) / oneMinusCos_, phi < 0 ? phi + 1 : phi};
    }

  private:
    Vec3d axis_, x_, y_;
    double oneMinusCos_;
};

struct SamplingReport {
    double pdfIntegral = 0;   // over all directions
    double chiSquareP = 1;    // of the samples' directions against that density
    double worstPdfRatio = 0; // |sample's density / density of the hit there - 1|
    double missed = 0;        // share of the samples whose ray from `from` does not meet the shape there
    int samples = 0;
};

// Density of the first point of the shape along a ray, or of all of them.
inline double pdfAlong(const Shape& shape, const Intersector& scene, Vec3 from, Vec3 w, bool all) {
    double sum = 0;
    Ray ray{from, w};
    for (int i = 0; i < (all ? 64 : 1); ++i) {
        SurfaceHit hit;
        if (!scene.intersect(ray, hit)) break;
        sum += static_cast<double>(shape.sampling()->pdfSolidAngle(from, hit));
        ray.origin = spawnOrigin(hit, w);
    }
    return sum;
}

// `hidden`: samples lie on the far side and behind other parts of the shape too.
inline SamplingReport examine(const Shape& shape, Vec3 from, bool hidden, int samples = 40000, int cells = 12,
                              int rays = 40) {
    const auto scene = intersectorOf(shape);
    const DirectionSquare directions(shape.bounds(), from);
    SamplingReport report;
    const std::size_t count = static_cast<std::size_t>(cells) * static_cast<std::size_t>(cells);
    std::vector<double> expected(count, 0.0), observed(count + 1, 0.0);
    const int n = cells * rays;
    for (int i = 0; i < n; ++i)
        for (int j = 0; j < n; ++j) {
            const Vec3 w(directions.direction((i + 0.5) / n, (j + 0.5) / n));
            const double pdf = pdfAlong(shape, *scene, from, w, hidden) * directions.solidAngle() / (double(n) * n);
            expected[static_cast<std::size_t>(i / rays * cells + j / rays)] += pdf;
            report.pdfIntegral += pdf;
        }
    Random random(17);
    for (int i = 0; i < samples; ++i) {
        const auto s = shape.sampling()->sample(from, 0, {random.uniform(), random.uniform()});
        if (!s) {
            ++observed[count];
            continue;
        }
        ++report.samples;
        const Vec3d d = Vec3d(s->p) - Vec3d(from);
        const Vec2d q = directions.square(normalize(d));
        const auto cell = [cells](double x) { return std::clamp(static_cast<int>(x * cells), 0, cells - 1); };
        ++observed[static_cast<std::size_t>(cell(q.x) * cells + cell(q.y))];

        SurfaceHit hit;
        const Ray ray{from, Vec3(normalize(d)), static_cast<float>(length(d) * 1.001)};
        const double grazing = std::abs(dot(normalize(d), Vec3d(s->ng)));
        const bool met = scene->intersect(ray, hit) &&
                         length(Vec3d(hit.p) - Vec3d(s->p)) < 2e-3 * length(d) / std::max(grazing, 1e-3);
        if (!met) {
            ++report.missed;
            continue;
        }
        // Edge-on the densities of neighbouring points differ; another face may lie just in front.
        if (grazing < 1e-2 || dot(hit.ng, s->ng) < 0.999f) continue;
        const double ratio = static_cast<double>(s->pdfSolidAngle / shape.sampling()->pdfSolidAngle(from, hit));
        report.worstPdfRatio = std::max(report.worstPdfRatio, std::abs(ratio - 1));
    }
    report.missed /= std::max(1, report.samples);
    expected.push_back(std::max(1e-6, 1 - report.pdfIntegral));
    for (double& e : expected) e *= samples;
    // Cells that the outline only touches may be missed by all rays: they are counted together.
    for (std::size_t i = 0; i < count; ++i)
        if (expected[i] < 2) {
            observed[count] += std::exchange(observed[i], 0.0);
            expected[count] += std::exchange(expected[i], 0.0);
        }
    report.chiSquareP = chiSquareTest(observed, expected).pValue;
    return report;
}

} // namespace abbe::test
