// Grids of an OpenVDB file, and fields made of them that can be rendered. One of the few headers with OpenVDB.
#pragma once

#include "vdb/instantiated.h"
#include "volumes/vdb_file.h"

#include <memory>
#include <openvdb/Grid.h>
#include <openvdb/Types.h>
#include <openvdb/io/File.h>
#include <openvdb/openvdb.h>

namespace abbe::vdb {

// An open file. Its heads are read, its grids are not.
class VdbInput {
  public:
    explicit VdbInput(const std::string& path);
    const std::string& path() const { return path_; }
    openvdb::io::File& file() { return *file_; }
    std::vector<std::string> names() const;
    // nullptr if there is no such grid. Throws Failure if its transform is singular.
    openvdb::GridBase::Ptr grid(const std::string& name);
    // "grid `density` of `a.vdb`", for messages.
    std::string subject(const std::string& name) const;

  private:
    std::string path_;
    std::unique_ptr<openvdb::io::File> file_;
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
