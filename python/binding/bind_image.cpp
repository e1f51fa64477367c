#include "binding/arguments.h"
#include "binding/bindings.h"
#include "binding/image_handle.h"
#include "io/file.h"

#include <nanobind/ndarray.h>
#include <nanobind/stl/pair.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/variant.h>
#include <nanobind/stl/vector.h>

namespace abbe::python {

namespace nb = nanobind;

namespace {

using Plane = nb::ndarray<nb::numpy, const float, nb::ndim<2>>;
using Colours = nb::ndarray<nb::numpy, float, nb::ndim<3>>;

// Without a copy: the array keeps the image.
Plane plane(nb::handle_t<ImageHandle> self, const std::string& name) {
    const ImageHandle& image = nb::cast<const ImageHandle&>(self);
    const std::span<const float> values = image.plane(name);
    if (values.empty()) throw nb::key_error(name.c_str());
    const std::size_t shape[] = {static_cast<std::size_t>(image.height()), static_cast<std::size_t>(image.width())};
    return Plane(values.data(), 2, shape, self);
}

Colours colours(const ImageHandle& image, const std::string& name) {
    const auto space = name == "xyz" || name == rgb::xyz.name ? std::optional(rgb::xyz) : findRgbSpace(name);
    if (!space) {
        std::string known = "xyz";
        for (const std::string_view one : rgbSpaceNames()) known += ", " + std::string(one);
        throw nb::value_error(("no colour space is called `" + name + "`; there are " + known).c_str());
    }
    auto* const values = new std::vector<float>(image.rgb(*space));
    const nb::capsule owner(values, [](void* p) noexcept { delete static_cast<std::vector<float>*>(p); });
    const std::size_t shape[] = {static_cast<std::size_t>(image.height()), static_cast<std::size_t>(image.width()), 3};
    return Colours(values->data(), 3, shape, owner);
}

nb::dict attributes(const ImageHandle& image) {
    nb::dict dict;
    for (const ImageAttribute& a : image.attributes()) dict[a.name.c_str()] = nb::cast(a.value);
    return dict;
}

std::shared_ptr<DiagnosticLog> save(const ImageHandle& image, const std::string& path, int bits, nb::dict view) {
    const ViewOptions options = viewOptions(view);
    auto log = std::make_shared<DiagnosticLog>();
    const nb::gil_scoped_release free;
    image.save(path, options, bits, *log);
    return log;
}

} // namespace

void bindImage(nb::module_& m) {
    nb::exception<IoError>(m, "IoError", PyExc_OSError);
    nb::class_<ImageHandle>(m, "ImageHandle")
        .def_static("read", &ImageHandle::read, nb::call_guard<nb::gil_scoped_release>())
        .def_prop_ro("width", &ImageHandle::width)
        .def_prop_ro("height", &ImageHandle::height)
        .def_prop_ro("window",
                     [](const ImageHandle& image) {
                         const PixelBounds b = image.window();
                         return nb::make_tuple(b.x0, b.y0, b.x1, b.y1);
                     })
        .def_prop_ro("display_size", &ImageHandle::displaySize)
        .def_prop_ro("space", &ImageHandle::space)
        .def("channels", &ImageHandle::channels)
        .def("plane", &plane)
        .def("rgb", &colours)
        .def("attributes", &attributes)
        .def("save", &save);
}

} // namespace abbe::python
