#include "textures/image_texture.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>

namespace abbe {

using namespace schema;

namespace {

constexpr std::string_view kTilePattern = "<UDIM>";

bool keyGiven(const Text& text, std::string_view key) {
    for (const auto& [name, value] : text.keys)
        if (name == key) return true;
    return false;
}

// Light is stored in these with a curve, or relative to primaries: not what a height or a direction is.
bool isColor(const std::string& space) {
    return !space.empty() && space != "Linear" && space != "linear" && space != "lin_srgb" && space != "scene_linear" &&
           space != "data" && space != "raw" && space != "Raw" && space != "Utility - Raw";
}

std::optional<ImagePixels> load(const std::string& path, const Text& asked, Diagnostics& diagnostics) {
    const std::string name = std::filesystem::path(path).filename().string();
    try {
        ImagePixels image = readImageFile(path);
        std::size_t bad = 0;
        for (const float x : image.values) bad += !std::isfinite(x);
        if (bad > 0) {
            diagnostics.error("E0451", asked.span,
                              fmt::format("{} values of `{}` are infinite or not a number", bad, name),
                              "cannot be a texture");
            return std::nullopt;
        }
        if (isColor(image.colorSpace) && !keyGiven(asked, "space"))
            diagnostics
                .warning("W0450", asked.span, fmt::format("`{}` is tagged as `{}`, a colour", name, image.colorSpace),
                         "its stored values are used as they are")
                .help = "write `space=data` behind the name if they are heights or directions";
        return image;
    } catch (const ImageFileError& e) {
        diagnostics.error("E0402", asked.span, fmt::format("`{}`: {}", name, e.what()), "cannot be read");
    } catch (const std::bad_alloc&) {
        diagnostics.error("E0404", asked.span, fmt::format("`{}` does not fit into memory", name));
    }
    return std::nullopt;
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
            .key({"space", {"data"}, "What the values are: `data` for heights, directions and the like."})
            .doc("Image in any usual format; `<UDIM>` in its name stands for the tile numbers from 1001.")
            .example("file \"bark.exr\" space=data"),
        field<P, Choice>(FieldType::choice, "wrap", &P::wrap)
            .choices({"periodic", "clamp", "mirror", "black"})
            .byDefault("periodic")
            .synonyms({"repeat", "extend", "wrap-mode"})
            .doc("What lies outside the unit square of texture coordinates; tiles of `<UDIM>` never wrap.")
            .example("wrap mirror"),
    };
    return {Kind::texture,
            "image",
            "Image over the texture coordinates, smoothly interpolated.",
            "texture bark image \"bark.exr\" space=data",
            false,
            std::move(fields)};
}

std::unique_ptr<Texture> makeImageTexture(const ImageTextureParams& p, Diagnostics& diagnostics) {
    if (p.file.value.find(kTilePattern) == std::string::npos) {
        auto image = load(p.file.value, p.file, diagnostics);
        return image ? std::make_unique<ImageTexture>(std::move(*image), wrapOf(p.wrap)) : nullptr;
    }
    std::map<int, ImagePixels> tiles;
    for (const auto& [number, path] : tileFiles(p.file.value)) {
        auto image = load(path, p.file, diagnostics);
        if (!image) return nullptr;
        tiles.emplace(number, std::move(*image));
    }
    return tiles.empty() ? nullptr : std::make_unique<ImageTexture>(std::move(tiles));
}

} // namespace abbe
