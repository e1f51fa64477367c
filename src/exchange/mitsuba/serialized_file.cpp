#include "exchange/mitsuba/shapes.h"
#include "exchange/shared/inflate.h"
#include "io/file.h"

#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace abbe::exchange {

namespace {

// Layout: [Mitsuba 3 documentation, "Serialized mesh loader"]: a header of two 16-bit numbers before every deflated
// mesh, and at the end of the file the offsets of all of them and how many there are.
constexpr std::uint16_t kMagic = 0x041c;
constexpr std::uint32_t kHasNormals = 0x0001, kHasUvs = 0x0002, kHasColors = 0x0008, kDoubles = 0x2000;
constexpr std::uint64_t kMostExpansion = 1100; // deflate makes no more of a byte

[[noreturn]] void failSerialized(const std::string& path, std::string_view why) {
    throw IoError(fmt::format("`{}`: {}", path, why));
}

template <typename T> T plain(std::string_view bytes, std::size_t at, const std::string& path) {
    if (at > bytes.size() || bytes.size() - at < sizeof(T)) failSerialized(path, "the file ends too early");
    T value;
    std::memcpy(&value, bytes.data() + at, sizeof(T));
    return value;
}

std::string meshBytes(std::string_view packed, const std::string& path) {
    Inflated result = inflated(packed, Packing::zlib, packed.size() * kMostExpansion);
    if (result.end != Inflated::End::whole) failSerialized(path, "a mesh of it is damaged");
    return std::move(result.bytes);
}

// Values one after the other.
class SerializedReader {
  public:
    SerializedReader(std::string_view bytes, const std::string& path) : bytes_(bytes), path_(path) {}
    template <typename T> T next() {
        const T value = plain<T>(bytes_, at_, path_);
        at_ += sizeof(T);
        return value;
    }
    float real(bool doubles) { return doubles ? static_cast<float>(next<double>()) : next<float>(); }
    void text() {
        while (next<char>() != 0) {
        }
    }
    // Whether so many values can be left.
    void require(std::uint64_t count, std::uint64_t bytesEach) {
        if (count > (bytes_.size() - at_) / bytesEach) failSerialized(path_, "a mesh of it ends too early");
    }

  private:
    std::string_view bytes_;
    const std::string& path_;
    std::size_t at_ = 0;
};

void readTriangles(SerializedReader& in, MeshData& mesh, std::uint64_t triangles, const std::string& path) {
    in.require(triangles, 12);
    for (std::uint64_t i = 0; i < triangles; ++i) {
        std::array<std::uint32_t, 3> face{};
        for (std::uint32_t& index : face) {
            index = in.next<std::uint32_t>();
            if (index >= mesh.positions.size()) failSerialized(path, "a face names a vertex that is not there");
        }
        mesh.triangles.push_back(face);
    }
}

MeshData meshOf(std::string_view bytes, std::uint16_t version, const std::string& path) {
    SerializedReader in(bytes, path);
    const auto flags = in.next<std::uint32_t>();
    if (version >= 4) in.text(); // its name
    const auto vertices = in.next<std::uint64_t>(), triangles = in.next<std::uint64_t>();
    const bool doubles = (flags & kDoubles) != 0;
    in.require(vertices, doubles ? 24 : 12);
    MeshData mesh;
    const auto vectors = [&](std::vector<Vec3>& to) {
        in.require(vertices, doubles ? 24 : 12);
        for (std::uint64_t i = 0; i < vertices; ++i) {
            const float x = in.real(doubles), y = in.real(doubles), z = in.real(doubles);
            to.emplace_back(x, y, z);
        }
    };
    vectors(mesh.positions);
    if (flags & kHasNormals) vectors(mesh.normals);
    if (flags & kHasUvs)
        for (std::uint64_t i = 0; i < vertices; ++i) {
            const float u = in.real(doubles), v = in.real(doubles);
            mesh.uvs.push_back({u, v});
        }
    if (flags & kHasColors) {
        std::vector<Vec3> colors;
        vectors(colors);
        MeshAttribute color{"color", 3, {}};
        for (const Vec3 c : colors) color.values.insert(color.values.end(), {c.x, c.y, c.z});
        mesh.attributes.push_back(std::move(color));
    }
    readTriangles(in, mesh, triangles, path);
    return mesh;
}

} // namespace

MeshData readSerializedMesh(const std::string& path, std::size_t index) {
    static_assert(std::endian::native == std::endian::little);
    const std::string file = readFileBytes(path);
    const std::string_view bytes = file;
    if (bytes.size() < 8 || plain<std::uint16_t>(bytes, 0, path) != kMagic)
        failSerialized(path, "it is no file of serialized meshes");
    const auto version = plain<std::uint16_t>(bytes, 2, path);
    if (version != 3 && version != 4)
        failSerialized(path, fmt::format("version {} of the format is not read", version));
    const auto count = plain<std::uint32_t>(bytes, bytes.size() - 4, path);
    const std::size_t each = version == 4 ? 8 : 4; // of an offset
    if (index >= count) failSerialized(path, fmt::format("it has {} meshes, and no number {}", count, index));
    if (count > (bytes.size() - 4) / each) failSerialized(path, "its list of meshes is damaged");
    const std::size_t table = bytes.size() - 4 - each * count;
    const auto offset = [&](std::size_t i) -> std::uint64_t {
        if (i == count) return table;
        return version == 4 ? plain<std::uint64_t>(bytes, table + 8 * i, path)
                            : plain<std::uint32_t>(bytes, table + 4 * i, path);
    };
    const std::uint64_t begin = offset(index), end = offset(index + 1);
    if (begin > table || end > table || end < begin + 4) failSerialized(path, "its list of meshes is damaged");
    MeshData mesh = meshOf(meshBytes(bytes.substr(begin + 4, end - begin - 4), path), version, path);
    for (const Vec3 p : mesh.positions)
        if (!std::isfinite(p.x + p.y + p.z)) failSerialized(path, "a vertex has numbers that are not finite");
    return mesh;
}

} // namespace abbe::exchange
