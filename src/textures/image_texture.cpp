#include "textures/image_texture.h"

#include <cmath>
#include <filesystem>
#include <fmt/format.h>

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

} // namespace abbe
