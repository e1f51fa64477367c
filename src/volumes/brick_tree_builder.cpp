#include "volumes/brick_tree_builder.h"

#include "base/check.h"
#include "base/parallel.h"

#include <algorithm>
#include <tuple>

namespace abbe {

namespace {

std::tuple<int, int, int> key(Vec3i v) { return {v.x, v.y, v.z}; }
Vec3i shifted(Vec3i v, int bits) { return {v.x >> bits, v.y >> bits, v.z >> bits}; }
std::uint32_t childOf(Vec3i v) { return static_cast<std::uint32_t>((v.x & 7) << 6 | (v.y & 7) << 3 | (v.z & 7)); }

void setRanks(std::span<const std::uint64_t, 8> mask, std::uint16_t* rank) {
    int count = 0;
    for (int i = 0; i < 8; ++i) {
        rank[i] = static_cast<std::uint16_t>(count);
        count += std::popcount(mask[i]);
    }
}

bool isConstant(const FieldBounds& b) { return b.minimum == b.maximum; }

} // namespace

void BrickTreeBuilder::forEachPlace(const std::function<void(std::size_t)>& body) { parallelFor(places_.size(), body); }

void BrickTreeBuilder::store(Leaf& leaf, const NodeBricks& bricks) {
    FieldBounds& all = leaf.node.bounds;
    all = {bricks[0].minimum, 0, bricks[0].maximum};
    double sum = 0;
    bool constant = true;
    for (std::uint32_t i = 0; i < 512; ++i) {
        const FieldBounds& b = bricks[i];
        all.minimum = std::min(all.minimum, b.minimum);
        all.maximum = std::max(all.maximum, b.maximum);
        sum += b.mean;
        constant = constant && isConstant(b) && b.maximum == bricks[0].maximum;
        if (b.maximum > 0) leaf.node.mask[i >> 6] |= std::uint64_t{1} << (i & 63);
    }
    all.mean = constant ? all.maximum : static_cast<float>(sum / 512);
    if (constant) {
        leaf.node.first = BrickBounds::kConstant;
        return;
    }
    setRanks(leaf.node.mask, leaf.node.rank);
    for (const FieldBounds& b : bricks)
        if (b.maximum > 0) leaf.bricks.push_back(b);
}

BrickBounds BrickTreeBuilder::link() {
    BrickBounds bounds;
    std::vector<Placed> level;
    Bounds3T<int> filled{{kFarthestVoxel, kFarthestVoxel, kFarthestVoxel},
                         {-kFarthestVoxel, -kFarthestVoxel, -kFarthestVoxel}};
    for (std::size_t i = 0; i < places_.size(); ++i)
        if (leaves_[i].node.bounds.maximum > 0) filled.add(places_[i]);
    if (filled.empty()) return bounds;
    for (std::size_t i = 0; i < places_.size(); ++i) {
        Leaf& leaf = leaves_[i];
        if (!(leaf.node.bounds.maximum > 0)) continue;
        if (!leaf.node.constant()) {
            leaf.node.first = static_cast<std::uint32_t>(bounds.bricks_.size());
            bounds.bricks_.insert(bounds.bricks_.end(), leaf.bricks.begin(), leaf.bricks.end());
        }
        level.push_back({places_[i] - filled.lower, leaf.node});
        leaf = Leaf();
    }
    ABBE_CHECK(bounds.bricks_.size() < BrickBounds::kConstant);
    bounds.bricks_.shrink_to_fit();
    bounds.origin_ = filled.lower * 8;
    bounds.size_ = (filled.upper - filled.lower + Vec3i(1, 1, 1)) * 8;
    bounds.levels_ = 1;
    while (level.size() > 1 || level[0].place != Vec3i()) {
        level = parents(bounds, std::move(level));
        ++bounds.levels_;
    }
    bounds.root_ = static_cast<std::uint32_t>(bounds.nodes_.size());
    bounds.nodes_.push_back(level[0].node);
    bounds.nodes_.shrink_to_fit();
    return bounds;
}

// Moves the nodes of one level into the tree and returns those above them.
std::vector<BrickTreeBuilder::Placed> BrickTreeBuilder::parents(BrickBounds& bounds, std::vector<Placed> level) {
    std::sort(level.begin(), level.end(), [](const Placed& a, const Placed& b) {
        const auto ka = key(shifted(a.place, 3)), kb = key(shifted(b.place, 3));
        return ka != kb ? ka < kb : childOf(a.place) < childOf(b.place);
    });
    std::vector<Placed> result;
    for (std::size_t begin = 0, end = 0; begin < level.size(); begin = end) {
        const Vec3i place = shifted(level[begin].place, 3);
        while (end < level.size() && shifted(level[end].place, 3) == place) ++end;
        const std::span<const Placed> children(level.data() + begin, end - begin);
        result.push_back(parent(place, children, static_cast<std::uint32_t>(bounds.nodes_.size())));
        if (!result.back().node.constant())
            for (const Placed& child : children) bounds.nodes_.push_back(child.node);
    }
    return result;
}

BrickTreeBuilder::Placed BrickTreeBuilder::parent(Vec3i place, std::span<const Placed> children, std::uint32_t first) {
    Placed result{place, {}};
    FieldBounds& all = result.node.bounds;
    all = children[0].node.bounds;
    if (children.size() < 512) all.minimum = 0;
    double sum = 0;
    bool constant = children.size() == 512;
    for (const Placed& child : children) {
        const FieldBounds& b = child.node.bounds;
        all.minimum = std::min(all.minimum, b.minimum);
        all.maximum = std::max(all.maximum, b.maximum);
        sum += b.mean;
        constant = constant && child.node.constant() && b.mean == children[0].node.bounds.mean;
        const std::uint32_t slot = childOf(child.place);
        result.node.mask[slot >> 6] |= std::uint64_t{1} << (slot & 63);
    }
    setRanks(result.node.mask, result.node.rank);
    all.mean = constant ? all.maximum : static_cast<float>(sum / 512);
    result.node.first = constant ? BrickBounds::kConstant : first;
    return result;
}

std::vector<BrickTreeBuilder::Place> BrickTreeBuilder::placesOf(const BrickBounds& bounds) {
    std::vector<Place> places;
    if (!bounds.empty()) visit(bounds, bounds.root_, bounds.levels_, {0, 0, 0}, places);
    for (Place& p : places) p = p + shifted(bounds.origin_, 3);
    return places;
}

void BrickTreeBuilder::visit(const BrickBounds& b, std::uint32_t index, int level, Vec3i place,
                             std::vector<Place>& places) {
    const BrickBounds::Node& node = b.nodes_[index];
    if (level == 1) {
        places.push_back(place);
        return;
    }
    for (std::uint32_t child = 0; child < 512; ++child) {
        if (!node.constant() && !node.has(child)) continue;
        const Vec3i at = place * 8 + Vec3i(static_cast<int>(child >> 6), child >> 3 & 7, child & 7);
        visit(b, node.constant() ? index : node.index(child), level - 1, at, places);
    }
}

FieldBounds BrickTreeBuilder::brick(const BrickBounds& bounds, Vec3i globalBrick) {
    const Vec3i c = globalBrick - bounds.origin_;
    return bounds.brick(static_cast<std::uint32_t>(c.x), static_cast<std::uint32_t>(c.y),
                        static_cast<std::uint32_t>(c.z));
}

} // namespace abbe
