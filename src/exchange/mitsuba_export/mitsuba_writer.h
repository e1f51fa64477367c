// What the writers of one Mitsuba scene share: the document, names, and how values are written.
#pragma once

#include "exchange/stated/export.h"
#include "exchange/stated/stated_spectra.h"

#include <map>
#include <pugixml.hpp>
#include <set>
#include <string>

namespace abbe::exchange {

// The text of a scene for Mitsuba 3; side files are written. Numbers of light are the same in both, and a pixel of 1 is
// a pixel of 1 (docs/importing.md). Throws IoError.
std::string exportMitsuba(Export&);

struct MitsubaWriter {
    explicit MitsubaWriter(Export& to) : out(to) {}

    Export& out;
    pugi::xml_node root, body; // what is referred to; what is seen
    NameTable ids;             // materials, media, textures, groups: one table there
    std::map<const StatedThing*, std::string> materials, media, textures;
    std::map<const StatedThing*, std::string> oneSided; // versions of materials that are black from behind
    std::map<std::string, std::string> groups;          // of objects
    std::set<std::string> expanded;                     // objects whose instances are written as shapes
    double exposure = 1;                                // factor of all light: cameras there have none
    bool hasMedia = false;                              // some shape has an interior
    bool hidesLights = false;                           // from the camera: all of them or none

    // A free name; Mitsuba's hold no dots.
    std::string takeId(std::string_view wish, std::string_view fallback);
    // The remarks of what was written last, in front of it.
    void remark(pugi::xml_node before);
};

// <tag name= value=>
void xmlValue(pugi::xml_node parent, const char* tag, std::string_view name, std::string_view value);
void xmlNumber(pugi::xml_node parent, std::string_view name, double value);
void xmlFlag(pugi::xml_node parent, std::string_view name, bool value);
// <tag type= name= id=>; an empty name or id is left out.
pugi::xml_node xmlChild(pugi::xml_node parent, const char* tag, std::string_view type, std::string_view name = {},
                        std::string_view id = {});
// `to_world`; nothing for the identity.
void xmlTransform(pugi::xml_node parent, const Transform&, std::string_view name = "to_world");
void xmlSpectrum(pugi::xml_node parent, std::string_view name, const PlainSpectrum&);

// A curve or a texture under a name. Textures have the picture's upper row at v = 0 there: shapes turn over theirs.
void writeMitsubaColor(pugi::xml_node parent, std::string_view name, const StatedSpectrum&, double scale,
                       MitsubaWriter&);
void writeMitsubaNumber(pugi::xml_node parent, std::string_view name, const StatedNumber&, MitsubaWriter&);
void writeMitsubaTexture(pugi::xml_node parent, std::string_view name, const StatedThing& texture, bool data,
                         MitsubaWriter&);

// A shape's material, by reference or in place. `outsideAlone`: nothing sees its other side.
void writeMitsubaMaterial(pugi::xml_node shape, const StatedThing* material, bool outsideAlone, MitsubaWriter&);
void writeMitsubaMedium(pugi::xml_node shape, const StatedThing& medium, MitsubaWriter&);
// Absorption inside of a clear material, as a medium.
void writeMitsubaAbsorption(pugi::xml_node shape, const StatedThing* material, MitsubaWriter&);

void writeMitsubaShape(pugi::xml_node parent, const Placed&, MitsubaWriter&);
void writeMitsubaLight(pugi::xml_node parent, const Placed&, MitsubaWriter&);
void writeMitsubaCamera(const StatedThing& camera, MitsubaWriter&);

} // namespace abbe::exchange
