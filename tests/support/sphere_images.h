// What a light sends to a point by way of a ball of glass, by quadrature over directions: closed forms of a sphere, in
// double, that share nothing with the renderer.
#pragma once

#include "support/manifold_cases.h"

#include <cmath>
#include <cstring>

namespace abbe::test {

// The light is a disk of radiance 1 that faces down (-y).
struct SphereImages {
    Vec3d centre;
    double radius = 1, index = 1.5;
    Vec3d lightCentre;
    double lightRadius = 0.1;

    // Where a direction from p leads by way of the ball, and what it brings if the light is there.
    struct Image {
        bool valid = false; // the chain exists
        double miss = 0;    // distance from the light's middle, in its plane; < 0 is never
        double factor = 0;
    };

    Image along(Vec3d p, Vec3d d, const char* signature) const {
        Image image;
        double factor = 1;
        const std::size_t events = std::strlen(signature);
        for (std::size_t i = 0; i < events; ++i) {
            const bool inside = i > 0;
            const Vec3d o = p - centre;
            const double b = -dot(o, d), c = lengthSquared(o) - square(radius), root2 = b * b - c;
            if (!(root2 >= 0)) return image;
            const double t = inside ? b + std::sqrt(root2) : b - std::sqrt(root2);
            if (!(t > 0)) return image;
            p = p + d * t;
            const Vec3d n = (p - centre) * ((inside ? -1 : 1) / radius);
            const double cosine = -dot(d, n), far = inside ? 1 / index : index;
            const double reflected = dielectricReflectance(cosine, far);
            if (signature[i] == 'R') {
                factor *= reflected;
                d = d + n * (2 * cosine);
                continue;
            }
            if (reflected >= 1) return image;
            factor *= (1 - reflected) / square(far);
            const double beyond = std::sqrt(1 - (1 - square(cosine)) / square(far));
            d = normalize(d * (1 / far) + n * (cosine / far - beyond));
        }
        // From outside, upwards, in front of the light.
        const double t = (lightCentre.y - p.y) / d.y;
        if (!(t > 0) || !(d.y > 0)) return image;
        const Vec3d q = p + d * t - lightCentre;
        // Reflected outside the ball is never in its own way; nor is what has left it.
        return {true, std::hypot(q.x, q.z), factor};
    }

    // ∫ factor dω over the directions that lead to the light.
    double integral(Vec3d p, const char* signature) const {
        const Vec3d axis = normalize(centre - p);
        const auto [x, y] = tangentsOf(axis);
        const double sine = radius / length(centre - p);
        // Even in the square over the cone: d = sine (u, v) across, dω = sine² du dv / cos.
        const Square square{p, axis, x, y, sine, signature};
        double sum = 0;
        constexpr int cells = 96;
        for (int i = 0; i < cells; ++i)
            for (int j = 0; j < cells; ++j)
                sum += refined(square, -1 + (2.0 * i + 1) / cells, -1 + (2.0 * j + 1) / cells, 1.0 / cells, 0);
        return sum;
    }

  private:
    struct Square {
        Vec3d p, axis, x, y;
        double sine;
        const char* signature;
    };

    Image at(const Square& s, double u, double v, double& cosine) const {
        const double sine2 = square(s.sine) * (u * u + v * v);
        if (u * u + v * v >= 1) return {};
        cosine = std::sqrt(1 - sine2);
        return along(s.p, s.x * (s.sine * u) + s.y * (s.sine * v) + s.axis * cosine, s.signature);
    }

    // Over a cell of half the side h about (u, v); cells near an edge of an image are cut.
    double refined(const Square& s, double u, double v, double h, int level) const {
        constexpr int kLevels = 9, kAlways = 1;
        double cosine = 1, other = 1;
        const Image middle = at(s, u, v, cosine);
        int valid = 0, lit = 0;
        double spread = 0;
        for (int k = 0; k < 4; ++k) {
            const Image corner = at(s, u + (k & 1 ? h : -h), v + (k & 2 ? h : -h), other);
            if (!corner.valid) continue;
            ++valid;
            lit += corner.miss < lightRadius;
            if (middle.valid) spread = std::max(spread, std::abs(corner.miss - middle.miss));
        }
        lit += middle.valid && middle.miss < lightRadius;
        const bool whole = middle.valid && valid == 4;
        const bool far = whole && middle.miss - 3 * spread > lightRadius,
                   inside = whole && lit == 5 && middle.miss + 2 * spread < lightRadius;
        const bool nothing = !middle.valid && valid == 0;
        if (level >= kAlways && (far || nothing)) return 0;
        if ((level >= kAlways + 2 && inside) || level == kLevels)
            return middle.valid && middle.miss < lightRadius ? middle.factor * 4 * h * h * square(s.sine) / cosine : 0;
        double sum = 0;
        for (int k = 0; k < 4; ++k)
            sum += refined(s, u + (k & 1 ? h : -h) / 2, v + (k & 2 ? h : -h) / 2, h / 2, level + 1);
        return sum;
    }
};

} // namespace abbe::test
