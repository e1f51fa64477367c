#include "base/parallel.h"
#include "vdb/field.h"
#include "vdb/output.h"

#include <atomic>
#include <fmt/format.h>
#include <mutex>
#include <openvdb/io/File.h>

namespace abbe::vdb {

namespace {

using openvdb::Coord;

// Tells how far it is, at every hundredth.
class Progress {
  public:
    Progress(std::size_t count, double done) : count_(count), done_(done) {}
    void step() {
        const std::size_t n = ++finished_;
        if (n * 100 / count_ == (n - 1) * 100 / count_) return;
        const std::lock_guard lock(mutex_);
        writeFrame(VdbFrame::progress, done_ * static_cast<double>(n) / static_cast<double>(count_));
    }

  private:
    std::size_t count_;
    double done_;
    std::atomic<std::size_t> finished_{0};
    std::mutex mutex_;
};

// Leaves of one field, waiting to be put into its tree.
class FieldLeaves {
  public:
    explicit FieldLeaves(std::size_t rows, const RecipeField& field, std::size_t first)
        : field_(field), first_(first), scalars_(field.components == 1 ? rows : 0),
          vectors_(field.components == 3 ? rows : 0) {}

    void add(std::size_t row, Coord origin, const RecipeLeaf& leaf) {
        if (field_.components == 1) {
            auto node = std::make_unique<openvdb::FloatTree::LeafNodeType>(origin, 0.f, false);
            const auto& v = leaf.components[first_];
            for (openvdb::Index i = 0; i < 512; ++i)
                if (v[i] != 0) node->setValueOn(i, v[i]);
            if (!node->isEmpty()) scalars_[row].push_back(std::move(node));
        } else {
            auto node = std::make_unique<openvdb::Vec3STree::LeafNodeType>(origin, openvdb::Vec3s(0), false);
            const auto* v = &leaf.components[first_];
            for (openvdb::Index i = 0; i < 512; ++i)
                if (v[0][i] != 0 || v[1][i] != 0 || v[2][i] != 0)
                    node->setValueOn(i, openvdb::Vec3s(v[0][i], v[1][i], v[2][i]));
            if (!node->isEmpty()) vectors_[row].push_back(std::move(node));
        }
    }

    openvdb::GridBase::Ptr grid() {
        openvdb::GridBase::Ptr grid = field_.components == 1
                                          ? openvdb::GridBase::Ptr(fill<openvdb::FloatGrid>(scalars_))
                                          : openvdb::GridBase::Ptr(fill<openvdb::Vec3SGrid>(vectors_));
        grid->setName(std::string(field_.name));
        if (!field_.unit.empty()) grid->insertMeta("unit", openvdb::StringMetadata(std::string(field_.unit)));
        if (field_.components == 1) grid->setGridClass(openvdb::GRID_FOG_VOLUME);
        return grid;
    }

  private:
    template <typename GridType, typename Rows> static typename GridType::Ptr fill(Rows& rows) {
        auto grid = GridType::create();
        for (auto& row : rows) {
            for (auto& leaf : row) grid->tree().addLeaf(leaf.release());
            row.clear();
        }
        return grid;
    }

    RecipeField field_;
    std::size_t first_; // component
    std::vector<std::vector<std::unique_ptr<openvdb::FloatTree::LeafNodeType>>> scalars_;
    std::vector<std::vector<std::unique_ptr<openvdb::Vec3STree::LeafNodeType>>> vectors_;
};

} // namespace

openvdb::GridPtrVec buildGrids(std::span<const RecipeField> fields, const openvdb::CoordBBox& voxels,
                               const LeafFunction& function, double done) {
    const Coord first(voxels.min().x() & ~7, voxels.min().y() & ~7, voxels.min().z() & ~7);
    const auto count = [&](int a) { return static_cast<std::size_t>((voxels.max()[a] - first[a]) / 8 + 1); };
    const std::size_t rows = count(0) * count(1);
    std::vector<FieldLeaves> leaves;
    std::size_t components = 0;
    for (const RecipeField& field : fields) {
        leaves.emplace_back(rows, field, components);
        components += static_cast<std::size_t>(field.components);
    }
    Progress progress(rows, done);
    parallelFor(rows, [&](std::size_t row) {
        RecipeLeaf leaf;
        leaf.components.resize(components);
        for (std::size_t k = 0; k < count(2); ++k) {
            const Coord origin = first + Coord(static_cast<int>(row / count(1)) * 8,
                                               static_cast<int>(row % count(1)) * 8, static_cast<int>(k) * 8);
            if (!function({origin.x(), origin.y(), origin.z()}, leaf)) continue;
            for (FieldLeaves& field : leaves) field.add(row, origin, leaf);
        }
        progress.step();
    });
    openvdb::GridPtrVec grids;
    for (FieldLeaves& field : leaves) grids.push_back(field.grid());
    return grids;
}

void writeGrids(const std::string& path, const openvdb::GridPtrVec& grids) {
    using Kind = VdbFault::Kind;
    openvdb::MetaMap metadata;
    metadata.insertMeta("creator", openvdb::StringMetadata("abbe volume"));
    try {
        openvdb::io::File file(path);
        file.setCompression(openvdb::io::COMPRESS_BLOSC | openvdb::io::COMPRESS_ACTIVE_MASK);
        file.write(grids, metadata);
        file.close();
        openvdb::io::File written(path); // the writer does not notice a full disk
        written.open(false);
        const auto back = written.readGrid(grids.back()->getName());
        if (back->activeVoxelCount() != grids.back()->activeVoxelCount())
            throw Failure(Kind::file, "the volume cannot be written: what was read back is not the same");
    } catch (const openvdb::Exception& e) {
        throw Failure(Kind::file, fmt::format("the volume cannot be written: {}", plainWords(e)));
    }
}

} // namespace abbe::vdb
