// The cost report of a render in headers, events and on the terminal.
#pragma once

#include "app/json.h"
#include "io/exr_writer.h"
#include "study/cost.h"

#include <optional>
#include <span>
#include <string>

namespace abbe {

// docs/cost.md lists the members.
Json costJson(const CostReport&);
// A row a line, those of nothing left out; ends with a line break.
std::string costTable(const CostReport&);

// Of an image's header.
inline constexpr const char* kCostAttribute = "abbe.bill";
ImageAttribute costAttribute(const CostReport&);
// Nothing if the image has none, or none that can be read.
std::optional<CostReport> readCost(std::span<const ImageAttribute>);

} // namespace abbe
