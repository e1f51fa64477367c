#include "vdb/commands.h"
#include "vdb/grid_builder.h"
#include "vdb/output.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe::vdb {

void make(Arguments arguments) {
    const auto seed = static_cast<std::uint32_t>(std::stoul(arguments[3]));
    const auto recipe = makeVolumeRecipe(arguments[0], seed);
    if (!recipe) throw Failure(VdbFault::Kind::helper, "there is no recipe for `" + arguments[0] + "`");
    openvdb::initialize();
    const Bounds3 bounds = recipe->bounds();
    const float size = maxComponent(bounds.diagonal()) / static_cast<float>(std::stoul(arguments[2]));
    const auto voxel = [&](float x, bool up) {
        return static_cast<int>(up ? std::ceil(x / size) : std::floor(x / size));
    };
    const openvdb::CoordBBox box(
        {voxel(bounds.lower.x, false), voxel(bounds.lower.y, false), voxel(bounds.lower.z, false)},
        {voxel(bounds.upper.x, true), voxel(bounds.upper.y, true), voxel(bounds.upper.z, true)});
    const auto leaf = [&](Vec3T<int> origin, RecipeLeaf& out) { return recipe->leaf(Vec3(origin) * size, size, out); };
    const auto grids = buildGrids(recipe->fields(), box, leaf, 0.95);
    for (const auto& grid : grids) {
        grid->setTransform(openvdb::math::Transform::createLinearTransform(static_cast<double>(size)));
        grid->setSaveFloatAsHalf(true);
        if (grid->getName() == "velocity") grid->setVectorType(openvdb::VEC_CONTRAVARIANT_RELATIVE);
        grid->insertMeta("recipe", openvdb::StringMetadata(fmt::format("{} seed {}", arguments[0], seed)));
    }
    writeGrids(arguments[1], grids);
}

} // namespace abbe::vdb
