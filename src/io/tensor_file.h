// Files of named arrays, "tensor_file", in which measured scattering is published [Dupuy2018]; Mitsuba 3 and pbrt-v4
// read them, too.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// What the elements of an array are, by the numbers of the format.
enum class TensorType : std::uint8_t {
    uint8 = 1,
    int8,
    uint16,
    int16,
    uint32,
    int32,
    uint64,
    int64,
    half,
    real,
    real64
};

struct Tensor {
    TensorType type = TensorType::uint8;
    std::vector<std::size_t> shape; // the last changes fastest
    std::string_view bytes;         // of the file, little-endian

    std::size_t size() const; // number of elements
    // Requires: of TensorType::real.
    std::vector<float> numbers() const;
};

class TensorFile {
  public:
    // Throws IoError.
    explicit TensorFile(const std::string& path);
    TensorFile(std::string content, std::string name);
    TensorFile(const TensorFile&) = delete;
    TensorFile& operator=(const TensorFile&) = delete;

    const std::string& name() const { return name_; }
    bool has(std::string_view field) const { return fields_.contains(field); }
    // Throws IoError, which names the fields that there are.
    const Tensor& operator[](std::string_view field) const;

  private:
    void readFields();

    std::string content_, name_;
    std::map<std::string, Tensor, std::less<>> fields_;
};

} // namespace abbe
