// Light that air and ground have scattered, everywhere in a spherical atmosphere around one place.
#pragma once

#include "lights/clear_air.h"

#include <array>
#include <vector>

namespace abbe {

// Radiance at a point is kept as its moments over the sphere of directions, ∫ L b_i dω with the basis below: all that
// scattering by phase functions without higher moments asks for.
class ScatteredLight {
  public:
    static constexpr std::size_t kMoments = 6;
    using Moments = std::array<SkyBands, kMoments>;

    // Spherical harmonics up to the second degree, so scaled that Σ_i b_i(v) b_i(w) of one degree is P_l(v·w). x of the
    // unit direction points to the sun's side, z to the zenith; nothing depends on the sign of y.
    static std::array<float, kMoments> basis(float x, float z);
    static constexpr std::size_t kDegree[kMoments] = {0, 1, 1, 2, 2, 2};

    // `sunZenith`: rad, at the place. Per unit of the sun's irradiance outside of the air. The air is only read here.
    ScatteredLight(const ClearAir&, double sunZenith, const SkyBands& groundAlbedo);

    // What is scattered once more, not counting sunlight, per km and sr: the coefficients of the basis in a shell,
    // where the sun stands at an angle (rad) from the zenith.
    Moments source(int shell, double sunZenith) const;

    int iterations() const { return iterations_; }

  private:
    struct Place; // among the angles of the sun
    struct Way;
    static constexpr int kLevels = ClearAir::kShells + 1;
    Place place(double sunZenith) const;
    std::size_t index(int level, int angle) const {
        return static_cast<std::size_t>(level) * static_cast<std::size_t>(angles_) + static_cast<std::size_t>(angle);
    }
    double angle(int i) const { return first_ + i * step_; }

    void findSource(const ClearAir&, int shell);
    void gather(const ClearAir&, int level, const SkyBands& groundAlbedo);
    SkyBands radiance(const Way&, double x, double z, int angle, const SkyBands& groundAlbedo) const;

    double first_, step_; // angles of the sun from the zenith, rad
    int angles_;
    int iterations_ = 0;           // until another changes nothing
    std::vector<Moments> field_;   // at the boundaries of shells, of scattered light
    std::vector<Moments> direct_;  // in shells, of sunlight
    std::vector<Moments> sources_; // in shells
    std::vector<SkyBands> ground_; // irradiance of the ground by scattered light
    std::vector<SkyBands> sunlit_; // and by the sun
};

// ∫ e^-σt dt from 0 to the length, km, with an extinction σ in 1/km.
SkyBands lengthSeen(const SkyBands& extinction, double length);

} // namespace abbe
