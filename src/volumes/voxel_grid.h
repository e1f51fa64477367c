// Sparse voxel grids in memory: one field each, in NanoVDB's layout.
#pragma once

#include "math/bounds.h"
#include "math/transform.h"
#include "math/vec.h"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <nanovdb/NanoVDB.h>
#include <optional>
#include <string>
#include <utility>

namespace abbe {

using Vec3i = Vec3T<int>;

// No grid has active voxels whose coordinates are further from 0 than this.
inline constexpr int kFarthestVoxel = 1 << 26;

// Bytes of one NanoVDB grid, aligned as it asks for.
class GridBytes {
  public:
    GridBytes() = default;
    // Not initialised. Throws std::bad_alloc.
    explicit GridBytes(std::size_t size);
    std::byte* data() { return data_.get(); }
    const std::byte* data() const { return data_.get(); }
    std::size_t size() const { return size_; }

  private:
    struct Release {
        void operator()(std::byte*) const;
    };
    std::unique_ptr<std::byte[], Release> data_;
    std::size_t size_ = 0;
};

// What the field means; from the file.
enum class VolumeClass : std::uint8_t { unknown, fog, levelSet, staggered };

struct GridFacts {
    std::string name;
    std::string unit; // as the file states it; usually nothing
    VolumeClass volumeClass = VolumeClass::unknown;
    Transform indexToWorld; // voxel (i, j, k) has its centre at indexToWorld.point({i, j, k}); invertible
};

// How NanoVDB names and stores a field's values.
template <typename Value> struct VoxelValue;
template <> struct VoxelValue<float> {
    using Build = float;
    static float read(float v) { return v; }
    static constexpr nanovdb::GridType kType = nanovdb::GridType::Float;
};
template <> struct VoxelValue<Vec3> {
    using Build = nanovdb::Vec3f;
    static Vec3 read(const nanovdb::Vec3f& v) { return {v[0], v[1], v[2]}; }
    static constexpr nanovdb::GridType kType = nanovdb::GridType::Vec3f;
};

// Reads a grid for one thread: remembers the last nodes, so that near points are cheap. A few cache lines, made on the
// stack for a ray or a sample. Must not outlive its grid.
template <typename Value> class VoxelSampler {
  public:
    using Nano = nanovdb::NanoGrid<typename VoxelValue<Value>::Build>;

    explicit VoxelSampler(const Nano& grid, const Bounds3& support)
        : accessor_(grid.getAccessor()), lower_(support.lower), upper_(support.upper) {}

    // The field at a point in index space: trilinear between voxel centres, 0 outside the grid (and at NaN). A constant
    // neighbourhood gives its value exactly.
    Value at(Vec3 p) noexcept {
        const bool inside =
            p.x > lower_.x && p.y > lower_.y && p.z > lower_.z && p.x < upper_.x && p.y < upper_.y && p.z < upper_.z;
        if (!inside) return Value{};
        const Vec3 cell{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
        const Vec3 f = p - cell;
        const nanovdb::Coord c(static_cast<int>(cell.x), static_cast<int>(cell.y), static_cast<int>(cell.z));
        switch (((c[0] & 7) == 7) << 2 | ((c[1] & 7) == 7) << 1 | ((c[2] & 7) == 7)) {
        case 0:
            return inLeaf(c, f);
        case 1:
            return acrossLeaves<1>(c, f);
        case 2:
            return acrossLeaves<2>(c, f);
        case 3:
            return acrossLeaves<3>(c, f);
        case 4:
            return acrossLeaves<4>(c, f);
        case 5:
            return acrossLeaves<5>(c, f);
        case 6:
            return acrossLeaves<6>(c, f);
        default:
            return acrossLeaves<7>(c, f);
        }
    }

    // The value of one voxel.
    Value voxel(Vec3i c) noexcept { return VoxelValue<Value>::read(accessor_.getValue({c.x, c.y, c.z})); }

  private:
    static float mix(float a, float b, float t) { return std::fma(t, b - a, a); }
    static Vec3 mix(Vec3 a, Vec3 b, float t) { return {mix(a.x, b.x, t), mix(a.y, b.y, t), mix(a.z, b.z, t)}; }

    // All eight corners in one leaf, or in one tile, which is constant.
    Value inLeaf(const nanovdb::Coord& c, Vec3 f) noexcept {
        const auto* leaf = accessor_.probeLeaf(c);
        if (!leaf) return VoxelValue<Value>::read(accessor_.getValue(c));
        const std::uint32_t o = leaf->CoordToOffset(c);
        const auto v = [&](std::uint32_t i) { return VoxelValue<Value>::read(leaf->getValue(o + i)); };
        const Value a = mix(mix(v(0), v(1), f.z), mix(v(8), v(9), f.z), f.y);
        const Value b = mix(mix(v(64), v(65), f.z), mix(v(72), v(73), f.z), f.y);
        return mix(a, b, f.x);
    }
    // Corners in two, four or eight leaves, each looked up once. Bit 2 of a corner is x, bit 0 z; `Crossed` has the
    // bits of the axes along which the cell leaves its leaf.
    template <int Crossed> Value acrossLeaves(const nanovdb::Coord& c, Vec3 f) noexcept {
        Value v[8];
        unrolled([&](auto part) {
            if constexpr ((part() & ~Crossed) == 0) {
                const nanovdb::Coord first = c.offsetBy(part() >> 2, part() >> 1 & 1, part() & 1);
                const auto* leaf = accessor_.probeLeaf(first);
                if (!leaf) v[part()] = VoxelValue<Value>::read(accessor_.getValue(first));
                unrolled([&](auto corner) {
                    if constexpr ((corner() & Crossed) == part()) {
                        const auto at = c.offsetBy(corner() >> 2, corner() >> 1 & 1, corner() & 1);
                        v[corner()] =
                            leaf ? VoxelValue<Value>::read(leaf->getValue(leaf->CoordToOffset(at))) : v[part()];
                    }
                });
            }
        });
        return mix(mix(mix(v[0], v[1], f.z), mix(v[2], v[3], f.z), f.y),
                   mix(mix(v[4], v[5], f.z), mix(v[6], v[7], f.z), f.y), f.x);
    }
    // body(0) … body(7), as constants.
    template <typename Body> static void unrolled(const Body& body) noexcept {
        [&]<int... I>(std::integer_sequence<int, I...>) { (body(std::integral_constant<int, I>()), ...); }
        (std::make_integer_sequence<int, 8>());
    }

    nanovdb::DefaultReadAccessor<typename VoxelValue<Value>::Build> accessor_;
    Vec3 lower_, upper_;
};

// A field over index space. Immutable; any number of threads may sample it.
template <typename Value> class BasicVoxelGrid {
  public:
    using Sampler = VoxelSampler<Value>;
    using Nano = typename Sampler::Nano;

    // nullopt when the bytes are no intact grid of this type, or it has voxels beyond kFarthestVoxel. Every node offset
    // is checked, so that sampling stays inside the bytes whatever they are. Values of inactive voxels count, and the
    // background must be 0. Requires: facts.indexToWorld invertible.
    static std::optional<BasicVoxelGrid> adopt(GridBytes bytes, GridFacts facts);

    const GridFacts& facts() const { return facts_; }
    const std::string& name() const { return facts_.name; }
    const Transform& indexToWorld() const { return facts_.indexToWorld; }
    const Transform& worldToIndex() const { return worldToIndex_; }

    bool empty() const { return activeVoxels() == 0; }
    // Corners of the active voxels in index space, both included; lower > upper when empty.
    Vec3i lowerVoxel() const { return lower_; }
    Vec3i upperVoxel() const { return upper_; }
    // Outside this box in index space (one voxel larger on all sides) the field is 0. Empty when the grid is.
    const Bounds3& support() const { return support_; }
    // Axis-aligned box around the support in the grid's world. Empty when the grid is.
    Bounds3d worldBounds() const;

    std::uint64_t activeVoxels() const { return nano().activeVoxelCount(); }
    std::size_t bytes() const { return bytes_.size(); }
    // Of the active voxels; of vectors those of shortest and greatest length. 0 when empty.
    Value minimum() const { return minimum_; }
    Value maximum() const { return maximum_; }

    Sampler sampler() const { return Sampler(nano(), support_); }
    const Nano& nano() const { return *reinterpret_cast<const Nano*>(bytes_.data()); }

  private:
    BasicVoxelGrid() = default;

    GridBytes bytes_;
    GridFacts facts_;
    Transform worldToIndex_;
    Vec3i lower_, upper_;
    Bounds3 support_;
    Value minimum_{}, maximum_{};
};

using VoxelGrid = BasicVoxelGrid<float>;
using VectorGrid = BasicVoxelGrid<Vec3>;

extern template class BasicVoxelGrid<float>;
extern template class BasicVoxelGrid<Vec3>;

// How many active voxels have a component that is not within [lower, upper].
std::uint64_t countOutside(const VectorGrid&, float lower, float upper);

} // namespace abbe
