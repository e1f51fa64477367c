#include "volumes/voxel_grid.h"

#include "base/check.h"

#include <algorithm>
#include <cstdlib>
#include <new>
#include <sys/mman.h>

namespace abbe {

namespace {

constexpr std::size_t kAlignment = 64;

static_assert(kAlignment % NANOVDB_DATA_ALIGNMENT == 0);

// A level's nodes in the bytes: an array from `first` on.
struct NodeArray {
    std::uint64_t first = 0, stride = 1, count = 0; // first: from the start of the bytes
    bool contains(std::uint64_t position) const {
        return position >= first && (position - first) % stride == 0 && (position - first) / stride < count;
    }
    std::uint64_t end() const { return first + stride * count; }
};

// Checks that following any child leads to a node of the right level inside the bytes.
template <typename Build> class LayoutCheck {
  public:
    explicit LayoutCheck(const GridBytes& bytes) : bytes_(bytes) {}

    bool passes() {
        if (bytes_.size() < sizeof(nanovdb::GridData) + sizeof(nanovdb::TreeData<3>)) return false;
        const auto& data = *reinterpret_cast<const nanovdb::GridData*>(bytes_.data());
        if (data.mMagic != NANOVDB_MAGIC_NUMBER || data.mVersion.getMajor() != NANOVDB_MAJOR_VERSION_NUMBER)
            return false;
        if (data.mGridSize > bytes_.size()) return false;
        const auto& tree = *reinterpret_cast<const nanovdb::TreeData<3>*>(data.treePtr());
        return places(tree) && root(tree) && children<Upper>(upper_, lower_) && children<Lower>(lower_, leaf_);
    }

  private:
    using Upper = nanovdb::NanoUpper<Build>;
    using Lower = nanovdb::NanoLower<Build>;
    using Leaf = nanovdb::NanoLeaf<Build>;
    using Root = nanovdb::NanoRoot<Build>;

    bool place(NodeArray& array, std::uint64_t offset, std::uint64_t count, std::uint64_t stride) const {
        array = {sizeof(nanovdb::GridData) + (offset % (std::uint64_t{1} << 62)), stride, count};
        return count == 0 || (array.first % NANOVDB_DATA_ALIGNMENT == 0 && array.end() <= bytes_.size());
    }
    bool places(const nanovdb::TreeData<3>& tree) {
        return place(leaf_, tree.mNodeOffset[0], tree.mNodeCount[0], sizeof(Leaf)) &&
               place(lower_, tree.mNodeOffset[1], tree.mNodeCount[1], sizeof(Lower)) &&
               place(upper_, tree.mNodeOffset[2], tree.mNodeCount[2], sizeof(Upper));
    }
    bool root(const nanovdb::TreeData<3>& tree) const {
        NodeArray place1;
        if (!place(place1, tree.mNodeOffset[3], 1, sizeof(typename Root::DataType))) return false;
        const auto& data = *reinterpret_cast<const typename Root::DataType*>(bytes_.data() + place1.first);
        const std::uint64_t tileBytes = std::uint64_t{data.mTableSize} * sizeof(typename Root::DataType::Tile);
        if (place1.end() + tileBytes > bytes_.size()) return false;
        for (std::uint32_t i = 0; i < data.mTableSize; ++i) {
            const auto* tile = data.tile(i);
            if (tile->child != 0 && !upper_.contains(place1.first + static_cast<std::uint64_t>(tile->child)))
                return false;
        }
        return true;
    }
    template <typename Node> bool children(const NodeArray& nodes, const NodeArray& below) const {
        for (std::uint64_t i = 0; i < nodes.count; ++i) {
            const std::uint64_t position = nodes.first + i * nodes.stride;
            const auto& data = *reinterpret_cast<const typename Node::DataType*>(bytes_.data() + position);
            for (auto it = data.mChildMask.beginOn(); it; ++it)
                if (!below.contains(position + static_cast<std::uint64_t>(data.mTable[*it].child))) return false;
        }
        return true;
    }

    const GridBytes& bytes_;
    NodeArray leaf_, lower_, upper_;
};

bool inRange(const nanovdb::CoordBBox& box) {
    for (int i = 0; i < 3; ++i)
        if (box.min()[i] < -kFarthestVoxel || box.max()[i] > kFarthestVoxel) return false;
    return true;
}

Vec3i vec(const nanovdb::Coord& c) { return {c[0], c[1], c[2]}; }

} // namespace

void GridBytes::Release::operator()(std::byte* p) const { std::free(p); }

// Lookups jump about: with large pages they find their addresses sooner.
GridBytes::GridBytes(std::size_t size) : size_(size) {
    constexpr std::size_t kLargePage = std::size_t{1} << 21;
    const std::size_t alignment = size >= 2 * kLargePage ? kLargePage : kAlignment;
    const std::size_t rounded = (size + alignment - 1) / alignment * alignment;
    data_.reset(static_cast<std::byte*>(std::aligned_alloc(alignment, std::max(rounded, alignment))), Release{});
    if (!data_) throw std::bad_alloc();
    if (alignment == kLargePage) ::madvise(data_.get(), rounded, MADV_HUGEPAGE);
}

template <typename Value>
std::optional<BasicVoxelGrid<Value>> BasicVoxelGrid<Value>::adopt(GridBytes bytes, GridFacts facts) {
    using Build = typename VoxelValue<Value>::Build;
    if (!LayoutCheck<Build>(bytes).passes()) return std::nullopt;
    const auto inverse = facts.indexToWorld.inverse();
    ABBE_CHECK(inverse);
    BasicVoxelGrid grid;
    grid.bytes_ = std::move(bytes);
    const auto& tree = grid.nano().tree();
    if (grid.nano().gridType() != VoxelValue<Value>::kType) return std::nullopt;
    if (VoxelValue<Value>::read(tree.background()) != Value{}) return std::nullopt;
    grid.facts_ = std::move(facts);
    grid.worldToIndex_ = *inverse;
    if (grid.activeVoxels() == 0) {
        grid.lower_ = {0, 0, 0};
        grid.upper_ = {-1, -1, -1};
        return grid;
    }
    if (!inRange(tree.bbox())) return std::nullopt;
    grid.lower_ = vec(tree.bbox().min());
    grid.upper_ = vec(tree.bbox().max());
    grid.support_.add(Vec3(grid.lower_ - Vec3i(1, 1, 1)));
    grid.support_.add(Vec3(grid.upper_ + Vec3i(1, 1, 1)));
    grid.minimum_ = VoxelValue<Value>::read(tree.root().minimum());
    grid.maximum_ = VoxelValue<Value>::read(tree.root().maximum());
    return grid;
}

template <typename Value> Bounds3d BasicVoxelGrid<Value>::worldBounds() const {
    Bounds3d box;
    if (empty()) return box;
    for (int corner = 0; corner < 8; ++corner) {
        const Vec3 p{corner & 1 ? support_.upper.x : support_.lower.x, corner & 2 ? support_.upper.y : support_.lower.y,
                     corner & 4 ? support_.upper.z : support_.lower.z};
        box.add(facts_.indexToWorld.point(Vec3d(p)));
    }
    return box;
}

template class BasicVoxelGrid<float>;
template class BasicVoxelGrid<Vec3>;

std::uint64_t countOutside(const VectorGrid& grid, float lower, float upper) {
    const auto outside = [=](const nanovdb::Vec3f& v) {
        const float low = std::min({v[0], v[1], v[2]}), high = std::max({v[0], v[1], v[2]});
        return !(low >= lower && high <= upper);
    };
    const auto& tree = grid.nano().tree();
    std::uint64_t count = 0;
    const auto* leaf = tree.getFirstNode<0>();
    for (std::uint32_t i = 0; i < tree.nodeCount(0); ++i)
        for (std::uint32_t n = 0; n < 512; ++n) count += leaf[i].isActive(n) && outside(leaf[i].getValue(n));
    const auto tiles = [&](const auto* nodes, std::uint32_t nodeCount, std::uint64_t voxels) {
        for (std::uint32_t i = 0; i < nodeCount; ++i) {
            using Node = std::remove_cvref_t<decltype(nodes[i])>;
            const auto& data = *reinterpret_cast<const typename Node::DataType*>(nodes + i);
            for (std::uint32_t n = 0; n < Node::SIZE; ++n)
                if (!data.mChildMask.isOn(n) && data.mValueMask.isOn(n) && outside(data.mTable[n].value))
                    count += voxels;
        }
    };
    tiles(tree.getFirstNode<1>(), tree.nodeCount(1), 512);
    tiles(tree.getFirstNode<2>(), tree.nodeCount(2), std::uint64_t{128} * 128 * 128);
    return count;
}

} // namespace abbe
