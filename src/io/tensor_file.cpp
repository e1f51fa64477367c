#include "io/tensor_file.h"

#include "io/file.h"

#include <cstring>
#include <fmt/format.h>
#include <fmt/ranges.h>

namespace abbe {

namespace {

constexpr std::string_view kTensorMagic("tensor_file\0", 12);
constexpr std::uint16_t kMostDimensions = 16;

std::size_t bytesOf(TensorType type) {
    switch (type) {
    case TensorType::uint8:
    case TensorType::int8:
        return 1;
    case TensorType::uint16:
    case TensorType::int16:
    case TensorType::half:
        return 2;
    case TensorType::uint32:
    case TensorType::int32:
    case TensorType::real:
        return 4;
    case TensorType::uint64:
    case TensorType::int64:
    case TensorType::real64:
        return 8;
    }
    return 0; // a type that the format has not
}

// Numbers one after another, little-endian.
class TensorBytes {
  public:
    TensorBytes(std::string_view bytes, const std::string& name) : bytes_(bytes), name_(name) {}

    [[noreturn]] void fail(const std::string& why) const {
        throw IoError(fmt::format("cannot read `{}`: {}", name_, why));
    }
    std::string_view text(std::size_t size) {
        if (size > bytes_.size()) fail("it is cut off");
        const std::string_view result = bytes_.substr(0, size);
        bytes_.remove_prefix(size);
        return result;
    }
    template <typename T> T number() {
        T value;
        std::memcpy(&value, text(sizeof value).data(), sizeof value);
        return value;
    }

  private:
    std::string_view bytes_;
    const std::string& name_;
};

} // namespace

std::size_t Tensor::size() const {
    std::size_t n = 1;
    for (const std::size_t s : shape) n *= s;
    return n;
}

std::vector<float> Tensor::numbers() const {
    std::vector<float> result(bytes.size() / sizeof(float));
    if (!bytes.empty()) std::memcpy(result.data(), bytes.data(), result.size() * sizeof(float));
    return result;
}

TensorFile::TensorFile(const std::string& path) : content_(readFileBytes(path)), name_(path) { readFields(); }

TensorFile::TensorFile(std::string content, std::string name) : content_(std::move(content)), name_(std::move(name)) {
    readFields();
}

void TensorFile::readFields() {
    TensorBytes in(content_, name_);
    if (!content_.starts_with(kTensorMagic)) in.fail("it is no file of tensors (.bsdf)");
    in.text(kTensorMagic.size());
    const int major = in.number<std::uint8_t>(), minor = in.number<std::uint8_t>();
    if (major != 1) in.fail(fmt::format("its format is {}.{}, not 1.0", major, minor));
    for (auto left = in.number<std::uint32_t>(); left > 0; --left) {
        const std::string field(in.text(in.number<std::uint16_t>()));
        const auto dimensions = in.number<std::uint16_t>();
        if (dimensions > kMostDimensions) in.fail(fmt::format("an array has {} dimensions", dimensions));
        Tensor tensor;
        tensor.type = static_cast<TensorType>(in.number<std::uint8_t>());
        const auto offset = in.number<std::uint64_t>();
        std::uint64_t bytes = bytesOf(tensor.type);
        if (bytes == 0) in.fail("an array is of an unknown type");
        for (std::uint16_t i = 0; i < dimensions; ++i) {
            const auto n = in.number<std::uint64_t>();
            if (n > 0 && bytes > content_.size() / n) in.fail("it is cut off: an array does not fit into it");
            tensor.shape.push_back(n);
            bytes *= n;
        }
        if (offset > content_.size() || bytes > content_.size() - offset)
            in.fail("it is cut off: an array does not fit into it");
        tensor.bytes = std::string_view(content_).substr(offset, bytes);
        fields_.insert_or_assign(field, std::move(tensor));
    }
}

const Tensor& TensorFile::operator[](std::string_view field) const {
    const auto found = fields_.find(field);
    if (found != fields_.end()) return found->second;
    std::vector<std::string_view> names;
    for (const auto& [name, tensor] : fields_) names.push_back(name);
    throw IoError(fmt::format("cannot read `{}`: it has no array `{}`, but {}", name_, field, fmt::join(names, ", ")));
}

} // namespace abbe
