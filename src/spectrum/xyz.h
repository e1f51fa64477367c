// CIE 1931 tristimulus values, their exact sums, and matrices on them; docs/conventions.md states their scale.
#pragma once

#include "math/exact_sum.h"

namespace abbe {

struct Xyz {
    double x = 0, y = 0, z = 0;

    Xyz operator+(Xyz b) const { return {x + b.x, y + b.y, z + b.z}; }
    Xyz operator-(Xyz b) const { return {x - b.x, y - b.y, z - b.z}; }
    Xyz operator*(double s) const { return {x * s, y * s, z * s}; }
    Xyz& operator+=(Xyz b) { return *this = *this + b; }
};

// Sums of XYZ that are the same in any order.
struct ExactXyz {
    ExactSum x, y, z;

    ExactXyz() = default;
    // Requires components below ExactSum::kLargest.
    ExactXyz(Xyz v) noexcept : x(v.x), y(v.y), z(v.z) {} // NOLINT: an Xyz is a sum of one term

    ExactXyz& operator+=(const ExactXyz& b) noexcept {
        x += b.x;
        y += b.y;
        z += b.z;
        return *this;
    }
    bool operator==(const ExactXyz&) const = default;
    Xyz value() const noexcept { return {x.value(), y.value(), z.value()}; }
};

// A 3×3 matrix in double, for colour.
struct Matrix3 {
    double m[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};

    static constexpr Matrix3 diagonal(double a, double b, double c) { return {{{a, 0, 0}, {0, b, 0}, {0, 0, c}}}; }

    constexpr Matrix3 operator*(const Matrix3& b) const {
        Matrix3 r;
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) r.m[i][j] = m[i][0] * b.m[0][j] + m[i][1] * b.m[1][j] + m[i][2] * b.m[2][j];
        return r;
    }
    // Applies the matrix to anything with three double members x, y, z.
    template <typename To, typename From> constexpr To apply(const From& v) const {
        return To{m[0][0] * v.x + m[0][1] * v.y + m[0][2] * v.z, m[1][0] * v.x + m[1][1] * v.y + m[1][2] * v.z,
                  m[2][0] * v.x + m[2][1] * v.y + m[2][2] * v.z};
    }
    // Requires a regular matrix.
    constexpr Matrix3 inverse() const {
        const auto minor = [&](int r0, int r1, int c0, int c1) {
            return m[r0][c0] * m[r1][c1] - m[r0][c1] * m[r1][c0];
        };
        const Matrix3 adjugate{{{minor(1, 2, 1, 2), -minor(0, 2, 1, 2), minor(0, 1, 1, 2)},
                                {-minor(1, 2, 0, 2), minor(0, 2, 0, 2), -minor(0, 1, 0, 2)},
                                {minor(1, 2, 0, 1), -minor(0, 2, 0, 1), minor(0, 1, 0, 1)}}};
        const double det = m[0][0] * adjugate.m[0][0] + m[0][1] * adjugate.m[1][0] + m[0][2] * adjugate.m[2][0];
        return adjugate * diagonal(1 / det, 1 / det, 1 / det);
    }
};

} // namespace abbe
