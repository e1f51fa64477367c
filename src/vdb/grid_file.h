// Grids of an OpenVDB file, read by a stream that throws where the file ends. The library's own openvdb::io::File reads
// on: numbers that were not there keep what memory held, so a damaged file asked for another amount of memory and time,
// and could give other contents, each time that it was read.
#pragma once

#include <fstream>
#include <map>
#include <openvdb/Grid.h>
#include <openvdb/io/Archive.h>
#include <openvdb/io/GridDescriptor.h>
#include <openvdb/io/io.h>
#include <string>
#include <vector>

namespace abbe::vdb {

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

} // namespace abbe::vdb
