#include "volumes/brick_tree_builder.h"

#include "base/check.h"
#include "base/parallel.h"
#include "math/hash.h"

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

namespace {

constexpr int kStrata = 4; // along each axis: 64 points in a pass
constexpr int kMostPasses = 8;
// All as shares of what the limits leave open: a pass that raises less is quiet; every extreme is widened by the first
// margin, and by the second as a share of what was found.
constexpr float kQuiet = 0.02f;
constexpr float kLeastMargin = 1.f / 64;
constexpr float kSampledMargin = 0.1f;

class BrickPilot {
  public:
    BrickPilot(const PointField& field, Vec3i brick)
        : field_(field), lower_(Vec3d(brick * 8)),
          seed_(combine64(combine64(static_cast<std::uint64_t>(brick.x), static_cast<std::uint64_t>(brick.y)),
                          static_cast<std::uint64_t>(brick.z))) {}

    FieldBounds run() {
        const FieldBounds limits = field_.limits({lower_, lower_ + Vec3d(8, 8, 8)});
        if (limits.minimum == limits.maximum) return {limits.maximum, limits.maximum, limits.maximum};
        const float open = limits.maximum - limits.minimum;
        low_ = high_ = field_.at(lower_ + Vec3d(4, 4, 4));
        for (int i = 0; i < kMostPasses; ++i) {
            const float low = low_, high = high_;
            pass();
            if (i > 0 && high_ - high <= kQuiet * open && low - low_ <= kQuiet * open) break;
        }
        const float margin = kSampledMargin * (high_ - low_) + kLeastMargin * open;
        FieldBounds b;
        b.minimum = std::max(limits.minimum, low_ - margin);
        b.maximum = std::min(limits.maximum, high_ + margin);
        b.mean = std::clamp(static_cast<float>(sum_ / count_), b.minimum, b.maximum);
        return b;
    }

  private:
    void pass() {
        constexpr double size = 8.0 / kStrata;
        for (int i = 0; i < kStrata * kStrata * kStrata; ++i) {
            const std::uint64_t h = mix64(seed_ + static_cast<std::uint64_t>(++count_) * 0x9e3779b97f4a7c15ull);
            const auto unit = [h](int shift) { return static_cast<double>(h >> shift & 0xfffff) * 0x1p-20; };
            const Vec3d stratum(i % kStrata, i / kStrata % kStrata, i / (kStrata * kStrata));
            const float value = field_.at(lower_ + (stratum + Vec3d{unit(0), unit(20), unit(40)}) * size);
            low_ = std::min(low_, value);
            high_ = std::max(high_, value);
            sum_ += static_cast<double>(value);
        }
    }

    const PointField& field_;
    Vec3d lower_;
    std::uint64_t seed_;
    float low_ = 0, high_ = 0;
    double sum_ = 0;
    int count_ = 0;
};

} // namespace

BrickBounds sampleBounds(const PointField& field, Vec3i bricks) {
    std::vector<BrickTreeBuilder::Place> places;
    for (int x = 0; x < bricks.x; x += 8)
        for (int y = 0; y < bricks.y; y += 8)
            for (int z = 0; z < bricks.z; z += 8) places.push_back(Vec3i(x, y, z) / 8);
    BrickTreeBuilder builder(std::move(places));
    return builder.build([&](Vec3i place, NodeBricks& node) {
        for (int i = 0; i < 512; ++i) {
            const Vec3i brick = place * 8 + Vec3i(i >> 6, i >> 3 & 7, i & 7);
            if (brick.x < bricks.x && brick.y < bricks.y && brick.z < bricks.z)
                node[static_cast<std::size_t>(i)] = BrickPilot(field, brick).run();
        }
    });
}

} // namespace abbe
