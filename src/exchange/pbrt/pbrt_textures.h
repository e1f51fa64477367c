// Textures of pbrt scenes: each becomes a texture of the scene language, or a plain value that stands wherever the
// texture is used.
#pragma once

#include "exchange/pbrt/pbrt_spectrum.h"

#include <map>
#include <span>
#include <string>
#include <vector>

namespace abbe::exchange {

// pbrt's `"uv"` mapping: textures see (su u + du, sv v + dv). Here meshes get such coordinates themselves.
struct PbrtUv {
    double su = 1, sv = 1, du = 0, dv = 0;

    bool isIdentity() const { return *this == PbrtUv(); }
    bool operator==(const PbrtUv&) const = default;
};

struct PbrtTexture {
    bool isPlain = false;      // the same value everywhere
    PbrtSpectrum plain;        // that value; flat for a float texture
    std::string word;          // the name of the texture of the scene file otherwise
    double factor = 1;         // of its values, for a float texture: they may be beyond 1, which textures here are not
    std::vector<PbrtUv> uvs{}; // the different mappings of all that it is made of; none: it needs no coordinates
};

class PbrtTextures {
  public:
    explicit PbrtTextures(PbrtShared& shared) : shared_(shared) {}

    // `Texture "name" "float|spectrum" "type" …` in a place where shapes are moved by `place`.
    void define(const std::string& name, bool isSpectrum, const std::string& type, const PbrtParams&,
                const Transform& place);

    // The value of a parameter, a texture or not, as the values of a property; `absent` when it is not given. `uvs`
    // receives the mappings. The numbers of float textures are within 0 and 1.
    void writeSpectrum(SceneNode& property, const PbrtParams&, std::string_view name, const PbrtSpectrum& absent,
                       std::vector<PbrtUv>& uvs);
    void writeNumber(SceneNode& property, const PbrtParams&, std::string_view name, double absent,
                     std::vector<PbrtUv>& uvs);

    // The texture that a parameter names; E0802 and null where it is not defined, null where it names none.
    const PbrtTexture* named(const PbrtParams&, std::string_view param, bool isSpectrum);
    // A float texture as the values of a property, through `stops` where it is no plain number: pairs of a value and
    // what is made of it, in steps of growing values from 0 on.
    void writeMapped(SceneNode& property, const PbrtTexture&, std::span<const Vec2d> stops);
    static void addUvs(std::vector<PbrtUv>& to, const std::vector<PbrtUv>& more);

  private:
    struct Making; // one definition

    PbrtTexture image(const Making&);
    PbrtTexture product(const Making&);
    PbrtTexture mixture(const Making&, bool byDirection);
    PbrtTexture checker(const Making&);
    PbrtTexture pattern(const Making&);
    PbrtTexture bilinear(const Making&);
    PbrtTexture constant(const Making&);
    PbrtTexture dots(const Making&);
    PbrtUv mapping(const Making&);
    // A parameter of a texture, itself perhaps a texture.
    void input(const Making&, SceneNode& node, std::string_view property, std::string_view param, double absent,
               PbrtTexture& of);
    void wrapImage(const Making&, const std::string& image, double scale, bool invert);
    PbrtTexture finish(const Making&, PbrtTexture);

    PbrtShared& shared_;
    std::map<std::string, PbrtTexture, std::less<>> floats_, spectra_;
};

} // namespace abbe::exchange
