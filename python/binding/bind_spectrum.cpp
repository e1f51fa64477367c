#include "binding/bindings.h"
#include "binding/diagnostic_records.h"
#include "parser/parse.h"
#include "scene/build_context.h"
#include "schema/spectrum_reader.h"
#include "spectrum/sensor.h"

#include <array>
#include <memory>
#include <nanobind/ndarray.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/tuple.h>
#include <string>
#include <tuple>
#include <vector>

namespace abbe::python {

namespace nb = nanobind;

namespace {

constexpr std::array kRoleNames = {"albedo", "unbounded", "emission", "index", "shape", "tint"};
constexpr std::array kNoDimension = {schema::Dimension::none};

// A value of the language in a role, as the renderer would use it.
class SpectrumHandle {
  public:
    // Null where `log` has errors.
    const Curve* curve = nullptr;
    std::shared_ptr<DiagnosticLog> log = std::make_shared<DiagnosticLog>();

    SpectrumHandle(const std::string& text, const std::string& role) {
        const auto* const known = std::ranges::find(kRoleNames, role);
        if (known == kRoleNames.end()) throw nb::value_error(("no spectrum is for `" + role + "`").c_str());
        const auto use = static_cast<schema::SpectrumRole>(known - kRoleNames.begin());
        SourceMap sources;
        Diagnostics diagnostics;
        schema::SceneTree tree;
        const auto document = parse(sources, sources.add("<spectrum>", "spectrum " + text + "\n"), {}, diagnostics);
        tree.document = document;
        const schema::NodeRange roots = document->roots();
        if (!diagnostics.hasErrors() && !roots.empty())
            if (const auto value = schema::readSpectrum(schema::SpectrumUse{"spectrum", use, kNoDimension},
                                                        schema::Entry(*roots.begin()), tree, diagnostics))
                curve = curves_.curve(*value, use, diagnostics);
        log->add(diagnostics, sources);
        if (!log->hasErrors() && !curve) throw nb::value_error("this is no spectrum");
    }

    SpectrumHandle(const SpectrumHandle&) = delete;
    SpectrumHandle& operator=(const SpectrumHandle&) = delete;

    double at(double nanometres) const { return curve->at(nanometres); }

  private:
    CurveLibrary curves_;
};

using Numbers = nb::ndarray<const double, nb::c_contig, nb::device::cpu>;
using Result = nb::ndarray<nb::numpy, double>;

// Of the shape of the wavelengths.
Result evaluate(const SpectrumHandle& spectrum, const Numbers& wavelengths) {
    auto values = std::make_unique<std::vector<double>>(wavelengths.size());
    for (std::size_t i = 0; i < values->size(); ++i) (*values)[i] = spectrum.at(wavelengths.data()[i]);
    std::vector<std::size_t> shape(wavelengths.ndim());
    for (std::size_t i = 0; i < shape.size(); ++i) shape[i] = wavelengths.shape(i);
    std::vector<double>* const kept = values.release();
    const nb::capsule owner(kept, [](void* p) noexcept { delete static_cast<std::vector<double>*>(p); });
    return Result(kept->data(), shape.size(), shape.data(), owner);
}

using Triple = std::tuple<double, double, double>;

Triple triple(const Xyz& v) { return {v.x, v.y, v.z}; }

} // namespace

void bindSpectrum(nb::module_& m) {
    nb::class_<SpectrumHandle>(m, "SpectrumHandle")
        .def(nb::init<const std::string&, const std::string&>())
        .def_prop_ro("log", [](const SpectrumHandle& s) { return s.log; })
        .def("at", &evaluate)
        .def("xyz", [](const SpectrumHandle& s) { return triple(integrate(*s.curve)); })
        .def("xyz_under", [](const SpectrumHandle& s, const SpectrumHandle& light) {
            return triple(integrate(*s.curve, *light.curve));
        });
    m.def("rgb_of_xyz", [](const Triple& xyz, const std::string& name) {
        const auto space = findRgbSpace(name);
        if (!space) throw nb::value_error(("no colour space is called `" + name + "`").c_str());
        const auto [x, y, z] = xyz;
        const Vec3d rgb = toRgb({x, y, z}, *space);
        return Triple{rgb.x, rgb.y, rgb.z};
    });
}

} // namespace abbe::python
