#include "caustics/light_tracing/light_path_shares.h"

#include <algorithm>
#include <map>
#include <utility>

namespace abbe {

namespace {

void add(LightPathShare& to, const LightPathShare& s) {
    to.share += s.share;
    to.before += s.before;
    to.after += s.after;
}

// Those of the same names, as of a lamp that is placed many times.
std::vector<LightPathShare> byName(const std::vector<LightPathShare>& shares) {
    std::vector<LightPathShare> result;
    std::map<std::pair<std::string, std::string>, std::size_t> places;
    for (const LightPathShare& s : shares) {
        const auto [place, isNew] = places.emplace(std::pair(s.light, s.target), result.size());
        if (isNew)
            result.push_back(s);
        else
            add(result[place->second], s);
    }
    return result;
}

} // namespace

std::vector<LightPathShare> largestShares(const std::vector<LightPathShare>& all) {
    constexpr std::size_t kMostShares = LightPathFindings::kShares;
    std::vector<LightPathShare> shares = byName(all);
    std::erase_if(shares, [](const LightPathShare& s) { return !(s.share > 0); });
    std::ranges::stable_sort(shares, std::ranges::greater(), &LightPathShare::share);
    if (shares.size() <= kMostShares) return shares;
    LightPathShare others;
    for (std::size_t i = kMostShares - 1; i < shares.size(); ++i) add(others, shares[i]);
    shares.resize(kMostShares - 1);
    shares.push_back(others);
    return shares;
}

} // namespace abbe
