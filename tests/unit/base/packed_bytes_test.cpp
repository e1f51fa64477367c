#include "base/packed_bytes.h"

#include <doctest/doctest.h>
#include <random>

using namespace abbe;

TEST_CASE("packed bytes are what they were, whatever they are") {
    std::mt19937 random(7);
    for (const std::size_t size : {0, 1, 7, 8, 9, 16, 255, 4096, 4099}) {
        for (const unsigned zeros : {0U, 50U, 95U, 100U}) { // of a hundred
            std::vector<std::byte> bytes(size), packed{std::byte{42}}, back{std::byte{1}};
            for (std::byte& b : bytes) b = random() % 100 < zeros ? std::byte{} : static_cast<std::byte>(random());
            appendPacked(bytes, packed);
            CHECK(packed[0] == std::byte{42}); // what was there stays
            CHECK(packed.size() - 1 <= (size + 7) / 8 * 9);
            const std::span<const std::byte> made(packed.begin() + 1, packed.end());
            CHECK(unpack(made, size, back));
            CHECK(back == bytes);
            if (zeros == 100) CHECK(made.size() == (size + 7) / 8);
            // Damage: what is missing, too much, or of another size is found.
            if (!made.empty()) CHECK_FALSE(unpack(made.first(made.size() - 1), size, back));
            CHECK_FALSE(unpack(made, size + 8, back));
            packed.push_back(std::byte{0}); // `made` may be gone
            CHECK_FALSE(unpack({packed.begin() + 1, packed.end()}, size, back));
        }
    }
}

// Whatever the processor has for it: parts are made on one machine and read on another.
TEST_CASE("packed bytes are flags and then the bytes that are not zero") {
    std::mt19937 random(3);
    for (const std::size_t words : {1, 7, 8, 9, 24, 41}) {
        std::vector<std::byte> bytes(8 * words), flags(words), kept, packed;
        for (std::size_t i = 0; i < bytes.size(); ++i) {
            if (random() % 2 == 0) continue;
            bytes[i] = static_cast<std::byte>(1 + random() % 255);
            flags[i / 8] |= static_cast<std::byte>(1u << i % 8);
            kept.push_back(bytes[i]);
        }
        appendPacked(bytes, packed);
        std::vector<std::byte> expected = flags;
        expected.insert(expected.end(), kept.begin(), kept.end());
        CHECK(packed == expected);
    }
}

TEST_CASE("nothing larger than eight times the packed bytes is made") {
    std::vector<std::byte> out;
    const std::vector<std::byte> packed(8);
    CHECK_FALSE(unpack(packed, std::size_t{1} << 40, out));
    CHECK(out.empty());
    CHECK_FALSE(unpack(packed, 65, out));
    CHECK(unpack(packed, 64, out));
    // Bytes behind the end have to be zero.
    const std::vector<std::byte> behind{std::byte{0b10}, std::byte{5}};
    CHECK(unpack(behind, 2, out));
    CHECK_FALSE(unpack(behind, 1, out));
}
