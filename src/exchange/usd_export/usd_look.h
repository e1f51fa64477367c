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

    // The colour of a reflectance, and of what a metal reflects straight back.
    Vec3d reflected(const std::function<double(double nm)>&) const;
    Vec3d metalColor(const StatedThing&, const char* property) const;

    std::string path() const { return "/Looks/" + name_; }
    UsdPrim take();

    UsdWriter& w;

  private:
    // The path of an output of the node of a texture; empty where there is none like it.
    std::string textureNode(const StatedThing&, bool isColor, const std::string& coordinates = {}, int depth = 0);
    std::string imageNode(const StatedThing&, std::string_view type, const std::string& coordinates);
    std::string placedNode(const StatedThing&, bool isColor, const std::string& coordinates, int depth);
    std::string productNode(const StatedThing&, bool isColor, const std::string& coordinates, int depth);
    UsdPrim& node(std::string_view id, const std::string& name);
    void connect(std::string_view parameter, bool isColor, const std::string& source);
    void writePreview(UsdPrim& material);

    std::string name_;
    UsdPrim surface_;
    std::vector<UsdPrim> nodes_;
    std::map<std::string, Vec3d, std::less<>> constants_;           // of parameters, for the preview
    std::map<std::string, const StatedThing*, std::less<>> images_; // likewise
};

} // namespace abbe::exchange
