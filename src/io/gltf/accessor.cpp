#include "io/gltf_document.h"

#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <limits>

namespace abbe {

namespace {

template <typename T> T load(const unsigned char* p) {
    T value;
    std::memcpy(&value, p, sizeof value);
    return value;
}

int componentSize(int type) {
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return 1;
    case TINYGLTF_COMPONENT_TYPE_SHORT:
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return 2;
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
    case TINYGLTF_COMPONENT_TYPE_FLOAT:
        return 4;
    default:
        return 0;
    }
}

int componentsOf(int type) {
    switch (type) {
    case TINYGLTF_TYPE_SCALAR:
        return 1;
    case TINYGLTF_TYPE_VEC2:
        return 2;
    case TINYGLTF_TYPE_VEC3:
        return 3;
    case TINYGLTF_TYPE_VEC4:
        return 4;
    case TINYGLTF_TYPE_MAT4:
        return 16;
    default:
        return 0;
    }
}

// One number, in [0, 1] or [-1, 1] if normalised.
float number(const unsigned char* p, int type, bool normalized) {
    const auto scaled = [normalized](auto v) {
        using T = decltype(v);
        if (!normalized) return static_cast<float>(v);
        return std::max(static_cast<float>(v) / static_cast<float>(std::numeric_limits<T>::max()), -1.f);
    };
    switch (type) {
    case TINYGLTF_COMPONENT_TYPE_BYTE:
        return scaled(load<std::int8_t>(p));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE:
        return scaled(load<std::uint8_t>(p));
    case TINYGLTF_COMPONENT_TYPE_SHORT:
        return scaled(load<std::int16_t>(p));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT:
        return scaled(load<std::uint16_t>(p));
    case TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT:
        return scaled(load<std::uint32_t>(p));
    default:
        return load<float>(p);
    }
}

std::uint32_t unsignedNumber(const unsigned char* p, int type) {
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE) return *p;
    if (type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT) return load<std::uint16_t>(p);
    return load<std::uint32_t>(p);
}

bool isUnsigned(int type) {
    return type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_BYTE || type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_SHORT ||
           type == TINYGLTF_COMPONENT_TYPE_UNSIGNED_INT;
}

} // namespace

const tinygltf::Accessor& GltfDocument::accessorAt(int accessor, const std::string& who) const {
    if (accessor < 0 || static_cast<std::size_t>(accessor) >= model_.accessors.size())
        fail(fmt::format("{} is accessor {}, but there are {}", who, accessor, model_.accessors.size()));
    return model_.accessors[static_cast<std::size_t>(accessor)];
}

int GltfDocument::components(int accessor, const std::string& who) const {
    return componentsOf(accessorAt(accessor, who).type);
}

const unsigned char* GltfDocument::range(int bufferView, std::size_t offset, std::size_t stride, std::size_t count,
                                         std::size_t element, const std::string& who) const {
    if (bufferView < 0 || static_cast<std::size_t>(bufferView) >= model_.bufferViews.size())
        fail(fmt::format("{}: bufferView {} of {}", who, bufferView, model_.bufferViews.size()));
    const tinygltf::BufferView& view = model_.bufferViews[static_cast<std::size_t>(bufferView)];
    const auto outside = [&](std::size_t length) {
        // No product can wrap: strides are small and counts are below the number of bytes.
        return offset > length || count > length || stride > 4096 || (count - 1) * stride + element > length - offset;
    };
    const auto misfit = [&](std::size_t length) {
        fail(fmt::format("{}: {} elements of {} bytes from byte {} on do not fit into bufferViews[{}] with {} bytes",
                         who, count, element, offset, bufferView, length));
    };
    if (const auto& data = unpacked_[static_cast<std::size_t>(bufferView)]; !data.empty()) {
        if (outside(data.size())) misfit(data.size());
        return data.data() + offset;
    }
    if (view.buffer < 0 || static_cast<std::size_t>(view.buffer) >= model_.buffers.size())
        fail(fmt::format("bufferViews[{}].buffer is {}, but there are {}", bufferView, view.buffer,
                         model_.buffers.size()));
    const auto& data = model_.buffers[static_cast<std::size_t>(view.buffer)].data;
    if (view.byteOffset > data.size() || view.byteLength > data.size() - view.byteOffset)
        fail(fmt::format("bufferViews[{}]: {} bytes from byte {} on, but buffers[{}] has {}", bufferView,
                         view.byteLength, view.byteOffset, view.buffer, data.size()));
    if (outside(view.byteLength)) misfit(view.byteLength);
    return data.data() + view.byteOffset + offset;
}

std::string_view GltfDocument::bytesOf(int bufferView, const std::string& who) const {
    if (bufferView < 0 || static_cast<std::size_t>(bufferView) >= model_.bufferViews.size())
        fail(fmt::format("{}: bufferView {} of {}", who, bufferView, model_.bufferViews.size()));
    const std::size_t length = model_.bufferViews[static_cast<std::size_t>(bufferView)].byteLength;
    if (length == 0) fail(fmt::format("{}: bufferViews[{}] is empty", who, bufferView));
    return {reinterpret_cast<const char*>(range(bufferView, 0, 1, 1, length, who)), length};
}

GltfView GltfDocument::view(int accessor, const std::string& who) const {
    const tinygltf::Accessor& a = accessorAt(accessor, who);
    const std::string path = fmt::format("accessors[{}] ({})", accessor, who);
    const int size = componentSize(a.componentType), components = componentsOf(a.type);
    if (size == 0 || components == 0) fail(fmt::format("{} holds no numbers or vectors that glTF has", path));
    if (a.count == 0) fail(fmt::format("{} is empty", path));
    const auto element = static_cast<std::size_t>(size * components);
    GltfView v{nullptr, element, a.count, a.componentType, components, a.normalized};
    if (a.bufferView < 0) {
        if (!a.sparse.isSparse) fail(fmt::format("{} has no bufferView", path));
        bound(static_cast<double>(a.count), path + " without data");
        return v;
    }
    if (static_cast<std::size_t>(a.bufferView) < model_.bufferViews.size()) {
        const std::size_t stride = model_.bufferViews[static_cast<std::size_t>(a.bufferView)].byteStride;
        if (stride != 0 && stride < element)
            fail(fmt::format("bufferViews[{}].byteStride is {}, less than the {} bytes of an element", a.bufferView,
                             stride, element));
        if (stride != 0) v.stride = stride;
    }
    v.data = range(a.bufferView, a.byteOffset, v.stride, v.count, element, path);
    return v;
}

void GltfDocument::applySparse(int accessor, const GltfView& v, std::vector<float>& values,
                               const std::string& who) const {
    const auto& sparse = model_.accessors[static_cast<std::size_t>(accessor)].sparse;
    const std::string path = fmt::format("accessors[{}].sparse ({})", accessor, who);
    const auto size = static_cast<std::size_t>(componentSize(v.componentType));
    const int indexType = sparse.indices.componentType;
    if (sparse.count < 1 || static_cast<std::size_t>(sparse.count) > v.count || sparse.indices.byteOffset < 0 ||
        sparse.values.byteOffset < 0 || !isUnsigned(indexType))
        fail(fmt::format("{} is not {} of {} elements with unsigned indices", path, sparse.count, v.count));
    const auto count = static_cast<std::size_t>(sparse.count);
    const auto indexSize = static_cast<std::size_t>(componentSize(indexType));
    const auto components = static_cast<std::size_t>(v.components), element = size * components;
    const unsigned char* at = range(sparse.indices.bufferView, static_cast<std::size_t>(sparse.indices.byteOffset),
                                    indexSize, count, indexSize, path + ".indices");
    const unsigned char* from = range(sparse.values.bufferView, static_cast<std::size_t>(sparse.values.byteOffset),
                                      element, count, element, path + ".values");
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t index = unsignedNumber(at + i * indexSize, indexType);
        if (index >= v.count) fail(fmt::format("{}.indices: number {} is {} of {}", path, i, index, v.count));
        for (std::size_t c = 0; c < components; ++c)
            values[index * components + c] = number(from + i * element + c * size, v.componentType, v.normalized);
    }
}

std::vector<float> GltfDocument::floats(int accessor, int components, const std::string& who) const {
    const GltfView v = view(accessor, who);
    if (v.components != components)
        fail(
            fmt::format("accessors[{}] ({}) has {} components instead of {}", accessor, who, v.components, components));
    const auto n = static_cast<std::size_t>(components),
               size = static_cast<std::size_t>(componentSize(v.componentType));
    std::vector<float> values(v.count * n, 0.f);
    if (v.data)
        for (std::size_t i = 0; i < v.count; ++i)
            for (std::size_t c = 0; c < n; ++c)
                values[i * n + c] = number(v.data + i * v.stride + c * size, v.componentType, v.normalized);
    if (model_.accessors[static_cast<std::size_t>(accessor)].sparse.isSparse) applySparse(accessor, v, values, who);
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i]))
            fail(fmt::format("accessors[{}] ({}): element {} is not finite", accessor, who, i / n));
    return values;
}

std::vector<std::uint32_t> GltfDocument::indices(int accessor, std::size_t limit, const std::string& who) const {
    const GltfView v = view(accessor, who);
    if (v.components != 1 || !isUnsigned(v.componentType) || v.normalized)
        fail(fmt::format("accessors[{}] ({}) does not hold unsigned numbers", accessor, who));
    if (!v.data || model_.accessors[static_cast<std::size_t>(accessor)].sparse.isSparse)
        fail(fmt::format("accessors[{}] ({}): sparse indices are not supported", accessor, who));
    std::vector<std::uint32_t> values(v.count);
    for (std::size_t i = 0; i < v.count; ++i) {
        values[i] = unsignedNumber(v.data + i * v.stride, v.componentType);
        if (values[i] >= limit)
            fail(fmt::format("accessors[{}] ({}): element {} names vertex {} of {}", accessor, who, i, values[i],
                             limit));
    }
    return values;
}

} // namespace abbe
