#include "exchange/usd_export/usd_look.h"

#include "spectrum/curve.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

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
    if (const std::string source = textureNode(*stated.texture, {false}); !source.empty())
        connect(parameter, false, source);
    else
        constant(parameter, 0.5);
    images_[std::string(parameter)] = stated.texture;
}

void UsdLook::color(std::string_view parameter, const StatedSpectrum& stated) {
    if (stated.curve) return constant(parameter, rgbOf(*stated.curve, w.out.scene.daylight()));
    if (!stated.texture) return;
    if (const std::string source = textureNode(*stated.texture, {true}); !source.empty())
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

// Heights are the shape's there as here, and a map of directions is along dPdu, dPdv and the normal.
void UsdLook::displacement(const StatedThing& shape) {
    const double length = shape.number("displacement", 0);
    const StatedThing* const map = shape.reference("displacement.map");
    const bool vector = shape.word("displacement.kind") == "vector";
    const double middle = shape.number("displacement.midpoint", vector ? 0 : 0.5);
    if (!map || length == 0) return;
    if (vector && (shape.word("displacement.space") == "object" || map->type != "image" || middle != 0)) {
        w.out.leftOut(shape.span, "`displacement` by vectors in the space of the object, or of no plain picture",
                      "MaterialX moves along the tangents");
        return;
    }
    std::string source;
    if (vector) {
        w.out.approximated(shape.span, "`displacement` by vectors",
                           "MaterialX moves along dPdu and dPdv, whatever their length and angle");
        source = imageNode(*map, "vector3", {});
    } else if (source = textureNode(*map, {false}); !source.empty() && middle != 0) {
        source = node("ND_subtract_float", "height",
                      {{"float inputs:in1", source}, {"float inputs:in2", usdFloat(middle)}}, "float");
    }
    if (source.empty()) return; // has been told
    displacement_ = node(vector ? "ND_displacement_vector3" : "ND_displacement_float", "displacement",
                         {{vector ? "vector3f inputs:displacement" : "float inputs:displacement", source},
                          {"float inputs:scale", usdFloat(length)}},
                         "token");
    if (!vector && map->type == "image") heights_ = {map, length, -length * middle};
}

void UsdLook::emission(const StatedThing& texture, double nits, Vec3d rgb) {
    const double most = maxComponent(rgb);
    nits *= most; // colours are at most 1
    rgb = rgb / most;
    std::string source = textureNode(texture, {true});
    if (!source.empty() && length(rgb - Vec3d(1, 1, 1)) > 1e-9)
        source = node("ND_multiply_color3", "tinted",
                      {{"color3f inputs:in1", source}, {"color3f inputs:in2", usdFloats(rgb)}}, "color3f");
    constant("emission_luminance", nits);
    if (source.empty())
        constant("emission_color", rgb);
    else
        connect("emission_color", true, source);
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

std::string UsdLook::node(std::string_view id, const std::string& name, const std::vector<Input>& inputs,
                          std::string_view type) {
    UsdPrim& prim = node(id, name);
    for (const Input& input : inputs)
        prim.set(input.declaration + (input.value.starts_with('<') ? ".connect" : ""), input.value);
    prim.declare(fmt::format("{} outputs:out", type));
    return fmt::format("<{}/{}.outputs:out>", path(), prim.name());
}

std::string UsdLook::outputOf(const std::string& source, std::string_view output) {
    return fmt::format("{}{}>", source.substr(0, source.rfind(':') + 1), output);
}

void UsdLook::connect(std::string_view parameter, bool isColor, const std::string& source) {
    surface_.set(fmt::format("{} inputs:{}.connect", isColor ? "color3f" : "float", parameter), source);
}

void UsdLook::writePreviewHeights(UsdPrim& material, UsdPrim& preview) {
    const auto& height = *heights_.map->value<schema::Text>("file");
    UsdPrim st("Shader", "preview_height_st"), texture("Shader", "preview_height");
    st.set("uniform token info:id", "\"UsdPrimvarReader_float2\"").set("string inputs:varname", "\"st\"");
    st.declare("float2 outputs:result");
    const auto four = [](double v) { return fmt::format("({0}, {0}, {0}, {0})", usdFloat(v)); };
    texture.set("uniform token info:id", "\"UsdUVTexture\"")
        .set("asset inputs:file", usdFile(w.out.files.refer(height.value)))
        .set("token inputs:sourceColorSpace", "\"raw\"")
        .set("float4 inputs:scale", four(heights_.scale))
        .set("float4 inputs:bias", four(heights_.bias));
    texture.set("float2 inputs:st.connect", fmt::format("<{}/preview_height_st.outputs:result>", path()));
    texture.set("token inputs:wrapS", "\"repeat\"").set("token inputs:wrapT", "\"repeat\"");
    texture.declare("float outputs:r");
    preview.set("float inputs:displacement.connect", fmt::format("<{}/preview_height.outputs:r>", path()));
    preview.declare("token outputs:displacement");
    material.set("token outputs:displacement.connect", fmt::format("<{}/preview.outputs:displacement>", path()));
    material.add(std::move(st)).add(std::move(texture));
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
    if (heights_.map) writePreviewHeights(material, preview);
    preview.declare("token outputs:surface");
    material.set("token outputs:surface.connect", fmt::format("<{}/preview.outputs:surface>", path()));
    material.add(std::move(preview));
}

UsdPrim UsdLook::take() {
    UsdPrim material("Material", name_);
    material.set("token outputs:mtlx:surface.connect", fmt::format("<{}/surface.outputs:surface>", path()));
    if (!displacement_.empty()) material.set("token outputs:mtlx:displacement.connect", displacement_);
    surface_.declare("token outputs:surface");
    material.add(std::move(surface_));
    for (UsdPrim& one : nodes_) material.add(std::move(one));
    writePreview(material);
    return material;
}

} // namespace abbe::exchange
