#include "exchange/usd_export/usd_look.h"

#include "spectrum/curve.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

constexpr int kTextureLevels = 16; // textures of textures

// What `space=` says, as MaterialX and usd-core name spaces.
std::string_view spaceOf(const schema::Text& file) {
    for (const auto& [key, value] : file.keys)
        if (key == "space") return value == "data" ? "raw" : std::string_view(value);
    return {};
}

} // namespace

UsdLook::UsdLook(std::string name, UsdWriter& writer)
    : w(writer), name_(std::move(name)), surface_("Shader", "surface") {
    surface_.set("uniform token info:id", "\"ND_open_pbr_surface_surfaceshader\"");
}

void UsdLook::constant(std::string_view parameter, double value) {
    surface_.set(fmt::format("float inputs:{}", parameter), usdFloat(value));
    constants_[std::string(parameter)] = {value, value, value};
}

void UsdLook::constant(std::string_view parameter, Vec3d rgb) {
    surface_.set(fmt::format("color3f inputs:{}", parameter), usdFloats(rgb));
    constants_[std::string(parameter)] = rgb;
}

void UsdLook::flag(std::string_view parameter) { surface_.set(fmt::format("bool inputs:{}", parameter), "true"); }

void UsdLook::number(std::string_view parameter, const StatedNumber& stated) {
    if (!stated.texture) return constant(parameter, stated.value);
    if (const std::string source = textureNode(*stated.texture, false); !source.empty())
        connect(parameter, false, source);
    else
        constant(parameter, 0.5);
    images_[std::string(parameter)] = stated.texture;
}

void UsdLook::color(std::string_view parameter, const StatedSpectrum& stated) {
    if (stated.curve) return constant(parameter, rgbOf(*stated.curve, w.out.scene.daylight()));
    if (!stated.texture) return;
    if (const std::string source = textureNode(*stated.texture, true); !source.empty())
        connect(parameter, true, source);
    else
        constant(parameter, Vec3d(0.5, 0.5, 0.5));
    images_[std::string(parameter)] = stated.texture;
}

void UsdLook::index(std::string_view parameter, const StatedThing& m, const char* property, double otherwise) {
    const StatedSpectrum stated = m.spectrum(property);
    const double plain = m.number(property, otherwise);
    constant(parameter, stated.curve ? indexAtD(*stated.curve) : plain);
    if (stated.curve && !stated.curve->isConstant())
        w.out.approximated(m.span, fmt::format("`{}` that disperses", property), "by its value at 589.3 nm");
}

void UsdLook::emissionColor(const StatedSpectrum& tint) {
    if (!tint.curve || tint.curve->stated.form == schema::SpectrumValue::Form::rgb ||
        tint.curve->stated.form == schema::SpectrumValue::Form::flat)
        return color("emission_color", tint);
    const Vec3d rgb = rgbOf(*tint.curve, w.out.scene.daylight());
    const double y = dot(rgb, exactUnits().luminance);
    constant("emission_color", y > 0 ? rgb / y : Vec3d(1, 1, 1));
}

void UsdLook::normal(const StatedThing* texture, double strength) {
    if (!texture) return;
    if (texture->type != "image") {
        w.out.leftOut(texture->span, "a normal map that is no picture", "MaterialX reads pictures of normals here");
        return;
    }
    const std::string source = imageNode(*texture, "vector3", {});
    UsdPrim& map = node("ND_normalmap", "normalmap");
    map.set("vector3f inputs:in.connect", source);
    if (strength != 1) map.set("float inputs:scale", usdFloat(strength));
    map.declare("float3 outputs:out");
    surface_.set("vector3f inputs:geometry_normal.connect", fmt::format("<{}/{}.outputs:out>", path(), map.name()));
}

Vec3d UsdLook::reflected(const std::function<double(double)>& curve) const {
    const SampledCurve sampled(curve);
    schema::SpectrumValue stated;
    stated.form = schema::SpectrumValue::Form::table;
    return rgbOf(StatedCurve(stated, schema::SpectrumRole::albedo, sampled), w.out.scene.daylight());
}

Vec3d UsdLook::metalColor(const StatedThing& m, const char* property) const {
    const auto* const index = m.value<schema::ComplexIndex>(property);
    if (!index) return {0.8, 0.8, 0.8};
    const Vec3d rgb = reflected([&](double nm) { // at normal incidence
        const double n = index->n->at(nm), k = index->k->at(nm);
        return ((n - 1) * (n - 1) + k * k) / ((n + 1) * (n + 1) + k * k);
    });
    // Gold is redder than Rec. 709 can say.
    return {std::min(1.0, rgb.x), std::min(1.0, rgb.y), std::min(1.0, rgb.z)};
}

UsdPrim& UsdLook::node(std::string_view id, const std::string& name) {
    std::string free = name;
    for (int i = 2; std::ranges::find(nodes_, free, &UsdPrim::name) != nodes_.end(); ++i)
        free = fmt::format("{}_{}", name, i);
    UsdPrim& prim = nodes_.emplace_back("Shader", free);
    prim.set("uniform token info:id", fmt::format("\"{}\"", id));
    return prim;
}

void UsdLook::connect(std::string_view parameter, bool isColor, const std::string& source) {
    surface_.set(fmt::format("{} inputs:{}.connect", isColor ? "color3f" : "float", parameter), source);
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
    const std::string_view theirs = type == "color3" ? "color3f" : type == "vector3" ? "float3" : "float";
    image.declare(fmt::format("{} outputs:out", theirs));
    return fmt::format("<{}/{}.outputs:out>", this->path(), image.name());
}

std::string UsdLook::placedNode(const StatedThing& texture, bool isColor, const std::string& coordinates, int depth) {
    const StatedSpectrum inner = texture.spectrum("map");
    if (!inner.texture || !coordinates.empty()) return {};
    const Vec2d scale = texture.pair("scale").value_or(Vec2d(1, 1)), offset = texture.pair("offset").value_or(Vec2d());
    UsdPrim& place = node("ND_place2d_vector2", "place");
    // It divides by the scale and turns the picture, not the coordinates.
    place.set("float2 inputs:scale", fmt::format("({}, {})", usdFloat(1 / scale.x), usdFloat(1 / scale.y)));
    if (const double turn = texture.number("rotate", 0)) place.set("float inputs:rotate", usdFloat(-turn / kDegree));
    if (offset.x != 0 || offset.y != 0)
        place.set("float2 inputs:offset", fmt::format("({}, {})", usdFloat(-offset.x), usdFloat(-offset.y)));
    place.declare("float2 outputs:out");
    const std::string source = fmt::format("<{}/{}.outputs:out>", path(), place.name());
    return textureNode(*inner.texture, isColor, source, depth + 1);
}

std::string UsdLook::productNode(const StatedThing& texture, bool isColor, const std::string& coordinates, int depth) {
    const char* const type = isColor ? "color3f" : "float";
    std::vector<std::pair<std::string, std::string>> inputs;
    for (const char* side : {"first", "second"}) {
        const StatedSpectrum stated = texture.spectrum(side);
        const std::string input = fmt::format("{} inputs:in{}", type, inputs.size() + 1);
        if (stated.texture) {
            const std::string source = textureNode(*stated.texture, isColor, coordinates, depth + 1);
            if (source.empty()) return {};
            inputs.emplace_back(input + ".connect", source);
        } else {
            const Vec3d rgb = stated.curve ? rgbOf(*stated.curve, w.out.scene.daylight()) : Vec3d(1, 1, 1);
            inputs.emplace_back(input, isColor ? usdFloats(rgb) : usdFloat(rgb.y));
        }
    }
    UsdPrim& product = node(isColor ? "ND_multiply_color3" : "ND_multiply_float", "product");
    for (const auto& [declaration, value] : inputs) product.set(declaration, value);
    product.declare(fmt::format("{} outputs:out", type));
    return fmt::format("<{}/{}.outputs:out>", path(), product.name());
}

std::string UsdLook::textureNode(const StatedThing& texture, bool isColor, const std::string& coordinates, int depth) {
    std::string made;
    if (depth < kTextureLevels) {
        if (texture.type == "image" && texture.word("take") != "alpha")
            made = imageNode(texture, isColor ? "color3" : "float", coordinates);
        if (texture.type == "placed") made = placedNode(texture, isColor, coordinates, depth);
        if (texture.type == "product") made = productNode(texture, isColor, coordinates, depth);
        if (texture.type == "attribute" && texture.word("encoding") != "srgb") {
            UsdPrim& value = node(isColor ? "ND_geompropvalue_color3" : "ND_geompropvalue_float", "attribute");
            const std::string name = texture.word("name");
            value.set("string inputs:geomprop", usdText(name == "color" ? "displayColor" : name));
            value.declare(isColor ? "color3f outputs:out" : "float outputs:out");
            made = fmt::format("<{}/{}.outputs:out>", path(), value.name());
        }
    }
    if (made.empty())
        w.out.leftOut(texture.span, fmt::format("texture `{}`", texture.type),
                      "it is not written as MaterialX; grey stands for it");
    w.out.leaveOutUnused(texture);
    return made;
}

// What programs without MaterialX show: colours, metal, roughness and opacity; pictures of the base alone.
void UsdLook::writePreview(UsdPrim& material) {
    const auto value = [&](std::string_view name, Vec3d otherwise) {
        const auto found = constants_.find(name);
        return found == constants_.end() ? otherwise : found->second;
    };
    UsdPrim preview("Shader", "preview");
    preview.set("uniform token info:id", "\"UsdPreviewSurface\"");
    const auto image = images_.find("base_color");
    const auto* const file =
        image == images_.end() || image->second->type != "image" ? nullptr : image->second->value<schema::Text>("file");
    if (file) {
        UsdPrim st("Shader", "preview_st"), texture("Shader", "preview_image");
        st.set("uniform token info:id", "\"UsdPrimvarReader_float2\"").set("string inputs:varname", "\"st\"");
        st.declare("float2 outputs:result");
        texture.set("uniform token info:id", "\"UsdUVTexture\"")
            .set("asset inputs:file", usdFile(w.out.files.refer(file->value)));
        texture.set("float2 inputs:st.connect", fmt::format("<{}/preview_st.outputs:result>", path()));
        texture.set("token inputs:wrapS", "\"repeat\"")
            .set("token inputs:wrapT", "\"repeat\"")
            .declare("float3 outputs:rgb");
        preview.set("color3f inputs:diffuseColor.connect", fmt::format("<{}/preview_image.outputs:rgb>", path()));
        material.add(std::move(st)).add(std::move(texture));
    } else {
        preview.set("color3f inputs:diffuseColor", usdFloats(value("base_color", {0.8, 0.8, 0.8})));
    }
    preview.set("float inputs:metallic", usdFloat(value("base_metalness", {}).x));
    preview.set("float inputs:roughness",
                usdFloat(value("specular_weight", {1, 1, 1}).x > 0 ? value("specular_roughness", {0.3, 0, 0}).x : 1));
    preview.set("float inputs:ior", usdFloat(value("specular_ior", {1.5, 0, 0}).x));
    const double clear = value("transmission_weight", {}).x, opacity = value("geometry_opacity", {1, 1, 1}).x;
    preview.set("float inputs:opacity", usdFloat(opacity * (1 - 0.9 * clear)));
    const Vec3d glow = value("emission_color", {1, 1, 1}) * value("emission_luminance", {}).x;
    if (maxComponent(glow) > 0) preview.set("color3f inputs:emissiveColor", usdFloats(glow));
    preview.declare("token outputs:surface");
    material.set("token outputs:surface.connect", fmt::format("<{}/preview.outputs:surface>", path()));
    material.add(std::move(preview));
}

UsdPrim UsdLook::take() {
    UsdPrim material("Material", name_);
    material.set("token outputs:mtlx:surface.connect", fmt::format("<{}/surface.outputs:surface>", path()));
    surface_.declare("token outputs:surface");
    material.add(std::move(surface_));
    for (UsdPrim& one : nodes_) material.add(std::move(one));
    writePreview(material);
    return material;
}

} // namespace abbe::exchange
