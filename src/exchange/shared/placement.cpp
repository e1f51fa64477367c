#include "exchange/shared/placement.h"

#include <array>

namespace abbe::exchange {

namespace {

bool isDiagonal(const Transform& m) {
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            if (r != c && m.a[r][c] != 0) return false;
    return true;
}

} // namespace

Transform axesTo(Vec3d x, Vec3d y, Vec3d z, Vec3d origin) {
    Transform map;
    for (int r = 0; r < 3; ++r) {
        map.a[r][0] = x[r];
        map.a[r][1] = y[r];
        map.a[r][2] = z[r];
    }
    map.t = origin;
    return map;
}

bool isIdentity(const Transform& m) {
    return isDiagonal(m) && m.a[0][0] == 1 && m.a[1][1] == 1 && m.a[2][2] == 1 && m.t == Vec3d();
}

void writeSteps(SceneNode& node, const Transform& m) {
    if (!isDiagonal(m)) {
        std::array<double, 16> matrix{};
        for (std::size_t r = 0; r < 3; ++r) {
            for (std::size_t c = 0; c < 3; ++c) matrix[4 * r + c] = m.a[r][c];
            matrix[4 * r + 3] = m.t[static_cast<int>(r)];
        }
        matrix[15] = 1;
        node.child("matrix").numbers(matrix);
        return;
    }
    const Vec3d scale{m.a[0][0], m.a[1][1], m.a[2][2]};
    if (scale.x != scale.y || scale.y != scale.z)
        node.child("scale").vector(scale);
    else if (scale.x != 1)
        node.child("scale").number(scale.x);
    if (m.t != Vec3d() || scale == Vec3d(1, 1, 1)) node.child("translate").vector(m.t);
}

void writeTransform(SceneNode& parent, const Transform& m) {
    if (!isIdentity(m)) writeSteps(parent.child("transform"), m);
}

} // namespace abbe::exchange
