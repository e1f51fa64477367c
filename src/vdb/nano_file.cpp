#include "vdb/field.h"
#include "vdb/output.h"

#include <algorithm>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

// Both packings that the format knows.
#define NANOVDB_USE_BLOSC
#define NANOVDB_USE_ZIP
#include <nanovdb/util/IO.h>
#include <openvdb/openvdb.h>

namespace abbe::vdb {

namespace {

using Kind = VdbFault::Kind;

// No packing of the format makes a byte of more than this: zlib's limit is 1032, that of Blosc 255.
constexpr std::uint64_t kMostUnpacked = 1100;

std::string codecText(nanovdb::io::Codec codec) {
    using nanovdb::io::Codec;
    return codec == Codec::ZIP ? "zip" : codec == Codec::BLOSC ? "blosc" : "none";
}

// What a head says about sizes against what there is, before memory is taken for it.
void checkSizes(const nanovdb::io::MetaData& grid, nanovdb::io::Codec codec, std::uint64_t left,
                const std::string& subject) {
    const std::uint64_t most = codec == nanovdb::io::Codec::NONE ? grid.fileSize : kMostUnpacked * grid.fileSize;
    if (grid.fileSize > left || grid.gridSize > most)
        throw Failure(Kind::damaged,
                      fmt::format("{} is damaged or cut off: it states {} bytes, packed into {}, of which {} are there",
                                  subject, grid.gridSize, grid.fileSize, std::min<std::uint64_t>(grid.fileSize, left)));
}

float valueOf(float v, float) { return v; }
template <typename T> float valueOf(T v, float) { return static_cast<float>(v); }
template <typename T> openvdb::Vec3s valueOf(const nanovdb::Vec3<T>& v, openvdb::Vec3s) {
    return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

openvdb::Coord coord(const nanovdb::Coord& c) { return {c[0], c[1], c[2]}; }

// The library's own way, nanovdb::NanoToOpenVDB, makes nodes instead of asking the tree for them. That is a third of
// what this folder takes to compile, since OpenVDB exports trees but not their nodes.
template <typename Build, typename Tree> class TreeCopy {
  public:
    TreeCopy(const nanovdb::NanoTree<Build>& from, Tree& to) : to_(to) {
        const auto* root = from.root().data();
        for (std::uint32_t i = 0; i < root->mTableSize; ++i) {
            const auto* tile = root->tile(i);
            if (tile->isChild())
                copyInternal(*root->getChild(tile), 2);
            else
                to_.addTile(3, coord(tile->origin()), value(tile->value), tile->state);
        }
    }

  private:
    using Value = typename Tree::ValueType;
    template <typename T> static Value value(const T& v) { return valueOf(v, Value()); }

    // `level`: of the node's tiles.
    template <typename Node> void copyInternal(const Node& node, openvdb::Index level) {
        const auto* data = node.data();
        for (std::uint32_t n = 0; n < Node::SIZE; ++n) {
            if (!node.childMask().isOn(n))
                to_.addTile(level, coord(node.offsetToGlobalCoord(n)), value(data->mTable[n].value),
                            node.valueMask().isOn(n));
            else if constexpr (Node::LEVEL == 2)
                copyInternal(*data->getChild(n), 1);
            else
                copyLeaf(*data->getChild(n));
        }
    }

    void copyLeaf(const nanovdb::NanoLeaf<Build>& from) {
        auto* leaf = to_.touchLeaf(coord(from.origin()));
        Value* values = leaf->buffer().data();
        for (std::uint32_t i = 0; i < nanovdb::NanoLeaf<Build>::SIZE; ++i) {
            values[i] = value(from.getValue(i));
            leaf->setActiveState(i, from.isActive(i));
        }
    }

    Tree& to_;
};

openvdb::math::Transform::Ptr transformOf(const nanovdb::Map& map) {
    auto m = openvdb::Mat4d::identity();
    m.setMat3(openvdb::Mat3d(map.mMatD).transpose()); // which acts from the other side there
    m.setTranslation(openvdb::Vec3d(map.mVecD));
    return openvdb::math::Transform::createLinearTransform(m);
}

openvdb::GridClass classOf(nanovdb::GridClass c) {
    return c == nanovdb::GridClass::LevelSet    ? openvdb::GRID_LEVEL_SET
           : c == nanovdb::GridClass::FogVolume ? openvdb::GRID_FOG_VOLUME
           : c == nanovdb::GridClass::Staggered ? openvdb::GRID_STAGGERED
                                                : openvdb::GRID_UNKNOWN;
}

using Handle = nanovdb::GridHandle<nanovdb::HostBuffer>;

// Null if the grid is not of that type.
template <typename Build, typename To> openvdb::GridBase::Ptr converted(const Handle& handle) {
    const auto* from = handle.template grid<Build>();
    if (!from) return nullptr;
    auto grid = To::create(valueOf(from->tree().background(), typename To::ValueType()));
    grid->setName(from->gridName());
    grid->setGridClass(classOf(from->gridClass()));
    grid->setTransform(transformOf(from->map()));
    TreeCopy<Build, typename To::TreeType>(from->tree(), grid->tree());
    return grid;
}

openvdb::GridBase::Ptr toOpenVdb(const Handle& handle) {
    using openvdb::FloatGrid, openvdb::Vec3SGrid;
    constexpr openvdb::GridBase::Ptr (*kConverts[])(const Handle&) = {
        converted<float, FloatGrid>,         converted<nanovdb::Vec3f, Vec3SGrid>, converted<nanovdb::Fp16, FloatGrid>,
        converted<nanovdb::Fp8, FloatGrid>,  converted<nanovdb::Fp4, FloatGrid>,   converted<nanovdb::FpN, FloatGrid>,
        converted<double, FloatGrid>,        converted<std::int32_t, FloatGrid>,   converted<std::int64_t, FloatGrid>,
        converted<nanovdb::Vec3d, Vec3SGrid>};
    for (const auto convert : kConverts)
        if (auto grid = convert(handle)) return grid;
    return nullptr;
}

} // namespace

bool looksLikeNanoVdb(std::string_view beginning) {
    const std::uint64_t magic = NANOVDB_MAGIC_NUMBER;
    return beginning.size() >= sizeof magic && std::memcmp(beginning.data(), &magic, sizeof magic) == 0;
}

NanoVdbFile::NanoVdbFile(const std::string& path) : path_(path) {
    std::ifstream file(path, std::ios::binary);
    const std::uint64_t size = std::filesystem::file_size(path);
    nanovdb::io::Segment segment;
    while (segment.read(file)) {
        const nanovdb::Version version = segment.header.version;
        if (library_.empty()) {
            library_ = fmt::format("{}.{}.{}", version.getMajor(), version.getMinor(), version.getPatch());
            compression_ = codecText(segment.header.codec);
        }
        auto at = static_cast<std::uint64_t>(file.tellg());
        for (const auto& grid : segment.meta) {
            checkSizes(grid, segment.header.codec, size - std::min(at, size),
                       fmt::format("grid `{}` of `{}`", grid.gridName, path));
            names_.push_back(grid.gridName);
            at += grid.fileSize;
        }
        file.seekg(static_cast<std::streamoff>(at));
    }
}

std::vector<std::string> NanoVdbFile::names() const { return names_; }

openvdb::GridBase::Ptr NanoVdbFile::grid(const std::string& name) const {
    const auto found = std::ranges::find(names_, name);
    if (found == names_.end()) return nullptr;
    const auto handle = nanovdb::io::readGrid(path_, static_cast<std::uint64_t>(found - names_.begin()));
    if (auto grid = toOpenVdb(handle)) return grid;
    throw Failure(Kind::wrongKind, fmt::format("grid `{}` of `{}` holds no numbers or vectors of three", name, path_));
}

} // namespace abbe::vdb
