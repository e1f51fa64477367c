// Every example of the reference renders: that of each type, and of each of its properties, in a scene of its own.
#include "scene/registry.h"
#include "schema/describe.h"
#include "snippet_scene.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <set>
#include <sstream>

namespace abbe::test {
namespace {

using schema::FieldInfo;
using schema::Kind;
using schema::TypeInfo;

// With what must be given besides: one property of each group.
std::string exampleBody(const TypeInfo& type, const FieldInfo& shown) {
    std::string body(shown.example);
    std::set<std::string_view> stated = {shown.group};
    for (const FieldInfo& field : type.fields)
        if (field.required && field.name != shown.name && (field.group.empty() || stated.insert(field.group).second))
            body += "; " + std::string(field.example);
    return body;
}

// Where it is seen: a definition that nothing uses would not be rendered.
std::string shownBy(const TypeInfo& type, const std::string& body) {
    const std::string inner = fmt::format("{} {{ {} }}", type.name, body);
    switch (type.kind) {
    case Kind::material:
        return fmt::format("shape sphere {{ material {} }}", inner);
    case Kind::texture:
        return fmt::format("shape sphere {{ material diffuse {{ reflectance {} }} }}", inner);
    case Kind::medium:
        return fmt::format("shape sphere {{ material boundary; interior {} }}", inner);
    case Kind::phase:
        return fmt::format(
            "shape sphere {{ material boundary; interior homogeneous {{ scattering 1 per-m; phase {} }} }}", inner);
    case Kind::instances:
        return fmt::format("object pebble {{ shape sphere {{ radius 2 cm }} }}\ninstances pebble {{ {} }}", body);
    default:
        return fmt::format("{} {}", keyword(type.kind), type.isDefault ? fmt::format("{{ {} }}", body) : inner);
    }
}

std::string wholeExample(const TypeInfo& type, const std::string& shown) {
    std::string text = "scene 1\n" + shown + "\n";
    if (type.kind != Kind::camera) text += "camera { from 0 0.5 5; look-at 0 0 0 }\n";
    if (type.kind != Kind::film) text += "film { size 4 4 }\n";
    return text + "light sky { radiance 1 }\nshape ground quad { points -3 -2 3  3 -2 3  3 -2 -3  -3 -2 -3 }\n";
}

// The example of the type with the property in it: what the type must have is there.
std::string overridden(const TypeInfo& type, const std::string& property) {
    std::istringstream words{std::string(type.example)};
    std::string kind, name;
    words >> kind >> name;
    if (name == "{" || type.isDefault) name.clear();
    return fmt::format("{}\noverride {} {} {{ {} }}", type.example, kind, name, property);
}

// Bodies in which properties mean something that need more than one other beside them.
struct Company {
    std::string_view kind, type, property, body;
};
constexpr std::string_view kFourPoints = "points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 1 0 }; faces { - 0 1 2 3 }";
const Company kCompany[] = {
    {"shape", "mesh", "uvs", "points { - 0 0 0; - 1 0 0; - 0 1 0 }; faces { - 0 1 2 }"},
    {"shape", "mesh", "attribute", kFourPoints},
    {"shape", "mesh", "materials", "file \"model.glb\""},
    {"light", "mesh", "texture", "file \"lamp.obj\"; luminance 5000 nits"},
    {"shape", "subdivision", "attribute", kFourPoints},
    {"shape", "subdivision", "uvs", kFourPoints},
    {"shape", "subdivision", "uv-faces",
     "points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 1 0 }; faces { - 0 1 2 3 }; uvs { - 0 0; - 1 0; - 1 1; - 0 1 }"},
    {"shape", "subdivision", "scheme", "points { - 0 0 0; - 1 0 0; - 1 1 0 }; faces { - 0 1 2 }"},
    {"shape", "subdivision", "at", "faces { - 0 1 2 }; at 0 s { points { - 0 0 0; - 1 0 0; - 1 1 0 } }"},
    {"shape", "curves", "at", "radius 0.1; basis linear; at 0 s { points { - 0 0 0; - 1 0 0; - 1 1 0 } }"},
    {"shape", "curves", "counts",
     "radius 0.1; points 0 0 0  0 1 0  0 2 1  0 2 2  1 0 0  1 1 0  1 2 1  1 2 2  2 0 0  2 1 0  2 2 1  2 2 2  2 3 2  2 "
     "4 2"},
    {"shape", "curves", "interior", "radius 0.1; points { - 0 0 0; - 0 1 0; - 0 2 1; - 0 2 2 }"},
    {"shape", "points", "normals", "radius 0.1; form disk; points { - 0 0 0; - 0 1 0 }"},
    {"volume", "vdb", "temperature", "file \"cloud.vdb\"; emissivity 2 per-m"},
    {"volume", "vdb", "emissivity", "file \"cloud.vdb\"; temperature temperature scale=1500"},
    {"volume", "vdb", "flame", "file \"cloud.vdb\"; emissivity 2 per-m; temperature temperature scale=1500"},
    {"camera", "perspective", "iso", "shutter 0.02 s; f-stop 2.8"},
    {"camera", "gltf", "iso", "file \"shot.glb\"; name \"Camera.001\"; shutter 0.02 s; f-stop 2.8"},
};

// A few ways to show a property, of which one has to render. What goes together is tried together.
std::vector<std::string> waysToShow(const TypeInfo& type, const FieldInfo& field) {
    const std::string body = exampleBody(type, field), example(field.example);
    std::vector<std::string> ways{shownBy(type, body)};
    for (const Company& c : kCompany)
        if (c.kind == keyword(type.kind) && c.type == type.name && c.property == field.name)
            return {shownBy(type, fmt::format("{}; {}", c.body, example))};
    if (type.kind == Kind::instances)
        for (const std::string_view place : {"grid 3 1 3; spacing 0.1 0.1 0.1", "scatter 20; over ground"})
            ways.push_back(shownBy(type, fmt::format("{}; {}", place, body)));
    else if (type.kind != Kind::film && type.kind != Kind::render)
        ways.push_back(overridden(type, example));
    for (const FieldInfo& other : type.fields)
        if (!other.example.empty() && &other != &field && (field.group.empty() || other.group != field.group))
            ways.push_back(shownBy(type, fmt::format("{}; {}", body, other.example)));
    return ways;
}

// Properties that every type of a kind has, though they mean nothing to some; and examples that name what is in a file.
constexpr std::string_view kMeaningless[] = {"E0721", "E0623", "E0645", "E0606", "E0643", "E0734", "E0455"};

} // namespace

TEST_SUITE_BEGIN("sweep");

TEST_CASE("the example of every type and of every property renders a picture of 4 by 4 pixels") {
    StandIns standIns;
    const schema::TypeTable table = makeTypeTable();
    std::size_t rendered = 0, all = 0;
    const auto tryOne = [&](const TypeInfo& type, std::string_view what, const std::vector<std::string>& ways) {
        ++all;
        SnippetVerdict first;
        for (const std::string& way : ways) {
            const SnippetFolder folder;
            const SnippetVerdict verdict = checkSnippet(wholeExample(type, way), folder.path, standIns);
            if (verdict.rendered) return void(++rendered);
            if (first.codes.empty()) first = verdict;
        }
        const bool meaningless = std::ranges::any_of(
            kMeaningless, [&](std::string_view code) { return first.codes.find(code) != std::string::npos; });
        CHECK_MESSAGE(meaningless, keyword(type.kind) << " " << type.name << ": " << what << "\n"
                                                      << ways[0] << "\n"
                                                      << first.report);
    };
    for (const TypeInfo& type : table.all()) {
        if (!type.example.empty()) tryOne(type, "its example", {std::string(type.example)});
        for (const FieldInfo& field : type.fields) tryOne(type, field.name, waysToShow(type, field));
    }
    MESSAGE(rendered, " of ", all, " examples rendered");
    CHECK(all > 600);
    CHECK(rendered + 40 > all);
}

TEST_SUITE_END();

} // namespace abbe::test
