#include "exchange/shared/ply_writer.h"

#include <array>
#include <bit>
#include <cstring>
#include <fmt/format.h>

namespace abbe::exchange {

static_assert(std::endian::native == std::endian::little);

namespace {

template <typename T> void appendBytes(std::string& out, const T& value) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), &value, sizeof(T));
    out.append(bytes.data(), bytes.size());
}

std::string plyHeader(const MeshData& mesh) {
    std::string text = fmt::format("ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.size());
    const auto property = [&](std::string_view name) { text += fmt::format("property float {}\n", name); };
    for (const char* name : {"x", "y", "z"}) property(name);
    if (!mesh.normals.empty())
        for (const char* name : {"nx", "ny", "nz"}) property(name);
    if (!mesh.uvs.empty())
        for (const char* name : {"u", "v"}) property(name);
    for (const MeshAttribute& attribute : mesh.attributes)
        if (attribute.channels == 1)
            property(attribute.name);
        else if (attribute.name == "color") // which readers put together again
            for (const char* channel : {"red", "green", "blue"}) property(channel);
        else
            for (const char* channel : {"r", "g", "b"}) property(fmt::format("{}_{}", attribute.name, channel));
    text += fmt::format("element face {}\nproperty list uchar uint vertex_indices\nend_header\n",
                        mesh.triangles.size() + mesh.quads.size());
    return text;
}

template <std::size_t N> void appendFaces(std::string& out, const std::vector<std::array<std::uint32_t, N>>& faces) {
    for (const auto& face : faces) {
        out += static_cast<char>(N);
        appendBytes(out, face);
    }
}

} // namespace

std::string binaryPly(const MeshData& mesh) {
    std::string out = plyHeader(mesh);
    out.reserve(out.size() + mesh.positions.size() * 48 + mesh.triangles.size() * 13 + mesh.quads.size() * 17);
    for (std::size_t i = 0; i < mesh.positions.size(); ++i) {
        appendBytes(out, mesh.positions[i]);
        if (!mesh.normals.empty()) appendBytes(out, mesh.normals[i]);
        if (!mesh.uvs.empty()) appendBytes(out, mesh.uvs[i]);
        for (const MeshAttribute& attribute : mesh.attributes)
            for (int c = 0; c < attribute.channels; ++c)
                appendBytes(
                    out,
                    attribute.values[i * static_cast<std::size_t>(attribute.channels) + static_cast<std::size_t>(c)]);
    }
    appendFaces(out, mesh.triangles);
    appendFaces(out, mesh.quads);
    return out;
}

} // namespace abbe::exchange
