#include "binding/background.h"
#include "binding/bindings.h"
#include "binding/diagnostic_records.h"
#include "binding/scene_handle.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace abbe::python {

namespace nb = nanobind;

namespace {

nb::list tuples(const DiagnosticLog& log) {
    nb::list list;
    for (const DiagnosticRecord& r : log.records())
        list.append(nb::make_tuple(r.error ? "error" : "warning", r.code, r.message, r.file, r.line, r.column,
                                   r.endLine, r.endColumn, r.label, r.notes, r.help));
    return list;
}

std::shared_ptr<SceneHandle> makeScene(std::string path, std::optional<std::string> text,
                                       std::vector<std::string> defines, std::vector<std::string> variants,
                                       std::vector<std::string> sets, std::vector<std::string> search) {
    SceneInput input;
    input.path = std::move(path);
    input.text = std::move(text);
    input.defines = std::move(defines);
    input.layers = {std::move(variants), std::move(sets), std::move(search)};
    return std::make_shared<SceneHandle>(std::move(input));
}

std::shared_ptr<DiagnosticLog> check(const std::shared_ptr<SceneHandle>& scene, std::optional<int> frame) {
    // Without the handle, whose end would need Python's lock.
    const auto log = std::make_shared<std::shared_ptr<DiagnosticLog>>();
    runInterruptibly([log, input = scene->input(), frame] { *log = checkScene(input, frame); });
    return *log;
}

// It may have to wait for a render of this process.
void forget(const std::shared_ptr<SceneHandle>& scene) {
    runInterruptibly([scene] { scene->forget(); });
}

} // namespace

void bindScene(nb::module_& m) {
    nb::class_<DiagnosticLog>(m, "DiagnosticLog")
        .def("records", &tuples)
        .def("text", &DiagnosticLog::text)
        .def("has_errors", &DiagnosticLog::hasErrors);
    nb::class_<SceneHandle>(m, "SceneHandle")
        .def(nb::new_(&makeScene), nb::arg("path"), nb::arg("text").none(), nb::arg("defines"), nb::arg("variants"),
             nb::arg("sets"), nb::arg("search"))
        .def("check", &check, nb::arg("frame").none())
        .def("forget", &forget);
    m.def("wait_for_abandoned", &Abandoned::waitForAll, nb::call_guard<nb::gil_scoped_release>());
}

} // namespace abbe::python
