#include "math/transform.h"

namespace abbe {

Transform Transform::translate(Vec3d v) {
    Transform r;
    r.t = v;
    return r;
}

Transform Transform::scale(Vec3d s) {
    Transform r;
    for (int i = 0; i < 3; ++i) r.a[i][i] = s[i];
    return r;
}

Transform Transform::rotate(Vec3d axis, double radians) {
    const Vec3d u = normalize(axis);
    const double c = std::cos(radians), s = std::sin(radians), k = 1 - c;
    Transform r;
    const double m[3][3] = {{c + u.x * u.x * k, u.x * u.y * k - u.z * s, u.x * u.z * k + u.y * s},
                            {u.y * u.x * k + u.z * s, c + u.y * u.y * k, u.y * u.z * k - u.x * s},
                            {u.z * u.x * k - u.y * s, u.z * u.y * k + u.x * s, c + u.z * u.z * k}};
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) r.a[i][j] = m[i][j];
    return r;
}

std::optional<Transform> Transform::lookAt(Vec3d from, Vec3d to, Vec3d up) {
    const Vec3d back = from - to;
    const Vec3d side = cross(up, back);
    if (!(length(back) > 0) || !(length(side) > 1e-12 * length(up) * length(back))) return std::nullopt;
    const Vec3d z = normalize(back), x = normalize(side), y = cross(z, x);
    Transform r;
    for (int i = 0; i < 3; ++i) {
        r.a[i][0] = x[i];
        r.a[i][1] = y[i];
        r.a[i][2] = z[i];
    }
    r.t = from;
    return r;
}

Transform Transform::then(const Transform& next) const {
    Transform r;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            r.a[i][j] = 0;
            for (int k = 0; k < 3; ++k) r.a[i][j] += next.a[i][k] * a[k][j];
        }
    r.t = next.point(t);
    return r;
}

double Transform::determinant() const {
    return a[0][0] * (a[1][1] * a[2][2] - a[1][2] * a[2][1]) - a[0][1] * (a[1][0] * a[2][2] - a[1][2] * a[2][0]) +
           a[0][2] * (a[1][0] * a[2][1] - a[1][1] * a[2][0]);
}

std::optional<Transform> Transform::inverse() const {
    double norm = 0;
    for (const auto& row : a)
        for (double v : row) norm = std::max(norm, std::abs(v));
    const double det = determinant();
    if (!(std::abs(det) > 1e-30 * norm * norm * norm) || !std::isfinite(det)) return std::nullopt;
    Transform r;
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            const int i1 = (i + 1) % 3, i2 = (i + 2) % 3, j1 = (j + 1) % 3, j2 = (j + 2) % 3;
            r.a[i][j] = (a[j1][i1] * a[j2][i2] - a[j1][i2] * a[j2][i1]) / det;
        }
    r.t = -r.vector(t);
    return r;
}

bool Transform::isFinite() const {
    for (const auto& row : a)
        for (double v : row)
            if (!std::isfinite(v)) return false;
    return abbe::isFinite(t);
}

std::optional<double> Transform::uniformScale() const {
    const double s2 = (a[0][0] * a[0][0] + a[1][0] * a[1][0] + a[2][0] * a[2][0]);
    for (int i = 0; i < 3; ++i)
        for (int j = 0; j < 3; ++j) {
            double d = 0;
            for (int k = 0; k < 3; ++k) d += a[k][i] * a[k][j];
            if (!(std::abs(d - (i == j ? s2 : 0)) <= 1e-9 * s2)) return std::nullopt;
        }
    return std::sqrt(s2);
}

Vec3d Transform::vector(Vec3d v) const {
    return {a[0][0] * v.x + a[0][1] * v.y + a[0][2] * v.z, a[1][0] * v.x + a[1][1] * v.y + a[1][2] * v.z,
            a[2][0] * v.x + a[2][1] * v.y + a[2][2] * v.z};
}

Vec3d Transform::point(Vec3d p) const { return vector(p) + t; }

Vec3d Transform::normal(Vec3d n) const {
    const Vec3d c0{a[0][0], a[1][0], a[2][0]}, c1{a[0][1], a[1][1], a[2][1]}, c2{a[0][2], a[1][2], a[2][2]};
    // det(A) A^-T has the columns c1×c2, c2×c0, c0×c1; the sign of det(A) is taken off again.
    const Vec3d cofactor = cross(c1, c2) * n.x + cross(c2, c0) * n.y + cross(c0, c1) * n.z;
    return determinant() < 0 ? -cofactor : cofactor;
}

} // namespace abbe
