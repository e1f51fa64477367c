// One material of a stage while it is written: the surface shader, the nodes that feed it, and its preview.
#pragma once

#include "exchange/usd_export/usd_writer.h"

#include <functional>
#include <map>
#include <string>
#include <vector>

namespace abbe::exchange {

class UsdLook {
  public:
    UsdLook(std::string name, UsdWriter&);

    // Parameters by their names in OpenPBR. What has a texture that cannot be written is W0801 and grey.
    void constant(std::string_view parameter, double);
    void constant(std::string_view parameter, Vec3d rgb);
    void number(std::string_view parameter, const StatedNumber&);
    void color(std::string_view parameter, const StatedSpectrum&); // nothing for nothing
    void flag(std::string_view parameter);
    void index(std::string_view parameter, const StatedThing&, const char* property, double otherwise = 1.5);
    // `emission-color` has the luminance of a factor where it is a colour, of 1 where it is a spectrum of light.
    void emissionColor(const StatedSpectrum&);
    void normal(const StatedThing* texture, double strength);
    // The shape's displacement, in its own space.
    void displacement(const StatedThing& shape);
    // What it gives off: nits where a texture is 1, which has the colour besides.
    void emission(const StatedThing& texture, double nits, Vec3d color);

    // The colour of a reflectance, and of what a metal reflects straight back.
    Vec3d reflected(const std::function<double(double nm)>&) const;
    Vec3d metalColor(const StatedThing&, const char* property) const;

    std::string path() const { return "/Looks/" + name_; }
    UsdPrim take();

    UsdWriter& w;

  private:
    // An input of a node: `float inputs:in1`, and a value or the path of an output, `<…>`.
    struct Input {
        std::string declaration, value;
    };
    // A node, and the path of its one output.
    std::string node(std::string_view id, const std::string& name, const std::vector<Input>&, std::string_view type);
    UsdPrim& node(std::string_view id, const std::string& name);
    // The same of another output.
    static std::string outputOf(const std::string& source, std::string_view output);

    // Textures: usd_textures.cpp. Each returns the path of an output of a node, of numbers or colours as it is asked;
    // empty where there is none like it. `coordinates` are an output, too; empty for those of the shape.
    struct Asked {
        bool isColor;
        std::string coordinates = {};
        int depth = 0;

        std::string_view type() const { return isColor ? "color3f" : "float"; }
        std::string_view ending() const { return isColor ? "color3" : "float"; }
        Asked inside() const { return {isColor, coordinates, depth + 1}; }
    };
    std::string textureNode(const StatedThing&, const Asked&);
    std::string imageNode(const StatedThing&, std::string_view type, const std::string& coordinates);
    std::string channelNode(const StatedThing&, const Asked&);
    std::string placedNode(const StatedThing&, const Asked&);
    std::string productNode(const StatedThing&, const Asked&);
    std::string attributeNode(const StatedThing&, const Asked&);
    std::string checkerNode(const StatedThing&, const Asked&);
    std::string noiseNode(const StatedThing&, const Asked&);
    std::string rampNode(const StatedThing&, const Asked&);
    std::string rampInput(const StatedThing&, const Asked&);
    // Of a number in all channels.
    std::string spread(const std::string& number, const Asked&);
    // A value, or the path of the output that has it; empty where there is none.
    std::string valueOf(const StatedSpectrum&, double otherwise, const Asked&);
    std::string constantOf(Vec3d, const Asked&) const;

    void connect(std::string_view parameter, bool isColor, const std::string& source);
    void writePreview(UsdPrim& material);
    void writePreviewHeights(UsdPrim& material, UsdPrim& preview);

    std::string name_;
    UsdPrim surface_;
    std::string displacement_; // path of an output
    struct {
        const StatedThing* map = nullptr;
        double scale = 0, bias = 0;
    } heights_; // of a picture, for the preview
    std::vector<UsdPrim> nodes_;
    std::map<std::string, Vec3d, std::less<>> constants_;           // of parameters, for the preview
    std::map<std::string, const StatedThing*, std::less<>> images_; // likewise
};

// Into a material: a surface alone, or one with the medium that fills its shape; null: the grey of shapes without one.
void usdWriteSurface(UsdLook&, const StatedThing& material);
void usdFill(UsdLook&, const StatedThing* material, const StatedThing& medium);
// Whether a medium is one that materials of USD can hold.
bool usdCanFill(const StatedThing& medium);

} // namespace abbe::exchange
