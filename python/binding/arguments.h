// Keyword arguments of Python as the options of a render.
#pragma once

#include "render_run/render_options.h"

#include <nanobind/nanobind.h>

namespace abbe::python {

// Takes all that `arguments` has; an unknown name is a TypeError, a wrong value a ValueError.
RenderOptions renderOptions(nanobind::dict arguments);
// `display`, `view`, `ocio`, `exposure`.
ViewOptions viewOptions(nanobind::dict arguments);

} // namespace abbe::python
