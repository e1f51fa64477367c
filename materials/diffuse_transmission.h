// Leaves, paper, lampshades: Lambert's law on the side that light comes from, and on the other.
#pragma once

#include "render/material.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

class Diagnostics;

struct DiffuseTransmissionParams {
    schema::TexturedSpectrum reflectance, transmittance; // 0 … 1, together at most 1; absent: 0.25
};

schema::TypeInfo diffuseTransmissionType();
// False, with a diagnostic, if the two together give back more light than arrives. Of textures nothing is known here.
bool checkParams(const DiffuseTransmissionParams&, const schema::PlaceOf&, Diagnostics&);
// Curves and textures must outlive the material.
std::unique_ptr<const Material> makeDiffuseTransmission(const DiffuseTransmissionParams&);

} // namespace abbe
