// What the writers of one pbrt scene share: the text, names, and how values are written.
#pragma once

#include "exchange/stated/export.h"
#include "exchange/stated/stated_spectra.h"

#include <map>
#include <string>
#include <vector>

namespace abbe::exchange {

// The text of a scene for pbrt-v4; side files are written. pbrt's world is left-handed: all numbers of places have x
// turned over (docs/importing_pbrt.md). Throws IoError.
std::string exportPbrt(Export&);

// Nine digits, more than pbrt's floats have; what is nothing beside `largest` is 0.
std::string pbrtNumber(double value, double largest = 0);

// The parameters of a directive, in order: ` "float radius" [ 0.5 ]`.
class PbrtList {
  public:
    PbrtList& number(std::string_view name, double value) { return add("float", name, pbrtNumber(value)); }
    PbrtList& integer(std::string_view name, double value) { return add("integer", name, pbrtNumber(value)); }
    PbrtList& flag(std::string_view name, bool value) { return add("bool", name, value ? "true" : "false"); }
    PbrtList& text(std::string_view type, std::string_view name, std::string_view value);
    PbrtList& point(std::string_view name, Vec3d);
    // Of a type as pbrt calls it, with the values as they stand between brackets.
    PbrtList& add(std::string_view type, std::string_view name, std::string_view values);
    PbrtList& spectrum(std::string_view name, const PlainSpectrum&);
    const std::string& str() const { return text_; }

  private:
    std::string text_;
};

struct PbrtWriter {
    explicit PbrtWriter(Export& to) : out(to) {}

    Export& out;
    std::string settings, definitions, world;
    NameTable names, textureNames; // see take()
    std::map<const StatedThing*, std::string> materials, media;
    std::map<std::pair<const StatedThing*, bool>, std::string> textures; // true: of spectra
    std::map<std::string, std::string> objects;
    std::string outside; // the medium around the camera

    // A free name, without what a text of pbrt's cannot hold.
    static std::string take(NameTable&, std::string_view wish, std::string_view fallback);
    // `# …` for what was written last.
    std::string remarks(std::string_view indent = {});
};

// Where something is in pbrt's world; `Transform [ … ]`, or nothing for the identity.
std::string pbrtPlace(const Transform& toWorld);
Transform pbrtMirrored(const Transform& toWorld);
Vec3d pbrtMirrored(Vec3d);

// A light's spectrum with its luminance as the factor that pbrt takes it for.
void pbrtWriteLight(PbrtList&, std::string_view name, const StatedLight&);

// `"spectrum reflectance" …`, or the name of a texture that is defined before.
void pbrtWriteColor(PbrtList&, std::string_view name, const StatedSpectrum&, PbrtWriter&);
void pbrtWriteAmount(PbrtList&, std::string_view name, const StatedNumber&, PbrtWriter&);
// The name of a texture, which is defined if it is not yet; empty where pbrt has none like it.
std::string pbrtTextureName(const StatedThing&, bool spectrum, PbrtWriter&);

// The name of a material, defined in front of all that is seen.
std::string pbrtMaterialName(const StatedThing&, PbrtWriter&);
// A shape's material, by its name or in place.
std::string pbrtMaterialLine(const StatedThing&, PbrtWriter&);
// The name of a medium; empty where pbrt has none like it.
std::string pbrtMediumName(const StatedThing&, PbrtWriter&);
// Of what a clear material absorbs; empty where it is nothing.
std::string pbrtAbsorptionName(const StatedThing& material, PbrtWriter&);

void pbrtWritePlaced(const Placed&, PbrtWriter&);
void pbrtWriteLightSource(const Placed&, PbrtWriter&);
void pbrtWriteView(PbrtWriter&);

} // namespace abbe::exchange
