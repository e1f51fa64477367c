// Primitives of glTF files compressed by Draco.
#include "base/memory_limit.h"
#include "io/gltf_document.h"

#include <cmath>
#include <draco/compression/decode.h>
#include <draco/compression/point_cloud/point_cloud_decoder.h>
#include <draco/core/varint_decoding.h>
#include <draco/mesh/mesh.h>
#include <draco/metadata/metadata_decoder.h>
#include <fmt/format.h>

namespace abbe {

namespace {

constexpr std::uint16_t kHasMetadata = 0x8000;
constexpr double kBytesPerFace = 256; // that the library takes while it builds the connectivity, at most

struct DracoCounts {
    std::uint32_t faces = 0, vertices = 0;
};

// The counts at the head of a stream: the library takes memory by them without asking what the stream can hold, as
// what is all the same takes no bits. Nothing for a damaged one, or an older one than glTF allows.
std::optional<DracoCounts> countsOf(std::string_view bytes) {
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    draco::DracoHeader header{};
    if (!draco::PointCloudDecoder::DecodeHeader(&buffer, &header).ok()) return std::nullopt;
    if (header.encoder_type != draco::TRIANGULAR_MESH ||
        header.version_major != draco::kDracoMeshBitstreamVersionMajor ||
        header.version_minor != draco::kDracoMeshBitstreamVersionMinor)
        return std::nullopt;
    buffer.set_bitstream_version(draco::kDracoMeshBitstreamVersion);
    draco::GeometryMetadata metadata;
    if ((header.flags & kHasMetadata) != 0 && !draco::MetadataDecoder().DecodeGeometryMetadata(&buffer, &metadata))
        return std::nullopt;
    DracoCounts counts;
    std::uint8_t traversal = 0;
    const bool sequential = header.encoder_method == draco::MESH_SEQUENTIAL_ENCODING;
    if (!sequential && !buffer.Decode(&traversal)) return std::nullopt;
    if (!draco::DecodeVarint(sequential ? &counts.faces : &counts.vertices, &buffer) ||
        !draco::DecodeVarint(sequential ? &counts.vertices : &counts.faces, &buffer))
        return std::nullopt;
    return counts;
}

// What a number of an accessor is divided by.
float accessorScale(const tinygltf::Accessor& accessor) {
    if (!accessor.normalized) return 1;
    switch (accessor.componentType) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return 127;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 255;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return 32767;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 65535;
    default:
        return 1;
    }
}

GltfUnpacked::Attribute attributeOf(const GltfDocument& document, draco::Mesh& mesh, int id, const std::string& name,
                                    float scale, const std::string& who) {
    const std::int32_t index = id < 0 ? -1 : mesh.GetAttributeIdByUniqueId(static_cast<std::uint32_t>(id));
    draco::PointAttribute* const attribute = index < 0 ? nullptr : mesh.attribute(index);
    if (!attribute) document.fail(fmt::format("{} is {}, which the stream does not have", who, id));
    const int components = attribute->num_components();
    if (components < 1 || components > 4) document.fail(fmt::format("{} has {} components", who, components));
    attribute->set_normalized(false); // the accessor says what the numbers mean
    GltfUnpacked::Attribute result{name, components, {}};
    const auto width = static_cast<std::size_t>(components);
    requireMemory(static_cast<double>(mesh.num_points()) * static_cast<double>(width * sizeof(float)));
    result.values.resize(mesh.num_points() * width);
    for (draco::PointIndex i(0); i < mesh.num_points(); ++i) {
        float* const to = &result.values[i.value() * width];
        if (!attribute->ConvertValue<float>(attribute->mapped_index(i), static_cast<std::int8_t>(components), to))
            document.fail(fmt::format("{}: the stream has no number {}", who, i.value()));
        for (std::size_t c = 0; c < width; ++c) {
            if (scale > 1) to[c] = std::max(to[c] / scale, -1.f);
            if (!std::isfinite(to[c])) document.fail(fmt::format("{}: element {} is not finite", who, i.value()));
        }
    }
    return result;
}

} // namespace

GltfUnpacked unpackDraco(const GltfDocument& document, const tinygltf::Primitive& primitive, const std::string& path) {
    const std::string who = path + ".extensions.KHR_draco_mesh_compression";
    const tinygltf::Value& extension = primitive.extensions.at("KHR_draco_mesh_compression");
    const int view = extension.Has("bufferView") ? extension.Get("bufferView").GetNumberAsInt() : -1;
    const std::string_view bytes = document.bytesOf(view, who + ".bufferView");
    const std::optional<DracoCounts> counts = countsOf(bytes);
    if (!counts) document.fail(fmt::format("{}: bufferViews[{}] holds no Draco mesh of version 2.2", who, view));
    const double elements = 3.0 * counts->faces + counts->vertices;
    document.bound(elements, who);
    requireMemory(elements / 3 * kBytesPerFace);
    draco::DecoderBuffer buffer;
    buffer.Init(bytes.data(), bytes.size());
    draco::Decoder decoder;
    auto decoded = decoder.DecodeMeshFromBuffer(&buffer);
    if (!decoded.ok())
        document.fail(
            fmt::format("{}: bufferViews[{}] is damaged: {}", who, view, decoded.status().error_msg_string()));
    draco::Mesh& mesh = *decoded.value();
    GltfUnpacked result;
    result.vertices = mesh.num_points();
    result.corners.reserve(3 * static_cast<std::size_t>(mesh.num_faces()));
    for (draco::FaceIndex f(0); f < mesh.num_faces(); ++f)
        for (const draco::PointIndex& corner : mesh.face(f)) {
            if (corner.value() >= result.vertices)
                document.fail(
                    fmt::format("{}: face {} names vertex {} of {}", who, f.value(), corner.value(), result.vertices));
            result.corners.push_back(corner.value());
        }
    if (!extension.Has("attributes")) return result;
    for (const auto& [name, id] : extension.Get("attributes").Get<tinygltf::Value::Object>()) {
        const std::string at = fmt::format("{}.attributes.{}", who, name);
        const auto accessor = primitive.attributes.find(name);
        if (accessor == primitive.attributes.end()) document.fail(at + " has no accessor");
        result.attributes.push_back(attributeOf(document, mesh, id.IsInt() ? id.GetNumberAsInt() : -1, name,
                                                accessorScale(document.accessorAt(accessor->second, at)), at));
    }
    return result;
}

} // namespace abbe
