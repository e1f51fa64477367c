// The words of the scene language for each choice of a Technique.
#pragma once

#include "render/technique.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe {

// Any other word gives the default.
Technique::Numbers numbersOf(std::string_view word);
Technique::Strategy strategyOf(std::string_view word);
Technique::Weights weightsOf(std::string_view word);
Technique::Directions directionsOf(std::string_view word);
Technique::LightChoice lightChoiceOf(std::string_view word);
Technique::Roulette rouletteOf(std::string_view word);
Technique::LightPaths lightPathsOf(std::string_view word);
Technique::Merging mergingOf(std::string_view word);

std::string_view word(Technique::Numbers);
std::string_view word(Technique::Strategy);
std::string_view word(Technique::Weights);
std::string_view word(Technique::Directions);
std::string_view word(Technique::LightChoice);
std::string_view word(Technique::Roulette);
std::string_view word(Technique::LightPaths);
std::string_view word(Technique::Merging);

// All of it, as properties of `render` with their values.
std::vector<std::pair<std::string, std::string>> properties(const Technique&);

} // namespace abbe
