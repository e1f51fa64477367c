// What `render { … }` says, and the words of the scene language for each choice of a Technique.
#pragma once

#include "render/integrator.h"
#include "render/technique.h"
#include "schema/type.h"

#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe {

// The words of the scene language for each choice of a Technique. Any other word gives the default.
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

// What `render { … }` says.
struct RenderParams {
    schema::Choice integrator{"path", {}};
    std::int64_t samples = 64;
    std::int64_t seed = 0;
    std::int64_t maxDepth = 0; // 0: no limit
    std::int64_t replicates = 2;
    double noise = 0;           // relative error to stop at; 0: none
    double timeLimit = 0;       // s; 0: none
    double textureCache = 2048; // MiB
    bool adaptive = false;
    schema::TableRows forbid; // rows of one word: effects that the scene must not need
    schema::Choice sampler{"sobol", {}};
    schema::Choice strategy{"mis", {}};
    schema::Choice weights{"balance", {}};
    schema::Choice directions{"importance", {}};
    schema::Choice roulette{"pilot", {}};
    schema::Choice lightPaths{"automatic", {}};
    schema::Choice merging{"automatic", {}};
    std::int64_t wavelengths = 8; // 1, 2, 4 or 8
    schema::Choice lightChoice{"tree", {}};
};

schema::TypeInfo renderType();
// Requires possibleWavelengths(params.wavelengths).
RenderSettings renderSettings(const RenderParams& params);
// Whether a path can have so many different ones, which repeat evenly in its lanes.
bool possibleWavelengths(std::int64_t count);

} // namespace abbe
