// How light is estimated. Every choice estimates the same image, but for the blur of merged light, which goes to 0 as
// samples are added (`merging`); they differ in noise and in time alone. All but the
// defaults exist for comparisons: `abbe study` shows what each choice is worth, `abbe verify` plays them off against
// each other.
#pragma once

#include <cstdint>

namespace abbe {

struct Technique {
    // Owen-scrambled Sobol points; jittered strata, as many as a replicate has samples, in every pair of dimensions;
    // or independent random numbers.
    enum class Numbers : std::uint8_t { sobol, stratified, random } numbers = Numbers::sobol;
    // How light is found: by next-event estimation and by scattering, or by one alone. What next-event estimation
    // cannot find (mirrors, parts of the sky that a light never samples) is found by scattering in any case.
    enum class Strategy : std::uint8_t { mis, lightsOnly, bsdfOnly } strategy = Strategy::mis;
    // How the two are weighed where both find the same light: the heuristics of [Veach1997, sec. 9.2], one half each,
    // or the balance heuristic as if one of the two had more samples than it has.
    enum class Weights : std::uint8_t { balance, power, equal, lights, scattering } weights = Weights::balance;
    // Where paths go on: as the surface or medium scatters; evenly over the hemisphere, or the sphere where light is
    // let through; or by a mixture of both, weighed by its density. Mirrors and clear glass are followed in any case.
    enum class Directions : std::uint8_t { importance, uniform, mixed } directions = Directions::importance;
    // Which light next-event estimation samples: chosen by what it may give to the place; by its power alone, or
    // evenly.
    enum class LightChoice : std::uint8_t { tree, power, uniform } lightChoice = LightChoice::tree;
    // Which paths go on: by what the pixel is expected to show, by their throughput, or all but those that carry next
    // to nothing. Paths beyond kLongPath vertices are never certain to go on.
    enum class Roulette : std::uint8_t { pilot, throughput, off } roulette = Roulette::pilot;
    // How many different ones a path has: 1, 2, 4 or 8. Fewer are repeated in the lanes.
    std::uint8_t wavelengths = 8;
    // Paths of light beside those from the camera: where a plan finds them worth their time; never; always, as many as
    // the plan finds best; or always, with all light that they can bring left to them.
    enum class LightPaths : std::uint8_t { automatic, off, always, alone } lightPaths = LightPaths::automatic;
    // Merging of light paths with camera paths behind mirrors and glass, for caustics that nothing else finds: where a
    // plan finds it worth its time, never, or always. The only choice here that is biased; none without light paths.
    enum class Merging : std::uint8_t { automatic, off, always } merging = Merging::automatic;

    // Directions of camera paths drawn by where pilots found light, beside those of surfaces: where that is forecast to
    // pay, never, or always.
    enum class Guiding : std::uint8_t { automatic, off, always } guiding = Guiding::automatic;
    // Windows through which skies are sampled: those that lights state alone; or, where none does, those that walks
    // from what the camera sees find. Read while the scene is built.
    enum class Windows : std::uint8_t { stated, automatic } windows = Windows::stated;

    friend bool operator==(const Technique&, const Technique&) = default;
};

} // namespace abbe
