// Phase functions as the language writes them.
#pragma once

#include "render/medium.h"
#include "schema/type.h"

#include <memory>

namespace abbe {

struct IsotropicPhaseParams {};
struct RayleighPhaseParams {};
struct HenyeyGreensteinPhaseParams {
    double g = 0;
};
struct DrainePhaseParams {
    double g = 0, alpha = 1;
};
struct MiePhaseParams {
    double radius = 10e-6; // m
    double spread = 0.2;
    const Curve* index = nullptr;
    const Curve* absorption = nullptr;
    const Curve* surroundings = nullptr;
};
struct TablePhaseParams {
    schema::Text file;
    schema::TableRows values;
};
struct MixPhaseParams {
    std::vector<schema::WeightedReference> parts;
};

schema::TypeInfo isotropicPhaseType();
schema::TypeInfo henyeyGreensteinPhaseType();
schema::TypeInfo rayleighPhaseType();
schema::TypeInfo drainePhaseType();
schema::TypeInfo miePhaseType();
schema::TypeInfo tablePhaseType();
schema::TypeInfo mixPhaseType();

std::shared_ptr<const PhaseFunction> makeIsotropicPhase(const IsotropicPhaseParams&);
std::shared_ptr<const PhaseFunction> makeHenyeyGreensteinPhase(const HenyeyGreensteinPhaseParams&);
std::shared_ptr<const PhaseFunction> makeRayleighPhase(const RayleighPhaseParams&);
std::shared_ptr<const PhaseFunction> makeDrainePhase(const DrainePhaseParams&);
std::shared_ptr<const PhaseFunction> makeMiePhase(const MiePhaseParams&);

} // namespace abbe
