// Materials that are told apart by their number and do nothing.
#pragma once

#include "render/material.h"

#include <array>
#include <cstdint>

namespace abbe::test {

class NumberedMaterial final : public Material {
  public:
    const Bsdf* bsdf(const SurfaceHit&, const Wavelengths&, Arena&) const noexcept override { return nullptr; }
};

// Requires i < 16.
inline const Material* material(std::uintptr_t i) {
    static const std::array<NumberedMaterial, 16> all;
    return &all.at(i);
}

} // namespace abbe::test
