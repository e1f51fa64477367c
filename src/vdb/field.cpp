#include "vdb/field.h"

#include "vdb/output.h"

#include <algorithm>
#include <atomic>
#include <cctype>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <openvdb/tools/LevelSetUtil.h>
#include <openvdb/tools/Prune.h>

namespace abbe::vdb {

namespace {

constexpr std::size_t kMagicBytes = 8;

std::string beginningOf(const std::string& path) {
    std::string bytes(kMagicBytes, '\0');
    std::ifstream file(path, std::ios::binary);
    file.read(bytes.data(), static_cast<std::streamsize>(bytes.size()));
    bytes.resize(static_cast<std::size_t>(std::max<std::streamsize>(file.gcount(), 0)));
    return bytes;
}

bool looksLikeOpenVdb(const std::string& begin) {
    const std::int64_t magic = openvdb::OPENVDB_MAGIC;
    return begin.size() == sizeof magic && std::memcmp(begin.data(), &magic, sizeof magic) == 0;
}

std::string damage(const std::string& subject, const std::string& path, const std::exception& e) {
    std::error_code unknown;
    const auto size = std::filesystem::file_size(path, unknown);
    return fmt::format("{} is damaged or cut off{}: {}", subject,
                       unknown ? std::string() : fmt::format(" (the file has {} bytes)", size), plainWords(e));
}

} // namespace

VdbInput::VdbInput(const std::string& path) : path_(path) {
    openvdb::initialize();
    // A file of another kind is told by its first bytes, which are an eight-byte number in every file of these two.
    const std::string begin = beginningOf(path);
    if (begin.empty()) throw Failure(VdbFault::Kind::damaged, fmt::format("`{}` is empty", path));
    const bool nano = looksLikeNanoVdb(begin);
    if (!nano && !looksLikeOpenVdb(begin))
        throw Failure(VdbFault::Kind::damaged, fmt::format("`{}` is not an OpenVDB or NanoVDB file", path));
    try {
        if (nano)
            nano_ = std::make_unique<NanoVdbFile>(path);
        else
            file_ = std::make_unique<GridFile>(path);
    } catch (const std::runtime_error& e) { // openvdb::Exception is none
        throw Failure(VdbFault::Kind::damaged, damage(fmt::format("`{}`", path), path, e));
    } catch (const openvdb::Exception& e) {
        throw Failure(VdbFault::Kind::damaged, damage(fmt::format("`{}`", path), path, e));
    }
    if (names().empty())
        throw Failure(VdbFault::Kind::damaged, fmt::format("`{}` holds no grids: it is empty or cut off", path));
}

std::vector<std::string> VdbInput::names() const { return nano_ ? nano_->names() : file_->names(); }

std::string VdbInput::library() const { return nano_ ? "NanoVDB " + nano_->library() : file_->version(); }

std::string VdbInput::compression() const {
    if (nano_) return nano_->compression();
    const std::uint32_t flags = file_->compression();
    std::string text = flags & openvdb::io::COMPRESS_BLOSC ? "blosc"
                       : flags & openvdb::io::COMPRESS_ZIP ? "zip"
                                                           : "none";
    if (flags & openvdb::io::COMPRESS_ACTIVE_MASK) text += ", active voxels only";
    return text;
}

openvdb::MetaMap VdbInput::metadata() const { return nano_ ? openvdb::MetaMap() : file_->metadata(); }

openvdb::GridBase::Ptr VdbInput::readGrid(const std::string& name) {
    return nano_ ? nano_->grid(name) : file_->grid(name);
}

openvdb::GridBase::Ptr VdbInput::grid(const std::string& name) {
    try {
        return readGrid(name);
    } catch (const openvdb::ArithmeticError&) {
        throw Failure(VdbFault::Kind::transform, subject(name) + " has a transform without an inverse");
    } catch (const std::runtime_error& e) { // of NanoVDB
        throw Failure(VdbFault::Kind::damaged, damage(subject(name), path_, e));
    } catch (const openvdb::Exception& e) {
        throw Failure(VdbFault::Kind::damaged, damage(subject(name), path_, e));
    }
}

std::string VdbInput::subject(const std::string& name) const { return fmt::format("grid `{}` of `{}`", name, path_); }

namespace {

using Kind = VdbFault::Kind;

bool finite(float v) { return std::isfinite(v); }
bool finite(const openvdb::Vec3s& v) { return finite(v[0]) && finite(v[1]) && finite(v[2]); }
bool negative(float v) { return v < 0; }
bool negative(const openvdb::Vec3s&) { return false; }

struct Repairs {
    std::atomic<std::uint64_t> notFinite{0}, negative{0}, inactive{0};

    std::vector<std::string> notes(const std::string& subject) const {
        std::vector<std::string> notes;
        const auto note = [&](std::uint64_t count, const char* what) {
            if (count > 0) notes.push_back(fmt::format("{}: {} {}", subject, count, what));
        };
        note(notFinite, "values are not finite and count as 0");
        note(negative, "values are negative and count as 0");
        note(inactive, "inactive values differ from the background and count as 0");
        return notes;
    }
};

// What a voxel or tile becomes; counts why.
template <typename Value> Value repaired(const Value& v, bool active, const Value& background, Repairs& repairs) {
    if (!active) {
        if (v != background && v != openvdb::zeroVal<Value>()) ++repairs.inactive;
        return openvdb::zeroVal<Value>();
    }
    if (!finite(v)) {
        ++repairs.notFinite;
        return openvdb::zeroVal<Value>();
    }
    if (negative(v)) {
        ++repairs.negative;
        return openvdb::zeroVal<Value>();
    }
    return v;
}

template <typename Tree> void repairLeaves(Tree& tree, Repairs& repairs) {
    using Value = typename Tree::ValueType;
    const Value background = tree.background(), zero = openvdb::zeroVal<Value>();
    forEachLeaf(tree, [&](typename Tree::LeafNodeType& leaf) {
        Value* values = leaf.buffer().data();
        for (openvdb::Index i = 0; i < Tree::LeafNodeType::SIZE; ++i) {
            const Value v = repaired(values[i], leaf.isValueOn(i), background, repairs);
            values[i] = v;
            if (v == zero) leaf.setValueOff(i); // so that what is empty can be pruned
        }
    });
}

template <typename Tree> void repairTiles(Tree& tree, Repairs& repairs) {
    using Value = typename Tree::ValueType;
    const Value background = tree.background();
    forEachTile(tree, [&](const auto& tile) {
        const Value v = repaired<Value>(*tile, tile.isValueOn(), background, repairs);
        tile.setValue(v);
        if (v == openvdb::zeroVal<Value>()) tile.setValueOff();
    });
}

template <typename GridType> Field<GridType> repairedField(typename GridType::Ptr grid, const std::string& subject) {
    Repairs repairs;
    auto& tree = grid->tree();
    const auto background = tree.background();
    repairTiles(tree, repairs);
    repairLeaves(tree, repairs);
    tree.root().setBackground(openvdb::zeroVal<typename GridType::ValueType>(), false);
    openvdb::tools::pruneInactive(tree);
    Field<GridType> field{grid, repairs.notes(subject)};
    if (background != openvdb::zeroVal<typename GridType::ValueType>())
        field.notes.push_back(fmt::format("{}: the background is not 0 but counts as 0", subject));
    return field;
}

// A tile of the root is 4096³ voxels; a constant field of many of them is no volume but a mistake.
template <typename GridType> void checkExtent(const GridType& grid, const std::string& subject) {
    constexpr int kMostRootTiles = 8;
    int tiles = 0;
    for (auto tile = grid.tree().root().cbeginValueOn(); tile; ++tile) ++tiles;
    const openvdb::CoordBBox box = grid.evalActiveVoxelBoundingBox();
    for (int a = 0; a < 3 && !box.empty(); ++a)
        if (tiles > kMostRootTiles || box.min()[a] < -kFarthestVoxel || box.max()[a] > kFarthestVoxel)
            throw Failure(Kind::extent,
                          tiles > kMostRootTiles
                              ? fmt::format("{} is constant over more than {}·4096³ voxels", subject, kMostRootTiles)
                              : fmt::format("{} has voxels further than {} from its origin", subject, kFarthestVoxel));
}

template <typename From> openvdb::FloatGrid::Ptr converted(const openvdb::GridBase& grid) {
    const auto& source = static_cast<const From&>(grid);
    auto result = openvdb::FloatGrid::create(openvdb::FloatTree::Ptr(new openvdb::FloatTree(source.tree())));
    result->insertMeta(source);
    result->setTransform(source.transform().copy());
    return result;
}

// The library does not convert trees of vectors: the active values are copied one by one.
template <typename From> openvdb::Vec3SGrid::Ptr convertedVectors(const openvdb::GridBase& grid) {
    using openvdb::Vec3s;
    const auto& source = static_cast<const From&>(grid);
    const auto& tree = source.tree();
    auto result = openvdb::Vec3SGrid::create(
        openvdb::Vec3STree::Ptr(new openvdb::Vec3STree(tree, openvdb::zeroVal<Vec3s>(), openvdb::TopologyCopy())));
    result->insertMeta(source);
    result->setTransform(source.transform().copy());
    forEachTile(result->tree(), [&](const auto& tile) {
        if (tile.isValueOn()) tile.setValue(Vec3s(tree.getValue(tile.getCoord())));
    });
    forEachLeaf(result->tree(), [&](openvdb::Vec3STree::LeafNodeType& leaf) {
        const auto* from = tree.probeConstLeaf(leaf.origin()); // there, as both have the same shape
        for (auto voxel = leaf.beginValueOn(); voxel; ++voxel) voxel.setValue(Vec3s(from->getValue(voxel.pos())));
    });
    return result;
}

openvdb::FloatGrid::Ptr maskField(const openvdb::GridBase& grid) {
    const auto fill = [&](const auto& source) {
        auto result = openvdb::FloatGrid::create(
            openvdb::FloatTree::Ptr(new openvdb::FloatTree(source.tree(), 0.f, 1.f, openvdb::TopologyCopy())));
        result->insertMeta(source);
        result->setTransform(source.transform().copy());
        return result;
    };
    if (grid.isType<openvdb::BoolGrid>()) return fill(static_cast<const openvdb::BoolGrid&>(grid));
    return fill(static_cast<const openvdb::MaskGrid&>(grid));
}

openvdb::FloatGrid::Ptr floatField(const openvdb::GridBase::Ptr& grid) {
    using namespace openvdb;
    if (grid->isType<FloatGrid>()) return gridPtrCast<FloatGrid>(grid);
    if (grid->isType<DoubleGrid>()) return converted<DoubleGrid>(*grid);
    if (grid->isType<Int32Grid>()) return converted<Int32Grid>(*grid);
    if (grid->isType<Int64Grid>()) return converted<Int64Grid>(*grid);
    if (grid->isType<BoolGrid>() || grid->isType<MaskGrid>()) return maskField(*grid);
    return nullptr;
}

} // namespace

Field<openvdb::FloatGrid> amountField(const VdbInput& input, const openvdb::GridBase::Ptr& grid, VdbUse use) {
    const std::string subject = input.subject(grid->getName());
    auto field = floatField(grid);
    if (!field)
        throw Failure(Kind::wrongKind,
                      fmt::format("{} holds {}, not numbers", subject,
                                  grid->type().find("Points") == 0 || grid->valueType() == "ptdataidx32"
                                      ? "points"
                                      : grid->valueType()));
    if (grid->getGridClass() == openvdb::GRID_LEVEL_SET) {
        if (use != VdbUse::amountOrLevelSet)
            throw Failure(Kind::wrongKind,
                          fmt::format("{} is a level set (distances from a surface), not an amount; `abbe volume "
                                      "convert --fog` makes fog of it",
                                      subject));
        openvdb::tools::sdfToFogVolume(*field);
    }
    auto result = repairedField<openvdb::FloatGrid>(field, subject);
    checkExtent(*result.grid, subject);
    return result;
}

Field<openvdb::Vec3SGrid> vectorField(const VdbInput& input, const openvdb::GridBase::Ptr& grid) {
    using namespace openvdb;
    const std::string subject = input.subject(grid->getName());
    Vec3SGrid::Ptr field;
    if (grid->isType<Vec3SGrid>()) field = gridPtrCast<Vec3SGrid>(grid);
    if (grid->isType<Vec3DGrid>()) field = convertedVectors<Vec3DGrid>(*grid);
    if (grid->isType<Vec3IGrid>()) field = convertedVectors<Vec3IGrid>(*grid);
    if (!field) throw Failure(Kind::wrongKind, fmt::format("{} holds {}, not vectors", subject, grid->valueType()));
    auto result = repairedField<Vec3SGrid>(field, subject);
    if (grid->getGridClass() == GRID_STAGGERED)
        result.notes.push_back(fmt::format("{}: staggered; its vectors are taken to be at voxel centres", subject));
    checkExtent(*result.grid, subject);
    return result;
}

std::optional<Transform> affineTransform(const openvdb::GridBase& grid) {
    if (!grid.transform().isLinear()) return std::nullopt;
    const openvdb::Mat4d m = grid.transform().baseMap()->getAffineMap()->getMat4();
    Transform t; // OpenVDB's vectors are rows: p' = p M
    for (int row = 0; row < 3; ++row)
        for (int column = 0; column < 3; ++column) t.a[row][column] = m(column, row);
    t.t = {m(3, 0), m(3, 1), m(3, 2)};
    if (!t.isFinite() || !t.inverse()) return std::nullopt;
    return t;
}

VolumeClass volumeClassOf(const openvdb::GridBase& grid) {
    switch (grid.getGridClass()) {
    case openvdb::GRID_FOG_VOLUME:
        return VolumeClass::fog;
    case openvdb::GRID_LEVEL_SET:
        return VolumeClass::levelSet;
    case openvdb::GRID_STAGGERED:
        return VolumeClass::staggered;
    default:
        return VolumeClass::unknown;
    }
}

std::string unitOf(const openvdb::GridBase& grid) {
    for (const char* key : {"unit", "units"})
        if (const auto meta = grid.getMetadata<openvdb::StringMetadata>(key)) return meta->value();
    return {};
}

} // namespace abbe::vdb
