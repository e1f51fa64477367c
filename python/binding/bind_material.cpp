#include "binding/bindings.h"
#include "binding/material_handle.h"
#include "binding/scene_handle.h"

#include <memory>
#include <nanobind/ndarray.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

namespace abbe::python {

namespace nb = nanobind;

namespace {

using Rows = nb::ndarray<const double, nb::shape<-1, 3>, nb::c_contig, nb::device::cpu>;
using Row = nb::ndarray<const double, nb::shape<-1>, nb::c_contig, nb::device::cpu>;
template <typename T> using Array = nb::ndarray<nb::numpy, T>;

// An array of numpy that is to be filled, and the same as numpy has it then.
template <typename T> class Filled {
  public:
    Filled(std::initializer_list<std::size_t> shape) : shape_(shape) {
        std::size_t size = 1;
        for (const std::size_t n : shape_) size *= n;
        values_ = std::make_unique<T[]>(size);
    }
    T* data() { return values_.get(); }
    Array<T> release() {
        T* const kept = values_.release();
        const nb::capsule owner(kept, [](void* p) noexcept { delete[] static_cast<T*>(p); });
        return Array<T>(kept, shape_.size(), shape_.data(), owner);
    }

  private:
    std::vector<std::size_t> shape_;
    std::unique_ptr<T[]> values_;
};

template <typename A> std::span<const double> spanOf(const A& array) { return {array.data(), array.size()}; }

Transport transportOf(bool importance) { return importance ? Transport::importance : Transport::radiance; }

void requireAsMany(const Rows& a, const Rows& b) {
    if (a.shape(0) != b.shape(0)) throw nb::value_error("there are not as many rows of both");
}

void requireWavelengths(const Row& nanometres) {
    if (nanometres.size() == 0) throw nb::value_error("there is no wavelength");
    for (const double nm : spanOf(nanometres))
        if (!(nm >= kMinWavelength && nm <= kMaxWavelength)) throw nb::value_error("a wavelength is out of range");
}

Array<float> eval(const MaterialHandle& m, const Rows& wo, const Rows& wi, const Row& nanometres, bool importance) {
    requireAsMany(wo, wi);
    requireWavelengths(nanometres);
    Filled<float> fcos{wo.shape(0), nanometres.size()};
    {
        const nb::gil_scoped_release free;
        m.eval(spanOf(wo), spanOf(wi), spanOf(nanometres), transportOf(importance), fcos.data());
    }
    return fcos.release();
}

Array<float> pdf(const MaterialHandle& m, const Rows& wo, const Rows& wi, const Row& nanometres) {
    requireAsMany(wo, wi);
    requireWavelengths(nanometres);
    Filled<float> density{wo.shape(0)};
    {
        const nb::gil_scoped_release free;
        m.pdf(spanOf(wo), spanOf(wi), spanOf(nanometres), density.data());
    }
    return density.release();
}

nb::tuple sample(const MaterialHandle& m, const Rows& wo, const Rows& u, const Row& nanometres, bool importance) {
    requireAsMany(wo, u);
    requireWavelengths(nanometres);
    const std::size_t count = wo.shape(0);
    Filled<float> wi{count, 3}, weight{count, nanometres.size()}, density{count};
    Filled<bool> delta{count};
    {
        const nb::gil_scoped_release free;
        m.sample(spanOf(wo), spanOf(u), spanOf(nanometres), transportOf(importance),
                 {wi.data(), weight.data(), density.data(), delta.data()});
    }
    return nb::make_tuple(wi.release(), weight.release(), density.release(), delta.release());
}

} // namespace

void bindMaterial(nb::module_& m) {
    nb::class_<MaterialHandle>(m, "MaterialHandle")
        .def(nb::new_([](const SceneHandle& scene, const std::string& name) {
                 const nb::gil_scoped_release free;
                 return std::make_shared<MaterialHandle>(scene.input(), name);
             }),
             nb::arg("scene"), nb::arg("name"))
        .def_prop_ro("log", &MaterialHandle::log)
        .def_prop_ro("names", &MaterialHandle::names)
        .def_prop_ro("found", &MaterialHandle::found)
        .def_prop_ro("obstacle", &MaterialHandle::obstacle)
        .def_prop_ro("chooses_lobe", &MaterialHandle::choosesLobe)
        .def_prop_ro("opacity", &MaterialHandle::opacity)
        .def("eval", &eval, nb::arg("wo"), nb::arg("wi"), nb::arg("wavelengths"), nb::arg("importance"))
        .def("pdf", &pdf, nb::arg("wo"), nb::arg("wi"), nb::arg("wavelengths"))
        .def("sample", &sample, nb::arg("wo"), nb::arg("u"), nb::arg("wavelengths"), nb::arg("importance"));
}

} // namespace abbe::python
