// A lens as its designer writes it down: a table of spherical surfaces and the stop.
#pragma once

#include "base/diagnostic.h"
#include "schema/type.h"
#include "spectrum/curve.h"

#include <memory>
#include <optional>
#include <string_view>
#include <vector>

namespace abbe {

// One surface, in the order in which light passes from the scene to the film. Lengths in m.
struct LensSurface {
    double curvature = 0;         // 1 / radius; positive: the centre lies on the film's side. 0: flat
    double thickness = 0;         // along the axis to the next surface; of the last one: without meaning
    double semiAperture = 0;      // of the glass, or of the stop when it is wide open
    const Curve* index = nullptr; // of the medium behind it; null: air, to which all indices are relative
    bool isStop = false;
};

// Sound if it comes from the functions below: one stop in air, light enters from air and leaves into air.
struct LensPrescription {
    std::vector<LensSurface> surfaces;
    std::vector<std::unique_ptr<const Curve>> glasses; // what `index` points to
    double scale = 1;                                  // all lengths have been multiplied by it

    void rescale(double factor);
};

// n(λ) = A + B/λ² with the index `nd` and the Abbe number V = (nd - 1) / (nF - nC).
std::unique_ptr<const Curve> glassFromAbbeNumber(double nd, double abbeNumber);

// Rows of radius (a length, `flat` or `stop`), thickness, medium and semi-aperture. A medium is `air`, a glass of the
// library, a refractive index, or index and Abbe number in quotes, "1.670/47.1", from which a Cauchy curve with these
// values at the d, F and C lines is made. Nothing after an error located in the table.
std::optional<LensPrescription> readPrescription(const schema::TableRows&, Diagnostics&);

// Published lenses that come with the program.
struct PublishedLens {
    std::string_view name;
    std::string_view source;
};
const std::vector<PublishedLens>& publishedLenses();
// Requires a name from publishedLenses().
LensPrescription publishedLens(std::string_view name);

} // namespace abbe
