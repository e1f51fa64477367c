#include "textures/image_texture.h"

#include "base/memory_limit.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fmt/format.h>
#include <new>

namespace abbe {

namespace {

constexpr double kFarthest = 1e12; // texture coordinates beyond have no fraction of a texel left
constexpr float kHuge = 1e18f;     // its square is finite

int tileNumber(double u, double v) { return 1001 + static_cast<int>(u) + 10 * static_cast<int>(v); }

// Brings a coordinate near the unit square, where floats are fine, without changing what is seen there.
double reduced(double x, Wrap wrap) {
    switch (wrap) {
    case Wrap::periodic:
        return x - std::floor(x);
    case Wrap::mirror:
        return x - 2 * std::floor(x / 2);
    case Wrap::clamp:
    case Wrap::black:
        return std::clamp(x, -4.0, 5.0); // farther than any footprint reaches back
    }
    return x;
}

// Half axes of the footprint become whole widths; those that are wider than the picture see all of it anyway.
Vec2 width(Vec2 halfAxis) {
    const auto tame = [](float x) { return std::isnan(x) ? 0 : std::min(std::max(x, -kHuge), kHuge); };
    const Vec2 d{tame(halfAxis.x), tame(halfAxis.y)};
    const float length = std::sqrt(d.x * d.x + d.y * d.y);
    return d * (length > 1 ? 2 / length : 2);
}

AbbeWrap moduleWrap(Wrap wrap) {
    switch (wrap) {
    case Wrap::periodic:
        return abbeWrapPeriodic;
    case Wrap::clamp:
        return abbeWrapClamp;
    case Wrap::mirror:
        return abbeWrapMirror;
    case Wrap::black:
        return abbeWrapBlack;
    }
    return abbeWrapBlack;
}

bool finite(const float* x, int n) {
    for (int i = 0; i < n; ++i)
        if (!std::isfinite(x[i])) return false;
    return true;
}

} // namespace

ImageTexture::ImageTexture(std::map<int, ImageTile> tiles, bool tiled, Wrap wrap, ImageEncoding encoding,
                           schema::Text asked, std::shared_ptr<TextureStore> store)
    : tiles_(std::move(tiles)), tiled_(tiled), wrap_(tiled ? Wrap::clamp : wrap), encoding_(encoding),
      asked_(std::move(asked)), store_(std::move(store)) {
    for (const auto& [number, tile] : tiles_) channels_ = std::min(channels_, static_cast<int>(tile.info.channels));
}

bool ImageTexture::covers(Vec2 uv) const noexcept {
    if (!tiled_) return true;
    const double u = std::floor(static_cast<double>(uv.x)), v = std::floor(static_cast<double>(uv.y));
    return u >= 0 && u < 10 && v >= 0 && v < 100 && tiles_.contains(tileNumber(u, v));
}

TextureJet ImageTexture::jet(const TexturePoint& point, int channels) const noexcept {
    return heights_ ? heights_->jet(point, channels) : TextureJet{};
}

// The tile of a point, and its coordinates in it. What lies exactly on the upper border of a tile belongs to it if
// there is no other.
const ImageTile* ImageTexture::tileOf(double& u, double& v) const noexcept {
    if (!tiled_) return &tiles_.begin()->second;
    const double column = std::floor(u), row = std::floor(v);
    const int left = column == u ? 1 : 0, below = row == v ? 1 : 0;
    for (int j = 0; j <= below; ++j)
        for (int i = 0; i <= left; ++i) {
            const double x = column - i, y = row - j;
            if (!(x >= 0 && x < 10 && y >= 0 && y < 100)) continue;
            const auto found = tiles_.find(tileNumber(x, y));
            if (found == tiles_.end()) continue;
            u -= x;
            v -= y;
            return &found->second;
        }
    return nullptr;
}

Vec3 ImageTexture::value(const TextureQuery& query) const noexcept {
    double u = static_cast<double>(query.uv.x), v = static_cast<double>(query.uv.y);
    if (!(std::abs(u) < kFarthest && std::abs(v) < kFarthest)) {
        faults_.add(LookupFaults::coordinates);
        u = v = 0;
    }
    const ImageTile* const tile = tileOf(u, v);
    if (!tile || !tile->handle) {
        faults_.add(LookupFaults::missingTile);
        return {};
    }
    const Vec2 du = width(query.du), dv = width(query.dv);
    const AbbeTextureLookup lookup{static_cast<float>(reduced(u, wrap_)),
                                   static_cast<float>(1 - reduced(v, wrap_)),
                                   du.x,
                                   -du.y,
                                   dv.x,
                                   -dv.y,
                                   moduleWrap(wrap_),
                                   tile->opened == tile->path ? tile->info.first : 0, // converted files have no other
                                   channels_};
    float texel[3] = {};
    // After a fault OpenImageIO takes the tile for good the next time it is asked for: nothing of the file is used.
    if (faults_.unreadable() || !store_->lookup(tile->handle, lookup, texel)) {
        faults_.add(LookupFaults::failedRead);
        if (faults_.firstUnreadable()) {
            faults_.say(store_->lookupFault());
            forgetTextureFile(tile->opened, store_->settings().directory);
        }
        return {};
    }
    if (!finite(texel, channels_)) {
        faults_.add(LookupFaults::notFinite);
        return {};
    }
    if (tile->stored)
        for (float& x : texel) x = static_cast<float>(encoding_.encoding->toLinear(static_cast<double>(x)));
    return channels_ == 1 ? Vec3(texel[0], texel[0], texel[0]) : Vec3(texel[0], texel[1], texel[2]);
}

Spectrum ImageTexture::spectrum(const TextureQuery& query, const Wavelengths& lambda) const noexcept {
    const Vec3 rgb = value(query);
    if (channels_ == 1 || !upsampling_) return Spectrum(std::clamp(rgb.x, 0.f, 1.f));
    return upsampling_->lookup(rgb).at(lambda);
}

Spectrum ImageTexture::lightFactor(const TextureQuery& query, const Wavelengths& lambda) const noexcept {
    const Vec3 rgb = value(query);
    if (channels_ == 1 || !upsampling_) return Spectrum(std::max(rgb.x, 0.f));
    return upsampling_->unbounded(rgb, lambda);
}

void ImageTexture::reportLookups(Diagnostics& diagnostics) const {
    const std::string name = std::filesystem::path(asked_.value).filename().string();
    const auto warn = [&](LookupFaults::Kind kind, const char* what, const char* code = "W0457") {
        if (const std::uint64_t n = faults_.count(kind))
            return &diagnostics.warning(code, asked_.span, fmt::format("{} lookups in `{}` {}", n, name, what),
                                        "black there");
        return static_cast<Diagnostic*>(nullptr);
    };
    warn(LookupFaults::coordinates, "had texture coordinates that are infinite or not a number");
    if (Diagnostic* d = warn(LookupFaults::missingTile, "fell into tiles that have no file"))
        d->help = "give every tile that the shape's texture coordinates reach a file";
    if (Diagnostic* d = warn(LookupFaults::failedRead, "failed, because the file could not be read", "W0458"))
        if (const std::string why = faults_.example(); !why.empty()) d->notes.push_back(why);
    warn(LookupFaults::notFinite, "met values that are infinite or not a number");
}

// What happens to an image texture between reading its headers and rendering.

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

ImagePixels readFinite(const ImageTile& tile) {
    ImagePixels image = readImageFile(tile.path, tile.info.first, tile.info.channels);
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
        if (!reported(tile.path, asked_.span, diagnostics, [&] { pixels.emplace(number, readFinite(tile)); }))
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
    TextureFile file =
        store_->file(tile.path, tile.info, *encoding_.encoding, compare ? &store_->upsampling(*rgbSpace()) : nullptr);
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
    if (info.first == info.alpha) return {findColorEncoding("data"), true};
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

// From now on the tiles are their alpha channels; false after an error.
bool takeAlpha(std::map<int, ImageTile>& tiles, const Text& asked, Diagnostics& diagnostics) {
    for (auto& [number, tile] : tiles) {
        if (tile.info.alpha < 0) {
            diagnostics.error("E0455", asked.span, fmt::format("`{}` has no alpha channel", fileName(tile.path))).help =
                "leave `take` out; a mask in a picture of its own needs none";
            return false;
        }
        tile.info.first = tile.info.alpha;
        tile.info.channels = 1;
    }
    return true;
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
        field<P, Choice>(FieldType::choice, "take", &P::take)
            .choices({"color", "alpha"})
            .byDefault("color")
            .synonyms({"channels"})
            .doc("`alpha`: the alpha channel alone, as numbers.")
            .example("take alpha"),
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
    if (p.take.word == "alpha" && !takeAlpha(tiles, p.file, diagnostics)) return nullptr;
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
