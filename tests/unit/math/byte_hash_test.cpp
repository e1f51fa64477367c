// The fingerprint of bytes: portions do not matter, every bit and the length do.
#include "math/byte_hash.h"

#include <doctest/doctest.h>
#include <set>
#include <vector>

namespace abbe::test {

TEST_CASE("byte hash: the same in any portions, another one for any bit, length or order") {
    std::vector<std::byte> bytes(101);
    for (std::size_t i = 0; i < bytes.size(); ++i) bytes[i] = static_cast<std::byte>(37 * i);
    const std::span<const std::byte> all(bytes);
    for (std::size_t cut = 0; cut <= all.size(); ++cut) {
        ByteHash hash;
        hash.add(all.first(cut));
        hash.add({});
        hash.add(all.subspan(cut));
        CHECK(hash.value() == hashOf(all));
    }
    std::set<std::uint64_t> seen{hashOf(all)};
    for (std::size_t bit = 0; bit < 8 * bytes.size(); ++bit) {
        bytes[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
        seen.insert(hashOf(all));
        bytes[bit / 8] ^= static_cast<std::byte>(1 << bit % 8);
    }
    CHECK(seen.size() == 8 * bytes.size() + 1);
    // Zeros count, too.
    const std::vector<std::byte> zeros(100);
    std::set<std::uint64_t> lengths;
    for (std::size_t n = 0; n <= zeros.size(); ++n) lengths.insert(hashOf(std::span(zeros).first(n)));
    CHECK(lengths.size() == zeros.size() + 1);
    // Words in another order.
    std::vector<std::byte> swapped(bytes);
    std::swap_ranges(swapped.begin(), swapped.begin() + 8, swapped.begin() + 32);
    CHECK(hashOf(swapped) != hashOf(all));
}

} // namespace abbe::test
