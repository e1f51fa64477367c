#include "volumes/brick_bounds.h"

#include "volumes/brick_tree_builder.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <tuple>

namespace abbe {

namespace {

using Place = BrickTreeBuilder::Place;

constexpr float kMargin = 1.f / 32;             // voxels beyond a brick where its bounds still hold
constexpr float kRounding = 1.f / (1 << 20);    // of the interpolation, relative
constexpr std::size_t kMostPlaces = 20'000'000; // bounds the memory

Vec3i operator>>(Vec3i v, int bits) { return {v.x >> bits, v.y >> bits, v.z >> bits}; }

// --- which nodes may hold something

void sortUnique(std::vector<Place>& places) {
    const auto before = [](Place a, Place b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); };
    std::sort(places.begin(), places.end(), before);
    places.erase(std::unique(places.begin(), places.end()), places.end());
}

class PlaceList {
  public:
    // The nodes of bricks [lower, upper] and one brick around them.
    void add(Vec3i lowerBrick, Vec3i upperBrick) {
        const Vec3i a = (lowerBrick - Vec3i(1, 1, 1)) >> 3, b = (upperBrick + Vec3i(1, 1, 1)) >> 3;
        const Vec3d size(b - a + Vec3i(1, 1, 1));
        if (static_cast<double>(places_.size()) + size.x * size.y * size.z > static_cast<double>(kMostPlaces))
            throw std::length_error("the grid is constant over too large a region");
        for (int x = a.x; x <= b.x; ++x)
            for (int y = a.y; y <= b.y; ++y)
                for (int z = a.z; z <= b.z; ++z) push({x, y, z});
    }
    std::vector<Place> take() {
        sortUnique(places_);
        return std::move(places_);
    }

  private:
    void push(Place p) {
        if (!places_.empty() && places_.back() == p) return;
        places_.push_back(p);
        if (places_.size() < next_) return;
        sortUnique(places_);
        next_ = 2 * places_.size() + 1'000'000;
    }
    std::size_t next_ = 1'000'000; // neighbouring leaves name the same nodes: the list is thinned now and then
    std::vector<Place> places_;
};

// A tile of 8^3 (level 1), 128^3 (2) or 4096^3 (3) voxels.
void addTile(PlaceList& list, const nanovdb::Coord& origin, int voxels, float value) {
    if (value == 0) return;
    const Vec3i first = Vec3i(origin[0], origin[1], origin[2]) >> 3;
    const int last = voxels / 8 - 1;
    list.add(first, first + Vec3i(last, last, last));
}

template <typename Node> void addTiles(PlaceList& list, const Node* nodes, std::uint32_t count, int voxels) {
    for (std::uint32_t i = 0; i < count; ++i) {
        const auto& data = *reinterpret_cast<const typename Node::DataType*>(nodes + i);
        for (std::uint32_t n = 0; n < Node::SIZE; ++n)
            if (!data.mChildMask.isOn(n)) addTile(list, nodes[i].offsetToGlobalCoord(n), voxels, data.mTable[n].value);
    }
}

std::vector<Place> placesOf(const VoxelGrid::Nano& grid) {
    PlaceList list;
    const auto& tree = grid.tree();
    const auto* leaf = tree.getFirstNode<0>();
    for (std::uint32_t i = 0; i < tree.nodeCount(0); ++i) addTile(list, leaf[i].origin(), 8, 1);
    addTiles(list, tree.getFirstNode<1>(), tree.nodeCount(1), 8);
    addTiles(list, tree.getFirstNode<2>(), tree.nodeCount(2), 128);
    const auto& root = *reinterpret_cast<const nanovdb::NanoRoot<float>::DataType*>(&tree.root());
    for (std::uint32_t i = 0; i < root.mTableSize; ++i)
        if (const auto* tile = root.tile(i); tile->isValue()) addTile(list, tile->origin(), 4096, tile->value);
    return list.take();
}

// --- bounds of one brick

// Voxels -1 … n + 1 of a brick of n along each axis, z fastest.
class Patch {
  public:
    static constexpr int kMost = 11;

    explicit Patch(int voxels) : size_(voxels + 3) {}

    int size() const { return size_; }
    float* row(int x, int y) { return v_ + (x * size_ + y) * size_; }

    FieldBounds bounds() {
        const double average = mean();
        if (average == 0) return {}; // what the margin reaches is not part of the field here
        moveEndsToMargin();
        float low = v_[0], high = v_[0];
        for (int i = 1; i < size_ * size_ * size_; ++i) {
            low = std::min(low, v_[i]);
            high = std::max(high, v_[i]);
        }
        if (low == high) return {low, low, low};
        low *= 1 - kRounding;
        high *= 1 + kRounding;
        return {low, std::clamp(static_cast<float>(average), low, high), high};
    }

  private:
    // Over the brick's own cells: voxels 0 … n, those at the ends with half the weight. 0 only if all of them are 0.
    double mean() {
        const int last = size_ - 2, cells = size_ - 3;
        double sum = 0;
        for (int x = 1; x <= last; ++x)
            for (int y = 1; y <= last; ++y) {
                const float* r = row(x, y);
                double line = 0.5 * (double(r[1]) + double(r[last]));
                for (int z = 2; z < last; ++z) line += double(r[z]);
                sum += line * (x == 1 || x == last ? 0.5 : 1.0) * (y == 1 || y == last ? 0.5 : 1.0);
            }
        return sum / (cells * cells * cells);
    }

    // A multilinear field takes its extremes over a box at corners of cells; the box ends kMargin beyond the brick, so
    // the outermost values move there, axis by axis.
    void moveEndsToMargin() {
        const auto move = [](float& end, float inner) { end = std::fma(kMargin, end - inner, inner); };
        const int last = size_ - 1;
        for (int a = 0; a < size_; ++a)
            for (int b = 0; b < size_; ++b) {
                move(row(a, b)[0], row(a, b)[1]);
                move(row(a, b)[last], row(a, b)[last - 1]);
            }
        for (int a = 0; a < size_; ++a)
            for (int b = 0; b < size_; ++b) {
                move(row(a, 0)[b], row(a, 1)[b]);
                move(row(a, last)[b], row(a, last - 1)[b]);
            }
        for (int a = 0; a < size_; ++a)
            for (int b = 0; b < size_; ++b) {
                move(row(0, a)[b], row(1, a)[b]);
                move(row(last, a)[b], row(last - 1, a)[b]);
            }
    }

    int size_;
    float v_[kMost * kMost * kMost];
};

// What is at one leaf's place in the grid: its values, or a constant.
struct Slot {
    const float* values = nullptr;
    float constant = 0;
};

// The leaves of one node, `width` of them along each axis, and one around them.
class NodeSlots {
  public:
    NodeSlots(nanovdb::DefaultReadAccessor<float>& accessor, Place place, int width) {
        for (int x = 0; x < width + 2; ++x)
            for (int y = 0; y < width + 2; ++y)
                for (int z = 0; z < width + 2; ++z) {
                    const nanovdb::Coord c((place.x * width + x - 1) * 8, (place.y * width + y - 1) * 8,
                                           (place.z * width + z - 1) * 8);
                    Slot& slot = slots_[x][y][z];
                    if (const auto* leaf = accessor.probeLeaf(c))
                        slot.values = leaf->data()->mValues;
                    else
                        slot.constant = accessor.getValue(c);
                }
    }

    // The value of slots [a, b) if it is one constant.
    bool constant(Vec3i a, Vec3i b, float& value) const {
        value = slots_[a.x][a.y][a.z].constant;
        for (int x = a.x; x < b.x; ++x)
            for (int y = a.y; y < b.y; ++y)
                for (int z = a.z; z < b.z; ++z)
                    if (slots_[x][y][z].values || slots_[x][y][z].constant != value) return false;
        return true;
    }

    // The patch of the brick whose first voxel is `at`, counted from that of the slots.
    void read(Vec3i at, Patch& patch) const {
        const Vec3i first = at - Vec3i(1, 1, 1);
        for (int i = 0; i < patch.size(); ++i)
            for (int j = 0; j < patch.size(); ++j) {
                const int x = first.x + i, y = first.y + j;
                const Slot* row = slots_[x >> 3][y >> 3];
                const int offset = (x & 7) << 6 | (y & 7) << 3;
                float* out = patch.row(i, j);
                for (int k = 0; k < patch.size(); ++k) {
                    const int z = first.z + k;
                    const Slot& slot = row[z >> 3];
                    out[k] = slot.values ? slot.values[offset + (z & 7)] : slot.constant;
                }
            }
    }

  private:
    Slot slots_[10][10][10];
};

void fillNode(const VoxelGrid::Nano& grid, Place place, int halvings, NodeBricks& bricks) {
    auto accessor = grid.getAccessor();
    const int width = 8 >> halvings, voxels = 8 >> halvings; // leaves of the node and voxels of a brick, on each axis
    const NodeSlots slots(accessor, place, width);
    float value = 0;
    if (slots.constant({0, 0, 0}, Vec3i(1, 1, 1) * (width + 2), value)) {
        bricks.fill({value, value, value});
        return;
    }
    Patch patch(voxels);
    for (int i = 0; i < 512; ++i) {
        const Vec3i at = Vec3i(8, 8, 8) + Vec3i(i >> 6, i >> 3 & 7, i & 7) * voxels;
        FieldBounds& bounds = bricks[static_cast<std::size_t>(i)];
        const Vec3i end = at + Vec3i(1, 1, 1) * (voxels + 1);
        if (slots.constant((at - Vec3i(1, 1, 1)) >> 3, (end >> 3) + Vec3i(1, 1, 1), value)) {
            bounds = {value, value, value};
            continue;
        }
        slots.read(at, patch);
        bounds = patch.bounds();
    }
}

// The same places, of nodes of finer bricks.
std::vector<Place> halved(const std::vector<Place>& places, int halvings) {
    std::vector<Place> result;
    const int parts = 1 << halvings;
    for (const Place p : places)
        for (int i = 0; i < parts * parts * parts; ++i)
            result.push_back(p * parts + Vec3i(i / (parts * parts), i / parts % parts, i % parts));
    return result;
}

// --- bounds that hold some bricks away

// One axis of the box filter: extremes over `radius` bricks on both sides.
struct Neighbourhood {
    int radius = 1;
    int size = 8 + 2 * radius;
    std::vector<FieldBounds> values = std::vector<FieldBounds>(static_cast<std::size_t>(size * size * size));

    FieldBounds& at(int x, int y, int z) { return values[static_cast<std::size_t>((x * size + y) * size + z)]; }

    void filter(int axis) {
        std::vector<FieldBounds> line(static_cast<std::size_t>(size));
        const auto place = [&](int a, int b, int i) -> FieldBounds& {
            return axis == 0 ? at(i, a, b) : axis == 1 ? at(a, i, b) : at(a, b, i);
        };
        for (int a = 0; a < size; ++a)
            for (int b = 0; b < size; ++b) {
                for (int i = 0; i < size; ++i) line[static_cast<std::size_t>(i)] = place(a, b, i);
                for (int i = radius; i < size - radius; ++i)
                    for (int k = i - radius; k <= i + radius; ++k) {
                        FieldBounds& out = place(a, b, i);
                        out.minimum = std::min(out.minimum, line[static_cast<std::size_t>(k)].minimum);
                        out.maximum = std::max(out.maximum, line[static_cast<std::size_t>(k)].maximum);
                    }
            }
    }
};

void fillDilated(const BrickBounds& tight, Place place, int radius, NodeBricks& bricks) {
    Neighbourhood n{radius};
    for (int x = 0; x < n.size; ++x)
        for (int y = 0; y < n.size; ++y)
            for (int z = 0; z < n.size; ++z)
                n.at(x, y, z) = BrickTreeBuilder::brick(tight, place * 8 + Vec3i(x - radius, y - radius, z - radius));
    for (int axis = 0; axis < 3; ++axis) n.filter(axis);
    for (int i = 0; i < 512; ++i)
        bricks[static_cast<std::size_t>(i)] = n.at(radius + (i >> 6), radius + (i >> 3 & 7), radius + (i & 7));
}

BrickBounds dilated(const BrickBounds& tight, int radius) {
    std::vector<Place> places;
    const int reach = (radius + 7) / 8;
    for (const Place p : BrickTreeBuilder::placesOf(tight))
        for (int x = -reach; x <= reach; ++x)
            for (int y = -reach; y <= reach; ++y)
                for (int z = -reach; z <= reach; ++z) places.push_back(p + Vec3i(x, y, z));
    sortUnique(places);
    BrickTreeBuilder builder(std::move(places));
    return builder.build([&](Place place, NodeBricks& bricks) { fillDilated(tight, place, radius, bricks); });
}

} // namespace

BrickBounds BrickBounds::build(const VoxelGrid& grid, float dilation, int halvings) {
    if (grid.empty()) return {};
    BrickTreeBuilder builder(halved(placesOf(grid.nano()), halvings));
    BrickBounds tight =
        builder.build([&](Place place, NodeBricks& bricks) { fillNode(grid.nano(), place, halvings, bricks); });
    const int radius = static_cast<int>(std::ceil((dilation + kMargin) / static_cast<float>(8 >> halvings)));
    return dilation > 0 && !tight.empty() ? dilated(tight, radius) : std::move(tight);
}

std::size_t BrickBounds::bytes() const {
    return sizeof(*this) + nodes_.capacity() * sizeof(Node) + bricks_.capacity() * sizeof(FieldBounds);
}

FieldBounds BrickBounds::at(Vec3 p) const {
    const float limit = static_cast<float>(kFarthestVoxel);
    if (!(std::abs(p.x) < limit && std::abs(p.y) < limit && std::abs(p.z) < limit)) return {};
    const auto local = [](float x, int origin) {
        return static_cast<std::uint32_t>((static_cast<int>(std::floor(x)) >> 3) - origin);
    };
    return brick(local(p.x, origin_.x), local(p.y, origin_.y), local(p.z, origin_.z));
}

FieldBounds BrickBounds::over(const Bounds3d& box) const {
    constexpr double kMostBricks = 4096; // a larger box is rather compared with everything
    const auto brickOf = [](double x) { return std::floor(x / 8); };
    const Vec3d a(brickOf(box.lower.x), brickOf(box.lower.y), brickOf(box.lower.z));
    const Vec3d b(brickOf(box.upper.x), brickOf(box.upper.y), brickOf(box.upper.z));
    const Vec3d count = b - a + Vec3d(1, 1, 1);
    const double limit = kFarthestVoxel;
    const bool near =
        std::max({std::abs(a.x), std::abs(a.y), std::abs(a.z), std::abs(b.x), std::abs(b.y), std::abs(b.z)}) < limit;
    if (empty()) return {};
    if (!near || !(count.x * count.y * count.z <= kMostBricks)) return {0, 0, maximum()};
    FieldBounds all{kInfinity, 0, 0};
    double sum = 0;
    for (int x = static_cast<int>(a.x); x <= static_cast<int>(b.x); ++x)
        for (int y = static_cast<int>(a.y); y <= static_cast<int>(b.y); ++y)
            for (int z = static_cast<int>(a.z); z <= static_cast<int>(b.z); ++z) {
                const Vec3i c = Vec3i(x, y, z) - origin_;
                const FieldBounds one = brick(static_cast<std::uint32_t>(c.x), static_cast<std::uint32_t>(c.y),
                                              static_cast<std::uint32_t>(c.z));
                all.minimum = std::min(all.minimum, one.minimum);
                all.maximum = std::max(all.maximum, one.maximum);
                sum += static_cast<double>(one.mean);
            }
    all.mean = static_cast<float>(sum / (count.x * count.y * count.z));
    return all;
}

FieldBounds BrickBounds::brick(std::uint32_t x, std::uint32_t y, std::uint32_t z) const {
    if (empty() || ((x | y | z) >> (3 * levels_)) != 0) return {};
    std::uint32_t index = root_;
    for (int level = levels_;; --level) {
        const Node& node = nodes_[index];
        if (node.constant()) return node.bounds;
        const int shift = 3 * (level - 1);
        const std::uint32_t child = (x >> shift & 7) << 6 | (y >> shift & 7) << 3 | (z >> shift & 7);
        if (!node.has(child)) return {};
        index = node.index(child);
        if (level == 1) return bricks_[index];
    }
}

} // namespace abbe
