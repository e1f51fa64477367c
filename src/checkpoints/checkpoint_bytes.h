// Numbers and texts as the bytes of a checkpoint, least byte first.
#pragma once

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <string>
#include <vector>

namespace abbe {

static_assert(std::endian::native == std::endian::little);

// Appends to bytes.
class ByteWriter {
  public:
    explicit ByteWriter(std::vector<std::byte>& bytes) : bytes_(bytes) {}
    // Of any type without padding and pointers.
    template <typename Number> void number(Number v) {
        const auto* from = reinterpret_cast<const std::byte*>(&v);
        bytes_.insert(bytes_.end(), from, from + sizeof v);
    }
    void text(const std::string& s) {
        number(static_cast<std::uint64_t>(s.size()));
        const auto* from = reinterpret_cast<const std::byte*>(s.data());
        bytes_.insert(bytes_.end(), from, from + s.size());
    }
    void texts(const std::vector<std::string>& list) {
        number(static_cast<std::uint64_t>(list.size()));
        for (const std::string& s : list) text(s);
    }

  private:
    std::vector<std::byte>& bytes_;
};

// Takes from the front. Beyond the end everything is 0 and empty, and sound() is false from then on.
class ByteReader {
  public:
    explicit ByteReader(std::span<const std::byte> bytes) : bytes_(bytes) {}
    template <typename Number> Number number() {
        Number v{};
        if (const auto from = take(sizeof v); !from.empty()) std::memcpy(&v, from.data(), sizeof v);
        return v;
    }
    std::string text() {
        const auto from = take(number<std::uint64_t>());
        return {reinterpret_cast<const char*>(from.data()), from.size()};
    }
    std::vector<std::string> texts() {
        std::vector<std::string> list;
        for (auto n = number<std::uint64_t>(); n > 0 && sound_; --n) list.push_back(text());
        return list;
    }
    std::span<const std::byte> take(std::uint64_t size) {
        if (size > bytes_.size()) {
            fail();
            return {};
        }
        const auto taken = bytes_.first(size);
        bytes_ = bytes_.subspan(size);
        return taken;
    }
    // As if the end had come.
    void fail() {
        sound_ = false;
        bytes_ = {};
    }
    bool sound() const { return sound_; }
    bool atEnd() const { return bytes_.empty(); }

  private:
    std::span<const std::byte> bytes_;
    bool sound_ = true;
};

} // namespace abbe
