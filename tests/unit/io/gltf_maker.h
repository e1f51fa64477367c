// glTF files put together accessor by accessor.
#pragma once

#include "gltf_support.h"

#include <vector>

namespace abbe::test {

class GltfMaker {
  public:
    // Each returns the number of what it adds.
    int view(const std::string& bytes, const std::string& more = {}) {
        data_.resize((data_.size() + 3) / 4 * 4, '\0');
        views_ += fmt::format(R"({}{{"buffer":0,"byteOffset":{},"byteLength":{}{}}})", viewCount_ ? "," : "",
                              data_.size(), bytes.size(), more);
        data_ += bytes;
        return viewCount_++;
    }
    int raw(const std::string& accessor) {
        accessors_ += (accessorCount_ ? "," : "") + accessor;
        return accessorCount_++;
    }
    int add(const std::string& type, int componentType, std::size_t count, const std::string& bytes,
            const std::string& more = {}) {
        const int at = view(bytes);
        return raw(fmt::format(R"({{"bufferView":{},"componentType":{},"count":{},"type":"{}"{}}})", at, componentType,
                               count, type, more));
    }
    int floats(const std::string& type, const std::vector<float>& values) {
        const std::size_t width = type == "MAT4" ? 16 : type == "SCALAR" ? 1 : static_cast<std::size_t>(type[3] - '0');
        return add(type, 5126, values.size() / width,
                   std::string(reinterpret_cast<const char*>(values.data()), values.size() * sizeof(float)));
    }
    // `more`: members of the top, without a comma around them.
    std::string binary(const std::string& nodes, const std::string& meshes, const std::string& more) const {
        const std::string none = "[]";
        const auto list = [&](const char* name, const std::string& items) {
            return items.empty() || items == none ? std::string() : fmt::format(R"(,"{}":{})", name, items);
        };
        const std::string buffers =
            data_.empty() ? "" : fmt::format(R"(,"buffers":[{{"byteLength":{}}}])", data_.size());
        const std::string json = R"({"asset":{"version":"2.0"})" + list("nodes", nodes) + list("meshes", meshes) +
                                 list("accessors", "[" + accessors_ + "]") + list("bufferViews", "[" + views_ + "]") +
                                 buffers + (more.empty() ? "" : "," + more) + "}";
        return data_.empty() ? json : glb(json, data_);
    }

  private:
    std::string data_, views_, accessors_;
    int viewCount_ = 0, accessorCount_ = 0;
};

} // namespace abbe::test
