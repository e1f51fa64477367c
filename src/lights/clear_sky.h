// The light of a cloudless day on the ground: the sky's and the sun's.
#pragma once

#include "lights/clear_air.h"
#include "spectrum/curve.h"

#include <memory>
#include <vector>

namespace abbe {

// The radiance of a cloudless sky seen from the ground, by day and in twilight. Spectra of all that the sky gives are a
// source times values at the bands, linear between them: source() holds the lines of the sun, and a power of the
// wavelength that leaves little to bend.
class ClearSky {
  public:
    // `sunElevation`: rad. The albedo, at the bands, is that of the ground all around.
    ClearSky(const AirParams&, double sunElevation, const SkyBands& groundAlbedo);

    // Of a direction: z to the zenith, x to the sun's side; unit length. Requires z >= 0.
    SkyBands at(Vec3 w) const noexcept;
    // What at() is multiplied with for W·m⁻²·sr⁻¹·nm⁻¹, where the sun's irradiance outside of the air is known.
    static double scale(double nm);

  private:
    // Light that air has scattered but for what aerosol scatters at the first time, and that, without its phase
    // function.
    struct Node {
        SkyBands smooth, haze;
    };
    static constexpr int kRows = 40, kColumns = 24;
    Node look(const ClearAir&, const class ScatteredLight&, double elevation, double azimuth) const;
    const Node& node(int row, int column) const {
        return nodes_[static_cast<std::size_t>(row * (kColumns + 1) + column)];
    }

    Vec3d sun_;
    std::vector<Node> nodes_; // by the root of the elevation, then by azimuth from the sun's over half a turn
};

// How much air light crosses, 1 from the zenith [Kasten1965]. Requires zenithAngle (rad) in [0, π/2].
double relativeAirMass(double zenithAngle);

// Spectral irradiance on a surface that faces the sun outside of the air, W·m⁻²·nm⁻¹ [ASTMG173].
double solarIrradianceInSpace(double nm);

// What mixed gases and 2 cm of water vapour leave of light after so much air [Iqbal1983]: bands that begin at 690 nm.
double gasTransmittance(double nm, double airMass);

// Spectral irradiance on a surface that faces the sun, at sea level, W·m⁻²·nm⁻¹; 0 where its middle is below the
// horizon. Air and aerosol scatter their share away, aerosol, ozone and gases absorb theirs. Requires zenithAngle (rad)
// in [0, π].
SampledCurve solarIrradiance(double zenithAngle, const AirParams&);

} // namespace abbe
