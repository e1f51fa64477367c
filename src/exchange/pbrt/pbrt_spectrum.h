// The spectra of pbrt scenes: colours, tables, names and temperatures, as the scene language writes them.
#pragma once

#include "exchange/pbrt/pbrt_params.h"
#include "exchange/pbrt/pbrt_shared.h"
#include "spectrum/curve.h"

#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace abbe::exchange {

// Pairs of wavelength and value as `table` and its rows, with as many digits as pbrt's own numbers have.
void pbrtWriteTable(SceneNode& node, const std::vector<double>& pairs, double scale);

// What a spectrum stands for: pbrt makes different curves of one colour [Pharr2023, sec. 4.6.6].
enum class PbrtUse : unsigned char { albedo, unbounded, light, index };

struct PbrtSpectrum {
    enum class Kind : unsigned char { flat, rgb, table, blackbody, illuminant, glass, metalEta, metalK };
    Kind kind = Kind::flat;
    double value = 0;          // of flat; kelvin of a black body
    Vec3d rgb{};               // of rgb
    std::string space;         // of rgb, as the language names it; empty for Rec. 709
    std::vector<double> pairs; // of table: nanometres and values
    std::string name;          // of illuminants, glasses and metals

    static PbrtSpectrum flat(double value);
    static PbrtSpectrum colour(Vec3d rgb) {
        PbrtSpectrum s;
        s.kind = Kind::rgb;
        s.rgb = rgb;
        return s;
    }
    // Writes it as the values of `node`, times `scale`. Kinds that have a scale of their own become tables then.
    void write(SceneNode& node, PbrtUse, double scale = 1) const;
    // As a curve over wavelength; of light one that is 0 where pbrt's is.
    std::unique_ptr<Curve> curve(PbrtUse) const;
    // ∫ s ȳ / ∫ ȳ; of a colour its relative luminance.
    double luminance() const;
    bool isBlack() const;
};

// The language's word for one of pbrt's colour spaces, "srgb" and others; empty where there is none of the name.
std::string pbrtSpaceWord(std::string_view name);

// A parameter of type rgb, spectrum, blackbody or float. What is wrong with it is reported; then nothing.
std::optional<PbrtSpectrum> pbrtSpectrum(const PbrtParam&, PbrtUse, PbrtShared&);
// A named spectrum of pbrt's own ("metal-Cu-eta", "glass-BK7", "stdillum-D65"), if the name is one of those.
std::optional<PbrtSpectrum> pbrtNamedSpectrum(std::string_view name);

// Light of a spectrum whose Y is to be `scale`, whatever the spectrum's own: pbrt divides by it, but for colours, of
// which it takes the illuminant's [Pharr2023, sec. 12.1]. Of a colour Y becomes scale times its luminance.
struct PbrtLight {
    PbrtSpectrum spectrum;
    double scale = 1;

    // Pixel values: 1 is what shows as 1.
    double luminance() const;
    // An absolute radiance for `emission` and `radiance`.
    void writeRadiance(SceneNode&) const;
    // The shape of the spectrum as a child `color`; none for the default of both programs, D65.
    void writeColor(SceneNode& light) const;
};
// `name` of a light, the illuminant of its colour space when absent.
PbrtLight pbrtLight(const PbrtParams&, std::string_view name, const std::string& colorSpace, PbrtShared&);

} // namespace abbe::exchange
