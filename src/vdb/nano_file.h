// Grids of NanoVDB files (.nvdb), made to grids of OpenVDB.
#pragma once

#include <cstdint>
#include <openvdb/Grid.h>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::vdb {

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

} // namespace abbe::vdb
