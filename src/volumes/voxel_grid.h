// Sparse voxel grids in memory: one field each, in NanoVDB's layout.
#pragma once

#include "math/bounds.h"
#include "math/transform.h"
#include "math/vec.h"

#include <cstddef>
#include <cstdint>
#include <immintrin.h>
#include <memory>
#include <nanovdb/NanoVDB.h>
#include <optional>
#include <string>
#include <type_traits>
#include <utility>

namespace abbe {

using Vec3i = Vec3T<int>;

// No grid has active voxels whose coordinates are further from 0 than this.
inline constexpr int kFarthestVoxel = 1 << 26;

// Bytes of one NanoVDB grid, aligned as it asks for. Copies are of the same bytes.
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
    std::shared_ptr<std::byte[]> data_;
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
    Value at(Vec3 p) noexcept { return at(_mm_setr_ps(p.x, p.y, p.z, 0)); }
    // The same; the fourth component means nothing.
    Value at(__m128 p) noexcept {
        const __m128 inside = _mm_and_ps(_mm_cmpgt_ps(p, three(lower_)), _mm_cmplt_ps(p, three(upper_)));
        if ((_mm_movemask_ps(inside) & 7) != 7) return Value{};
        const __m128 cell = _mm_floor_ps(p);
        alignas(16) float f[4];
        alignas(16) int at[4];
        _mm_store_ps(f, _mm_sub_ps(p, cell));
        _mm_store_si128(reinterpret_cast<__m128i*>(at), _mm_cvttps_epi32(cell));
        return between({at[0], at[1], at[2]}, {f[0], f[1], f[2]});
    }

    // The value of one voxel.
    Value voxel(Vec3i c) noexcept { return VoxelValue<Value>::read(accessor_.getValue({c.x, c.y, c.z})); }

  private:
    static __m128 three(const Vec3& v) { return _mm_maskload_ps(&v.x, _mm_setr_epi32(-1, -1, -1, 0)); }
    static Vec3 mix(Vec3 a, Vec3 b, float t) {
        return {std::fma(t, b.x - a.x, a.x), std::fma(t, b.y - a.y, a.y), std::fma(t, b.z - a.z, a.z)};
    }
    // Four corners each at the lower and at the upper x, in the order of y, z.
    static float mix(__m128 lower, __m128 upper, Vec3 f) {
        const __m128 x = _mm_fmadd_ps(_mm_set1_ps(f.x), _mm_sub_ps(upper, lower), lower);
        const __m128 y = _mm_fmadd_ps(_mm_set1_ps(f.y), _mm_sub_ps(_mm_movehl_ps(x, x), x), x);
        const __m128 z = _mm_fmadd_ss(_mm_set_ss(f.z), _mm_sub_ss(_mm_movehdup_ps(y), y), y);
        return _mm_cvtss_f32(z);
    }
    static __m128 pairs(const float* first, const float* second) {
        const auto load = [](const float* p) {
            return _mm_castsi128_ps(_mm_loadl_epi64(reinterpret_cast<const __m128i*>(p)));
        };
        return _mm_movelh_ps(load(first), load(second));
    }
    // The same, of eight corners whose bit 2 is x, bit 0 z.
    static float mix(const float* v, Vec3 f) { return mix(_mm_load_ps(v), _mm_load_ps(v + 4), f); }
    static Vec3 mix(const Vec3* v, Vec3 f) {
        return mix(mix(mix(v[0], v[1], f.z), mix(v[2], v[3], f.z), f.y),
                   mix(mix(v[4], v[5], f.z), mix(v[6], v[7], f.z), f.y), f.x);
    }

    // In the cell above `c`.
    Value between(const nanovdb::Coord& c, Vec3 f) noexcept {
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

    // All eight corners in one leaf, or in one tile, which is constant.
    Value inLeaf(const nanovdb::Coord& c, Vec3 f) noexcept {
        const auto* leaf = accessor_.probeLeaf(c);
        if (!leaf) return VoxelValue<Value>::read(accessor_.getValue(c));
        const std::uint32_t o = leaf->CoordToOffset(c);
        if constexpr (std::is_same_v<Value, float>) {
            const float* v = leaf->data()->mValues + o;
            return mix(pairs(v, v + 8), pairs(v + 64, v + 72), f);
        } else {
            Value v[8];
            for (std::uint32_t i = 0; i < 8; ++i)
                v[i] = VoxelValue<Value>::read(leaf->getValue(o + (i >> 2) * 64 + (i >> 1 & 1) * 8 + (i & 1)));
            return mix(v, f);
        }
    }
    // Corners in two, four or eight leaves, each looked up once. Bit 2 of a corner is x, bit 0 z; `Crossed` has the
    // bits of the axes along which the cell leaves its leaf.
    template <int Crossed> Value acrossLeaves(const nanovdb::Coord& c, Vec3 f) noexcept {
        alignas(16) Value v[8];
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
        return mix(v, f);
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
