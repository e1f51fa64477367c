// What covers the light of an OpenPBR surface that shines: its coat and its fuzz [Andersson2024].
#pragma once

#include "materials/openpbr.h"
#include "materials/sheen_lobe.h"
#include "render/emission_veil.h"

namespace abbe {

// The coat absorbs along the refracted way; fuzz lets through what it does not throw back. Refers to the coat's colour.
// Requires coats and fuzz without textures.
class OpenPbrVeil final : public EmissionVeil {
  public:
    explicit OpenPbrVeil(const OpenPbrParams&);
    // Whether there is anything to pass.
    static bool needed(const OpenPbrParams&);

    Spectrum passing(float cosine, const Wavelengths&) const noexcept override;

  private:
    float coat_, fuzz_; // shares covered
    const Curve* color_;
    float coatIor_;
    SheenLobe sheen_;
};

} // namespace abbe
