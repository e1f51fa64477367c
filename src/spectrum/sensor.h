// What turns spectra into the three numbers of a pixel: the CIE observer, or a camera's sensitivities.
#pragma once

#include "spectrum/data/cameras.h"
#include "spectrum/observer.h"

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace abbe {

// Immutable; shared between threads. Costs the same per sample whatever it is: three sums over one table.
class Sensor {
  public:
    // The CIE 1931 2° observer: bit for bit toXyz().
    Sensor() = default;
    // A camera with a 3×3 matrix from its signals to XYZ, which gives `light` itself exactly and the 24 patches of the
    // ColorChecker under it with the least squared error [Langlands2020; Pharr2023, sec. 5.4.2]. What a camera sees
    // alike stays alike: colours differ from the observer's where its sensitivities do.
    // Requires that the light has power where the camera is sensitive.
    Sensor(const CameraSensitivities&, const Curve& light);

    // One path's estimate, as toXyz().
    Xyz operator()(const Spectrum& radiance, const Wavelengths& w) const { return toXyz(radiance, w, cells_); }
    // What it tends to: exact for piecewise-linear curves with nodes at whole nanometres.
    Xyz integrate(const Curve&) const;
    bool isObserver() const { return !table_; }

  private:
    using Table = std::array<detail::ObserverCell, 470>;
    std::unique_ptr<const Table> table_; // null: the observer's
    const detail::ObserverCell* cells_ = detail::kObserver.data();
};

// "nikon-d850", …; null for other names.
const CameraSensitivities* findSensitivities(std::string_view name);
std::vector<std::string_view> sensorNames();

} // namespace abbe
