// What the writers of one stage share: its prims, names, and how places and light are written.
#pragma once

#include "exchange/stated/export.h"
#include "exchange/stated/stated_spectra.h"
#include "exchange/usd_export/usd_text.h"

#include <compare>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace abbe::exchange {

// The text of a stage of OpenUSD, which `abbe-usd` reads back (docs/importing_usd.md): a unit is a metre, time codes
// are frames, light is in nits, materials are OpenPBR as MaterialX nodes in UsdShade. Throws IoError.
std::string exportUsd(Export&);

// What a material of a stage is made for: there, unlike here, displacement and what fills a shape are part of it.
struct UsdDress {
    const StatedThing* material = nullptr;  // null: the grey of shapes without one
    const StatedThing* displaced = nullptr; // the shape whose `displacement` it is
    const StatedThing* interior = nullptr;  // a medium

    auto operator<=>(const UsdDress&) const = default;
};

struct UsdWriter {
    explicit UsdWriter(Export& to) : out(to) {}

    Export& out;
    UsdPrim world{"Xform", "World"}, looks{"Scope", "Looks"}, objects{"Scope", "Objects"};
    std::set<std::string> names;                   // of prims, all different
    std::map<UsdDress, std::string> materials;     // paths
    std::map<std::string, std::string> prototypes; // paths of objects
    double perSecond = 24;                         // time codes
    double last = 0;                               // s, of all keys

    // A name that prims may have and none has yet.
    std::string take(std::string_view wish, std::string_view fallback);
    double code(double seconds) const { return rounded(seconds * perSecond); }
    // For what was written last.
    UsdPrim& withRemarks(UsdPrim& prim) { return prim.remark(out.takeRemarks()); }
};

// `xformOp:transform`, with samples where it moves. `before` is applied first.
void usdPlace(UsdPrim&, const Placed&, const Transform& before, UsdWriter&);
// The times of samples between which a motion is nearly linear, in s.
std::vector<double> usdTimes(const Motion&, const std::vector<double>& keys, UsdWriter&);
// A transform that stands still; nothing for the identity.
void usdPlace(UsdPrim&, const Transform&);

// Whatever it is, into `parent`.
void usdWritePlaced(const Placed&, UsdPrim& parent, UsdWriter&);
// One instance of an object; many of one, where its places are known.
void usdWriteInstance(const Placed&, UsdPrim& parent, UsdWriter&);
void usdWriteInstances(const Placed&, UsdPrim& parent, UsdWriter&);
// The path of what stands in `parent`, which is the world or an object.
std::string usdPathIn(const UsdPrim& parent, const UsdPrim& child);

// Mean cosine of a medium's phase function; one that has others is W0802.
double usdAnisotropy(const StatedThing& medium, UsdWriter&);

// A shape without light, dressed and placed, into `parent`.
void usdWriteShape(const Placed&, UsdPrim& parent, UsdWriter&);
void usdWriteLight(const Placed&, UsdPrim& parent, UsdWriter&);
void usdWriteVolume(const Placed&, UsdPrim& parent, UsdWriter&);
// Polygons of a shape or light as a Mesh, placed; nothing where it has none.
std::optional<UsdPrim> usdMesh(const Placed&, UsdWriter&);
// Whether polygons of a shape or light have what a texture is looked up by.
bool usdShowsTexture(const StatedThing& shape, const StatedThing& texture, const StatedScene&);
// What an even spectrum looks like, luminance 1: that of a texture of radiance where it is white, which is W0802.
// Linear Rec. 709.
Vec3d usdFlatWhite(const StatedThing& texture, UsdWriter&);
// `inputs:intensity`, `inputs:color` and a temperature: of a radiance, or of an intensity over what an area shows.
void usdWriteAmount(UsdPrim&, const StatedLight&, double times, UsdWriter&);
bool usdIsAreaLight(const StatedThing&);

// The path of a material; empty for nothing.
std::string usdMaterial(const UsdDress&, UsdWriter&);
void usdBind(UsdPrim&, const std::string& material);
// Of a surface that shows a texture as light: nits where it is 1, times a colour. Black, or matte as the shape is.
struct UsdGlowing {
    const StatedThing* texture = nullptr;
    double nits = 0;
    Vec3d color;
    const StatedThing* shape = nullptr;
};
std::string usdGlow(const UsdGlowing&, UsdWriter&);

// Its path; empty where USD has none like it.
std::string usdWriteCamera(const StatedThing&, UsdPrim& parent, UsdWriter&);
UsdPrim usdSettings(const std::string& camera, UsdWriter&);

} // namespace abbe::exchange
