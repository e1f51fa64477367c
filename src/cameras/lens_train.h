// The surfaces of a lens in their places: exact rays through them, and the paraxial quantities that describe the whole.
#pragma once

#include "cameras/exposure.h"
#include "cameras/lens_prescription.h"

namespace abbe {

// Lens coordinates: the axis is z, light travels towards +z, the first surface has its vertex at z = 0; in m.
struct LensRay {
    Vec3d p;
    Vec3d d; // unit
};

// Paraxial quantities of a lens in air at one wavelength [Born1999, ch. 4]. Places are z on the axis.
struct CardinalPoints {
    double focalLength = 0;                       // negative: the lens diverges
    double frontFocus = 0, rearFocus = 0;         // focal points
    double frontPrincipal = 0, rearPrincipal = 0; // principal points
};

// Immutable, thread-safe.
class LensTrain {
  public:
    // The prescription is read and not kept. Requires a sound one.
    explicit LensTrain(const LensPrescription&);

    // A ray that comes from the film, through all surfaces and the stop, into the scene: replaced by the ray in front
    // of the lens. False if it is lost: at a rim, at the stop's opening, or by total reflection.
    bool toScene(LensRay&, double nm, const Aperture& opening) const noexcept;
    // The other way; `entry` becomes where the ray hit the first surface.
    bool toFilm(LensRay&, double nm, const Aperture& opening, Vec3d* entry = nullptr) const noexcept;

    CardinalPoints cardinalPoints(double nm) const;
    // Where the scene sees the middle of the stop, and how large: radius per radius of the stop. Paraxial.
    double entrancePupil(double nm) const;
    double entrancePupilScale(double nm) const;

    bool disperses() const { return disperses_; }
    double stopRadius() const { return surfaces_[stop_].semiAperture; } // wide open, m
    double length() const { return surfaces_.back().z; }                // from the first vertex to the last
    double rearRadius() const { return surfaces_.back().semiAperture; }
    double rearEdge() const { return edge(surfaces_.back()); } // z of the rim of the last surface
    double frontRadius() const { return surfaces_.front().semiAperture; }
    double frontEdge() const { return edge(surfaces_.front()); }

  private:
    struct Surface {
        double z = 0; // vertex
        double curvature = 0;
        double semiAperture = 0;
        std::uint32_t before = 0, behind = 0; // media
        bool isStop = false;
    };
    // (height, angle) in front of the first surface to the same behind another: y' = a y + b u, u' = c y + d u.
    struct Matrix {
        double a = 1, b = 0, c = 0, d = 1;
    };
    static constexpr int kCells = 470; // of 1 nm

    static double edge(const Surface&);
    double index(std::uint32_t medium, double nm) const;
    Matrix matrix(std::size_t surfaces, double nm) const; // through that many surfaces, with the way to the last one
    bool cross(const Surface&, LensRay&, double ratio, double forward, const Aperture&) const noexcept;

    std::vector<Surface> surfaces_;
    std::vector<double> indices_; // (kCells + 1) of each medium at 360, 361, … nm; medium 0 is air
    std::size_t stop_ = 0;
    bool disperses_ = false;
};

} // namespace abbe
