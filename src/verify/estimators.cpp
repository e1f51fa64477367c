#include "verify/estimators.h"

namespace abbe {

namespace {

// With more lights than this a choice by power is far noisier than one by place.
constexpr std::size_t kFewLights = 8;

} // namespace

std::array<Estimator, 2> verifyEstimators(std::size_t lights) {
    using T = Technique;
    T scattering, asking;
    scattering.weights = T::Weights::scattering;
    asking.weights = T::Weights::lights;
    asking.directions = T::Directions::mixed;
    asking.numbers = T::Numbers::random;
    asking.roulette = T::Roulette::throughput;
    if (lights <= kFewLights) asking.lightChoice = T::LightChoice::power;
    return {
        {{"scattering", "directions and weights as surfaces sample them; light met by scattering", scattering},
         {"asking", "half of the directions even, weighed by values; light asked for; independent numbers", asking}}};
}

} // namespace abbe
