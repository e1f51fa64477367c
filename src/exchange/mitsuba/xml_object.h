// What a scene of Mitsuba's is after its text was read: objects (plugins) with parameters, each with its place.
#pragma once

#include "base/source.h"
#include "math/transform.h"

#include <algorithm>
#include <array>
#include <deque>
#include <filesystem>
#include <memory>
#include <memory_resource>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::exchange {

struct XmlObject;

// The tag of a parameter whose value made no sense, which was said: it is as if it were not there.
inline constexpr const char* kBrokenTag = "broken";

// The numbers of a parameter: one, or three.
class XmlParamNumbers {
  public:
    void assign(std::size_t count, double value) { count_ = count, values_.fill(value); }
    void set(std::span<const double> values) {
        count_ = std::min(values.size(), values_.size());
        std::copy_n(values.begin(), count_, values_.begin());
    }
    void clear() { count_ = 0; }
    std::size_t size() const { return count_; }
    bool empty() const { return count_ == 0; }
    double operator[](std::size_t i) const { return values_[i]; }
    const double* begin() const { return values_.data(); }
    const double* end() const { return values_.data() + count_; }

  private:
    std::array<double, 3> values_{};
    std::size_t count_ = 0;
};

// One parameter of an object. Only what its tag says is set. Scenes have millions of them, so that what they point to
// belongs to the scene.
struct XmlParam {
    std::string_view tag;  // "float", "rgb", "ref", "bsdf", …
    std::string_view name; // in today's spelling; empty for most nested objects
    std::string_view text; // the attribute `value`, or the file of a spectrum
    Span span;
    mutable bool used = false;            // some converter asked for it
    XmlParamNumbers numbers;              // of float, integer, point, vector, rgb, and spectra that are numbers alone
    const Transform* transform = nullptr; // of `transform`
    const XmlObject* object = nullptr;    // a nested object, or the one that is referred to
};

// <TAG type="PLUGIN" id="ID"> … </TAG>
struct XmlObject {
    explicit XmlObject(std::pmr::memory_resource* memory) : params(memory) {}

    std::string_view tag, plugin, id;
    Span span;
    std::pmr::vector<XmlParam> params; // all there before converters hold pointers
    std::size_t number = 0;            // among the objects of the scene
    bool complete = false;             // all of it was read
    enum class Walk : std::uint8_t { unseen, open, done } walk = Walk::unseen; // of the reader, which looks for cycles

    // The parameter of this name, marked as used, or null.
    const XmlParam* find(std::string_view name) const;
    bool has(std::string_view name) const;
    // Nested objects and references of this tag, marked as used, in the order of the file.
    std::vector<const XmlObject*> objects(std::string_view tag) const;
    // The id, or nothing where the reader made one up.
    std::string_view label() const { return id; }
};

// All of a file with its includes. Objects stay where they are.
struct XmlScene {
    // A text, or a transform, for as long as the scene lives.
    std::string_view keep(std::string_view);
    const Transform* keep(const Transform&);

    // Taken in large blocks and given back as a whole.
    std::unique_ptr<std::pmr::monotonic_buffer_resource> memory =
        std::make_unique<std::pmr::monotonic_buffer_resource>();
    std::vector<std::shared_ptr<const void>> files; // as they were parsed: parameters and objects point into them
    std::pmr::deque<XmlObject> objects{memory.get()};
    const XmlObject* root = nullptr;                // <scene>, or null after an error
    std::vector<std::filesystem::path> searchPaths; // folders of files that are not beside the one that names them
};

struct XmlVersion {
    int major = 3, minor = 0;
};

// "0.5.0"; the other one where the text is none.
XmlVersion xmlVersion(std::string_view text, XmlVersion otherwise);

// A parameter that upgraded skies have: y is up in their own space, not z.
inline constexpr const char* kSkyWithYUp = "y_is_up";

// What was written for older versions means the same in 3 (xml_upgrade.cpp). Before version 2 names were in camel case,
// and textures had uoffset, voffset, uscale and vscale.
void upgradeXmlObject(XmlObject&, XmlVersion, XmlScene&);

} // namespace abbe::exchange
