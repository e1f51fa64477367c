// Buffer views of glTF files compressed by meshopt.
#include "base/memory_limit.h"
#include "io/gltf_document.h"

#include <fmt/format.h>
#include <meshoptimizer.h>

namespace abbe {

namespace {

constexpr double kMostUnpacked = 1024; // that the coding makes of one byte: 64 where all is the same

std::size_t naturalOf(const tinygltf::Value& of, const char* key) {
    if (!of.Has(key)) return 0;
    const tinygltf::Value& value = of.Get(key);
    return value.IsInt() && value.GetNumberAsInt() > 0 ? static_cast<std::size_t>(value.GetNumberAsInt()) : 0;
}

std::string wordOf(const tinygltf::Value& of, const char* key, const char* otherwise) {
    return of.Has(key) && of.Get(key).IsString() ? of.Get(key).Get<std::string>() : otherwise;
}

// The library asserts what it asks of strides and counts, or does nothing about it.
bool fitsMode(const std::string& mode, std::size_t count, std::size_t stride) {
    if (mode == "ATTRIBUTES") return stride % 4 == 0 && stride > 0 && stride <= 256;
    if (mode == "TRIANGLES") return count % 3 == 0 && (stride == 2 || stride == 4);
    return mode == "INDICES" && (stride == 2 || stride == 4);
}

bool fitsFilter(const std::string& filter, std::size_t stride) {
    if (filter == "OCTAHEDRAL") return stride == 4 || stride == 8;
    if (filter == "QUATERNION") return stride == 8;
    return filter == "EXPONENTIAL" ? stride % 4 == 0 : filter == "NONE";
}

int decode(const std::string& mode, std::vector<unsigned char>& to, std::size_t count, std::size_t stride,
           const unsigned char* from, std::size_t size) {
    if (mode == "ATTRIBUTES") return meshopt_decodeVertexBuffer(to.data(), count, stride, from, size);
    if (mode == "TRIANGLES") return meshopt_decodeIndexBuffer(to.data(), count, stride, from, size);
    return meshopt_decodeIndexSequence(to.data(), count, stride, from, size);
}

} // namespace

const char* meshoptName(const tinygltf::BufferView& view) {
    for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"})
        if (view.extensions.contains(name)) return name;
    return nullptr;
}

std::vector<unsigned char> unpackMeshopt(const GltfDocument& document, const tinygltf::Value& extension,
                                         const std::string& path) {
    const auto& buffers = document.model().buffers;
    const int buffer = extension.Has("buffer") ? extension.Get("buffer").GetNumberAsInt() : -1;
    if (static_cast<std::size_t>(buffer) >= buffers.size())
        document.fail(fmt::format("{}.buffer is {}, but there are {}", path, buffer, buffers.size()));
    const auto& data = buffers[static_cast<std::size_t>(buffer)].data;
    const std::size_t offset = naturalOf(extension, "byteOffset"), size = naturalOf(extension, "byteLength");
    if (offset > data.size() || size > data.size() - offset || size == 0)
        document.fail(fmt::format("{}: {} bytes from byte {} on, but buffers[{}] has {}", path, size, offset, buffer,
                                  data.size()));
    const std::size_t count = naturalOf(extension, "count"), stride = naturalOf(extension, "byteStride");
    const std::string mode = wordOf(extension, "mode", ""), filter = wordOf(extension, "filter", "NONE");
    if (count == 0 || !fitsMode(mode, count, stride) || !fitsFilter(filter, stride))
        document.fail(fmt::format("{}: mode `{}` and filter `{}` do not go with {} elements of {} bytes", path,
                                  mode.substr(0, 20), filter.substr(0, 20), count, stride));
    const double bytes = static_cast<double>(count) * static_cast<double>(stride);
    if (bytes > kMostUnpacked * static_cast<double>(size))
        document.fail(fmt::format("{}: {:.0f} bytes out of {}", path, bytes, size));
    requireMemory(bytes);
    std::vector<unsigned char> result(count * stride);
    if (decode(mode, result, count, stride, data.data() + offset, size) != 0)
        document.fail(fmt::format("{}: the stream is damaged, or of a newer version than 0 of its coding", path));
    if (filter == "OCTAHEDRAL") meshopt_decodeFilterOct(result.data(), count, stride);
    if (filter == "QUATERNION") meshopt_decodeFilterQuat(result.data(), count, stride);
    if (filter == "EXPONENTIAL") meshopt_decodeFilterExp(result.data(), count, stride);
    return result;
}

} // namespace abbe
