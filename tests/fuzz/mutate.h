// Random changes to inputs of a fuzz target: the same changes for the same seed, on any machine.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace abbe::fuzz {

// SplitMix64 [Steele2014].
class Random {
  public:
    explicit Random(std::uint64_t seed) : state_(seed) {}
    std::uint64_t next();
    // Below `n`, which is above 0; as even as inputs need it.
    std::size_t below(std::size_t n) { return static_cast<std::size_t>(next() % n); }

  private:
    std::uint64_t state_;
};

// Some changes, one after the other: bits and bytes, numbers at the borders of their types, texts of other inputs, and
// pieces that are left out, moved, repeated or taken from `other`. At most `longest` bytes come out.
std::string mutate(const std::string& input, const std::string& other, std::span<const std::string> words,
                   std::size_t longest, Random&);

// The words and numbers of a text, to be put into others.
void collectWords(const std::string& input, std::vector<std::string>& words);

} // namespace abbe::fuzz
