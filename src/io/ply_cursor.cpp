#include "io/ply_cursor.h"

#include "io/io_error.h"
#include "io/number_scan.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace abbe {

namespace {

template <typename T> double load(const char* p, bool swap) {
    std::array<char, sizeof(T)> bytes;
    std::memcpy(bytes.data(), p, sizeof(T));
    if (swap) std::reverse(bytes.begin(), bytes.end());
    return static_cast<double>(std::bit_cast<T>(bytes));
}

// Every PLY integer is exact in double.
double loadScalar(PlyScalar type, const char* p, bool swap) {
    switch (type) {
    case PlyScalar::int8:
        return load<std::int8_t>(p, swap);
    case PlyScalar::uint8:
        return load<std::uint8_t>(p, swap);
    case PlyScalar::int16:
        return load<std::int16_t>(p, swap);
    case PlyScalar::uint16:
        return load<std::uint16_t>(p, swap);
    case PlyScalar::int32:
        return load<std::int32_t>(p, swap);
    case PlyScalar::uint32:
        return load<std::uint32_t>(p, swap);
    case PlyScalar::float32:
        return load<float>(p, swap);
    case PlyScalar::float64:
        break;
    }
    return load<double>(p, swap);
}

} // namespace

PlyCursor::PlyCursor(const PlyHeader& header, std::string_view bytes, const std::string& name)
    : begin_(bytes.data()), p_(begin_ + header.bodyOffset), end_(begin_ + bytes.size()), last_(p_), name_(name),
      text_(header.encoding == PlyEncoding::text),
      swap_((header.encoding == PlyEncoding::bigEndian) == (std::endian::native == std::endian::little)) {}

void PlyCursor::failAt(const char* place, const std::string& what) const {
    throw IoError(fmt::format("cannot read `{}`: byte {}: {}", name_, place - begin_, what));
}

double PlyCursor::textScalar() {
    while (p_ < end_ && static_cast<unsigned char>(*p_) <= ' ') ++p_;
    last_ = p_;
    if (p_ == end_) fail("the file ends too early");
    const auto value = scanNumber<double>(p_, end_);
    const bool ended = p_ == end_ || static_cast<unsigned char>(*p_) <= ' ';
    if (!value || !ended) fail("this is not a number that fits");
    return *value;
}

double PlyCursor::scalar(PlyScalar type) {
    if (text_) return textScalar();
    last_ = p_;
    const std::size_t size = sizeOf(type);
    if (left() < size) fail("the file ends too early");
    p_ += size;
    return loadScalar(type, last_, swap_);
}

std::uint64_t PlyCursor::listLength(const PlyProperty& p) {
    const double n = scalar(*p.listCount);
    const std::uint64_t itemSize = text_ ? 1 : sizeOf(p.type);
    if (!(n >= 0) || n != std::floor(n) || n > static_cast<double>(left() / itemSize + 1))
        fail(fmt::format("a list of {} entries is more than the file holds", n));
    return static_cast<std::uint64_t>(n);
}

void PlyCursor::skip(const PlyProperty& p) {
    for (std::uint64_t n = p.listCount ? listLength(p) : 1; n > 0; --n) scalar(p.type);
}

void PlyCursor::skip(const PlyElement& e) {
    for (std::uint64_t i = 0; i < e.count; ++i)
        for (const PlyProperty& p : e.properties) skip(p);
}

} // namespace abbe
