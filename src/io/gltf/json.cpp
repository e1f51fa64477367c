// glTF files before the library reads them: containers, nesting, and what it would refuse.
#include "base/memory_limit.h"
#include "io/file.h"
#include "io/gltf.h"
#include "io/gltf_document.h"

#include <algorithm>
#include <cstring>
#include <fmt/format.h>
#include <functional>

namespace abbe {

namespace {

constexpr int kDeepest = 256;
constexpr std::size_t kGlbHead = 20;             // of the container and its first chunk
constexpr std::uint32_t kJsonChunk = 0x4e4f534a; // "JSON", little-endian

std::uint32_t gltfWord(std::string_view bytes, std::size_t at) {
    std::uint32_t value;
    std::memcpy(&value, bytes.data() + at, sizeof value);
    return value;
}

std::optional<GltfFault> findDeepNesting(std::string_view json, std::size_t firstByte) {
    int depth = 0;
    bool text = false;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (text) {
            if (c == '\\')
                ++i;
            else if (c == '"')
                text = false;
        } else if (c == '"') {
            text = true;
        } else if (c == '{' || c == '[') {
            if (++depth > kDeepest)
                return GltfFault{firstByte + i, fmt::format("JSON nested more than {} levels deep", kDeepest)};
        } else if (c == '}' || c == ']') {
            --depth;
        }
    }
    return std::nullopt;
}

} // namespace

bool isBinaryGltf(std::string_view bytes) { return bytes.starts_with("glTF"); }

std::optional<GltfFault> findContainerFault(std::string_view bytes) {
    if (!isBinaryGltf(bytes)) return findDeepNesting(bytes, 0);
    if (bytes.size() < 20)
        return GltfFault{bytes.size(), fmt::format("the file ends after {} of at least 20 bytes", bytes.size())};
    if (const std::uint32_t version = gltfWord(bytes, 4); version != 2)
        return GltfFault{4, fmt::format("version {} of the container; only 2 is known", version)};
    if (const std::uint32_t length = gltfWord(bytes, 8); length > bytes.size())
        return GltfFault{bytes.size(), fmt::format("the file ends after {} of {} bytes", bytes.size(), length)};
    const std::size_t length = gltfWord(bytes, 8);
    if (length < 20) return GltfFault{8, fmt::format("a length of {} bytes", length)};
    std::size_t at = 12;
    for (int chunk = 0; at < length; ++chunk) {
        if (length - at < 8) return GltfFault{at, "a chunk without room for its header"};
        const std::size_t size = gltfWord(bytes, at), left = length - at - 8;
        if (size > left) return GltfFault{at, fmt::format("a chunk of {} bytes where only {} are left", size, left)};
        if (chunk == 0 && gltfWord(bytes, at + 4) != kJsonChunk)
            return GltfFault{at + 4, "the first chunk is not JSON"};
        if (size % 4 != 0) return GltfFault{at, fmt::format("a chunk of {} bytes, no multiple of 4", size)};
        if (chunk == 0)
            if (auto fault = findDeepNesting(bytes.substr(at + 8, size), at + 8)) return fault;
        at += 8 + size;
    }
    return std::nullopt;
}

namespace {

// What makes it worth to look for what mendedGltf() mends.
bool mayNeedMending(std::string_view json) {
    for (const std::string_view word : {"KHR_animation_pointer", "_compression"})
        if (json.find(word) != std::string_view::npos) return true;
    return false;
}

template <typename F> void eachObject(nlohmann::json& of, const char* list, F&& f) {
    const auto found = of.find(list);
    if (found == of.end() || !found->is_array()) return;
    for (auto& one : *found)
        if (one.is_object()) f(one);
}

bool isMeshoptFallback(const nlohmann::json& buffer) {
    const auto extensions = buffer.find("extensions");
    if (buffer.contains("uri") || extensions == buffer.end() || !extensions->is_object()) return false;
    for (const auto& [name, extension] : extensions->items()) {
        if (!name.ends_with("_meshopt_compression") || !extension.is_object()) continue;
        const auto flag = extension.find("fallback");
        if (flag != extension.end() && flag->is_boolean() && flag->get<bool>()) return true;
    }
    return false;
}

// The indices of a primitive need a buffer view in the library's eyes. They get that of the compressed stream, which
// nothing reads as indices.
void mendDracoIndices(nlohmann::json& tree, const std::function<void(nlohmann::json&, const char*, int)>& ensure) {
    const auto accessors = tree.find("accessors");
    if (accessors == tree.end() || !accessors->is_array()) return;
    eachObject(tree, "meshes", [&](auto& mesh) {
        eachObject(mesh, "primitives", [&](auto& primitive) {
            const nlohmann::json::json_pointer view("/extensions/KHR_draco_mesh_compression/bufferView");
            const auto indices = primitive.find("indices");
            if (!primitive.contains(view) || !primitive[view].is_number_integer() || indices == primitive.end() ||
                !indices->is_number_unsigned() || indices->template get<std::size_t>() >= accessors->size())
                return;
            nlohmann::json& accessor = (*accessors)[indices->template get<std::size_t>()];
            if (accessor.is_object()) ensure(accessor, "bufferView", primitive[view].template get<int>());
        });
    });
}

// Nothing if it is sound as it is, or no JSON.
std::optional<std::string> mendedJson(std::string_view json) {
    if (!mayNeedMending(json)) return std::nullopt;
    nlohmann::json tree = nlohmann::json::parse(json, nullptr, false);
    if (!tree.is_object()) return std::nullopt;
    bool mended = false;
    const auto ensure = [&](nlohmann::json& object, const char* key, int value) {
        if (object.contains(key)) return;
        object[key] = value;
        mended = true;
    };
    mendDracoIndices(tree, ensure);
    eachObject(tree, "animations", [&](auto& animation) {
        eachObject(animation, "channels", [&](auto& channel) {
            const auto target = channel.find("target");
            if (target != channel.end() && target->is_object()) ensure(*target, "node", -1);
        });
    });
    eachObject(tree, "buffers", [&](auto& buffer) {
        if (!isMeshoptFallback(buffer)) return;
        buffer["byteLength"] = 1;
        buffer["uri"] = "data:application/octet-stream;base64,AA==";
        mended = true;
    });
    if (!mended) return std::nullopt;
    return tree.dump();
}

} // namespace

std::optional<std::string> mendedGltf(std::string_view bytes) {
    if (!isBinaryGltf(bytes)) return mendedJson(bytes);
    const std::size_t size = gltfWord(bytes, 12), length = gltfWord(bytes, 8);
    std::optional<std::string> json = mendedJson(bytes.substr(kGlbHead, size));
    if (!json) return std::nullopt;
    json->resize((json->size() + 3) / 4 * 4, ' ');
    const std::string_view rest = bytes.substr(kGlbHead + size, length - kGlbHead - size);
    requireMemory(static_cast<double>(rest.size() + json->size()));
    const auto put = [](std::size_t value) {
        const auto v = static_cast<std::uint32_t>(value);
        return std::string(reinterpret_cast<const char*>(&v), sizeof v);
    };
    std::string whole = "glTF" + put(2) + put(kGlbHead + json->size() + rest.size()) + put(json->size()) + "JSON";
    return whole.append(*json).append(rest);
}

namespace {

// The JSON of a glTF file, without the buffers that a binary one has behind it.
std::string gltfJsonOf(RegularFile& file) {
    std::string head(kGlbHead, '\0');
    head.resize(file.readAt(0, head));
    std::uint64_t begin = 0, size = file.size();
    if (isBinaryGltf(head)) {
        if (head.size() < kGlbHead) return {};
        begin = kGlbHead;
        size = 0;
        for (std::size_t i = 4; i-- > 0;) size = size << 8 | static_cast<unsigned char>(head[12 + i]);
        size = std::min(size, file.size() - begin);
    }
    requireMemory(static_cast<double>(size));
    std::string text(static_cast<std::size_t>(size), '\0');
    text.resize(file.readAt(begin, text));
    return text;
}

} // namespace

// `+` is a space, too.
std::string decodedGltfUri(const std::string& uri) {
    const auto digit = [](char c) {
        if (c >= '0' && c <= '9') return c - '0';
        if (c >= 'a' && c <= 'f') return c - 'a' + 10;
        return c >= 'A' && c <= 'F' ? c - 'A' + 10 : 0;
    };
    std::string path;
    for (std::size_t i = 0; i < uri.size(); ++i) {
        const bool code = uri[i] == '%' && uri.size() > i + 2;
        path += code ? static_cast<char>(digit(uri[i + 1]) << 4 | digit(uri[i + 2])) : uri[i] == '+' ? ' ' : uri[i];
        if (code) i += 2;
    }
    return path;
}

std::vector<std::string> gltfBufferFiles(const std::string& path) {
    std::vector<std::string> files;
    RegularFile file(path);
    if (!file.good()) return files;
    const std::string text = gltfJsonOf(file);
    if (findContainerFault(text)) return files; // nested too deeply
    const nlohmann::json tree = nlohmann::json::parse(text, nullptr, false);
    if (!tree.is_object()) return files;
    const auto buffers = tree.find("buffers");
    if (buffers == tree.end() || !buffers->is_array()) return files;
    for (const auto& buffer : *buffers) {
        const auto uri = buffer.is_object() ? buffer.find("uri") : buffer.end();
        if (uri == buffer.end() || !uri->is_string()) continue;
        if (const auto name = uri->get<std::string>(); !name.starts_with("data:"))
            files.push_back(decodedGltfUri(name));
    }
    return files;
}

} // namespace abbe
