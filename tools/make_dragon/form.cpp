#include "form.h"

namespace dragon {
namespace {

constexpr Vec kNeck{0, 14.5, 2};
constexpr double kYaw = -0.30, kRoll = 0.10, kPitch = 0.06, kHeadSize = 1.16;

Vec turn(double& a, double& b, double angle, Vec& p) {
    const double c = std::cos(angle), s = std::sin(angle), x = a, y = b;
    a = c * x - s * y;
    b = s * x + c * y;
    return p;
}

// Union with a fillet of about k.
double blend(double a, double b, double k) {
    const double h = std::max(k - std::abs(a - b), 0.0) / k;
    return std::min(a, b) - h * h * k * 0.25;
}

double ellipsoid(Vec p, Vec c, Vec r) {
    const Vec q = p - c, a{q.x / r.x, q.y / r.y, q.z / r.z}, b{a.x / r.x, a.y / r.y, a.z / r.z};
    const double k = length(a), g = length(b);
    return g < 1e-9 ? -std::min({r.x, r.y, r.z}) : k * (k - 1) / g;
}

// An ellipsoid whose z axis is turned towards `axis` and whose y axis is near `up`.
double ellipsoid(Vec p, Vec c, Vec r, Vec axis, Vec up) {
    const Vec z = unit(axis), x = unit(cross(up, z)), y = cross(z, x), q = p - c;
    return ellipsoid({dot(q, x), dot(q, y), dot(q, z)}, {}, r);
}

// A cone with round ends.
double limb(Vec p, Vec a, double ra, Vec b, double rb) {
    const Vec d = b - a;
    const double t = std::clamp(dot(p - a, d) / dot(d, d), 0.0, 1.0);
    return length(p - mix(a, b, t)) - mix(ra, rb, t);
}

double triangle(Vec p, Vec a, Vec b, Vec c) {
    const Vec n = cross(b - a, c - a);
    const auto beside = [&](Vec s, Vec e) { return dot(cross(e - s, p - s), n) < 0; };
    if (!beside(a, b) && !beside(b, c) && !beside(c, a)) return std::abs(dot(p - a, unit(n)));
    return std::min({limb(p, a, 0, b, 0), limb(p, b, 0, c, 0), limb(p, c, 0, a, 0)});
}

double tail(Vec p, double swell) {
    constexpr std::array<Vec, 9> at{{{0, 6, -2},
                                     {0.4, 4.0, -5.6},
                                     {4.6, 2.6, -9.0},
                                     {10.0, 1.9, -8.2},
                                     {13.2, 1.5, -3.4},
                                     {13.8, 1.3, 2.0},
                                     {12.6, 1.1, 6.6},
                                     {9.8, 1.3, 9.6},
                                     {6.4, 4.0, 10.6}}};
    constexpr int kPieces = 4;
    double d = 1e9;
    Vec last = at[1];
    for (int i = 1; i <= kPieces * 6; ++i) {
        const int n = std::min((i - 1) / kPieces, 5);
        const double t = double(i - n * kPieces) / kPieces, s = double(i) / (kPieces * 6);
        // Catmull and Rom's spline.
        const Vec a = at[n], b = at[n + 1], c = at[n + 2], e = at[n + 3];
        const Vec next = b + ((c - a) + (a * 2 - b * 5 + c * 4 - e + (b * 3 - c * 3 + e - a) * t) * t) * (0.5 * t);
        const auto radius = [](double u) { return 0.62 + 2.5 * std::pow(1 - u, 1.4); };
        d = blend(d, limb(p, last, radius(s - 1.0 / (kPieces * 6)), next, radius(s)), 0.15);
        last = next;
    }
    // A spade that stands at the end.
    const Vec along = unit({-0.35, 0.93, 0.1}), up = unit({0.87, 0.2, 0.5}),
              middle = last + along * 1.9 + Vec{-0.5, 0, 0.2};
    d = blend(d, ellipsoid(p, middle, {0.45 + 1.2 * swell, 1.5, 1.7}, along, up), 0.6);
    for (double s : {-1.0, 1.0})
        d = blend(d, limb(p, middle, 0.6, middle + up * (2.0 * s) - along * 1.0, 0.3 + swell), 0.7);
    return blend(d, limb(p, middle, 0.7, middle + along * 3.0, 0.25 + swell), 0.9);
}

double torso(Vec p, double swell) {
    double d = ellipsoid(p, {0, 5.4, -2.2}, {5.0, 5.0, 5.0});
    d = blend(d, ellipsoid(p, {0, 9.2, 0.3}, {4.1, 5.0, 4.0}), 2.5);
    d = blend(d, limb(p, {0, 11, 0.2}, 3.0, {0, 16, 1.8}, 2.3), 2.0);
    return blend(d, tail(p, swell), 1.6);
}

double legs(Vec p) {
    const Vec q{std::abs(p.x), p.y, p.z};
    double front = limb(q, {3.1, 9.4, 1.4}, 2.2, {3.7, 5.2, 2.2}, 1.55);
    front = blend(front, limb(q, {3.7, 5.2, 2.2}, 1.5, {3.2, 1.7, 4.2}, 1.3), 0.8);
    front = blend(front, ellipsoid(q, {3.2, 1.0, 5.0}, {1.75, 1.1, 1.9}), 0.9);
    double hind = ellipsoid(q, {4.9, 4.4, -1.6}, {2.5, 4.2, 4.3}, {0.15, -0.25, 1}, {0, 1, 0});
    hind = blend(hind, limb(q, {5.8, 1.5, 0.2}, 1.5, {6.4, 1.15, 3.2}, 1.35), 1.2);
    for (int i = -1; i <= 1; ++i) {
        const double s = 1.3 * i;
        front = blend(front, limb(q, {3.2 + 0.8 * s, 0.9, 5.4}, 0.75, {3.3 + 1.2 * s, 0.72, 7.2}, 0.8), 0.35);
        hind = blend(hind, limb(q, {6.5 + 0.8 * s, 0.95, 3.4}, 0.8, {6.7 + 1.2 * s, 0.75, 5.4}, 0.85), 0.35);
    }
    return std::min(front, hind);
}

// From here on in the frame of the head, mirrored to x >= 0.
double skull(Vec q, double swell) {
    double d = ellipsoid(q, {0, 18.4, 2.8}, {4.1, 3.6, 3.9});
    d = blend(d, ellipsoid(q, {0, 17.2, 7.0}, {2.5, 1.75, 3.4}), 1.6);
    d = blend(d, ellipsoid(q, {2.6, 16.7, 3.8}, {1.9, 1.7, 2.0}), 1.2);
    d = blend(d, ellipsoid(q, {1.15, 18.0, 9.5}, {0.75, 0.65, 0.8}), 0.7);
    d = blend(d, ellipsoid(q, kEye, Vec{1, 1, 1} * (kEyeRadius + 0.2)), 0.6);
    d = blend(d, limb(q, {1.3, 20.2, 6.4}, 0.45, {3.9, 20.9, 3.8}, 0.65), 0.8);
    const Vec ear{0.85, 0.3, -0.6};
    d = blend(d, ellipsoid(q, Vec{3.9, 18.7, 0.6} + ear * 4.0, {0.5 + 2 * swell, 1.1 + swell, 2.4}, ear, {0, 1, 0.1}),
              0.8);
    return blend(
        d, ellipsoid(q, Vec{3.9, 18.6, 0.6} + ear * 2.0, {0.6 + 2 * swell, 1.9 + swell, 3.3}, ear, {0, 1, 0.1}), 0.7);
}

// The lids open in an almond before the eye.
double lids(Vec q) { return ellipsoid(q, kEye + kGaze * 1.3, {1.42, 1.12, 1.0}, kGaze, {0.22, 1, 0}); }

double jaw(Vec q) {
    return blend(ellipsoid(q, {0, 15.9, 6.2}, {2.25, 1.25, 3.6}), ellipsoid(q, {0, 16.2, 3.0}, {3.0, 1.7, 2.6}), 1.2);
}

double wing(Vec p, double swell) {
    const Vec q{std::abs(p.x), p.y, p.z};
    const Vec root{2.2, 11.0, -2.0}, wrist{6.2, 17.6, -6.0};
    const Vec tip[3] = {{13.4, 16.6, -7.4}, {12.0, 10.6, -8.0}, {7.0, 7.0, -7.4}};
    double d = limb(q, root, 1.0, wrist, 0.66 + 0.5 * swell);
    for (Vec t : tip) d = blend(d, limb(q, wrist, 0.5 + 0.5 * swell, t, 0.26 + swell), 0.3);
    const Vec a = mix(mix(tip[0], tip[1], 0.5), wrist, 0.2), b = mix(mix(tip[1], tip[2], 0.5), wrist, 0.2);
    const Vec c = mix(mix(tip[2], root, 0.45), wrist, 0.1);
    const double skin =
        std::min({triangle(q, wrist, tip[0], a), triangle(q, wrist, a, tip[1]), triangle(q, wrist, tip[1], b),
                  triangle(q, wrist, b, tip[2]), triangle(q, wrist, tip[2], c), triangle(q, wrist, c, root)});
    return blend(d, skin - 0.2 - 2.4 * swell, 0.35);
}

} // namespace

Vec toHead(Vec p) {
    Vec q = p - kNeck;
    turn(q.x, q.z, kYaw, q);
    turn(q.x, q.y, -kRoll, q);
    turn(q.y, q.z, kPitch, q);
    return q * (1 / kHeadSize) + kNeck;
}

Vec fromHead(Vec p) {
    Vec q = (p - kNeck) * kHeadSize;
    turn(q.y, q.z, -kPitch, q);
    turn(q.x, q.y, kRoll, q);
    turn(q.x, q.z, -kYaw, q);
    return q + kNeck;
}

std::array<double, kParts> Form::parts(Vec p) const {
    Vec q = toHead(p);
    q.x = std::abs(q.x);
    const double body = blend(blend(torso(p, swell_), legs(p), 0.9), skull(q, swell_) * kHeadSize, 1.4),
                 wings = wing(p, swell_);
    // Wings grow out of the skin: no edge between them.
    const double all = blend(body, wings, 0.7);
    std::array<double, kParts> d{};
    d[kWing] = wings < body + 0.05 ? all : all + 1e-6;
    d[kSkin] = wings < body + 0.05 ? all + 1e-6 : all;
    d[kJaw] = jaw(q) * kHeadSize;
    d[kSocket] = -lids(q);
    d[kSocket] *= kHeadSize;
    return d;
}

double Form::operator()(Vec p) const {
    const auto d = parts(p);
    return std::max(std::min({d[kSkin], d[kJaw], d[kWing]}), d[kSocket]);
}

Part Form::part(Vec p) const {
    const auto d = parts(p);
    int best = kSkin;
    for (int i : {kJaw, kWing})
        if (d[i] < d[best]) best = i;
    return static_cast<Part>(d[kSocket] > d[best] ? kSocket : best);
}

Vec Form::normal(Vec p) const {
    constexpr double h = 1e-3;
    const Form& f = *this;
    return unit({f({p.x + h, p.y, p.z}) - f({p.x - h, p.y, p.z}), f({p.x, p.y + h, p.z}) - f({p.x, p.y - h, p.z}),
                 f({p.x, p.y, p.z + h}) - f({p.x, p.y, p.z - h})});
}

namespace {

// One step of Newton's method along the gradient, no longer than half a centimetre.
template <class F> Vec newton(const F& f, Vec p) {
    constexpr double h = 1e-3;
    const Vec g = Vec{f({p.x + h, p.y, p.z}) - f({p.x - h, p.y, p.z}), f({p.x, p.y + h, p.z}) - f({p.x, p.y - h, p.z}),
                      f({p.x, p.y, p.z + h}) - f({p.x, p.y, p.z - h})} *
                  (0.5 / h);
    const Vec step = g * (-f(p) / std::max(dot(g, g), 0.1));
    return p + step * std::min(1.0, 0.5 / std::max(length(step), 1e-12));
}

} // namespace

Vec Form::project(Vec p) const {
    for (int i = 0; i < 4; ++i) p = newton(*this, p);
    return p;
}

Vec Form::project(Vec p, Part a, Part b) const {
    for (int i = 0; i < 4; ++i)
        for (Part part : {a, b}) p = newton([&](Vec q) { return parts(q)[part]; }, p);
    return p;
}

} // namespace dragon
