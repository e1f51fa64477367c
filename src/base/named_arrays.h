// Arrays of a program that this one is a library of, under names that scenes state in the place of files.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <string_view>

namespace abbe {

// Views into memory that `owner` keeps, and that nobody changes. What the members are called is a matter of who reads
// them: as in PLY files, "points" of three, "faces", ….
struct NamedArrays {
    std::map<std::string, std::span<const float>, std::less<>> floats;
    std::map<std::string, std::span<const std::uint32_t>, std::less<>> integers;
    std::map<std::string, std::span<const std::uint8_t>, std::less<>> bytes;
    std::array<int, 3> size{}; // of a picture: width, height, channels; of a volume: voxels along x, y, z
    std::array<double, 6> place{1, 1, 1, 0, 0, 0}; // of a volume: size of a voxel and middle of the first, m
    std::shared_ptr<const void> owner;

    // Empty if there are none of that name.
    std::span<const float> of(std::string_view name) const;
    std::span<const std::uint32_t> indices(std::string_view name) const;
};

// The name, "memory:12/ball", under which they are found as long as somebody has them. No name is given twice. Any
// thread, and below.
std::string nameArrays(std::string_view what, std::shared_ptr<const NamedArrays>);
// Null if the name is none of these, or they are gone.
std::shared_ptr<const NamedArrays> findArrays(std::string_view name);

} // namespace abbe
