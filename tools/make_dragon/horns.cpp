#include "horns.h"

namespace dragon {
namespace {

constexpr double kPi = 3.14159265358979323846;
constexpr int kSides = 6;

// A ring of the sweep: centre, half widths along two directions.
struct Ring {
    Vec center;
    double wide = 0, deep = 0;
};

// A hexagonal tube through `rings`, its base creased and its end drawn together; `side` is the direction of the width.
void sweep(Cage& cage, const std::vector<Ring>& rings, Vec side) {
    const int first = int(cage.points.size()), count = int(rings.size());
    for (int r = 0; r < count; ++r) {
        const Vec along = unit(rings[std::min(r + 1, count - 1)].center - rings[std::max(r - 1, 0)].center);
        const Vec x = unit(side - along * dot(side, along)), y = cross(along, x);
        for (int i = 0; i < kSides; ++i) {
            const double a = 2 * kPi * i / kSides;
            cage.points.push_back(rings[r].center + x * (std::cos(a) * rings[r].wide) +
                                  y * (std::sin(a) * rings[r].deep));
        }
    }
    const auto face = [&](Quad q) {
        for (int& p : q) p += first;
        cage.faces.push_back(q);
        cage.parts.push_back(kSkin);
    };
    for (int r = 0; r + 1 < count; ++r)
        for (int i = 0; i < kSides; ++i) {
            const int a = r * kSides + i, b = r * kSides + (i + 1) % kSides;
            face({a, b, b + kSides, a + kSides});
        }
    for (int i = 0; i < kSides; ++i) cage.creases[edge(first + i, first + (i + 1) % kSides)] = 10;
    const int top = (count - 1) * kSides;
    face({3, 2, 1, 0});
    face({5, 4, 3, 0});
    face({top, top + 1, top + 2, top + 3});
    face({top, top + 3, top + 4, top + 5});
}

// A curved horn from `root` by way of `bend` to `tip`.
void horn(Cage& cage, Vec root, Vec bend, Vec tip, double radius, int rings, Vec side) {
    std::vector<Ring> out;
    for (int i = 0; i <= rings; ++i) {
        const double t = double(i) / rings, r = i == rings ? 0.04 * radius : radius * (1 - 0.8 * t);
        out.push_back({mix(mix(root, bend, t), mix(bend, tip, t), t), r, r});
    }
    sweep(cage, out, side);
}

Cage horns() {
    Cage cage;
    for (double s : {-1.0, 1.0}) {
        const auto at = [&](Vec p) { return fromHead({s * p.x, p.y, p.z}); };
        horn(cage, at({1.9, 20.6, 1.6}), at({2.9, 24.6, 0.6}), at({3.1, 25.4, -4.2}), 1.35, 7, {1, 0, 0});
        horn(cage, at({3.5, 16.9, 1.6}), at({4.9, 16.6, 0.6}), at({5.6, 17.2, -0.9}), 0.75, 4, {0, 1, 0});
    }
    return cage;
}

Cage claws() {
    Cage cage;
    for (double s : {-1.0, 1.0})
        for (int i = -1; i <= 1; ++i) {
            const double w = 1.56 * i;
            horn(cage, {s * (3.3 + w), 0.85, 7.2}, {s * (3.35 + 1.1 * w), 1.1, 8.6}, {s * (3.35 + 1.15 * w), 0.08, 9.4},
                 0.6, 4, {1, 0, 0});
            horn(cage, {s * (6.7 + w), 0.9, 5.4}, {s * (6.8 + 1.1 * w), 1.15, 6.9}, {s * (6.8 + 1.15 * w), 0.08, 7.7},
                 0.64, 4, {1, 0, 0});
        }
    return cage;
}

// Flat spines along the middle of head, neck, back and tail, which they find by going down onto the form.
Cage spines() {
    constexpr std::array<Vec, 12> over{{{0, 23, 3.4},
                                        {0, 22.5, 0.8},
                                        {0, 20.5, -2.2},
                                        {0, 16.5, -3.0},
                                        {0, 14.2, -4.2},
                                        {0, 11.8, -6},
                                        {0, 9.4, -8.2},
                                        {0.3, 7.0, -9.6},
                                        {2.6, 6.0, -10.8},
                                        {5.8, 4.8, -10.4},
                                        {8.8, 4.0, -8.6},
                                        {11.0, 3.6, -5.2}}};
    constexpr std::array<double, 12> size{0.9, 1.2, 1.45, 1.5, 1.75, 1.9, 1.9, 1.75, 1.5, 1.25, 1.0, 0.8};
    Cage cage;
    const Form form;
    for (int i = 0; i < 12; ++i) {
        const bool head = i < 3;
        const auto place = [&](int n) { return form.project(form.project(n < 3 ? fromHead(over[n]) : over[n])); };
        const Vec foot = place(i), n = form.normal(foot);
        const Vec back = unit(place(std::min(i + 1, 11)) - place(std::max(i - 1, 0)));
        const Vec along = unit(back - n * dot(back, n)), side = cross(n, along);
        const double h = size[i] * (head ? 1.0 : 1.15);
        const auto at = [&](double up, double b) { return foot + n * (h * up) + along * (h * b); };
        sweep(cage,
              {{at(-0.45, -0.1), 0.26 * h, 0.62 * h},
               {at(0.2, 0), 0.24 * h, 0.6 * h},
               {at(0.75, 0.32), 0.15 * h, 0.36 * h},
               {at(1.15, 0.85), 0.02 * h, 0.03 * h}},
              side);
    }
    return cage;
}

} // namespace

std::vector<Group> makeHorns() { return {{"horns", horns()}, {"claws", claws()}, {"spines", spines()}}; }

} // namespace dragon
