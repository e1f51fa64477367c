#include "integrators/technique_words.h"

#include <array>

namespace abbe {

namespace {

// In the order of the enumerators; the first is the default.
template <typename E> constexpr std::array<std::string_view, 5> kWords{};
template <> constexpr std::array<std::string_view, 5> kWords<Technique::Numbers>{"sobol", "stratified", "random"};
template <> constexpr std::array<std::string_view, 5> kWords<Technique::Strategy>{"mis", "lights", "bsdf"};
template <>
constexpr std::array<std::string_view, 5> kWords<Technique::Weights>{"balance", "power", "equal", "lights",
                                                                     "scattering"};
template <> constexpr std::array<std::string_view, 5> kWords<Technique::Directions>{"importance", "uniform", "mixed"};
template <> constexpr std::array<std::string_view, 5> kWords<Technique::LightChoice>{"tree", "power", "uniform"};
template <> constexpr std::array<std::string_view, 5> kWords<Technique::Roulette>{"pilot", "throughput", "off"};

template <>
constexpr std::array<std::string_view, 5> kWords<Technique::LightPaths>{"automatic", "off", "always", "alone"};
template <> constexpr std::array<std::string_view, 5> kWords<Technique::Merging>{"automatic", "off", "always"};

template <typename E> E find(std::string_view word) {
    for (std::size_t i = 1; i < kWords<E>.size(); ++i)
        if (!word.empty() && kWords<E>[i] == word) return static_cast<E>(i);
    return static_cast<E>(0);
}
template <typename E> std::string_view wordOf(E e) { return kWords<E>[static_cast<std::size_t>(e)]; }

} // namespace

Technique::Numbers numbersOf(std::string_view word) { return find<Technique::Numbers>(word); }
Technique::Strategy strategyOf(std::string_view word) { return find<Technique::Strategy>(word); }
Technique::Weights weightsOf(std::string_view word) { return find<Technique::Weights>(word); }
Technique::Directions directionsOf(std::string_view word) { return find<Technique::Directions>(word); }
Technique::LightChoice lightChoiceOf(std::string_view word) { return find<Technique::LightChoice>(word); }
Technique::Roulette rouletteOf(std::string_view word) { return find<Technique::Roulette>(word); }

Technique::LightPaths lightPathsOf(std::string_view word) { return find<Technique::LightPaths>(word); }
Technique::Merging mergingOf(std::string_view word) { return find<Technique::Merging>(word); }

std::string_view word(Technique::Numbers e) { return wordOf(e); }
std::string_view word(Technique::Strategy e) { return wordOf(e); }
std::string_view word(Technique::Weights e) { return wordOf(e); }
std::string_view word(Technique::Directions e) { return wordOf(e); }
std::string_view word(Technique::LightChoice e) { return wordOf(e); }
std::string_view word(Technique::Roulette e) { return wordOf(e); }
std::string_view word(Technique::LightPaths e) { return wordOf(e); }
std::string_view word(Technique::Merging e) { return wordOf(e); }

std::vector<std::pair<std::string, std::string>> properties(const Technique& t) {
    const auto text = [](auto e) { return std::string(word(e)); };
    return {{"sampler", text(t.numbers)},
            {"strategy", text(t.strategy)},
            {"mis-weights", text(t.weights)},
            {"directions", text(t.directions)},
            {"light-choice", text(t.lightChoice)},
            {"roulette", text(t.roulette)},
            {"light-paths", text(t.lightPaths)},
            {"merging", text(t.merging)},
            {"wavelengths", std::to_string(t.wavelengths)}};
}

} // namespace abbe
