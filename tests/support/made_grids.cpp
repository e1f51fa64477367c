#include "support/made_grids.h"

#include "base/check.h"

#include <cstring>
#include <nanovdb/util/GridBuilder.h>

namespace abbe {

namespace {

nanovdb::Map nanoMap(const Transform& t, const Transform& inverse) {
    nanovdb::Map map;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) {
            map.mMatD[3 * row + column] = t.a[row][column];
            map.mInvMatD[3 * row + column] = inverse.a[row][column];
            map.mMatF[3 * row + column] = static_cast<float>(t.a[row][column]);
            map.mInvMatF[3 * row + column] = static_cast<float>(inverse.a[row][column]);
        }
        map.mVecD[row] = t.t[row];
        map.mVecF[row] = static_cast<float>(t.t[row]);
    }
    map.mTaperD = 1;
    map.mTaperF = 1;
    return map;
}

template <typename Value>
BasicVoxelGrid<Value> finished(nanovdb::GridBuilder<typename VoxelValue<Value>::Build>& builder, GridFacts facts) {
    const auto inverse = facts.indexToWorld.inverse();
    ABBE_CHECK(inverse);
    builder.setStats(nanovdb::StatsMode::MinMax);
    builder.setChecksum(nanovdb::ChecksumMode::Disable);
    const auto handle = builder.getHandle(nanoMap(facts.indexToWorld, *inverse), facts.name);
    GridBytes bytes(handle.size());
    std::memcpy(bytes.data(), handle.data(), handle.size());
    auto grid = BasicVoxelGrid<Value>::adopt(std::move(bytes), std::move(facts));
    ABBE_CHECK(grid);
    return std::move(*grid);
}

} // namespace

VoxelGrid makeVoxelGrid(std::span<const Voxel> voxels, GridFacts facts) {
    nanovdb::GridBuilder<float> builder(0.f);
    auto accessor = builder.getAccessor();
    for (const Voxel& v : voxels) {
        ABBE_CHECK(v.value >= 0 && isFinite(v.value));
        accessor.setValue({v.place.x, v.place.y, v.place.z}, v.value);
    }
    return finished<float>(builder, std::move(facts));
}

VectorGrid makeVectorGrid(std::span<const VectorVoxel> voxels, GridFacts facts) {
    nanovdb::GridBuilder<nanovdb::Vec3f> builder(nanovdb::Vec3f(0.f));
    auto accessor = builder.getAccessor();
    for (const VectorVoxel& v : voxels) {
        ABBE_CHECK(isFinite(v.value));
        accessor.setValue({v.place.x, v.place.y, v.place.z}, nanovdb::Vec3f(v.value.x, v.value.y, v.value.z));
    }
    return finished<Vec3>(builder, std::move(facts));
}

} // namespace abbe
