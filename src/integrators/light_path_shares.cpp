#include "integrators/light_path_shares.h"

#include <algorithm>

namespace abbe {

std::vector<LightPathShare> largestShares(std::vector<LightPathShare> shares) {
    constexpr std::size_t kMost = LightPathFindings::kShares;
    std::erase_if(shares, [](const LightPathShare& s) { return !(s.share > 0); });
    std::ranges::stable_sort(shares, std::ranges::greater(), &LightPathShare::share);
    if (shares.size() <= kMost) return shares;
    LightPathShare others;
    for (std::size_t i = kMost - 1; i < shares.size(); ++i) {
        others.share += shares[i].share;
        others.before += shares[i].before;
        others.after += shares[i].after;
    }
    shares.resize(kMost - 1);
    shares.push_back(others);
    return shares;
}

} // namespace abbe
