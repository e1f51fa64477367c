// How light is estimated. Every choice estimates the same image; they differ in noise and in time alone. All but the
// defaults exist for comparisons: `abbe study` shows what each choice is worth, `abbe verify` plays them off against
// each other.
#pragma once

#include <cstdint>

namespace abbe {

struct Technique {
    // Owen-scrambled Sobol points, or independent random numbers.
    enum class Numbers : std::uint8_t { sobol, random } numbers = Numbers::sobol;
    // How light is found: by asking lights and by scattering, or by one alone.
    enum class Strategy : std::uint8_t { mis, lightsOnly, bsdfOnly } strategy = Strategy::mis;
    // Which light is asked: by what it may give to the place; by its power alone, or evenly.
    enum class LightChoice : std::uint8_t { tree, power, uniform } lightChoice = LightChoice::tree;
};

} // namespace abbe
