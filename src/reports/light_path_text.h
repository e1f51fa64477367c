// What was decided on paths of light, in words.
#pragma once

#include "app/json.h"
#include "caustics/glints/glint_findings.h"
#include "caustics/light_tracing/light_path_findings.h"
#include "caustics/manifold/manifold_findings.h"
#include "caustics/merging/merge_findings.h"
#include "render/caustic_findings.h"

#include <string>

namespace abbe {

// One line, such as "light paths 2 per camera path: forecast 12 × as efficient (lamp → ball 63 %, lamp → elsewhere
// 22 %)" or "no light paths: nothing focuses light". Empty where nobody looked.
std::string lightPathLine(const LightPathFindings&);
// The same with all that was measured for all techniques, line by line.
std::string lightPathText(const CausticFindings&);
// What light paths cannot show to the lens; empty where manifold sampling is not used.
std::string manifoldLine(const CausticFindings&);
// The rest of that, and what nothing finds; empty where light paths are not merged and nothing is missing.
std::string mergeLine(const MergeFindings&);
// Empty where no glints are probed.
std::string glintLine(const GlintFindings&);
// docs/output.md lists the members.
Json lightPathJson(const CausticFindings&);

} // namespace abbe
