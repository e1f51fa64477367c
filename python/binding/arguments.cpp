#include "binding/arguments.h"

#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>
#include <string>
#include <unordered_map>

namespace abbe::python {

namespace nb = nanobind;

namespace {

[[noreturn]] void refuse(const std::string& text) { throw nb::value_error(text.c_str()); }

template <typename T> T castTo(nb::handle value, const char* name, const char* what) {
    T result;
    if (!nb::try_cast<T>(value, result))
        refuse(fmt::format("{}: {} is expected, not {}", name, what, nb::repr(value).c_str()));
    return result;
}

double number(nb::handle value, const char* name, double least, double most) {
    const auto x = castTo<double>(value, name, "a number");
    if (!(x >= least && x <= most)) refuse(fmt::format("{}: {} is not between {} and {}", name, x, least, most));
    return x;
}

std::int64_t whole(nb::handle value, const char* name, std::int64_t least, std::int64_t most) {
    const auto x = castTo<std::int64_t>(value, name, "a whole number");
    if (x < least || x > most) refuse(fmt::format("{}: {} is not between {} and {}", name, x, least, most));
    return x;
}

std::vector<int> wholes(nb::handle value, const char* name, std::size_t count) {
    std::vector<int> list;
    for (const nb::handle one : nb::iter(value)) list.push_back(static_cast<int>(whole(one, name, -1000000, 1000000)));
    if (list.size() != count) refuse(fmt::format("{}: {} whole numbers are expected", name, count));
    return list;
}

std::string text(nb::handle value, const char* name) { return castTo<std::string>(value, name, "a text"); }

constexpr std::int64_t kMost = 4294967295;
constexpr double kMebibyte = 1 << 20;

using Taker = std::function<void(RenderOptions&, nb::handle)>;

void takePart(RenderOptions& o, nb::handle v) {
    const auto part = wholes(v, "part", 2);
    if (part[1] < 1 || part[0] < 1 || part[0] > part[1]) refuse("part: (k, n) with 1 <= k <= n is expected");
    o.part = Vec2i{part[0], part[1]};
}

const std::unordered_map<std::string, Taker>& takers() {
    static const std::unordered_map<std::string, Taker> table = {
        {"output", [](auto& o, nb::handle v) { o.output = text(v, "output"); }},
        {"samples", [](auto& o, nb::handle v) { o.build.samples = whole(v, "samples", 1, kMost); }},
        {"noise", [](auto& o, nb::handle v) { o.build.noise = number(v, "noise", 0, 1); }},
        {"time", [](auto& o, nb::handle v) { o.build.timeLimit = number(v, "time", 0, 1e9); }},
        {"seed", [](auto& o, nb::handle v) { o.build.seed = whole(v, "seed", 0, INT64_MAX); }},
        {"camera", [](auto& o, nb::handle v) { o.build.camera = text(v, "camera"); }},
        {"adaptive", [](auto& o, nb::handle v) { o.build.adaptive = castTo<bool>(v, "adaptive", "True or False"); }},
        {"size",
         [](auto& o, nb::handle v) {
             const auto size = wholes(v, "size", 2);
             if (size[0] < 1 || size[1] < 1) refuse("size: (width, height) of at least a pixel is expected");
             o.build.size = Vec2i{size[0], size[1]};
         }},
        {"crop",
         [](auto& o, nb::handle v) {
             const auto c = wholes(v, "crop", 4);
             if (c[2] <= c[0] || c[3] <= c[1]) refuse("crop: (x0, y0, x1, y1) with x0 < x1 and y0 < y1 is expected");
             o.crop = PixelBounds{c[0], c[1], c[2], c[3]};
         }},
        {"memory", [](auto& o, nb::handle v) { o.memory = number(v, "memory", 16 * kMebibyte, 1e18) / kMebibyte; }},
        {"texture_cache",
         [](auto& o, nb::handle v) {
             o.build.textureCache = number(v, "texture_cache", 16 * kMebibyte, 1e18) / kMebibyte;
         }},
        {"frame",
         [](auto& o, nb::handle v) { o.input.frame = static_cast<int>(whole(v, "frame", -1000000000, 1000000000)); }},
        {"part", takePart},
        {"skip", [](auto& o, nb::handle v) { o.skip = static_cast<std::uint32_t>(whole(v, "skip", 0, kMost)); }},
        {"resume", [](auto& o, nb::handle v) { o.checkpoint.resume = castTo<bool>(v, "resume", "True or False"); }},
        {"checkpoint", [](auto& o, nb::handle v) { o.checkpoint.interval = number(v, "checkpoint", 0, 1e9); }},
        {"checkpoint_off", [](auto& o, nb::handle v) { o.checkpoint.off = nb::cast<bool>(v); }},
        {"checkpoint_keep", [](auto& o, nb::handle v) { o.checkpoint.keep = nb::cast<bool>(v); }},
        {"png", [](auto& o, nb::handle v) { o.png.off = !castTo<bool>(v, "png", "True or False"); }},
        {"parts",
         [](auto& o, nb::handle v) { o.parts = castTo<std::vector<std::string>>(v, "parts", "a list of paths"); }},
        {"so_far", [](auto& o, nb::handle v) { o.soFar = castTo<bool>(v, "so_far", "True or False"); }},
    };
    return table;
}

} // namespace

RenderOptions renderOptions(nb::dict arguments) {
    RenderOptions options;
    options.quiet = true;
    options.preview = false;
    for (const auto [key, value] : arguments) {
        const auto name = nb::cast<std::string>(key);
        const auto taker = takers().find(name);
        if (taker == takers().end()) throw nb::type_error(fmt::format("render() has no argument {}", name).c_str());
        if (!value.is_none()) taker->second(options, value);
    }
    options.inMemory = options.output.empty();
    return options;
}

ViewOptions viewOptions(nb::dict arguments) {
    ViewOptions view;
    for (const auto [key, value] : arguments) {
        const auto name = nb::cast<std::string>(key);
        if (value.is_none()) continue;
        if (name == "display")
            view.display = text(value, "display");
        else if (name == "view")
            view.view = text(value, "view");
        else if (name == "ocio")
            view.config = text(value, "ocio");
        else if (name == "exposure")
            view.exposure = number(value, "exposure", -100, 100);
        else
            throw nb::type_error(fmt::format("save() has no argument {}", name).c_str());
    }
    return view;
}

} // namespace abbe::python
