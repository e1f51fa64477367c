#include "vdb/commands.h"
#include "vdb/field.h"
#include "vdb/output.h"

#include <cmath>
#include <fmt/format.h>
#include <mutex>

namespace abbe::vdb {

namespace {

// What the values of one part of a grid are.
struct Statistics {
    double minimum = HUGE_VAL, maximum = -HUGE_VAL;
    std::uint64_t notFinite = 0, negative = 0, inactive = 0;

    void add(double v) {
        if (!std::isfinite(v)) {
            ++notFinite;
            return;
        }
        minimum = std::min(minimum, v);
        maximum = std::max(maximum, v);
        if (v < 0) ++negative;
    }
    void add(const Statistics& s) {
        minimum = std::min(minimum, s.minimum);
        maximum = std::max(maximum, s.maximum);
        notFinite += s.notFinite;
        negative += s.negative;
        inactive += s.inactive;
    }
};

template <typename T> double number(const T& v) {
    if constexpr (openvdb::VecTraits<T>::IsVec)
        return std::sqrt(double(v[0]) * double(v[0]) + double(v[1]) * double(v[1]) + double(v[2]) * double(v[2]));
    else
        return static_cast<double>(v);
}

template <typename Tree> Statistics statisticsOf(const Tree& tree) {
    Statistics all;
    std::mutex mutex;
    const auto background = tree.background();
    forEachLeaf(tree, [&](const typename Tree::LeafNodeType& leaf) {
        Statistics s;
        for (openvdb::Index i = 0; i < Tree::LeafNodeType::SIZE; ++i) {
            const auto& v = leaf.getValue(i);
            if (leaf.isValueOn(i))
                s.add(number(v));
            else if (v != background)
                ++s.inactive;
        }
        const std::lock_guard lock(mutex);
        all.add(s);
    });
    forEachTile(tree, [&](const auto& tile) {
        if (tile.isValueOn()) all.add(number<typename Tree::ValueType>(*tile));
    });
    return all;
}

template <typename GridType> bool readValues(const openvdb::GridBase& base, VdbGridInfo& info) {
    if (!base.isType<GridType>()) return false;
    const auto& tree = static_cast<const GridType&>(base).tree();
    const Statistics s = statisticsOf(tree);
    info.read = true;
    info.background = number(tree.background());
    info.notFinite = s.notFinite;
    info.negative = s.negative;
    info.inactiveValues = base.getGridClass() == openvdb::GRID_LEVEL_SET ? 0 : s.inactive; // inside a level set
    if (s.minimum <= s.maximum) {
        info.minimum = s.minimum;
        info.maximum = s.maximum;
    }
    return true;
}

std::string classText(openvdb::GridClass c) {
    return c == openvdb::GRID_UNKNOWN ? "unknown" : openvdb::GridBase::gridClassToString(c);
}

std::vector<std::pair<std::string, std::string>> metadataOf(const openvdb::MetaMap& map) {
    std::vector<std::pair<std::string, std::string>> list;
    for (auto it = map.beginMeta(); it != map.endMeta(); ++it)
        if (it->second) list.emplace_back(it->first, it->second->str().substr(0, 400));
    return list;
}

void inspect(const openvdb::GridBase& grid, VdbGridInfo& info) {
    using namespace openvdb;
    info.type = grid.valueType();
    info.volumeClass = classText(grid.getGridClass());
    info.unit = unitOf(grid);
    info.half = grid.saveFloatAsHalf();
    info.affine = grid.transform().isLinear();
    const auto transform = affineTransform(grid);
    info.singular = info.affine && !transform;
    if (transform) info.indexToWorld = *transform;
    const CoordBBox box = grid.evalActiveVoxelBoundingBox();
    info.lower = {box.min()[0], box.min()[1], box.min()[2]};
    info.upper = {box.max()[0], box.max()[1], box.max()[2]};
    info.activeVoxels = grid.activeVoxelCount();
    info.activeTiles = grid.baseTree().activeTileCount();
    info.leaves = grid.baseTree().leafCount();
    info.memoryBytes = grid.memUsage();
    info.metadata = metadataOf(grid);
    readValues<FloatGrid>(grid, info) || readValues<DoubleGrid>(grid, info) || readValues<Int32Grid>(grid, info) ||
        readValues<Int64Grid>(grid, info) || readValues<Vec3SGrid>(grid, info) || readValues<Vec3DGrid>(grid, info) ||
        readValues<Vec3IGrid>(grid, info);
}

} // namespace

void info(Arguments arguments) {
    VdbInput input(arguments[0]);
    VdbFileInfo info;
    info.library = input.library();
    info.metadata = metadataOf(input.metadata());
    for (const std::string& name : input.names()) {
        VdbGridInfo& grid = info.grids.emplace_back();
        grid.name = name;
        try {
            inspect(*input.grid(name), grid); // one at a time in memory
        } catch (const Failure& e) {
            if (e.fault().kind != VdbFault::Kind::transform) throw;
            grid.singular = true;
        }
    }
    info.compression = input.compression();
    writeFrame(VdbFrame::fileInfo, info);
}

} // namespace abbe::vdb
