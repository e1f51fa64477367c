// Turns the spectra of a scene into curves, and owns them.
#pragma once

#include "base/diagnostic.h"
#include "schema/scene_tree.h"
#include "spectrum/color_space.h"
#include "spectrum/curve.h"

#include <memory>
#include <vector>

namespace abbe {

// Reports what cannot be: unknown names with suggestions, light used as reflectance, colours without a spectrum.
class CurveLibrary {
  public:
    // Null after a diagnostic.
    const Curve* curve(const schema::SpectrumValue&, schema::SpectrumRole, Diagnostics&);
    schema::ComplexIndex metal(std::string_view name, Span, Diagnostics&);
    const Curve* constant(double value);
    // Illuminant D65, scaled to Y = 1.
    const Curve* daylight();
    // What `rgb 1 1 1` of a space is as light: its illuminant, Y = 1.
    const Curve* white(const RgbSpace&);

    std::vector<std::unique_ptr<const Curve>> release() { return std::move(curves_); }

  private:
    const Curve* keep(std::unique_ptr<const Curve>);
    const Curve* named(const schema::SpectrumValue&, schema::SpectrumRole, Diagnostics&);
    const Curve* rgb(const schema::SpectrumValue&, schema::SpectrumRole, Diagnostics&);
    const Curve* table(const schema::SpectrumValue&, schema::SpectrumRole);
    const Curve* tint(const schema::SpectrumValue&, Diagnostics&);

    std::vector<std::unique_ptr<const Curve>> curves_;
    const Curve* daylight_ = nullptr;
};

} // namespace abbe
