// Textures as nodes of MaterialX [MaterialX2023].
#include "exchange/usd_export/usd_look.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace abbe::exchange {

namespace {

constexpr int kTextureLevels = 16;    // textures of textures
constexpr std::size_t kMostStops = 8; // of a ramp: each is a mixture of the one before, and readers limit their depth
constexpr double kStepWidth = 1e-6;   // of a ramp that jumps

// What `space=` says, as MaterialX and usd-core name spaces.
std::string_view spaceOf(const schema::Text& file) {
    for (const auto& [key, value] : file.keys)
        if (key == "space") return value == "data" ? "raw" : std::string_view(value);
    return {};
}

} // namespace

std::string UsdLook::constantOf(Vec3d rgb, const Asked& asked) const {
    return asked.isColor ? usdFloats(rgb) : usdFloat(rgb.y);
}

std::string UsdLook::valueOf(const StatedSpectrum& stated, double otherwise, const Asked& asked) {
    if (stated.texture) return textureNode(*stated.texture, asked);
    return constantOf(
        stated.curve ? rgbOf(*stated.curve, w.out.scene.daylight()) : Vec3d(otherwise, otherwise, otherwise), asked);
}

std::string UsdLook::spread(const std::string& number, const Asked& asked) {
    return asked.isColor && !number.empty()
               ? node("ND_convert_float_color3", "grey", {{"float inputs:in", number}}, "color3f")
               : number;
}

std::string UsdLook::imageNode(const StatedThing& texture, std::string_view type, const std::string& coordinates) {
    const auto* const file = texture.value<schema::Text>("file");
    if (!file) return {};
    UsdPrim& image = node(fmt::format("ND_image_{}", type), "image");
    const std::string_view space = spaceOf(*file);
    texture.has("space");
    const std::string path = usdFile(w.out.files.refer(file->value));
    if (space.empty())
        image.set("asset inputs:file", path);
    else
        image.set("asset inputs:file", path, fmt::format("colorSpace = \"{}\"", space));
    const std::string wrap = texture.word("wrap");
    if (wrap == "clamp" || wrap == "mirror" || wrap == "black")
        for (const char axis : {'u', 'v'})
            image.set(fmt::format("string inputs:{}addressmode", axis),
                      fmt::format("\"{}\"", wrap == "black" ? "constant" : wrap));
    if (!coordinates.empty()) image.set("float2 inputs:texcoord.connect", coordinates);
    const std::string_view theirs = type == "color4"    ? "color4f"
                                    : type == "color3"  ? "color3f"
                                    : type == "vector3" ? "float3"
                                                        : "float";
    image.declare(fmt::format("{} outputs:out", theirs));
    return fmt::format("<{}/{}.outputs:out>", this->path(), image.name());
}

std::string UsdLook::channelNode(const StatedThing& texture, const Asked& asked) {
    if (texture.type == "image") // alpha
        return spread(
            node("ND_extract_color4", "alpha",
                 {{"color4f inputs:in", imageNode(texture, "color4", asked.coordinates)}, {"int inputs:index", "3"}},
                 "float"),
            asked);
    const StatedThing* const of = texture.textured("of", 0).texture;
    if (!of) return {};
    Asked colors = asked.inside();
    colors.isColor = true;
    const std::string source = textureNode(*of, colors), take = texture.word("take");
    if (source.empty()) return {};
    const char* const index = take == "green" ? "1" : take == "blue" ? "2" : "0";
    return spread(
        node("ND_extract_color3", "channel", {{"color3f inputs:in", source}, {"int inputs:index", index}}, "float"),
        asked);
}

// It divides by the scale and turns the picture, not the coordinates.
std::string UsdLook::placedNode(const StatedThing& texture, const Asked& asked) {
    const StatedSpectrum inner = texture.spectrum("map");
    if (!inner.texture) return {};
    const Vec2d scale = texture.pair("scale").value_or(Vec2d(1, 1)), offset = texture.pair("offset").value_or(Vec2d());
    std::vector<Input> inputs = {
        {"float2 inputs:scale", fmt::format("({}, {})", usdFloat(1 / scale.x), usdFloat(1 / scale.y))}};
    if (const double turn = texture.number("rotate", 0))
        inputs.push_back({"float inputs:rotate", usdFloat(-turn / kDegree)});
    if (offset.x != 0 || offset.y != 0)
        inputs.push_back({"float2 inputs:offset", fmt::format("({}, {})", usdFloat(-offset.x), usdFloat(-offset.y))});
    if (!asked.coordinates.empty()) inputs.push_back({"float2 inputs:texcoord", asked.coordinates});
    Asked placed = asked.inside();
    placed.coordinates = node("ND_place2d_vector2", "place", inputs, "float2");
    return textureNode(*inner.texture, placed);
}

std::string UsdLook::productNode(const StatedThing& texture, const Asked& asked) {
    std::vector<Input> inputs;
    for (const char* side : {"first", "second"}) {
        const std::string value = valueOf(texture.spectrum(side), 1, asked.inside());
        if (value.empty()) return {};
        inputs.push_back({fmt::format("{} inputs:in{}", asked.type(), inputs.size() + 1), value});
    }
    return node(fmt::format("ND_multiply_{}", asked.ending()), "product", inputs, asked.type());
}

std::string UsdLook::attributeNode(const StatedThing& texture, const Asked& asked) {
    if (texture.word("encoding") == "srgb") return {};
    const std::string name = texture.word("name");
    return node(fmt::format("ND_geompropvalue_{}", asked.ending()), "attribute",
                {{"string inputs:geomprop", usdText(name == "color" ? "displayColor" : name)}}, asked.type());
}

// Squares over the texture coordinates, of which `color2` has the one at the origin; or the parity of cubes in the
// space of the shape.
std::string UsdLook::checkerNode(const StatedThing& texture, const Asked& asked) {
    const std::string even = valueOf(texture.spectrum("even"), 0.8, asked.inside()),
                      odd = valueOf(texture.spectrum("odd"), 0.2, asked.inside());
    if (even.empty() || odd.empty()) return {};
    const auto* const scale = texture.quantity("scale");
    std::string mask;
    if (scale && scale->dimension == schema::Dimension::length) {
        const std::string position =
            node("ND_position_vector3", "position", {{"string inputs:space", "\"object\""}}, "float3");
        const std::string cells =
            node("ND_multiply_vector3FA", "cells",
                 {{"vector3f inputs:in1", position}, {"float inputs:in2", usdFloat(1 / scale->value)}}, "float3");
        const std::string whole = node("ND_floor_vector3", "whole", {{"vector3f inputs:in", cells}}, "float3");
        const std::string sum = node("ND_dotproduct_vector3", "sum",
                                     {{"vector3f inputs:in1", whole}, {"vector3f inputs:in2", "(1, 1, 1)"}}, "float");
        mask = node("ND_modulo_float", "parity", {{"float inputs:in1", sum}, {"float inputs:in2", "2"}}, "float");
    } else {
        const std::string count = usdFloat(scale ? scale->value : 8);
        std::vector<Input> inputs = {{"color3f inputs:color1", asked.isColor ? odd : "(1, 1, 1)"},
                                     {"color3f inputs:color2", asked.isColor ? even : "(0, 0, 0)"},
                                     {"float2 inputs:uvtiling", fmt::format("({0}, {0})", count)}};
        if (!asked.coordinates.empty()) inputs.push_back({"float2 inputs:texcoord", asked.coordinates});
        const std::string squares = node("ND_checkerboard_color3", "checker", inputs, "color3f");
        if (asked.isColor) return squares;
        mask =
            node("ND_extract_color3", "parity", {{"color3f inputs:in", squares}, {"int inputs:index", "0"}}, "float");
    }
    return node(fmt::format("ND_mix_{}", asked.ending()), "checks",
                {{fmt::format("{} inputs:bg", asked.type()), even},
                 {fmt::format("{} inputs:fg", asked.type()), odd},
                 {"float inputs:mix", mask}},
                asked.type());
}

// Both are sums of gradient noise of the same size, over octaves that are as much finer and weaker, about the same mean
// and as strong: ours is scaled so that unit gradients reach 1, by 2/√3 [Perlin2002]; theirs, whose gradients are √2
// long, by 0.982 [MaterialX2023, mx_noise]. Where the bumps are is up to the lattice, which is another one.
std::string UsdLook::noiseNode(const StatedThing& texture, const Asked& asked) {
    const double gain = texture.number("gain", 0.5), octaves = texture.number("octaves", 4);
    double total = 0;
    for (double k = 0, weight = 1; k < octaves; ++k, weight *= gain) total += weight;
    const double strength = 2 / std::numbers::sqrt3 / (0.982 * std::numbers::sqrt2);
    const std::string position =
        node("ND_position_vector3", "position", {{"string inputs:space", "\"object\""}}, "float3");
    const std::string cells =
        node("ND_multiply_vector3FA", "cells",
             {{"vector3f inputs:in1", position}, {"float inputs:in2", usdFloat(1 / texture.number("scale", 0.1))}},
             "float3");
    const std::string noise = node("ND_fractal3d_float", "noise",
                                   {{"float inputs:amplitude", usdFloat(0.5 * strength / total)},
                                    {"int inputs:octaves", fmt::format("{}", static_cast<int>(octaves))},
                                    {"float inputs:lacunarity", usdFloat(texture.number("lacunarity", 2))},
                                    {"float inputs:diminish", usdFloat(gain)},
                                    {"vector3f inputs:position", cells}},
                                   "float");
    w.out.approximated(texture.span, "`noise`",
                       texture.number("seed", 0) == 0 ? "another noise of this size and strength"
                                                      : "another noise of this size and strength, without a seed");
    return spread(node("ND_add_float", "lifted", {{"float inputs:in1", noise}, {"float inputs:in2", "0.5"}}, "float"),
                  asked);
}

// The number that a ramp follows.
std::string UsdLook::rampInput(const StatedThing& texture, const Asked& asked) {
    Asked number = asked.inside();
    number.isColor = false;
    if (const StatedNumber input = texture.textured("input", 0); input.texture)
        return textureNode(*input.texture, number);
    else if (texture.has("input"))
        return usdFloat(input.value);
    const std::string over = texture.word("over");
    if (over == "x" || over == "y" || over == "z") {
        const std::string position =
            node("ND_position_vector3", "position", {{"string inputs:space", "\"object\""}}, "float3");
        const char* const index = over == "x" ? "0" : over == "y" ? "1" : "2";
        return node("ND_extract_vector3", "along", {{"vector3f inputs:in", position}, {"int inputs:index", index}},
                    "float");
    }
    const std::string coordinates =
        asked.coordinates.empty() ? node("ND_texcoord_vector2", "texcoord", {}, "float2") : asked.coordinates;
    return node("ND_extract_vector2", "along",
                {{"float2 inputs:in", coordinates}, {"int inputs:index", over == "v" ? "1" : "0"}}, "float");
}

// Two stops at the ends are a node of their own; else each stop is mixed over those before, exact in between.
std::string UsdLook::rampNode(const StatedThing& texture, const Asked& asked) {
    const auto stops = texture.stops("stop");
    if (stops.empty() || stops.size() > kMostStops) return {};
    const std::string type(asked.type()), over = texture.word("over");
    std::string value = valueOf(stops[0].second, 0.5, asked.inside());
    if (value.empty()) return {};
    const bool whole = stops.size() == 2 && stops[0].first == 0 && stops[1].first == 1;
    if (whole && !texture.has("input") && over != "x" && over != "y" && over != "z") {
        const std::string last = valueOf(stops[1].second, 0.5, asked.inside());
        if (last.empty()) return {};
        const bool up = over == "v";
        std::vector<Input> inputs = {{type + (up ? " inputs:valueb" : " inputs:valuel"), value},
                                     {type + (up ? " inputs:valuet" : " inputs:valuer"), last}};
        if (!asked.coordinates.empty()) inputs.push_back({"float2 inputs:texcoord", asked.coordinates});
        return node(fmt::format("ND_{}_{}", up ? "ramptb" : "ramplr", asked.ending()), "ramp", inputs, type);
    }
    const std::string along = rampInput(texture, asked);
    if (along.empty()) return {};
    for (std::size_t i = 0; i + 1 < stops.size(); ++i) {
        const double from = stops[i].first, to = std::max(stops[i + 1].first, from + kStepWidth);
        const std::string next = valueOf(stops[i + 1].second, 0.5, asked.inside());
        if (next.empty()) return {};
        const std::string line = node(
            "ND_remap_float", "line",
            {{"float inputs:in", along}, {"float inputs:inlow", usdFloat(from)}, {"float inputs:inhigh", usdFloat(to)}},
            "float");
        const std::string share = node("ND_clamp_float", "share", {{"float inputs:in", line}}, "float");
        value = node(fmt::format("ND_mix_{}", asked.ending()), "ramp",
                     {{type + " inputs:bg", value}, {type + " inputs:fg", next}, {"float inputs:mix", share}}, type);
    }
    // One stop is a constant, which nodes that feed others cannot be.
    return value.starts_with('<') ? value
                                  : node(fmt::format("ND_constant_{}", asked.ending()), "constant",
                                         {{type + " inputs:value", value}}, type);
}

std::string UsdLook::textureNode(const StatedThing& texture, const Asked& asked) {
    std::string made;
    const std::string& type = texture.type;
    if (asked.depth >= kTextureLevels)
        made.clear();
    else if (type == "image" && texture.word("take") != "alpha")
        made = imageNode(texture, asked.ending(), asked.coordinates);
    else if (type == "image" || type == "channel")
        made = channelNode(texture, asked);
    else if (type == "placed")
        made = placedNode(texture, asked);
    else if (type == "product")
        made = productNode(texture, asked);
    else if (type == "attribute")
        made = attributeNode(texture, asked);
    else if (type == "checker")
        made = checkerNode(texture, asked);
    else if (type == "noise")
        made = noiseNode(texture, asked);
    else if (type == "ramp")
        made = rampNode(texture, asked);
    if (made.empty()) {
        w.out.leftOut(texture.span, fmt::format("texture `{}`", type),
                      "it is not written as MaterialX; grey stands for it");
        for (const auto& unused : texture.takeUnused()) texture.has(unused.property); // all of it is
    }
    w.out.leaveOutUnused(texture);
    return made;
}

} // namespace abbe::exchange
