// What the writers of one stage share: its prims, names, and how places and light are written.
#pragma once

#include "exchange/stated/export.h"
#include "exchange/stated/stated_spectra.h"
#include "exchange/usd_export/usd_text.h"

#include <map>
#include <optional>
#include <set>
#include <string>
#include <vector>

namespace abbe::exchange {

// The text of a stage of OpenUSD, which `abbe-usd` reads back (docs/importing_usd.md): a unit is a metre, time codes
// are frames, light is in nits, materials are OpenPBR as MaterialX nodes in UsdShade. Throws IoError.
std::string exportUsd(Export&);

struct UsdWriter {
    explicit UsdWriter(Export& to) : out(to) {}

    Export& out;
    UsdPrim world{"Xform", "World"}, looks{"Scope", "Looks"}, objects{"Scope", "Objects"};
    std::set<std::string> names;                         // of prims, all different
    std::map<const StatedThing*, std::string> materials; // paths
    std::map<std::string, std::string> prototypes;       // paths of objects
    double perSecond = 24;                               // time codes
    double last = 0;                                     // s, of all keys

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

// A shape without light, dressed and placed, into `parent`.
void usdWriteShape(const Placed&, UsdPrim& parent, UsdWriter&);
void usdWriteLight(const Placed&, UsdPrim& parent, UsdWriter&);
void usdWriteVolume(const Placed&, UsdPrim& parent, UsdWriter&);
// Polygons of a shape or light as a Mesh, placed; nothing where it has none.
std::optional<UsdPrim> usdMesh(const Placed&, UsdWriter&);
// `inputs:intensity`, `inputs:color` and a temperature: of a radiance, or of an intensity over what an area shows.
void usdWriteAmount(UsdPrim&, const StatedLight&, double times, UsdWriter&);
bool usdIsAreaLight(const StatedThing&);

// The path of a material; empty where a shape has none.
std::string usdMaterial(const StatedThing*, UsdWriter&);
void usdBind(UsdPrim&, const std::string& material);

// Its path; empty where USD has none like it.
std::string usdWriteCamera(const StatedThing&, UsdPrim& parent, UsdWriter&);
UsdPrim usdSettings(const std::string& camera, UsdWriter&);

} // namespace abbe::exchange
