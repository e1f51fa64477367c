#include "vdb/commands.h"
#include "vdb/field.h"
#include "vdb/output.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe::vdb {

namespace {

openvdb::GridPtrVec evaluate(const VolumeRecipe& recipe, float size, double done) {
    const Bounds3 bounds = recipe.bounds();
    const auto voxel = [&](float x, bool up) {
        return static_cast<int>(up ? std::ceil(x / size) : std::floor(x / size));
    };
    const openvdb::CoordBBox box(
        {voxel(bounds.lower.x, false), voxel(bounds.lower.y, false), voxel(bounds.lower.z, false)},
        {voxel(bounds.upper.x, true), voxel(bounds.upper.y, true), voxel(bounds.upper.z, true)});
    const auto leaf = [&](Vec3T<int> origin, RecipeLeaf& out) { return recipe.leaf(Vec3(origin) * size, size, out); };
    return buildGrids(recipe.fields(), box, leaf, done);
}

// The longest side of what the recipe fills, in metres, rather too small: its bounds are wider than that.
float filledLength(const VolumeRecipe& recipe) {
    constexpr float kVoxels = 128;
    const float size = maxComponent(recipe.bounds().diagonal()) / kVoxels;
    openvdb::CoordBBox filled;
    for (const auto& grid : evaluate(recipe, size, 0.01)) filled.expand(grid->evalActiveVoxelBoundingBox());
    const openvdb::Coord dim = filled.dim();
    return static_cast<float>(std::max({dim.x(), dim.y(), dim.z()}) - 2) * size;
}

} // namespace

void make(Arguments arguments) {
    const auto seed = static_cast<std::uint32_t>(std::stoul(arguments[3]));
    const auto recipe = makeVolumeRecipe(arguments[0], seed);
    if (!recipe) throw Failure(VdbFault::Kind::helper, "there is no recipe for `" + arguments[0] + "`");
    openvdb::initialize();
    // Two more, since the outermost voxels may miss what is there.
    const float size = filledLength(*recipe) / static_cast<float>(std::stoul(arguments[2]) + 2);
    const auto grids = evaluate(*recipe, size, 0.95);
    for (const auto& grid : grids) {
        grid->setTransform(openvdb::math::Transform::createLinearTransform(static_cast<double>(size)));
        grid->setSaveFloatAsHalf(true);
        if (grid->getName() == "velocity") grid->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
        grid->insertMeta("recipe", openvdb::StringMetadata(fmt::format("{} seed {}", arguments[0], seed)));
    }
    writeGrids(arguments[1], grids);
}

} // namespace abbe::vdb
