#include "base/named_arrays.h"
#include "binding/bindings.h"

#include <map>
#include <nanobind/ndarray.h>
#include <nanobind/stl/array.h>
#include <nanobind/stl/map.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <vector>

namespace abbe::python {

namespace nb = nanobind;

namespace {

using Floats = nb::ndarray<const float, nb::c_contig, nb::device::cpu>;
using Bytes = nb::ndarray<const std::uint8_t, nb::c_contig, nb::device::cpu>;
using Indices = nb::ndarray<const std::uint32_t, nb::c_contig, nb::device::cpu>;

// Arrays of numpy under a name, as they are: no copy. Whoever has this keeps them; so does a render that reads them.
class ArraysHandle {
  public:
    ArraysHandle(const std::string& what, const std::map<std::string, Floats>& floats,
                 const std::map<std::string, Indices>& integers, std::array<int, 3> size,
                 const std::map<std::string, Bytes>& bytes, std::array<double, 6> place) {
        // Counted by nanobind without Python's lock.
        struct Owner {
            std::vector<Floats> floats;
            std::vector<Indices> integers;
            std::vector<Bytes> bytes;
        };
        auto owner = std::make_shared<Owner>();
        auto arrays = std::make_shared<NamedArrays>();
        for (const auto& [name, array] : floats) {
            arrays->floats.emplace(name, std::span(array.data(), array.size()));
            owner->floats.push_back(array);
        }
        for (const auto& [name, array] : integers) {
            arrays->integers.emplace(name, std::span(array.data(), array.size()));
            owner->integers.push_back(array);
        }
        for (const auto& [name, array] : bytes) {
            arrays->bytes.emplace(name, std::span(array.data(), array.size()));
            owner->bytes.push_back(array);
        }
        arrays->size = size;
        arrays->place = place;
        arrays->owner = std::move(owner);
        arrays_ = std::move(arrays);
        name_ = nameArrays(what, arrays_);
    }

    const std::string& name() const { return name_; }

  private:
    std::shared_ptr<const NamedArrays> arrays_;
    std::string name_;
};

} // namespace

void bindArrays(nb::module_& m) {
    nb::class_<ArraysHandle>(m, "ArraysHandle")
        .def(nb::init<const std::string&, const std::map<std::string, Floats>&, const std::map<std::string, Indices>&,
                      std::array<int, 3>, const std::map<std::string, Bytes>&, std::array<double, 6>>(),
             nb::arg("what"), nb::arg("floats"), nb::arg("integers"), nb::arg("size"),
             nb::arg("bytes") = std::map<std::string, Bytes>(),
             nb::arg("place") = std::array<double, 6>{1, 1, 1, 0, 0, 0})
        .def_prop_ro("name", &ArraysHandle::name);
}

} // namespace abbe::python
