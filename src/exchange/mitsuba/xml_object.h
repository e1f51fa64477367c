// What a scene of Mitsuba's is after its text was read: objects (plugins) with parameters, each with its place.
#pragma once

#include "base/source.h"
#include "math/transform.h"

#include <deque>
#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::exchange {

struct XmlObject;

// The tag of a parameter whose value made no sense, which was said: it is as if it were not there.
inline constexpr const char* kBrokenTag = "broken";

// One parameter of an object. Only what its tag says is set.
struct XmlParam {
    std::string tag;  // "float", "rgb", "ref", "bsdf", …
    std::string name; // in today's spelling; empty for most nested objects
    std::string text; // the attribute `value`, or the file of a spectrum
    Span span;
    std::vector<double> numbers;       // of float, integer, point, vector, rgb, and spectra that are numbers alone
    Transform transform;               // of `transform`
    const XmlObject* object = nullptr; // a nested object, or the one that is referred to
    mutable bool used = false;         // some converter asked for it
};

// <TAG type="PLUGIN" id="ID"> … </TAG>
struct XmlObject {
    std::string tag, plugin, id;
    Span span;
    std::vector<XmlParam> params; // all there before converters hold pointers
    enum class Walk : std::uint8_t { unseen, open, done } walk = Walk::unseen; // of the reader, which looks for cycles

    // The parameter of this name, marked as used, or null.
    const XmlParam* find(std::string_view name) const;
    bool has(std::string_view name) const;
    // Nested objects and references of this tag, marked as used, in the order of the file.
    std::vector<const XmlObject*> objects(std::string_view tag) const;
    // The id, or nothing where the reader made one up.
    const std::string& label() const { return id; }
};

// All of a file with its includes. Objects stay where they are.
struct XmlScene {
    std::deque<XmlObject> objects;
    const XmlObject* root = nullptr;                // <scene>, or null after an error
    std::vector<std::filesystem::path> searchPaths; // folders of files that are not beside the one that names them
};

struct XmlVersion {
    int major = 3, minor = 0;
};

// "0.5.0"; the other one where the text is none.
XmlVersion xmlVersion(std::string_view text, XmlVersion otherwise);

// What was written for older versions means the same in 3 (xml_upgrade.cpp). Before version 2 names were in camel case,
// and textures had uoffset, voffset, uscale and vscale.
void upgradeXmlObject(XmlObject&, XmlVersion);

} // namespace abbe::exchange
