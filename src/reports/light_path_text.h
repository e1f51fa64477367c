// What was decided on paths of light, in words.
#pragma once

#include "app/json.h"
#include "render/light_path_findings.h"

#include <string>

namespace abbe {

// One line, such as "light paths 2 per camera path: forecast 12 × as efficient (lamp → ball 63 %, lamp → elsewhere
// 22 %)" or "no light paths: nothing focuses light". Empty where nobody looked.
std::string lightPathLine(const LightPathFindings&);
// The same with all that was measured, line by line.
std::string lightPathText(const LightPathFindings&);
// What light paths cannot show to the lens; empty where manifold sampling is not used.
std::string manifoldLine(const LightPathFindings&);
// The rest of that, and what nothing finds; empty where light paths are not merged and nothing is missing.
std::string mergeLine(const MergeFindings&);
// Empty where no glints are probed.
std::string glintLine(const GlintFindings&);
// docs/output.md lists the members.
Json lightPathJson(const LightPathFindings&);

} // namespace abbe
