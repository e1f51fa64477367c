#include "exchange/gltf/gltf_textures.h"

#include "base/file.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

std::uint32_t gltfBigEndian(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 0; i < 4; ++i) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
}

// Whether a PNG has alpha: by its type of colour, or by a chunk tRNS before its pixels [ISO 15948, 11.2.2].
bool pngHasAlpha(std::string_view png) {
    constexpr std::size_t kColorType = 25, kFirstChunk = 8;
    if (png.size() <= kColorType) return false;
    if (png[kColorType] == 4 || png[kColorType] == 6) return true;
    for (std::size_t at = kFirstChunk; at + 8 <= png.size(); at += 12 + std::size_t{gltfBigEndian(png, at)}) {
        const std::string_view type = png.substr(at + 4, 4);
        if (type == "tRNS") return true;
        if (type == "IDAT") return false;
    }
    return false;
}

// JPEG has none; of WebP the extended header says it, and the lossless one.
bool pictureHasAlpha(std::string_view head) {
    if (head.starts_with("\x89PNG\r\n\x1a\n")) return pngHasAlpha(head);
    if (!head.starts_with("RIFF") || head.size() < 25 || head.substr(8, 4) != "WEBP") return false;
    const std::string_view chunk = head.substr(12, 4);
    return (chunk == "VP8X" && (head[20] & 0x10) != 0) || (chunk == "VP8L" && (head[24] & 0x10) != 0);
}

std::string gltfHeadOf(const std::filesystem::path& path) {
    constexpr std::size_t kMost = 1 << 20; // what stands before the pixels of a PNG: profiles, comments
    RegularFile file(path.string());
    std::string head(file.good() ? std::min<std::uint64_t>(kMost, file.size()) : 0, '\0');
    head.resize(file.good() ? file.readAt(0, head) : 0);
    return head;
}

} // namespace

void writeGltfProduct(SceneNode& at, const std::vector<GltfFactor>& factors) {
    if (factors.empty()) {
        at.number(1);
        return;
    }
    SceneNode* rest = &at;
    for (std::size_t i = 0; i + 1 < factors.size(); ++i) {
        rest->word("product");
        factors[i](rest->child("first"));
        rest = &rest->child("second");
    }
    factors.back()(*rest);
}

void writeGltfColor(SceneNode& at, Vec3d c) {
    if (c.x == c.y && c.y == c.z)
        at.number(c.x);
    else
        at.word("rgb").vector(c);
}

GltfTextureUse GltfTextures::use(int index, int texCoord, const tinygltf::ExtensionMap& extensions, std::string where,
                                 Span span) {
    GltfTextureUse use;
    use.where = std::move(where);
    use.span = span;
    if (index < 0) return use;
    const auto& textures = ctx_.model().textures;
    if (static_cast<std::size_t>(index) >= textures.size()) {
        ctx_.import.diagnostics.error(
            "E0802", span, fmt::format("{} is texture {}, but the file has {}", use.where, index, textures.size()));
        return use;
    }
    use.set = texCoord;
    placing(use, extensions);
    if (use.set < 0 || use.set > 1) {
        ctx_.import.leftOut(nullptr, span, use.where,
                            fmt::format("it uses TEXCOORD_{}; only 0 and 1 are read", use.set));
        return use;
    }
    const int image = imageOf(textures[static_cast<std::size_t>(index)], index);
    if (image >= 0 && !this->image(image, span).path.empty()) use.texture = index;
    return use;
}

void GltfTextures::placing(GltfTextureUse& use, const tinygltf::ExtensionMap& extensions) {
    const GltfObject transform(extensions, "KHR_texture_transform", use.where, use.span, ctx_.import);
    if (!transform) return;
    const auto pair = [&](const char* name, double& u, double& v) {
        const tinygltf::Value* const value = transform.find(name);
        if (!value) return;
        const auto isGood = [&](int i) {
            constexpr double kLargest = 1e9;
            return value->Get(i).IsNumber() && std::abs(value->Get(i).GetNumberAsDouble()) <= kLargest;
        };
        const bool good = value->IsArray() && value->ArrayLen() == 2 && isGood(0) && isGood(1);
        if (!good)
            return void(ctx_.import.diagnostics.error(
                "E0802", use.span, fmt::format("`{}` in {} is not two numbers up to 1e9", name, transform.where())));
        u = value->Get(0).GetNumberAsDouble();
        v = value->Get(1).GetNumberAsDouble();
    };
    pair("offset", use.offsetU, use.offsetV);
    pair("scale", use.scaleU, use.scaleV);
    use.rotation = transform.number("rotation", 0);
    use.set = static_cast<int>(std::clamp(transform.number("texCoord", use.set), -1.0, 1e6));
    transform.warnOfUnused();
}

// The one that can be read: an extension stands for another image of the same picture.
int GltfTextures::imageOf(const tinygltf::Texture& texture, int index) const {
    const auto& images = ctx_.model().images;
    const Span span = ctx_.places.of("textures", index);
    const auto exists = [&](int i) { return i >= 0 && static_cast<std::size_t>(i) < images.size(); };
    if (exists(texture.source)) return texture.source;
    for (const char* extension : {"EXT_texture_webp", "EXT_texture_avif", "KHR_texture_basisu", "MSFT_texture_dds"}) {
        const auto found = texture.extensions.find(extension);
        if (found == texture.extensions.end() || !found->second.Has("source")) continue;
        const tinygltf::Value& source = found->second.Get("source");
        if (exists(gltfIndex(source))) return gltfIndex(source);
    }
    ctx_.import.diagnostics.error("E0802", span,
                                  fmt::format("textures[{}] has no image of the {} in the file", index, images.size()));
    return -1;
}

const GltfTextures::Image& GltfTextures::image(int index, Span user) {
    const auto found = images_.find(index);
    return found != images_.end() ? found->second : images_.emplace(index, readImage(index, user)).first->second;
}

GltfTextures::Image GltfTextures::readImage(int index, Span user) {
    const GltfImage image = gltfImage(ctx_.document, index);
    const std::string name = gltfName("image", "images", index,
                                      image.file.empty() ? ctx_.model().images[static_cast<std::size_t>(index)].name
                                                         : image.file.filename().string());
    constexpr std::array<std::string_view, 3> kUnread = {".ktx2", ".dds", ".avif"};
    if (std::ranges::find(kUnread, image.extension) != kUnread.end()) {
        ctx_.import.leftOut(nullptr, user, name,
                            fmt::format("`{}` is not read; convert the file's images to PNG or JPEG", image.extension));
        return {};
    }
    if (image.bytes.empty()) {
        std::error_code error;
        if (image.file.empty() || !std::filesystem::is_regular_file(image.file, error)) {
            ctx_.import.diagnostics.error("E0401", user, fmt::format("{} is not there", name)).help =
                "images lie beside the glTF file, or in it";
            return {};
        }
        return {ctx_.import.files.refer(image.file), pictureHasAlpha(gltfHeadOf(image.file))};
    }
    const std::string& stem = ctx_.model().images[static_cast<std::size_t>(index)].name;
    const std::string extension = image.extension.empty() ? "png" : image.extension.substr(1);
    return {ctx_.import.files.write(stem.empty() ? fmt::format("image-{}", index) : stem, extension, image.bytes),
            pictureHasAlpha(image.bytes)};
}

std::string GltfTextures::wrap(const GltfTextureUse& use) {
    const int index = ctx_.model().textures[static_cast<std::size_t>(use.texture)].sampler;
    const auto& samplers = ctx_.model().samplers;
    if (index < 0) return {};
    const Span span = ctx_.places.of("samplers", index);
    if (static_cast<std::size_t>(index) >= samplers.size()) {
        ctx_.import.diagnostics.error(
            "E0802", use.span,
            fmt::format("textures[{}].sampler is {}, but the file has {}", use.texture, index, samplers.size()));
        return {};
    }
    const tinygltf::Sampler& sampler = samplers[static_cast<std::size_t>(index)];
    const bool first = filtersSaid_.insert(index).second;
    if (first && sampler.magFilter == TINYGLTF_TEXTURE_FILTER_NEAREST)
        ctx_.import.approximated(nullptr, span, fmt::format("magFilter NEAREST of samplers[{}]", index),
                                 "images are smooth between their pixels");
    if (first && sampler.wrapS != sampler.wrapT)
        ctx_.import.approximated(nullptr, span, fmt::format("samplers[{}]", index),
                                 "images wrap alike in both directions: as wrapS says");
    return sampler.wrapS == TINYGLTF_TEXTURE_WRAP_CLAMP_TO_EDGE     ? "clamp"
           : sampler.wrapS == TINYGLTF_TEXTURE_WRAP_MIRRORED_REPEAT ? "mirror"
                                                                    : "";
}

const std::string& GltfTextures::definition(const GltfTextureUse& use, GltfTexels texels) {
    const tinygltf::Texture& texture = ctx_.model().textures[static_cast<std::size_t>(use.texture)];
    const int index = imageOf(texture, use.texture);
    const std::string wrap = this->wrap(use);
    std::string& name = names_[{index, wrap, texels}];
    if (!name.empty()) return name;
    const std::string& path = image(index, use.span).path;
    const std::string stem = std::filesystem::path(path).stem().string();
    name = ctx_.textureNames.take(texels == GltfTexels::alpha ? stem + "-alpha" : stem, "image");
    SceneNode& node = ctx_.define("texture");
    node.name(name).word("image").text(path);
    if (texels == GltfTexels::color) node.key("space", "srgb_rec709_scene");
    if (texels == GltfTexels::data) node.key("space", "data");
    if (texels == GltfTexels::alpha) node.child("take").word("alpha");
    if (!wrap.empty()) node.child("wrap").word(wrap);
    return name;
}

// With v upwards on both sides of the transform: u' = su cos u - sv sin v + ou + sv sin, and
// v' = su sin u + sv cos v + 1 - ov - sv cos.
void GltfTextures::write(SceneNode& at, const GltfTextureUse& use, GltfTexels texels) {
    const std::string& name = definition(use, texels);
    const double c = std::cos(use.rotation), s = std::sin(use.rotation);
    const double u = use.offsetU + use.scaleV * s, v = 1 - use.offsetV - use.scaleV * c;
    const bool turned = use.rotation != 0, scaled = use.scaleU != 1 || use.scaleV != 1;
    if (!turned && !scaled && u == 0 && v == 0) {
        at.name(name);
        return;
    }
    at.word("placed").child("map").name(name);
    if (scaled) at.child("scale").number(use.scaleU).number(use.scaleV);
    if (turned) at.child("rotate").number(use.rotation / kDegree).word("deg");
    if (u != 0 || v != 0) at.child("offset").number(u).number(v);
}

void GltfTextures::writeChannel(SceneNode& at, const GltfTextureUse& use, std::string_view channel) {
    at.word("channel");
    write(at.child("of"), use, GltfTexels::data);
    at.child("take").word(channel);
}

bool GltfTextures::hasAlpha(const GltfTextureUse& use) {
    const int index = imageOf(ctx_.model().textures[static_cast<std::size_t>(use.texture)], use.texture);
    return image(index, use.span).alpha;
}

} // namespace abbe::exchange
