// What happens to an image texture between reading its headers and rendering.
#include "base/memory_limit.h"
#include "textures/image_texture.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <new>

namespace abbe {

namespace {

std::string fileName(const std::string& path) { return std::filesystem::path(path).filename().string(); }

// Runs `body`, which may throw; false after its error.
template <typename F> bool reported(const std::string& path, Span span, Diagnostics& diagnostics, const F& body) {
    const std::string name = fileName(path);
    try {
        body();
        return true;
    } catch (const NotFiniteError& e) {
        diagnostics.error("E0451", span, fmt::format("{} values of `{}` are infinite or not a number", e.count, name),
                          "cannot be a texture");
    } catch (const ImageFileError& e) {
        diagnostics.error("E0402", span, fmt::format("`{}`: {}", name, e.what()), "cannot be read");
    } catch (const std::bad_alloc& e) {
        diagnostics.error("E0404", span, fmt::format("`{}` does not fit into memory", name), memoryReason(e));
    }
    return false;
}

ImagePixels readFinite(const std::string& path) {
    ImagePixels image = readImageFile(path);
    std::uint64_t bad = 0;
    for (const float x : image.values) bad += !std::isfinite(x);
    if (bad > 0) throw NotFiniteError(bad);
    return image;
}

std::string percent(std::uint64_t part, std::uint64_t whole) {
    return fmt::format("{:.2g} %", 100.0 * static_cast<double>(part) / static_cast<double>(whole));
}

} // namespace

bool ImageTexture::prepare(TextureUse use, Span user, Diagnostics& diagnostics) {
    warnOfUse(use, user, diagnostics);
    return use == TextureUse::heights ? prepareHeights(diagnostics) : prepareShading(use, diagnostics);
}

void ImageTexture::warnOfUse(TextureUse use, Span user, Diagnostics& diagnostics) {
    const bool wantsColor = use == TextureUse::reflectance || use == TextureUse::light;
    const bool heights = use == TextureUse::heights;
    const ColorEncoding& encoding = *encoding_.encoding;
    const bool isColor = encoding.space != nullptr;
    // Linear values mean the same either way; unless someone said that they are a colour.
    const bool plain = encoding.curve == TransferCurve::linear && !encoding_.inScene;
    if (isColor == wantsColor || warned_ || (isColor && (plain || (heights && !encoding_.said)))) return;
    warned_ = true;
    Diagnostic* d = nullptr;
    const std::string name = fileName(asked_.value);
    if (wantsColor) {
        d = &diagnostics.warning("W0451", asked_.span, fmt::format("`{}` is `space=data`, and used as a colour", name),
                                 "its numbers are taken as linear Rec. 709");
        d->help = "write `space=` with the colour space that it was painted in, for example `space=srgb_rec709_scene`";
    } else {
        d = &diagnostics.warning(
            "W0450", asked_.span,
            fmt::format("`{}` is {} `{}`, a colour", name, encoding_.said ? "tagged as" : "taken for", encoding.name),
            heights                                   ? "its stored values are used as they are"
            : encoding.curve == TransferCurve::linear ? "its values are used as they are"
                                                      : "its values are decoded to linear ones");
        d->help = "write `space=data` behind the name if its values are heights, directions, a roughness or the like";
    }
    if (user.valid()) d->related.push_back({user, wantsColor ? "a colour is wanted here" : "numbers are wanted here"});
}

bool ImageTexture::prepareHeights(Diagnostics& diagnostics) {
    if (heights_) return true;
    std::map<int, ImagePixels> pixels;
    for (const auto& [number, tile] : tiles_)
        if (!reported(tile.path, asked_.span, diagnostics, [&] { pixels.emplace(number, readFinite(tile.path)); }))
            return false;
    if (tiled_)
        heights_.emplace(std::move(pixels));
    else
        heights_.emplace(std::move(pixels.begin()->second), wrap_);
    return true;
}

bool ImageTexture::prepareShading(TextureUse use, Diagnostics& diagnostics) {
    if (!store_->settings().open) return true;
    const bool colorful = channels_ == 3;
    const bool colors = use == TextureUse::reflectance || use == TextureUse::light;
    if (colors && colorful && !upsampling_) upsampling_ = &store_->upsampling(rgbSpace() ? *rgbSpace() : rgb::rec709);
    for (auto& [number, tile] : tiles_)
        if (!tile.handle &&
            !reported(tile.path, asked_.span, diagnostics, [&, &t = tile] { openTile(t, diagnostics); }))
            return false;
    if (use == TextureUse::reflectance) warnOfReflectances(diagnostics);
    return true;
}

void ImageTexture::openTile(ImageTile& tile, Diagnostics& diagnostics) {
    const bool compare = rgbSpace() && channels_ == 3;
    TextureFile file = textureFile(tile.path, tile.info, *encoding_.encoding, store_->settings().directory,
                                   compare ? &store_->upsampling(*rgbSpace()) : nullptr);
    tile.handle = store_->open(file.path);
    tile.opened = std::move(file.path);
    tile.stored = file.stored;
    counts_ += file.counts;
    const std::string name = fileName(tile.path);
    if (!file.problem.empty())
        diagnostics
            .warning("W0452", asked_.span, fmt::format("`{}` cannot be kept as a texture: {}", name, file.problem),
                     "is used as it is")
            .help = "it takes more memory and time, and colours are decoded after filtering; XDG_CACHE_HOME names "
                    "another folder";
    if (file.counts.negative > 0)
        diagnostics.warning("W0453", asked_.span,
                            fmt::format("{} of {} texels of `{}` have a negative channel", file.counts.negative,
                                        file.counts.texels, name),
                            "taken as 0");
}

// Of all tiles together, once.
void ImageTexture::warnOfReflectances(Diagnostics& diagnostics) {
    const std::string name = fileName(asked_.value);
    if (counts_.above > 0)
        diagnostics
            .warning("W0454", asked_.span,
                     fmt::format("{} of {} texels of `{}` are above 1", counts_.above, counts_.texels, name),
                     "no surface reflects more than it gets: taken as 1")
            .help = "is the colour space right?";
    if (counts_.impossible > 0)
        diagnostics
            .warning("W0455", asked_.span,
                     fmt::format("{} of the texels of `{}` are too saturated for a reflectance",
                                 percent(counts_.impossible, counts_.sampled), name),
                     "the nearest colours are taken")
            .help = "a wider colour space than the one that it was painted in has this effect";
    counts_ = {};
}

} // namespace abbe
