// Affine maps in double: composed and inverted once at load, applied to float data afterwards.
#pragma once

#include "math/vec.h"

#include <optional>

namespace abbe {

// p' = A p + t, column vectors; a[r][c].
struct Transform {
    double a[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
    Vec3d t{};

    bool operator==(const Transform&) const = default;

    static Transform translate(Vec3d);
    static Transform scale(Vec3d);
    // Right-handed rotation by `radians` about a (not necessarily unit) axis.
    static Transform rotate(Vec3d axis, double radians);
    // Places an object at `from` with its local -z towards `to` and its y near `up`. nullopt when degenerate.
    static std::optional<Transform> lookAt(Vec3d from, Vec3d to, Vec3d up);

    // The map that applies `this` first and `next` second.
    Transform then(const Transform& next) const;
    std::optional<Transform> inverse() const; // nullopt when |det| < 1e-30 |A|^3
    double determinant() const;
    bool isFinite() const;
    // The scale s if A = s R with R orthogonal (mirrors allowed), to 1e-9; nullopt otherwise.
    std::optional<double> uniformScale() const;

    Vec3d point(Vec3d p) const;
    Vec3d vector(Vec3d v) const;
    // A^-T n up to a positive factor: outward normals stay outward, under mirrors too (where the cross product of
    // mapped edges turns inward). From cofactors, without an inverse.
    Vec3d normal(Vec3d n) const;
};

} // namespace abbe
