#include "vdb/commands.h"
#include "vdb/field.h"
#include "vdb/output.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <openvdb/tools/Interpolation.h>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/Prune.h>
#include <sstream>

namespace abbe::vdb {

namespace {

using Kind = VdbFault::Kind;

struct Settings {
    std::vector<std::string> grids; // empty: all
    double resample = 1;            // size of the new voxels in old ones
    bool fog = false, clean = false, half = false;
    std::optional<float> prune; // tolerance
    std::optional<openvdb::BBoxd> crop;
};

std::vector<std::string> split(const std::string& text) {
    std::vector<std::string> parts;
    std::istringstream stream(text);
    for (std::string part; std::getline(stream, part, ',');) parts.push_back(part);
    return parts;
}

Settings settingsOf(Arguments options) {
    Settings s;
    for (const std::string& option : options) {
        const std::size_t equals = option.find('=');
        const std::string name = option.substr(0, equals), value = option.substr(equals + 1);
        if (name == "grid") s.grids.push_back(value);
        if (name == "resample") s.resample = std::stod(value);
        if (name == "fog") s.fog = true;
        if (name == "clean") s.clean = true;
        if (name == "half") s.half = true;
        if (name == "prune") s.prune = std::stof(value);
        if (name == "crop") {
            const auto v = split(value);
            s.crop.emplace(openvdb::Vec3d(std::stod(v.at(0)), std::stod(v.at(1)), std::stod(v.at(2))),
                           openvdb::Vec3d(std::stod(v.at(3)), std::stod(v.at(4)), std::stod(v.at(5))));
        }
    }
    return s;
}

// Whether anything but 0 is near the box of voxels.
template <typename Accessor> bool anyNear(Accessor& accessor, const openvdb::CoordBBox& box) {
    for (int x = box.min().x() & ~7; x <= box.max().x(); x += 8)
        for (int y = box.min().y() & ~7; y <= box.max().y(); y += 8)
            for (int z = box.min().z() & ~7; z <= box.max().z(); z += 8) {
                const openvdb::Coord c(x, y, z);
                using Value = typename Accessor::ValueType;
                if (accessor.probeConstLeaf(c) || accessor.getValue(c) != openvdb::zeroVal<Value>()) return true;
            }
    return false;
}

void store(RecipeLeaf& leaf, std::size_t i, float v) { leaf.components[0][i] = v; }
void store(RecipeLeaf& leaf, std::size_t i, const openvdb::Vec3s& v) {
    for (std::size_t c = 0; c < 3; ++c) leaf.components[c][i] = v[static_cast<int>(c)];
}

// Each new voxel is the mean of evenly spaced samples over its box, interpolated in the old grid.
template <typename GridType> openvdb::GridBase::Ptr resampled(const GridType& grid, double factor, int components) {
    using Value = typename GridType::ValueType;
    const int n = std::max(1, static_cast<int>(std::lround(factor)));
    const auto leafFunction = [&](Vec3i origin, RecipeLeaf& leaf) {
        auto accessor = grid.getConstAccessor();
        const auto old = [&](int v, double add) { return static_cast<int>(std::floor((v + add) * factor)); };
        const openvdb::CoordBBox box({old(origin.x, -0.5) - 1, old(origin.y, -0.5) - 1, old(origin.z, -0.5) - 1},
                                     {old(origin.x, 7.5) + 2, old(origin.y, 7.5) + 2, old(origin.z, 7.5) + 2});
        if (!anyNear(accessor, box)) return false;
        for (std::size_t i = 0; i < 512; ++i) {
            const openvdb::Vec3d place(origin.x + static_cast<double>(i >> 6),
                                       origin.y + static_cast<double>(i >> 3 & 7),
                                       origin.z + static_cast<double>(i & 7));
            Value sum = openvdb::zeroVal<Value>();
            for (int k = 0; k < n * n * n; ++k) {
                const openvdb::Vec3d at((k / (n * n) + 0.5) / n - 0.5, (k / n % n + 0.5) / n - 0.5,
                                        (k % n + 0.5) / n - 0.5);
                Value v;
                openvdb::tools::BoxSampler::sample(accessor, (place + at) * factor, v);
                sum += v;
            }
            store(leaf, i, sum * (1.f / static_cast<float>(n * n * n)));
        }
        return true;
    };
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    if (box.empty()) return grid.deepCopyGrid();
    const auto scaled = [&](int v, int add) { return static_cast<int>(std::floor((v + add) / factor)) + add; };
    const RecipeField field{"field", "", components};
    const auto grids = buildGrids({&field, 1},
                                  {{scaled(box.min().x(), -1), scaled(box.min().y(), -1), scaled(box.min().z(), -1)},
                                   {scaled(box.max().x(), 1), scaled(box.max().y(), 1), scaled(box.max().z(), 1)}},
                                  leafFunction, 1);
    grids[0]->insertMeta(grid);
    auto transform = grid.transform().copy();
    transform->preScale(factor);
    grids[0]->setTransform(transform);
    return grids[0];
}

template <typename GridType>
openvdb::GridBase::Ptr worked(typename GridType::Ptr grid, const Settings& s, int components) {
    openvdb::GridBase::Ptr result = grid;
    if (s.resample != 1) result = resampled(*grid, s.resample, components);
    if (s.crop) result->clipGrid(*s.crop);
    if (s.prune) {
        using Value = typename GridType::ValueType;
        openvdb::tools::prune(openvdb::gridPtrCast<GridType>(result)->tree(), Value(*s.prune));
    }
    if (s.half) result->setSaveFloatAsHalf(true);
    return result;
}

void checkResampling(const VdbInput& input, const openvdb::GridBase& grid, const Settings& s) {
    if (s.resample == 1 && !s.crop) return;
    if (!grid.transform().isLinear())
        throw Failure(Kind::transform,
                      input.subject(grid.getName()) + " lies in a frustum and cannot be resampled or cropped");
    if (grid.getGridClass() == openvdb::GRID_LEVEL_SET && !s.fog)
        throw Failure(Kind::wrongKind, input.subject(grid.getName()) +
                                           " is a level set, which is not resampled or cropped; make it fog (--fog)");
}

openvdb::GridBase::Ptr converted(const VdbInput& input, openvdb::GridBase::Ptr grid, const Settings& s,
                                 std::vector<std::string>& notes) {
    using namespace openvdb;
    checkResampling(input, *grid, s);
    const bool vector = grid->isType<Vec3SGrid>() || grid->isType<Vec3DGrid>() || grid->isType<Vec3IGrid>();
    if (vector) {
        if (!s.clean && grid->isType<Vec3SGrid>()) return worked<Vec3SGrid>(gridPtrCast<Vec3SGrid>(grid), s, 3);
        auto field = vectorField(input, grid);
        notes.insert(notes.end(), field.notes.begin(), field.notes.end());
        return worked<Vec3SGrid>(field.grid, s, 3);
    }
    const bool levelSet = grid->getGridClass() == GRID_LEVEL_SET;
    if (grid->isType<FloatGrid>() && !s.clean && !(levelSet && s.fog))
        return worked<FloatGrid>(gridPtrCast<FloatGrid>(grid), s, 1);
    auto field = amountField(input, grid, s.fog ? VdbUse::amountOrLevelSet : VdbUse::amount);
    notes.insert(notes.end(), field.notes.begin(), field.notes.end());
    return worked<FloatGrid>(field.grid, s, 1);
}

} // namespace

void convert(Arguments arguments) {
    VdbInput input(arguments[0]);
    const Settings settings = settingsOf(arguments.subspan(2));
    std::vector<std::string> notes;
    openvdb::GridPtrVec grids;
    for (const std::string& name : settings.grids.empty() ? input.names() : settings.grids) {
        const auto grid = input.grid(name);
        if (!grid) throw Failure(Kind::noGrid, fmt::format("`{}` has no grid `{}`", input.path(), name), input.names());
        grids.push_back(converted(input, grid, settings, notes));
    }
    if (grids.empty()) throw Failure(Kind::noGrid, fmt::format("`{}` has no grids", input.path()));
    writeGrids(arguments[1], grids);
    std::string text;
    for (const std::string& note : notes) text += note + "\n";
    writeFrame(VdbFrame::text, text);
}

} // namespace abbe::vdb
