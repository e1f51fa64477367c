#include "exchange/pbrt/pbrt_shared.h"

#include "io/file.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vector>
#include <zlib.h>

namespace abbe::exchange {

namespace {

// No compressed file becomes more than this: a few bytes could ask for any amount of memory.
constexpr std::size_t kPbrtMostUnpacked = std::size_t(1) << 32;

std::string pbrtUnpack(std::string_view packed, const std::string& path) {
    z_stream stream{};
    if (inflateInit2(&stream, 15 + 16) != Z_OK) throw IoError(fmt::format("cannot unpack `{}`", path));
    std::string out;
    std::vector<char> block(std::size_t(1) << 20);
    std::size_t given = 0;
    int result = Z_OK;
    while (result == Z_OK) {
        if (stream.avail_in == 0) {
            if (given == packed.size()) break;
            const std::size_t part = std::min<std::size_t>(packed.size() - given, std::size_t(1) << 30);
            stream.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data() + given)); // zlib only reads it
            stream.avail_in = static_cast<uInt>(part);
            given += part;
        }
        stream.next_out = reinterpret_cast<Bytef*>(block.data());
        stream.avail_out = static_cast<uInt>(block.size());
        result = inflate(&stream, Z_NO_FLUSH);
        out.append(block.data(), block.size() - stream.avail_out);
        if (out.size() > kPbrtMostUnpacked) break;
    }
    inflateEnd(&stream);
    if (out.size() > kPbrtMostUnpacked) throw IoError(fmt::format("`{}` is larger than 4 GiB when unpacked", path));
    if (result != Z_STREAM_END) throw IoError(fmt::format("`{}` is no intact gzip file", path));
    return out;
}

bool pbrtIsDiagonal(const Transform& t) {
    for (int r = 0; r < 3; ++r)
        for (int c = 0; c < 3; ++c)
            if (r != c && t.a[r][c] != 0) return false;
    return true;
}

} // namespace

std::string pbrtReadFile(const std::filesystem::path& path) {
    std::string bytes = readFileBytes(path.string());
    if (bytes.size() > 2 && bytes[0] == '\x1f' && bytes[1] == '\x8b') return pbrtUnpack(bytes, path.string());
    return bytes;
}

bool pbrtIsIdentity(const Transform& t) {
    return pbrtIsDiagonal(t) && t.a[0][0] == 1 && t.a[1][1] == 1 && t.a[2][2] == 1 && t.t == Vec3d();
}

void pbrtSteps(SceneNode& node, const Transform& t) {
    if (!pbrtIsDiagonal(t)) {
        SceneNode& matrix = node.child("matrix");
        for (int r = 0; r < 3; ++r) matrix.number(t.a[r][0]).number(t.a[r][1]).number(t.a[r][2]).number(t.t[r]);
        matrix.number(0).number(0).number(0).number(1);
        return;
    }
    const Vec3d scale{t.a[0][0], t.a[1][1], t.a[2][2]};
    if (scale.x != scale.y || scale.y != scale.z)
        node.child("scale").vector(scale);
    else if (scale.x != 1)
        node.child("scale").number(scale.x);
    if (t.t != Vec3d() || scale == Vec3d(1, 1, 1)) node.child("translate").vector(t.t);
}

void pbrtTransform(SceneNode& parent, const Transform& t) {
    if (!pbrtIsIdentity(t)) pbrtSteps(parent.child("transform"), t);
}

} // namespace abbe::exchange
