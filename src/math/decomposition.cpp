#include "math/decomposition.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

using Matrix = std::array<std::array<double, 3>, 3>;

Matrix cofactors(const Matrix& m) {
    Matrix c;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            const std::size_t i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            c[i][j] = m[i1][j1] * m[i2][j2] - m[i1][j2] * m[i2][j1];
        }
    return c;
}

double determinant(const Matrix& m, const Matrix& cofactor) {
    return m[0][0] * cofactor[0][0] + m[0][1] * cofactor[0][1] + m[0][2] * cofactor[0][2];
}

double frobenius(const Matrix& m) {
    double sum = 0;
    for (const auto& row : m)
        for (const double x : row) sum += x * x;
    return std::sqrt(sum);
}

// The orthogonal factor of the polar decomposition by Newton's iteration Q ← (γ Q + Q^-T / γ) / 2 with Higham's
// scaling γ [Higham1986]; quadratic convergence, so the loop ends after a dozen steps whatever the scales are.
Matrix orthogonalFactor(Matrix q) {
    for (int step = 0; step < 100; ++step) {
        const Matrix c = cofactors(q);
        const double inverse = 1 / determinant(q, c); // Q^-T = cofactors / det
        const double gamma = std::sqrt(frobenius(c) * std::abs(inverse) / frobenius(q));
        double change = 0;
        for (std::size_t i = 0; i < 3; ++i)
            for (std::size_t j = 0; j < 3; ++j) {
                const double next = 0.5 * (gamma * q[i][j] + c[i][j] * inverse / gamma);
                change = std::max(change, std::abs(next - q[i][j]));
                q[i][j] = next;
            }
        if (change < 1e-15) break;
    }
    return q;
}

// From a proper rotation, by the largest of the four components, which is never small [Shepperd1978].
Quaternion toQuaternion(const Matrix& r) {
    const double trace = r[0][0] + r[1][1] + r[2][2];
    const std::array<double, 4> squares{trace, r[0][0], r[1][1], r[2][2]};
    const auto largest = static_cast<std::size_t>(std::max_element(squares.begin(), squares.end()) - squares.begin());
    if (largest == 0) {
        const double w = 0.5 * std::sqrt(1 + trace), f = 0.25 / w;
        return {w, {(r[2][1] - r[1][2]) * f, (r[0][2] - r[2][0]) * f, (r[1][0] - r[0][1]) * f}};
    }
    const std::size_t i = largest - 1, j = (i + 1) % 3, k = (i + 2) % 3;
    std::array<double, 3> v;
    v[i] = 0.5 * std::sqrt(std::max(0.0, 1 + r[i][i] - r[j][j] - r[k][k]));
    const double f = 0.25 / v[i];
    v[j] = (r[j][i] + r[i][j]) * f;
    v[k] = (r[k][i] + r[i][k]) * f;
    return {(r[k][j] - r[j][k]) * f, {v[0], v[1], v[2]}};
}

Matrix toMatrix(const Quaternion& q) {
    const double w = q.w, x = q.v.x, y = q.v.y, z = q.v.z;
    return {{{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)},
             {2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
             {2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}}};
}

Quaternion mix(const Quaternion& a, const Quaternion& b, double weightA, double weightB) {
    const Quaternion q{a.w * weightA + b.w * weightB, a.v * weightA + b.v * weightB};
    const double l = std::sqrt(q.w * q.w + lengthSquared(q.v));
    return {q.w / l, q.v / l};
}

Quaternion slerp(const Quaternion& a, Quaternion b, double u) {
    double cosine = a.w * b.w + dot(a.v, b.v);
    if (cosine < 0) { // the same rotation, the nearer of its two quaternions
        b = {-b.w, -b.v};
        cosine = -cosine;
    }
    // The angle from its sine: arccos loses half the digits of small ones.
    const Vec3d dv = b.v - a.v;
    const double angle = 2 * std::asin(std::min(1.0, 0.5 * std::sqrt(square(b.w - a.w) + lengthSquared(dv))));
    const double sine = std::sin(angle);
    if (!(sine > 1e-12)) return mix(a, b, 1 - u, u);
    return mix(a, b, std::sin((1 - u) * angle) / sine, std::sin(u * angle) / sine);
}

} // namespace

Decomposition Decomposition::of(const Transform& t) {
    Matrix a;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) a[i][j] = t.a[i][j];
    Matrix q = orthogonalFactor(a);
    if (determinant(q, cofactors(q)) < 0)
        for (auto& row : q)
            for (double& x : row) x = -x;
    Decomposition d{t.t, toQuaternion(q), {}};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) {
            const auto product = [&](std::size_t r, std::size_t c) {
                return q[0][r] * a[0][c] + q[1][r] * a[1][c] + q[2][r] * a[2][c];
            };
            d.stretch[i][j] = 0.5 * (product(i, j) + product(j, i)); // Q^T A, symmetric but for rounding
        }
    return d;
}

Transform Decomposition::compose() const {
    const Matrix r = toMatrix(rotation);
    Transform t;
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            t.a[i][j] = r[i][0] * stretch[0][j] + r[i][1] * stretch[1][j] + r[i][2] * stretch[2][j];
    t.t = translation;
    return t;
}

Decomposition interpolate(const Decomposition& a, const Decomposition& b, double u) {
    Decomposition d{a.translation * (1 - u) + b.translation * u, slerp(a.rotation, b.rotation, u), {}};
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j) d.stretch[i][j] = a.stretch[i][j] * (1 - u) + b.stretch[i][j] * u;
    return d;
}

} // namespace abbe
