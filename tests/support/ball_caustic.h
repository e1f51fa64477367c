// Irradiance on a floor under a glass ball and a round light, by quadrature in double precision: what a picture of the
// caustic is compared with. Nothing of the renderer is used.
//
// The ball, the light and the place on the floor share a plane of symmetry, and what the ball does to a ray from the
// place depends on the angle α between the ray and the line to the ball's middle alone: rays of one α leave the ball as
// a cone of revolution about that line. Where the cone meets the plane of the light within its rim is a quadratic
// inequality in cos φ, φ the angle about the line. So of the integral over directions one dimension is solved exactly,
// and the other is done by adaptive Gauss-Legendre rules.
#pragma once

#include "support/quadrature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

namespace abbe::test {

// Lengths in radii of the ball. The middles of ball and light stand above each other; the light faces down.
struct BallCausticScene {
    double index = 1.5;
    double ball = 1.3;        // height of the middle of the ball above the floor; more than 1
    double lightHeight = 5.8; // height of the light above the floor; above the ball
    double lightRadius = 0.5; // above 0
};

class BallCaustic {
  public:
    // Ways of light from the light to the floor: beside the ball, reflected by its outside, and, with n >= 1 stretches
    // in the glass, refracted twice and reflected n - 1 times inside.
    static constexpr int kDirect = -1, kReflected = 0, kRefracted = 1;
    // Light that grazes the ball stays in it long: each order brings some at its own distance from the axis, the 12th
    // still 0.2 % of all there.
    static constexpr int kOrders = 48;

    // `cells`: how many the range of an angle is divided into before it is refined. `tolerance`: absolute, of each way,
    // in squares of the light's radius. Twice as many and half of it show the error.
    // `first`: the least order that irradiance() counts.
    explicit BallCaustic(BallCausticScene scene, int cells = 256, double tolerance = 1e-6, int first = kDirect)
        : s_(scene), cells_(cells), tolerance_(tolerance), first_(first) {}

    // For a light of radiance 1, at the distance `rho` from the axis; all ways from `first` on together.
    double irradiance(double rho) const {
        double sum = 0;
        for (int order = first_; order <= kOrders; ++order) sum += part(order, rho);
        return sum;
    }

    // Of one way.
    double part(int order, double rho) const {
        const Place p = place(rho);
        const double grazing = std::asin(1 / p.distance);
        if (order == kDirect)
            return sum(grazing, std::numbers::pi, cells_, [&](double alpha) {
                return std::sin(alpha) * overLight(p, alpha, alpha, p.distance * std::sin(alpha));
            });
        // By the angle of incidence: at grazing incidence everything is smooth in it.
        const double least = order > 2 ? leastIncidence(order) : 0;
        const int cells = order > 8 ? cells_ / 8 : order > 2 ? cells_ / 2 : order == 1 ? 4 * cells_ : cells_;
        return sum(least, std::numbers::pi / 2, cells, [&](double incidence) {
            const double b = std::sin(incidence), refracted = std::asin(b / s_.index);
            const double alpha = std::asin(b / p.distance);
            const double turn = 2 * incidence - std::numbers::pi + order * (std::numbers::pi - 2 * refracted);
            const double measure = b / p.distance * std::cos(incidence) / (p.distance * std::cos(alpha));
            return measure * throughput(order, incidence, refracted) * overLight(p, alpha, alpha - turn, b);
        });
    }

  private:
    // A place on the floor, x = rho: the unit vector a to the middle of the ball, and e at right angles to it in the
    // plane of both and the axis.
    struct Place {
        double distance, ax, ay, ex, ey;
    };
    Place place(double rho) const {
        const double d = std::hypot(rho, s_.ball);
        return {d, -rho / d, s_.ball / d, s_.ball / d, rho / d};
    }

    // Below it less than 1e-9 gets through.
    double leastIncidence(int order) const {
        double low = 0, high = std::numbers::pi / 2;
        for (int step = 0; step < 40; ++step) {
            const double m = (low + high) / 2;
            (throughput(order, m, std::asin(std::sin(m) / s_.index)) < 1e-9 ? low : high) = m;
        }
        return low;
    }

    // Unpolarised at each surface, as the renderer has it. Every incidence on the sphere has the same two angles.
    double throughput(int order, double incidence, double refracted) const {
        const double ci = std::cos(incidence), ct = std::cos(refracted), n = s_.index;
        const double s = (ci - n * ct) / (ci + n * ct), p = (n * ci - ct) / (n * ci + ct);
        const double r = (s * s + p * p) / 2;
        return order == 0 ? r : (1 - r) * (1 - r) * std::pow(r, order - 1);
    }

    // ∫ cosθ dφ, θ at the floor, over those rays of one α that meet the light. They leave the ball at the angle `delta`
    // to a, and pass its middle at the distance b. With the origin there, a ray's line in the plane of φ has the moment
    // -b, and (meeting point - middle of the light)·d_y is linear in u = cos φ along x and in sin φ along z.
    double overLight(const Place& p, double alpha, double delta, double b) const {
        const double dx = std::cos(delta), dy = std::sin(delta), height = s_.lightHeight - s_.ball,
                     r2 = s_.lightRadius * s_.lightRadius;
        const double x0 = height * dx * p.ax, x1 = height * dy * p.ex + b, z = height * dy + b * p.ay;
        const double y0 = dx * p.ay, y1 = dy * p.ey; // d_y, above 0 towards the light
        const double q2 = x1 * x1 - z * z - r2 * y1 * y1, q1 = x0 * x1 - r2 * y0 * y1,
                     q0 = x0 * x0 + z * z - r2 * y0 * y0;
        std::array<double, 5> at{-1, 1, 1, 1, 1};
        const double root = q1 * q1 - q2 * q0;
        if (root >= 0) {
            const double q = -(q1 + std::copysign(std::sqrt(root), q1));
            at[1] = inside(q / q2);
            at[2] = inside(q0 / q);
        }
        at[3] = inside(-y0 / y1);
        std::sort(at.begin(), at.end());
        double angle = 0, cosine = 0;
        for (std::size_t i = 0; i + 1 < at.size(); ++i) {
            const double u = (at[i] + at[i + 1]) / 2;
            if (at[i] == at[i + 1] || y0 + y1 * u <= 0 || (q2 * u + 2 * q1) * u + q0 > 0) continue;
            angle += std::acos(at[i]) - std::acos(at[i + 1]);
            cosine += std::sqrt(1 - at[i] * at[i]) - std::sqrt(1 - at[i + 1] * at[i + 1]);
        }
        // φ and -φ.
        return 2 * (std::cos(alpha) * p.ay * angle + std::sin(alpha) * p.ey * cosine);
    }
    static double inside(double u) { return u > -1 && u < 1 ? u : 1; } // NaN too

    template <typename F> double sum(double a, double b, int cells, F&& f) const {
        double total = 0;
        for (int c = 0; c < cells; ++c) {
            const double x0 = a + (b - a) * c / cells, x1 = a + (b - a) * (c + 1) / cells;
            total += refine(f, x0, x1, cell(f, x0, x1), tolerance_ * s_.lightRadius * s_.lightRadius / cells, 40);
        }
        return total;
    }
    template <typename F> static double cell(F&& f, double a, double b) {
        static const GaussLegendre<8> rule;
        double sum = 0;
        for (std::size_t i = 0; i < 8; ++i) sum += rule.weight[i] * f(a + (b - a) * rule.node[i]);
        return sum * (b - a);
    }
    // Where the edge of the light comes into sight, the integrand has the singularity of a square root.
    template <typename F> static double refine(F&& f, double a, double b, double whole, double tolerance, int depth) {
        if (whole == 0) return 0;
        const double m = (a + b) / 2, left = cell(f, a, m), right = cell(f, m, b);
        if (depth == 0 || std::abs(left + right - whole) < tolerance) return left + right;
        return refine(f, a, m, left, tolerance / 2, depth - 1) + refine(f, m, b, right, tolerance / 2, depth - 1);
    }

    BallCausticScene s_;
    int cells_;
    double tolerance_;
    int first_;
};

} // namespace abbe::test
