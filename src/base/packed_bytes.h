// Bytes of which most are zero, in less room: sums of 128 bits of which a few samples fill a third, and planes in which
// nothing is.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace abbe {

// Appends of each eight bytes a byte that says which are not zero, and behind all of these the bytes that are not:
// whoever unpacks knows early where the bytes of the next ones begin. At most 9/8 of the size.
void appendPacked(std::span<const std::byte> bytes, std::vector<std::byte>& out);

// The `size` bytes that were packed, in place of what is in `out`. False if `packed` is no such thing; nothing larger
// than eight times `packed` is made.
bool unpack(std::span<const std::byte> packed, std::size_t size, std::vector<std::byte>& out);

} // namespace abbe
