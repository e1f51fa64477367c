// Cryptomatte 1.2 [Friedman2015]: which things a pixel sees, and how much of it each covers.
#pragma once

#include "film/film_layers.h"

#include <string_view>

namespace abbe {

// MurmurHash3 of 32 bits, x86 variant, seed 0 [Appleby2011].
std::uint32_t murmurHash3(std::string_view);
// The identifier of a name: its hash as the bits of a float, with the exponent kept from 0 and 255 so that it is
// neither denormal nor infinite nor NaN.
float cryptomatteId(std::string_view name);

// The layer `name` ("CryptoObject"): channels NAME00.R … NAME02.A, six ranks of identifier and coverage, by falling
// coverage, and NAME.R .G .B, a picture for people. `samples[i]`: of pixel i.
std::vector<NamedPlane> cryptomattePlanes(const FilmLayers&, FilmLayers::Matte, std::string_view name,
                                          const std::vector<float>& samples);

// The header's attributes of that layer, by name and value: "cryptomatte/d1ab93f/name", ….
std::vector<std::pair<std::string, std::string>> cryptomatteHeader(const FilmLayers&, FilmLayers::Matte,
                                                                   std::string_view name);

} // namespace abbe
