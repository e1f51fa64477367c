// Rounding of parts so that they add up.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace abbe {

// Planes whose sum is the picture: its light groups, or its components.
using Partition = std::vector<std::span<float>>;

// Parts of a picture are rounded to float one by one, so that their sum misses the picture by some last bits. Changes
// the parts of each partition, by about that much, until part₀ + part₁ + … in float, in this order, is the whole to the
// last bit: what a compositor adds up is the picture. Where parts of opposite signs cancel, no parts of their precision
// add up to so small a whole: there all of them, and the whole, are rounded to the last bit of the largest.
// Returns how many values were left alone because their parts miss the whole by more than rounding can.
std::size_t roundToSum(std::span<float> whole, std::span<const Partition> partitions);

} // namespace abbe
