#include "vdb/field.h"
#include "vdb/output.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::vdb {

namespace {

// The library warns of a newer format, reads on as if it were this one, and calls the file damaged.
void checkFormat(std::istream& stream, const std::string& path) {
    std::int64_t magic;
    std::uint32_t format;
    stream.read(reinterpret_cast<char*>(&magic), sizeof magic);
    stream.read(reinterpret_cast<char*>(&format), sizeof format);
    stream.seekg(0);
    if (format > openvdb::OPENVDB_FILE_VERSION)
        throw Failure(
            VdbFault::Kind::damaged,
            fmt::format("`{}` has format {} of OpenVDB, and formats up to {} can be read: it was written by a "
                        "newer program, or is damaged",
                        path, format, openvdb::OPENVDB_FILE_VERSION));
}

} // namespace

using openvdb::GridBase;
using openvdb::io::GridDescriptor;

GridFile::GridFile(const std::string& path)
    : stream_(path, std::ios::binary), streamMetadata_(new openvdb::io::StreamMetadata) {
    stream_.exceptions(std::ios::failbit | std::ios::badbit);
    checkFormat(stream_, path);
    readHeader(stream_);
    openvdb::io::setStreamMetadataPtr(stream_, streamMetadata_, /*transfer=*/false);
    setFormatVersion(stream_);
    setLibraryVersion(stream_);
    setDataCompression(stream_);
    metadata_.readMeta(stream_);
    readHeads();
}

void GridFile::readHeads() {
    const bool canSeek = inputHasGridOffsets();
    for (std::int32_t left = readGridCount(stream_); left > 0; --left) {
        GridDescriptor descriptor;
        const GridBase::Ptr grid = descriptor.read(stream_);
        if (canSeek) {
            descriptor.seekToEnd(stream_);
        } else {
            readGrid(grid, descriptor, stream_);
            read_[descriptor.uniqueName()] = grid;
        }
        descriptors_.emplace(descriptor.gridName(), descriptor);
    }
    if (canSeek) return;
    for (const auto& [name, descriptor] : descriptors_) connectInstance(descriptor, read_);
}

std::vector<std::string> GridFile::names() const {
    std::vector<std::string> names;
    for (const auto& [name, descriptor] : descriptors_)
        names.push_back(GridDescriptor::nameAsString(descriptor.uniqueName()));
    return names;
}

GridFile::Descriptors::const_iterator GridFile::find(const std::string& name) const {
    const std::string unique = GridDescriptor::stringAsUniqueName(name);
    const auto same = [&](const auto& entry) { return entry.second.uniqueName() == unique; };
    const auto exact = std::find_if(descriptors_.begin(), descriptors_.end(), same);
    return exact != descriptors_.end() ? exact : descriptors_.find(name);
}

GridBase::Ptr GridFile::grid(const std::string& name) {
    const auto found = find(name);
    if (found == descriptors_.end()) return nullptr;
    const GridDescriptor& descriptor = found->second;
    if (const auto whole = read_.find(descriptor.uniqueName()); whole != read_.end()) return whole->second;
    const GridBase::Ptr grid = readAt(descriptor);
    if (!descriptor.isInstance()) return grid;
    // It has the tree of another one.
    const auto parent = find(GridDescriptor::nameAsString(descriptor.instanceParentName()));
    if (parent == descriptors_.end())
        OPENVDB_THROW(openvdb::IoError, "it shares the values of a grid that is not there");
    grid->setTree(readAt(parent->second)->baseTreePtr());
    return grid;
}

GridBase::Ptr GridFile::readAt(const GridDescriptor& descriptor) {
    const GridBase::Ptr grid = GridBase::createGrid(descriptor.gridType());
    grid->setSaveFloatAsHalf(descriptor.saveFloatAsHalf());
    descriptor.seekToGrid(stream_);
    readGrid(grid, descriptor, stream_);
    return grid;
}

} // namespace abbe::vdb
