#include "fuzz/mutate.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>

namespace abbe::fuzz {

namespace {

constexpr std::array<std::int64_t, 21> kNumbers{
    0,     1,     -1,    2,       3,          7,          8,          127,       128,       255,      256,
    32767, 65535, 65536, 1 << 24, 0x7fffffff, 0x80000000, 0xffffffff, 1LL << 40, INT64_MAX, INT64_MIN};
constexpr std::array<const char*, 14> kTexts{
    "0", "-1", "1e308", "1e-320", "nan", "inf", "4294967296", "18446744073709551615", "0.5", "\n", "{", "}", "\"", "/"};

// A number of that many bytes over what is there, in either order.
void putNumber(std::string& s, Random& random) {
    const std::size_t size = std::size_t{1} << random.below(4);
    if (s.size() < size) return;
    auto v = static_cast<std::uint64_t>(kNumbers[random.below(kNumbers.size())]);
    if (random.below(4) == 0) v += random.below(33) - 16; // wraps around
    std::array<char, 8> bytes{};
    std::memcpy(bytes.data(), &v, sizeof v);
    if (random.below(4) == 0) std::reverse(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
    std::memcpy(s.data() + random.below(s.size() - size + 1), bytes.data(), size);
}

// A little more or less than what is there, as 1, 2 or 4 bytes.
void addToNumber(std::string& s, Random& random) {
    const std::size_t size = std::size_t{1} << random.below(3);
    if (s.size() < size) return;
    char* const at = s.data() + random.below(s.size() - size + 1);
    std::uint32_t v = 0;
    std::memcpy(&v, at, size);
    v += static_cast<std::uint32_t>(random.below(71)) - 35;
    std::memcpy(at, &v, size);
}

std::string piece(const std::string& s, Random& random) {
    if (s.empty()) return {};
    const std::size_t at = random.below(s.size());
    const std::size_t most = random.below(4) == 0 ? s.size() - at : std::min<std::size_t>(s.size() - at, 64);
    return s.substr(at, 1 + random.below(most));
}

// Instead of the word or number at a random place, so that texts stay what they are.
void replaceWord(std::string& s, const std::string& by, Random& random) {
    if (s.empty()) return;
    const auto inWord = [](char c) {
        return std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '_';
    };
    std::size_t begin = random.below(s.size());
    while (begin < s.size() && !inWord(s[begin])) ++begin;
    std::size_t end = begin;
    while (begin > 0 && inWord(s[begin - 1])) --begin;
    while (end < s.size() && inWord(s[end])) ++end;
    s.replace(begin, end - begin, by);
}

void changeOnce(std::string& s, const std::string& other, std::span<const std::string> words, Random& random) {
    const auto place = [&] { return random.below(s.size() + 1); };
    const auto word = [&]() -> std::string {
        if (words.empty() || random.below(4) == 0) return kTexts[random.below(kTexts.size())];
        return words[random.below(words.size())];
    };
    switch (random.below(12)) {
    case 0:
        if (!s.empty()) s[random.below(s.size())] ^= static_cast<char>(1 << random.below(8));
        return;
    case 1:
        if (!s.empty()) s[random.below(s.size())] = static_cast<char>(random.next());
        return;
    case 2:
    case 3:
        return putNumber(s, random);
    case 4:
        return addToNumber(s, random);
    case 5:
        if (!s.empty()) s.erase(random.below(s.size()), 1 + random.below(random.below(3) ? 8 : s.size()));
        return;
    case 6:
        s.insert(place(), piece(s, random));
        return;
    case 7:
        s.insert(place(), piece(other, random));
        return;
    case 8: {
        const std::string by = piece(other, random);
        const std::size_t at = place();
        s.replace(at, by.size(), by);
        return;
    }
    case 9:
        s.insert(place(), word());
        return;
    case 10:
        return replaceWord(s, word(), random);
    default:
        s.resize(place());
    }
}

} // namespace

std::uint64_t Random::next() {
    std::uint64_t x = state_ += 0x9e3779b97f4a7c15ull;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ull;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebull;
    return x ^ (x >> 31);
}

std::string mutate(const std::string& input, const std::string& other, std::span<const std::string> words,
                   std::size_t longest, Random& random) {
    std::string s = input;
    for (std::size_t n = 1 + random.below(random.below(2) ? 2 : 8); n > 0; --n) changeOnce(s, other, words, random);
    if (s.size() > longest) s.resize(longest);
    return s;
}

void collectWords(const std::string& input, std::vector<std::string>& words) {
    std::string word;
    for (const char c : input + ' ') {
        if (std::isalnum(static_cast<unsigned char>(c)) || c == '-' || c == '_' || c == '.') {
            word += c;
            continue;
        }
        if (word.size() >= 2 && word.size() <= 40 && std::ranges::find(words, word) == words.end())
            words.push_back(word);
        word.clear();
    }
}

} // namespace abbe::fuzz
