#include "exchange/shared/vdb_writer.h"

#include "base/check.h"

#include <bit>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <map>
#include <vector>

namespace abbe::exchange {

static_assert(std::endian::native == std::endian::little);

namespace {

// The layout of version 222 of the format, without compression, as OpenVDB's io/ and tree/ read it. A tree has nodes of
// 32³ children, of which each has 16³ leaves of 8³ voxels. First all nodes come with their masks, then the leaves'
// values.
constexpr std::uint32_t kVdbVersion = 222;
constexpr int kLeafSide = 8, kLowerSide = 16, kUpperSide = 32;
constexpr std::int8_t kAllValues = 6; // "no mask, all values are there"

struct VdbLeaf {
    std::array<float, 512> values{};
    std::array<std::uint64_t, 8> mask{};
};

using VdbCoord = std::array<int, 3>;

// Numbers of children within a node: x counts slowest.
struct VdbLower {
    std::map<std::uint32_t, VdbLeaf> leaves;
};
struct VdbUpper {
    std::map<std::uint32_t, VdbLower> children;
};
using VdbRoot = std::map<VdbCoord, VdbUpper>; // by origin

class VdbWriter {
  public:
    template <typename T> VdbWriter& put(const T& value) {
        std::array<char, sizeof(T)> bytes;
        std::memcpy(bytes.data(), &value, sizeof(T));
        out_.append(bytes.data(), bytes.size());
        return *this;
    }
    VdbWriter& text(std::string_view text) {
        put(static_cast<std::uint32_t>(text.size()));
        out_ += text;
        return *this;
    }
    VdbWriter& raw(std::string_view bytes) {
        out_ += bytes;
        return *this;
    }
    std::size_t size() const { return out_.size(); }
    void patch(std::size_t at, std::int64_t value) { std::memcpy(out_.data() + at, &value, sizeof value); }
    std::string take() { return std::move(out_); }

    // A mask with the bits of the children, then an empty one of values, then values that are all 0.
    template <typename Children> void inner(const Children& children, int side) {
        const auto count =
            static_cast<std::size_t>(side) * static_cast<std::size_t>(side) * static_cast<std::size_t>(side);
        std::vector<std::uint64_t> mask(count / 64, 0);
        for (const auto& [number, child] : children) mask[number / 64] |= std::uint64_t{1} << (number % 64);
        for (const std::uint64_t word : mask) put(word);
        out_.append(count / 8, '\0');
        put(kAllValues);
        out_.append(4 * count, '\0');
    }

  private:
    std::string out_;
};

std::uint32_t vdbNumber(int x, int y, int z, int side) { return static_cast<std::uint32_t>((x * side + y) * side + z); }

VdbRoot vdbTree(std::array<int, 3> counts, std::span<const float> values) {
    VdbRoot root;
    constexpr int kLower = kLeafSide * kLowerSide, kUpper = kLower * kUpperSide;
    std::size_t at = 0;
    for (int z = 0; z < counts[2]; ++z)
        for (int y = 0; y < counts[1]; ++y)
            for (int x = 0; x < counts[0]; ++x, ++at) {
                if (values[at] == 0) continue;
                VdbUpper& upper = root[{x / kUpper * kUpper, y / kUpper * kUpper, z / kUpper * kUpper}];
                VdbLower& lower =
                    upper
                        .children[vdbNumber(x % kUpper / kLower, y % kUpper / kLower, z % kUpper / kLower, kUpperSide)];
                VdbLeaf& leaf = lower.leaves[vdbNumber(x % kLower / kLeafSide, y % kLower / kLeafSide,
                                                       z % kLower / kLeafSide, kLowerSide)];
                const std::uint32_t voxel = vdbNumber(x % kLeafSide, y % kLeafSide, z % kLeafSide, kLeafSide);
                leaf.values[voxel] = values[at];
                leaf.mask[voxel / 64] |= std::uint64_t{1} << (voxel % 64);
            }
    return root;
}

void writeVdbTree(VdbWriter& out, const VdbRoot& root) {
    out.put(std::uint32_t{1}).put(0.0f); // buffers of a leaf; background
    out.put(std::uint32_t{0}).put(static_cast<std::uint32_t>(root.size()));
    for (const auto& [origin, upper] : root) {
        for (const int c : origin) out.put(static_cast<std::int32_t>(c));
        out.inner(upper.children, kUpperSide);
        for (const auto& [number, lower] : upper.children) {
            out.inner(lower.leaves, kLowerSide);
            for (const auto& [leafNumber, leaf] : lower.leaves) out.put(leaf.mask);
        }
    }
}

void writeVdbBuffers(VdbWriter& out, const VdbRoot& root) {
    for (const auto& [origin, upper] : root)
        for (const auto& [number, lower] : upper.children)
            for (const auto& [leafNumber, leaf] : lower.leaves) out.put(leaf.mask).put(kAllValues).put(leaf.values);
}

void writeVdbGrid(VdbWriter& out, std::array<int, 3> counts, const VdbGrid& grid) {
    ABBE_CHECK(grid.values.size() == static_cast<std::size_t>(counts[0]) * static_cast<std::size_t>(counts[1]) *
                                         static_cast<std::size_t>(counts[2]));
    const VdbRoot root = vdbTree(counts, grid.values);
    out.text(grid.name).text("Tree_float_5_4_3").text("");
    const std::size_t positions = out.size();
    out.put(std::int64_t{0}).put(std::int64_t{0}).put(std::int64_t{0});
    out.patch(positions, static_cast<std::int64_t>(out.size()));
    out.put(std::uint32_t{0}); // compression
    out.put(std::uint32_t{1}).text("class").text("string").text("fog volume");
    out.text("UniformScaleMap");
    // Scale, size of a voxel, 1 / scale, its square, 1 / (2 scale).
    for (const double scale : {1.0, 1.0, 1.0, 1.0, 0.5})
        for (int axis = 0; axis < 3; ++axis) out.put(scale);
    writeVdbTree(out, root);
    out.patch(positions + 8, static_cast<std::int64_t>(out.size()));
    writeVdbBuffers(out, root);
    out.patch(positions + 16, static_cast<std::int64_t>(out.size()));
}

} // namespace

std::string vdbFile(std::array<int, 3> counts, std::span<const VdbGrid> grids) {
    VdbWriter out;
    out.put(std::int64_t{0x56444220}).put(kVdbVersion).put(std::uint32_t{6}).put(std::uint32_t{0}).put(char{1});
    out.raw("00000000-0000-0000-0000-000000000000");
    out.put(std::uint32_t{0}).put(static_cast<std::uint32_t>(grids.size())); // metadata of the file, grids
    for (const VdbGrid& grid : grids) writeVdbGrid(out, counts, grid);
    return out.take();
}

} // namespace abbe::exchange
