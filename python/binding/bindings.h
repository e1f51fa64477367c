// The parts of the extension.
#pragma once

#include <nanobind/nanobind.h>

namespace abbe::python {

void bindLanguage(nanobind::module_&); // tables, suggestions, layout, the program itself
void bindScene(nanobind::module_&);
void bindImage(nanobind::module_&);
void bindRender(nanobind::module_&);
void bindArrays(nanobind::module_&);
void bindSpectrum(nanobind::module_&);
void bindMaterial(nanobind::module_&);

} // namespace abbe::python
