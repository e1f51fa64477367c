// The tables of this folder.
#pragma once

#include "spectrum/named_spectra.h"

#include <span>

namespace abbe::data {

std::span<const NamedSpectrum> illuminants();
std::span<const NamedSpectrum> reflectances();
std::span<const Glass> glasses();
std::span<const Metal> metals();

} // namespace abbe::data
