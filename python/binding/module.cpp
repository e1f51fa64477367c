// abbe._abbe: what the Python of the package is written on. Nothing here is meant for its users.
#include "base/program_folder.h"
#include "binding/bindings.h"

#include <dlfcn.h>
#include <filesystem>
#include <nanobind/nanobind.h>

namespace {

// What the renderer loads at run time lies beside the extension, in a wheel as in a build folder.
void findHelpers() {
    Dl_info self;
    if (dladdr(reinterpret_cast<const void*>(&findHelpers), &self) == 0 || !self.dli_fname) return;
    std::error_code error;
    const auto path = std::filesystem::canonical(self.dli_fname, error);
    if (!error) abbe::setProgramFolder(path.parent_path());
}

} // namespace

NB_MODULE(_abbe, m) {
    findHelpers();
    abbe::python::bindLanguage(m);
    abbe::python::bindScene(m);
    abbe::python::bindImage(m);
    abbe::python::bindRender(m);
    abbe::python::bindArrays(m);
    abbe::python::bindSpectrum(m);
    abbe::python::bindMaterial(m);
}
