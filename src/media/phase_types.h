// Phase functions as the language writes them.
#pragma once

#include "render/phase_function.h"
#include "schema/type.h"

#include <functional>
#include <memory>

namespace abbe {

struct TablePhaseParams {
    schema::Text file;
    schema::TableRows values;
};
struct MixPhaseParams {
    std::vector<schema::WeightedReference> parts;
};

std::vector<schema::TypeInfo> phaseTypes();
// Those that need nothing but their parameters: all but `table` and `mix`. `bind` fills the parameters of the type
// named and returns false after a diagnostic; null then.
std::shared_ptr<const PhaseFunction> makePhase(std::string_view type, const std::function<bool(void*)>& bind);

} // namespace abbe
