#include "io/gltf_container.h"

#include <cstdint>
#include <cstring>
#include <fmt/format.h>

namespace abbe {

namespace {

constexpr int kDeepest = 256;
constexpr std::uint32_t kJsonChunk = 0x4e4f534a; // "JSON", little-endian

std::uint32_t word(std::string_view bytes, std::size_t at) {
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
    if (const std::uint32_t version = word(bytes, 4); version != 2)
        return GltfFault{4, fmt::format("version {} of the container; only 2 is known", version)};
    if (const std::uint32_t length = word(bytes, 8); length > bytes.size())
        return GltfFault{bytes.size(), fmt::format("the file ends after {} of {} bytes", bytes.size(), length)};
    const std::size_t length = word(bytes, 8);
    if (length < 20) return GltfFault{8, fmt::format("a length of {} bytes", length)};
    std::size_t at = 12;
    for (int chunk = 0; at < length; ++chunk) {
        if (length - at < 8) return GltfFault{at, "a chunk without room for its header"};
        const std::size_t size = word(bytes, at), left = length - at - 8;
        if (size > left) return GltfFault{at, fmt::format("a chunk of {} bytes where only {} are left", size, left)};
        if (chunk == 0 && word(bytes, at + 4) != kJsonChunk) return GltfFault{at + 4, "the first chunk is not JSON"};
        if (size % 4 != 0) return GltfFault{at, fmt::format("a chunk of {} bytes, no multiple of 4", size)};
        if (chunk == 0)
            if (auto fault = findDeepNesting(bytes.substr(at + 8, size), at + 8)) return fault;
        at += 8 + size;
    }
    return std::nullopt;
}

} // namespace abbe
