// What is told of a render, in words and for programs: of the finished picture, of its cost (in headers, events and on
// the terminal), and of what was decided on paths of light.
#pragma once

#include "app/json.h"
#include "cameras/exposure.h"
#include "caustics/glints/glint_plan.h"
#include "caustics/light_tracing/light_path_plan.h"
#include "caustics/manifold/manifold_plan.h"
#include "caustics/merging/merge_plan.h"
#include "io/exr_writer.h"
#include "pictures/picture_figures.h"
#include "render/integrator.h"
#include "rendering/guide_plan.h"
#include "study/cost.h"

#include <optional>
#include <span>
#include <string>

namespace abbe {

// "picture median 12.3 nits, 99 % of it up to 840 nits   display 2.1 % below 1 %, 0.4 % above 99 %".
std::string pictureLine(const PictureFigures&);
// How to look at a PNG: "to look at it:  xdg-open room.png" where there is a screen, else where the file is.
std::string viewingLine(const std::string& png);
// The figures, and the exposure that the picture has.
Json pictureJson(const PictureFigures&, const Exposure&);

// docs/cost.md lists the members.
Json costJson(const CostReport&);
// A row a line, those of nothing left out; ends with a line break.
std::string costTable(const CostReport&);

// Of an image's header.
ImageAttribute costAttribute(const CostReport&);
bool isCostAttribute(const ImageAttribute&);
// Nothing if the image has none, or none that can be read.
std::optional<CostReport> readCost(std::span<const ImageAttribute>);

// One line, such as "light paths 2 per camera path: forecast 12 × as efficient (light → ball 63 %, light → elsewhere
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
// Empty where paths are not guided.
std::string guideLine(const GuideFindings&);
Json guideJson(const GuideFindings&);
// Sets what there is of it.
void addLook(Json& event, const LookFindings&);
// docs/output.md lists the members.
Json lightPathJson(const CausticFindings&);

} // namespace abbe
