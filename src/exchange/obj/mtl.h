// Material libraries of OBJ files (.mtl): what stands in them, and the materials that it becomes (docs/importing.md).
#pragma once

#include "exchange/shared/import.h"
#include "math/vec.h"

#include <filesystem>
#include <map>
#include <string>
#include <string_view>

namespace abbe::exchange {

// A picture with its options.
struct MtlMap {
    std::string file; // as it is written, but with forward slashes
    std::filesystem::path path;
    Span span;
    double scale[2] = {1, 1}, offset[2] = {0, 0}; // of texture coordinates, in this order
    double bump = 1;                              // -bm
    char channel = 0;                             // -imfchan: r, g, b, m, l or z
    bool clamp = false;
};

struct MtlValue {
    Vec3d rgb; // a single number three times
    Span span;

    double number() const { return rgb.x; }
    double largest() const { return std::max({rgb.x, rgb.y, rgb.z}); }
};

// What stands under one `newmtl`, by keywords in lower case; the last statement of a kind counts.
struct MtlMaterial {
    std::string name;
    Span span;
    std::map<std::string, MtlValue, std::less<>> values;
    std::map<std::string, MtlMap, std::less<>> maps;

    double number(std::string_view keyword, double otherwise) const;
    bool has(std::string_view keyword) const { return values.contains(keyword) || maps.contains(keyword); }
    const MtlMap* map(std::string_view keyword) const; // null if there is none
};

using MtlLibrary = std::map<std::string, MtlMaterial, std::less<>>;

// Adds the materials of a file; of two with one name the last counts. Pictures that are not there are left out. `from`:
// what names the file, for one that cannot be read (E0402).
void readMtl(const std::filesystem::path&, Span from, MtlLibrary&, Import&);

// What a material is put on.
struct MtlSurface {
    bool textured = true; // has texture coordinates; without them pictures are left out
    double size = 1;      // m, diagonal of the model, for heights of bumps
};

// Appends type and properties of a material to `at`.
void writeMtlMaterial(SceneNode& at, MtlMaterial, const MtlSurface&, Import&);
// `emission` of a shape with the material, if it has any.
void writeMtlEmission(SceneNode& shape, const MtlMaterial&, const MtlSurface&, Import&);

} // namespace abbe::exchange
