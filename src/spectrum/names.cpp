#include "spectrum/names.h"

#include <algorithm>

namespace abbe {

bool sameName(std::string_view a, std::string_view b) {
    const auto lower = [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + ('a' - 'A')) : c; };
    return std::ranges::equal(a, b, [&](char p, char q) { return lower(p) == lower(q); });
}

} // namespace abbe
