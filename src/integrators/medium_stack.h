// Which shapes' interiors a path is in.
#pragma once

#include "integrators/entered_stack.h"
#include "render/medium.h"

namespace abbe {

// Interiors that overlap add up.
using MediumStack = EnteredStack<Medium>;

} // namespace abbe
