#include "base/memory_limit.h"
#include "base/named_arrays.h"
#include "volumes/vdb_file.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <nanovdb/util/GridBuilder.h>

namespace abbe {

namespace {

// Of leaves while they are built, their masks and the final grid, for each float.
constexpr double kBytesPerNumber = 9;

std::size_t voxelsOf(const NamedArrays& arrays) {
    std::size_t count = 1;
    for (const int n : arrays.size) count *= static_cast<std::size_t>(std::max(n, 0));
    return count;
}

float valueAt(const float* values, std::size_t voxel, float) { return values[voxel]; }
nanovdb::Vec3f valueAt(const float* values, std::size_t voxel, nanovdb::Vec3f) {
    return {values[3 * voxel], values[3 * voxel + 1], values[3 * voxel + 2]};
}

// What is 0 becomes no voxel, as in files.
template <typename Value>
std::optional<BasicVoxelGrid<Value>> gridOf(std::span<const float> values, const NamedArrays& arrays,
                                            const std::string& name) {
    using Stored = typename VoxelValue<Value>::Build;
    const auto& [sx, sy, sz, x0, y0, z0] = arrays.place;
    const Transform toWorld = Transform::scale({sx, sy, sz}).then(Transform::translate({x0, y0, z0}));
    if (!toWorld.inverse()) return std::nullopt;
    const std::array<int, 3>& size = arrays.size;
    requireMemory(kBytesPerNumber * static_cast<double>(values.size()));
    nanovdb::GridBuilder<Stored> builder(Stored(0.f));
    const auto width = static_cast<std::size_t>(size[0]), height = static_cast<std::size_t>(size[1]);
    builder(
        [&](const nanovdb::Coord& c) {
            const auto x = static_cast<std::size_t>(c[0]), y = static_cast<std::size_t>(c[1]);
            return valueAt(values.data(), (static_cast<std::size_t>(c[2]) * height + y) * width + x, Stored());
        },
        nanovdb::CoordBBox({0, 0, 0}, {size[0] - 1, size[1] - 1, size[2] - 1}));
    builder.setStats(nanovdb::StatsMode::MinMax);
    builder.setChecksum(nanovdb::ChecksumMode::Disable);
    const auto handle = builder.getHandle(1.0, nanovdb::Vec3d(0), name);
    GridBytes bytes(handle.size());
    std::memcpy(bytes.data(), handle.data(), handle.size());
    return BasicVoxelGrid<Value>::adopt(std::move(bytes), {name, {}, VolumeClass::fog, toWorld});
}

// A reason why these are no field, or nothing.
std::string arrayFault(const NamedArrays& arrays, std::span<const float> values, VdbUse use) {
    const std::size_t numbers = (use == VdbUse::vector ? 3 : 1) * voxelsOf(arrays);
    if (values.size() != numbers || numbers == 0)
        return fmt::format("it has {} numbers, but {} × {} × {} voxels need {}", values.size(), arrays.size[0],
                           arrays.size[1], arrays.size[2], numbers);
    for (std::size_t i = 0; i < values.size(); ++i)
        if (!std::isfinite(values[i]) || (use != VdbUse::vector && values[i] < 0))
            return fmt::format("number {} of it is {}", i, values[i]);
    return {};
}

} // namespace

std::variant<std::vector<VdbGrid>, VdbFault> gridsOf(const NamedArrays& arrays, const std::string& name,
                                                     std::span<const VdbRequest> requests) {
    using Kind = VdbFault::Kind;
    std::vector<VdbGrid> grids;
    std::vector<std::string> known;
    for (const auto& [array, values] : arrays.floats) known.push_back(array);
    for (const VdbRequest& r : requests) {
        VdbGrid& grid = grids.emplace_back();
        const std::size_t number = grids.size() - 1;
        const auto found = arrays.floats.find(r.grid);
        if (found == arrays.floats.end()) {
            if (r.optional) continue;
            return VdbFault{Kind::noGrid, fmt::format("`{}` has no array `{}`", name, r.grid), known, number};
        }
        if (const std::string fault = arrayFault(arrays, found->second, r.use); !fault.empty())
            return VdbFault{
                Kind::wrongKind, fmt::format("array `{}` of `{}` is no grid: {}", r.grid, name, fault), {}, number};
        try {
            if (r.use == VdbUse::vector)
                grid.vector = gridOf<Vec3>(found->second, arrays, r.grid);
            else
                grid.scalar = gridOf<float>(found->second, arrays, r.grid);
        } catch (const std::bad_alloc& e) {
            return VdbFault{
                Kind::memory, fmt::format("array `{}` of `{}`: {}", r.grid, name, memoryReason(e)), {}, number};
        }
        if (!grid.vector && !grid.scalar)
            return VdbFault{Kind::transform, fmt::format("`{}` has voxels of no size", name), {}, number};
    }
    return grids;
}

} // namespace abbe
