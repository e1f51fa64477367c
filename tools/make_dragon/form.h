// The form of a young dragon as a function of space: negative inside, about a distance near the surface.
#pragma once

#include "vec.h"

namespace dragon {

// What the surface belongs to. Where parts meet without a blend the surface has an edge.
enum Part { kSkin, kJaw, kSocket, kWing, kParts };

class Form {
  public:
    // Thin parts grow by `swell`, in cm: a coarse lattice then sees them.
    explicit Form(double swell = 0) : swell_(swell) {}

    // Distances of the parts. The form is their union less the sockets, whose distance is that of the hole's outside.
    [[nodiscard]] std::array<double, kParts> parts(Vec p) const;
    [[nodiscard]] double operator()(Vec p) const;
    [[nodiscard]] Part part(Vec p) const;

    // Unit outward normal, and the nearest point of the surface, or of the edge where two parts meet.
    [[nodiscard]] Vec normal(Vec p) const;
    [[nodiscard]] Vec project(Vec p) const;
    [[nodiscard]] Vec project(Vec p, Part a, Part b) const;

  private:
    double swell_;
};

// Between the frame of the body, which looks along +z, and that of the head, which is turned.
Vec toHead(Vec p);
Vec fromHead(Vec p);

// Eyes, in the frame of the head; the other one is mirrored in x.
inline constexpr Vec kEye{2.55, 18.6, 4.95}, kGaze{0.6, 0.1, 0.79};
inline constexpr double kEyeRadius = 1.7;

} // namespace dragon
