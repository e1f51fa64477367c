// Images of glTF files, as they were encoded.
#include "base/enclosure.h"
#include "io/gltf_scene.h"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>

namespace abbe {

namespace {

// By its first bytes, which no exporter gets wrong, or else by its media type.
std::string imageExtension(std::string_view bytes, std::string_view mediaType) {
    constexpr std::pair<std::string_view, const char*> heads[] = {{"\x89PNG", ".png"},     {"\xff\xd8\xff", ".jpg"},
                                                                  {"\xabKTX 20", ".ktx2"}, {"DDS ", ".dds"},
                                                                  {"GIF8", ".gif"},        {"BM", ".bmp"}};
    for (const auto& [head, extension] : heads)
        if (bytes.starts_with(head)) return extension;
    if (bytes.starts_with("RIFF") && bytes.substr(8).starts_with("WEBP")) return ".webp";
    constexpr std::pair<std::string_view, const char*> types[] = {
        {"image/png", ".png"},        {"image/jpeg", ".jpg"}, {"image/webp", ".webp"}, {"image/ktx2", ".ktx2"},
        {"image/vnd-ms.dds", ".dds"}, {"image/gif", ".gif"},  {"image/bmp", ".bmp"}};
    for (const auto& [type, extension] : types)
        if (mediaType == type) return extension;
    return {};
}

// Those that the library does not know as data: other media types than PNG, JPEG, BMP and GIF.
GltfImage imageOfData(const GltfDocument& document, const std::string& uri, const std::string& who) {
    const std::size_t comma = uri.find(',');
    std::string head = uri.substr(5, comma == std::string::npos ? 0 : comma - 5), ignored;
    std::vector<unsigned char> bytes;
    const bool good =
        head.ends_with(";base64") &&
        tinygltf::DecodeDataURI(&bytes, ignored, "data:application/octet-stream;base64" + uri.substr(comma), 0, false);
    if (!good || bytes.empty()) document.fail(who + ".uri is no data in base64");
    GltfImage image{{}, std::string(bytes.begin(), bytes.end()), {}};
    image.extension = imageExtension(image.bytes, std::string_view(head).substr(0, head.find(';')));
    return image;
}

bool hasScheme(const std::string& uri) {
    const std::size_t colon = uri.find(':');
    return colon != std::string::npos && colon > 1 &&
           std::all_of(uri.begin(), uri.begin() + static_cast<std::ptrdiff_t>(colon),
                       [](unsigned char c) { return std::isalnum(c) || c == '+' || c == '-' || c == '.'; });
}

} // namespace

GltfImage gltfImage(const GltfDocument& document, int index) {
    const auto& images = document.model().images;
    if (static_cast<std::size_t>(index) >= images.size())
        document.fail(fmt::format("image {}, but there are {}", index, images.size()));
    const tinygltf::Image& image = images[static_cast<std::size_t>(index)];
    const std::string who = fmt::format("images[{}]", index);
    if (image.bufferView >= 0) {
        const std::string_view bytes = document.bytesOf(image.bufferView, who + ".bufferView");
        return {imageExtension(bytes, image.mimeType), std::string(bytes), {}};
    }
    if (!image.image.empty()) { // of a data URI
        const std::string bytes(image.image.begin(), image.image.end());
        return {imageExtension(bytes, image.mimeType), bytes, {}};
    }
    if (image.uri.starts_with("data:")) return imageOfData(document, image.uri, who);
    if (image.uri.empty()) document.fail(who + " has neither bytes nor a file");
    if (hasScheme(image.uri))
        document.fail(fmt::format("{}.uri is `{}`: no file beside it", who, image.uri.substr(0, 60)));
    const std::filesystem::path folder = std::filesystem::path(document.name()).parent_path();
    std::filesystem::path file = folder / decodedGltfUri(image.uri);
    if (!mayName(folder.empty() ? "." : folder, file))
        document.fail(
            fmt::format("{}.uri is `{}`, outside of the scene's project; {}", who, image.uri, helpOutsideReach(file)));
    std::string extension = file.extension().string();
    std::ranges::transform(extension, extension.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return {extension == ".jpeg" ? ".jpg" : extension, {}, std::move(file)};
}

} // namespace abbe
