#include "guiding/space_tree.h"

#include <algorithm>
#include <array>

namespace abbe {

namespace {

struct Cut {
    int axis = 3; // 3: none
    float at = 0;
};

constexpr std::size_t kEnough = 500; // places by which a median is found

// Through the median along the longest side of what holds the places, or along the next one if all are in one plane.
Cut cutThrough(std::span<const SpaceTree::Place> places) {
    Vec3 lower = places[0].p, upper = lower;
    for (const SpaceTree::Place& place : places) {
        lower = min(lower, place.p);
        upper = max(upper, place.p);
    }
    const Vec3 size = upper - lower;
    std::array axes = {0, 1, 2};
    std::ranges::stable_sort(axes, [&](int a, int b) { return size[a] > size[b]; });
    const std::size_t step = std::max<std::size_t>(1, places.size() / kEnough);
    std::vector<float> along;
    for (const int axis : axes) {
        along.clear();
        for (std::size_t i = 0; i < places.size(); i += step) along.push_back(places[i].p[axis]);
        const auto middle = along.begin() + static_cast<std::ptrdiff_t>(along.size() / 2);
        std::ranges::nth_element(along, middle);
        const float at = *middle;
        const auto below = static_cast<std::size_t>(std::ranges::count_if(along, [at](float v) { return v < at; }));
        if (4 * below >= along.size()) return {axis, at};
    }
    return {};
}

// Those that are `first` come first; how many these are. Without a branch, which would be foreseen every other time.
template <typename First>
std::size_t putFirst(std::span<SpaceTree::Place> places, std::vector<SpaceTree::Place>& others, First first) {
    others.resize(std::max(others.size(), places.size()));
    std::size_t count = 0, otherCount = 0;
    for (const SpaceTree::Place place : places) {
        const bool is = first(place);
        places[count] = others[otherCount] = place;
        count += is;
        otherCount += !is;
    }
    std::copy_n(others.begin(), otherCount, places.begin() + static_cast<std::ptrdiff_t>(count));
    return count;
}

} // namespace

SpaceTree::SpaceTree(std::vector<Place>& places, std::size_t least) : nodes_(kInMedium + 1), numbers_(nodes_.size()) {
    std::vector<Place> others;
    std::span<Place> left = places;
    for (std::size_t face = 0; face <= kInMedium; ++face) {
        const std::size_t count = putFirst(left, others, [face](const Place& place) { return place.face == face; });
        divide(face, left.first(count), places.size() - left.size(), least, others);
        left = left.subspan(count);
    }
    for (std::uint32_t face = 0; face <= kInMedium; ++face) depths_[face] = depth(face);
}

void SpaceTree::divide(std::size_t node, std::span<Place> places, std::size_t before, std::size_t least,
                       std::vector<Place>& others) {
    const Cut cut = places.size() >= 2 * least ? cutThrough(places) : Cut();
    if (cut.axis == 3) {
        nodes_[node].next = static_cast<std::uint32_t>(node) & 0x3fffffff;
        numbers_[node] = static_cast<std::uint32_t>(ends_.size());
        ends_.push_back(before + places.size());
        return;
    }
    const std::size_t below = putFirst(places, others, [cut](const Place& p) { return p.p[cut.axis] < cut.at; });
    const std::size_t children = nodes_.size();
    nodes_.resize(children + 2);
    numbers_.resize(children + 2);
    nodes_[node].split = cut.at;
    nodes_[node].axis = static_cast<std::uint32_t>(cut.axis) & 3;
    nodes_[node].next = static_cast<std::uint32_t>(children) & 0x3fffffff;
    divide(children, places.first(below), before, least, others);
    divide(children + 1, places.subspan(below), before + below, least, others);
}

std::uint32_t SpaceTree::depth(std::uint32_t node) const {
    const Node& n = nodes_[node];
    return n.next == node ? 0 : 1 + std::max(depth(n.next), depth(n.next + 1));
}

} // namespace abbe
