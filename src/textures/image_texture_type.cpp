#include "textures/image_texture.h"

#include <algorithm>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

using namespace schema;

namespace {

constexpr std::string_view kTilePattern = "<UDIM>";

std::string_view spaceKey(const Text& text) {
    for (const auto& [name, value] : text.keys)
        if (name == "space") return value;
    return {};
}

// As the scene may name them: encodings, the linear spaces of the rest of the language, and what they stand for.
std::vector<std::string_view> spaceNames() {
    std::vector<std::string_view> names = colorEncodingNames();
    for (const std::string_view name : rgbSpaceNames())
        if (std::ranges::find(names, name) == names.end()) names.push_back(name);
    names.push_back("unknown");
    return names;
}

const ColorEncoding* encodingOfTag(std::string_view tag) {
    // What OpenImageIO calls the curve of BT.709; pictures that claim it are viewed as sRGB.
    if (tag == "Rec709") return findColorEncoding("srgb_rec709_scene");
    return findColorEncoding(tag);
}

// By what the scene says, else by the file's tag, else by its type.
ImageEncoding encodingOf(const AbbeImageInfo& info, const Text& asked, Diagnostics& diagnostics) {
    if (const std::string_view space = spaceKey(asked); !space.empty() && space != "unknown")
        return {findColorEncoding(space), true, true};
    const bool integers = info.type == abbeTexel8 || info.type == abbeTexel16;
    const std::string_view tag = info.colorSpace;
    const ColorEncoding* const tagged = tag.empty() ? nullptr : encodingOfTag(tag);
    const ColorEncoding* guessed = findColorEncoding(integers ? "srgb_rec709_scene" : "lin_rec709_scene");
    const float* const c = info.chromaticities;
    if (info.chromatic && (tagged ? tagged->curve == TransferCurve::linear && tagged->space : !integers)) {
        const auto at = [&](int i) { return Chromaticity{static_cast<double>(c[i]), static_cast<double>(c[i + 1])}; };
        if (const ColorEncoding* const exact = findColorEncoding(at(0), at(2), at(4), at(6))) return {exact, true};
        diagnostics
            .warning("W0456", asked.span, "the primaries of the picture belong to no known colour space",
                     fmt::format("taken as {}", guessed->name))
            .help = "`space=` names the colour space";
        return {guessed};
    }
    if (tagged) return {tagged, true};
    if (!tag.empty())
        diagnostics
            .warning("W0456", asked.span, fmt::format("the picture is tagged as `{}`, which is not known", tag),
                     fmt::format("taken as {}", guessed->name))
            .help = "`space=` names the colour space";
    return {guessed};
}

// Every file of the pattern whose number is 1001 … 1999.
std::map<int, std::string> tileFiles(const std::string& pattern) {
    std::map<int, std::string> files;
    const std::size_t at = pattern.find(kTilePattern);
    for (int tile = 1001; tile < 2000; ++tile) {
        std::string path = pattern;
        path.replace(at, kTilePattern.size(), std::to_string(tile));
        std::error_code error;
        if (std::filesystem::exists(path, error)) files.emplace(tile, std::move(path));
    }
    return files;
}

Wrap wrapOf(const Choice& choice) {
    return choice.word == "clamp"    ? Wrap::clamp
           : choice.word == "mirror" ? Wrap::mirror
           : choice.word == "black"  ? Wrap::black
                                     : Wrap::periodic;
}

} // namespace

TypeInfo imageTextureType() {
    using P = ImageTextureParams;
    std::vector<FieldInfo> fields = {
        field<P, Text>(FieldType::file, "file", &P::file)
            .argument(0)
            .required()
            .tiles()
            .synonyms({"filename", "path", "map"})
            .key({"space", spaceNames(),
                  "How the values are stored: a colour space, or `data` for heights, directions, a roughness and the "
                  "like. When absent the file's tag, else `srgb_rec709_scene` for integers, `lin_rec709_scene` for "
                  "floats."})
            .doc("Image in any usual format; `<UDIM>` in its name stands for the tile numbers from 1001.")
            .example("file \"bark.exr\" space=lin_rec709_scene"),
        field<P, Choice>(FieldType::choice, "wrap", &P::wrap)
            .choices({"periodic", "clamp", "mirror", "black"})
            .byDefault("periodic")
            .synonyms({"repeat", "extend", "wrap-mode"})
            .doc("What lies outside the unit square of texture coordinates; tiles of `<UDIM>` never wrap.")
            .example("wrap mirror"),
    };
    return {Kind::texture,
            "image",
            "Image over the texture coordinates, filtered.",
            "texture bark image \"bark.exr\" space=data",
            false,
            std::move(fields)};
}

std::unique_ptr<Texture> makeImageTexture(const ImageTextureParams& p, std::shared_ptr<TextureStore> store,
                                          Diagnostics& diagnostics) {
    const bool tiled = p.file.value.find(kTilePattern) != std::string::npos;
    std::map<int, std::string> files;
    if (tiled)
        files = tileFiles(p.file.value);
    else
        files.emplace(1001, p.file.value);
    std::map<int, ImageTile> tiles;
    for (auto& [number, path] : files) {
        try {
            ImageTile& tile = tiles[number];
            tile.info = describeImageFile(path);
            tile.path = std::move(path);
        } catch (const ImageFileError& e) {
            const std::string name = std::filesystem::path(path).filename().string();
            diagnostics.error("E0402", p.file.span, fmt::format("`{}`: {}", name, e.what()), "cannot be read");
            return nullptr;
        }
    }
    if (tiles.empty()) return nullptr; // reported with the name
    const ImageEncoding encoding = encodingOf(tiles.begin()->second.info, p.file, diagnostics);
    for (const auto& [number, tile] : tiles) {
        Diagnostics repeated; // of the first tile
        const ImageEncoding other = encodingOf(tile.info, p.file, repeated);
        if (other.encoding == encoding.encoding) continue;
        diagnostics
            .error("E0452", p.file.span,
                   fmt::format("tile {} is stored as `{}`, tile {} as `{}`", tiles.begin()->first,
                               encoding.encoding->name, number, other.encoding->name),
                   "tiles differ in their colour space")
            .help = "`space=` says how all of them are to be read";
        return nullptr;
    }
    return std::make_unique<ImageTexture>(std::move(tiles), tiled, wrapOf(p.wrap), encoding, p.file, std::move(store));
}

} // namespace abbe
