#include "geometry/curves_segment.h"

namespace abbe {

namespace {

// kMonomial[basis][k][i]: weight of control point i in the coefficient of u^k.
using Matrix = std::array<std::array<double, 4>, 4>;
constexpr std::array<Matrix, 4> kMonomial{{
    {{{1, 0, 0, 0}, {-1, 1, 0, 0}, {0, 0, 0, 0}, {0, 0, 0, 0}}},
    {{{1. / 6, 4. / 6, 1. / 6, 0}, {-0.5, 0, 0.5, 0}, {0.5, -1, 0.5, 0}, {-1. / 6, 0.5, -0.5, 1. / 6}}},
    {{{0, 1, 0, 0}, {-0.5, 0, 0.5, 0}, {1, -2.5, 2, -0.5}, {-0.5, 1.5, -1.5, 0.5}}},
    {{{1, 0, 0, 0}, {-3, 3, 0, 0}, {3, -6, 3, 0}, {-1, 3, -3, 1}}},
}};

template <typename T> std::array<T, 4> toBezier(const std::array<T, 4>& c) {
    return {c[0], c[0] + c[1] * (1. / 3), c[0] + c[1] * (2. / 3) + c[2] * (1. / 3), c[0] + c[1] + c[2] + c[3]};
}

} // namespace

CurveSegment::CurveSegment(CurveBasis basis, const SizedPoint* points) : c_{}, r_{} {
    const Matrix& m = kMonomial[static_cast<std::size_t>(basis)];
    const std::size_t count = basis == CurveBasis::linear ? 2 : 4;
    for (std::size_t i = 0; i < count; ++i) {
        const Vec3d p(points[i].position);
        const auto r = static_cast<double>(points[i].radius);
        for (std::size_t k = 0; k < count; ++k) {
            c_[k] += p * m[k][i];
            r_[k] += r * m[k][i];
        }
    }
}

std::optional<Vec3d> CurveSegment::tangent(double u) const {
    const Vec3d d = derivative(u);
    const double l2 = lengthSquared(d);
    // Rounding of the coefficients leaves about 1e-16 of their size where the derivative is 0.
    const double scale = lengthSquared(c_[1]) + lengthSquared(c_[2]) + lengthSquared(c_[3]);
    if (l2 > 1e-20 * scale) return d * (1 / std::sqrt(l2));
    for (double h = 0x1p-12; h <= 1; h *= 2) {
        const Vec3d chord = position(std::min(u + h, 1.0)) - position(std::max(u - h, 0.0));
        const double chord2 = lengthSquared(chord);
        if (chord2 > 1e-24 * scale && chord2 > 0) return chord * (1 / std::sqrt(chord2));
    }
    return std::nullopt;
}

void CurveSegment::bezier(std::array<Vec3d, 4>& points, std::array<double, 4>& radii) const {
    points = toBezier(c_);
    radii = toBezier(r_);
}

} // namespace abbe
