// Grids of an OpenVDB or NanoVDB file, fields made of them that can be rendered, and new grids. The one header with
// OpenVDB.
#pragma once

#include "base/parallel.h"
#include "volumes/vdb_file.h"
#include "volumes/volume_recipe.h"

#include <fstream>
#include <functional>
#include <map>
#include <memory>
#include <openvdb/Grid.h>
#include <openvdb/Types.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <openvdb/openvdb.h>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

// Trees that the library has instantiated: their members come from there instead of being compiled in each
// unit that makes a tree, which was most of the time that this folder took to compile.
#ifdef __OPTIMIZE__ // without inlining more of them is needed than the library exports
namespace openvdb {
OPENVDB_USE_VERSION_NAMESPACE
namespace OPENVDB_VERSION_NAME {

extern template class tree::Tree<BoolTree::RootNodeType>;
extern template class tree::Tree<DoubleTree::RootNodeType>;
extern template class tree::Tree<FloatTree::RootNodeType>;
extern template class tree::Tree<Int32Tree::RootNodeType>;
extern template class tree::Tree<Int64Tree::RootNodeType>;
extern template class tree::Tree<MaskTree::RootNodeType>;
extern template class tree::Tree<Vec3DTree::RootNodeType>;
extern template class tree::Tree<Vec3ITree::RootNodeType>;
extern template class tree::Tree<Vec3STree::RootNodeType>;

} // namespace OPENVDB_VERSION_NAME
} // namespace openvdb
#endif

namespace abbe::vdb {

// Walks over trees with few templates of the library's: its leaf managers and iterators over whole trees instantiate a
// scheduler and four levels of iterators for each type of value.

// Calls function(leaf) for every leaf, from many threads.
template <typename Tree, typename Function> void forEachLeaf(Tree& tree, const Function& function) {
    using Leaf =
        std::conditional_t<std::is_const_v<Tree>, const typename Tree::LeafNodeType, typename Tree::LeafNodeType>;
    std::vector<Leaf*> leaves;
    tree.getNodes(leaves);
    parallelFor(leaves.size(), [&](std::size_t i) { function(*leaves[i]); });
}

// Calls function(iterator) for every tile, active or not: what no leaf covers.
template <typename Tree, typename Function> void forEachTile(Tree& tree, const Function& function) {
    const auto tilesOf = [&](auto& node) {
        for (auto tile = node.beginValueAll(); tile; ++tile) function(tile);
    };
    auto& root = tree.root();
    tilesOf(root);
    for (auto upper = root.beginChildOn(); upper; ++upper) {
        tilesOf(*upper);
        for (auto lower = upper->beginChildOn(); lower; ++lower) tilesOf(*lower);
    }
}

// In nano_file.cpp: NanoVDB files (.nvdb), of which grids of OpenVDB are made.
// Whether a file that begins like this is one.
bool looksLikeNanoVdb(std::string_view beginning);

// An open file: its heads are read, its grids are not. Segments of different packing may follow each other.
class NanoVdbFile {
  public:
    // Throws Failure.
    explicit NanoVdbFile(const std::string& path);
    std::vector<std::string> names() const;
    // The first of that name, or null. Numbers that are packed with fewer bits become float. Throws Failure, also for
    // grids of booleans, indices and points, and std::runtime_error where the library meets damage.
    openvdb::GridBase::Ptr grid(const std::string& name) const;
    const std::string& library() const { return library_; }         // version that wrote the file, "32.4.2"
    const std::string& compression() const { return compression_; } // of the first segment: "none", "zip", "blosc"

  private:
    std::string path_, library_, compression_;
    std::vector<std::string> names_; // in the order of the file
};

// In grid_file.cpp: grids of an OpenVDB file, read by a stream that throws where the file ends. The library's own
// openvdb::io::File reads on: numbers that were not there keep what memory held, so a damaged file asked for another
// amount of memory and time, and could give other contents, each time that it was read.
// An open file, of which the heads are read and, unless it was written to a stream that cannot seek, no grid. All
// functions throw openvdb::Exception or std::ios_base::failure where it is damaged, Failure where its format is newer.
class GridFile : private openvdb::io::Archive {
  public:
    explicit GridFile(const std::string& path);

    using Archive::compression;
    using Archive::version; // of what wrote the file, "10.0/224"
    // "density", or "density[1]" where several have one name; by the alphabet.
    std::vector<std::string> names() const;
    const openvdb::MetaMap& metadata() const { return metadata_; } // of the whole file
    // The grid of one of names(), or the first with a name that several have; null if there is none.
    openvdb::GridBase::Ptr grid(const std::string& name);

  private:
    using Descriptors = std::multimap<std::string, openvdb::io::GridDescriptor>;

    void readHeads();
    Descriptors::const_iterator find(const std::string& name) const;
    openvdb::GridBase::Ptr readAt(const openvdb::io::GridDescriptor& descriptor);

    std::ifstream stream_;
    openvdb::io::StreamMetadata::Ptr streamMetadata_; // as long as the stream: it keeps the pointer's address
    openvdb::MetaMap metadata_;
    Descriptors descriptors_; // by name without number
    NamedGridMap read_;       // where all had to be read at once; by unique name
};

// An open file of either kind. Its heads are read, its grids are not.
class VdbInput {
  public:
    explicit VdbInput(const std::string& path);
    const std::string& path() const { return path_; }
    std::vector<std::string> names() const;
    std::string library() const; // version of what wrote the file
    std::string compression() const;
    openvdb::MetaMap metadata() const; // of the whole file
    // nullptr if there is no such grid. Throws Failure if its transform is singular.
    openvdb::GridBase::Ptr grid(const std::string& name);
    // "grid `density` of `a.vdb`", for messages.
    std::string subject(const std::string& name) const;

  private:
    openvdb::GridBase::Ptr readGrid(const std::string& name);

    std::string path_;
    std::unique_ptr<GridFile> file_; // one of the two
    std::unique_ptr<NanoVdbFile> nano_;
};

// A field with background 0, inactive voxels 0 and finite values; and what was changed for that.
template <typename GridType> struct Field {
    typename GridType::Ptr grid;
    std::vector<std::string> notes;
};

// Numbers, none below 0. Any numeric grid becomes float; a level set only with `use`. Throws Failure.
Field<openvdb::FloatGrid> amountField(const VdbInput& input, const openvdb::GridBase::Ptr& grid, VdbUse use);
// Vectors of float. Throws Failure.
Field<openvdb::Vec3SGrid> vectorField(const VdbInput& input, const openvdb::GridBase::Ptr& grid);

// nullopt if the map is not affine, or has no inverse.
std::optional<Transform> affineTransform(const openvdb::GridBase& grid);
VolumeClass volumeClassOf(const openvdb::GridBase& grid);
// As the metadata "unit" or "units" say, else "".
std::string unitOf(const openvdb::GridBase& grid);

} // namespace abbe::vdb

namespace abbe::vdb {

// Grids made leaf by leaf in parallel, and files of them.

// Sets the values of the leaf whose first voxel is given; false if all are 0.
using LeafFunction = std::function<bool(Vec3T<int> origin, RecipeLeaf& leaf)>;

// One grid per field, float or Vec3s, of all leaves in the box (voxels). Progress goes to the program, up to `done`.
openvdb::GridPtrVec buildGrids(std::span<const RecipeField> fields, const openvdb::CoordBBox& voxels,
                               const LeafFunction& leaf, double done);

// Writes all grids, compressed by blosc, and reads the last one back. Throws Failure.
void writeGrids(const std::string& path, const openvdb::GridPtrVec& grids);

} // namespace abbe::vdb
