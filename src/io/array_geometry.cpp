#include "io/array_geometry.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace abbe {

namespace {

[[noreturn]] void refuseArrays(const std::string& name, const std::string& why) {
    throw IoError(fmt::format("cannot take `{}`: {}", name, why));
}

void requireFinite(std::span<const float> values, std::string_view array, const std::string& name) {
    const auto bad = std::ranges::find_if(values, [](float x) { return !std::isfinite(x); });
    if (bad != values.end())
        refuseArrays(name, fmt::format("number {} of `{}` is {}", bad - values.begin(), array, *bad));
}

// Three numbers for each of `count` points, or none at all.
std::vector<Vec3> vectorsOf(const NamedArrays& arrays, std::string_view array, std::size_t count,
                            const std::string& name) {
    const std::span<const float> values = arrays.of(array);
    if (!values.empty() && values.size() != 3 * count)
        refuseArrays(name, fmt::format("`{}` has {} numbers for {} points", array, values.size(), count));
    requireFinite(values, array, name);
    std::vector<Vec3> vectors(values.size() / 3);
    for (std::size_t i = 0; i < vectors.size(); ++i) vectors[i] = {values[3 * i], values[3 * i + 1], values[3 * i + 2]};
    return vectors;
}

std::vector<Vec3> pointsIn(const NamedArrays& arrays, const std::string& name) {
    const std::size_t numbers = arrays.of("points").size();
    if (numbers % 3 != 0) refuseArrays(name, fmt::format("`points` has {} numbers, no multiple of three", numbers));
    return vectorsOf(arrays, "points", numbers / 3, name);
}

std::vector<Vec2> uvsOf(const NamedArrays& arrays, std::size_t count, const std::string& name) {
    const std::span<const float> values = arrays.of("uvs");
    if (!values.empty() && values.size() != 2 * count)
        refuseArrays(name, fmt::format("`uvs` has {} numbers for {} points", values.size(), count));
    requireFinite(values, "uvs", name);
    std::vector<Vec2> uvs(values.size() / 2);
    for (std::size_t i = 0; i < uvs.size(); ++i) uvs[i] = {values[2 * i], values[2 * i + 1]};
    return uvs;
}

void addNamedAttributes(const NamedArrays& arrays, std::size_t count, const std::string& name,
                        std::vector<MeshAttribute>& to) {
    constexpr std::string_view kAttribute = "attribute:";
    for (const auto& [array, values] : arrays.floats) {
        if (!array.starts_with(kAttribute)) continue;
        if (values.size() != count && values.size() != 3 * count)
            refuseArrays(name, fmt::format("`{}` has {} numbers for {} points", array, values.size(), count));
        requireFinite(values, array, name);
        to.push_back({array.substr(kAttribute.size()), values.size() == count ? 1 : 3, {values.begin(), values.end()}});
    }
}

// Calls `face` with the corners of each.
template <typename Face>
void visitFaces(const NamedArrays& arrays, std::size_t points, const std::string& name, const Face& face) {
    const std::span<const std::uint32_t> indices = arrays.indices("faces"), sizes = arrays.indices("face-sizes");
    const auto fixed = static_cast<std::size_t>(arrays.size[0]);
    if (sizes.empty() && (fixed < 3 || indices.size() % fixed != 0))
        refuseArrays(name, fmt::format("`faces` has {} numbers, not {} for each face", indices.size(), fixed));
    const std::size_t count = sizes.empty() ? indices.size() / fixed : sizes.size();
    std::size_t first = 0;
    for (std::size_t i = 0; i < count; ++i) {
        const std::size_t corners = sizes.empty() ? fixed : sizes[i];
        if (corners < 3) refuseArrays(name, fmt::format("face {} has {} corners", i, corners));
        if (corners > indices.size() - first) refuseArrays(name, fmt::format("`faces` ends in face {}", i));
        const auto own = indices.subspan(first, corners);
        for (const std::uint32_t index : own)
            if (index >= points)
                refuseArrays(name, fmt::format("face {} names point {}, but there are {} points", i, index, points));
        if (!face(own)) refuseArrays(name, fmt::format("face {} is no polygon that can be split into triangles", i));
        first += corners;
    }
    if (first != indices.size())
        refuseArrays(name, fmt::format("`faces` has {} numbers, but its faces have {}", indices.size(), first));
}

} // namespace

MeshFile meshOf(const NamedArrays& arrays, const std::string& name) {
    MeshFile file;
    file.mesh.positions = pointsIn(arrays, name);
    const std::size_t count = file.mesh.positions.size();
    file.mesh.normals = vectorsOf(arrays, "normals", count, name);
    file.mesh.uvs = uvsOf(arrays, count, name);
    addNamedAttributes(arrays, count, name, file.mesh.attributes);
    visitFaces(arrays, count, name,
               [&](std::span<const std::uint32_t> corners) { return addPolygon(file.mesh, corners); });
    file.groups.push_back({{}, {}, 0, file.mesh.triangles.size(), 0, file.mesh.quads.size()});
    return file;
}

CageFile cageOf(const NamedArrays& arrays, const std::string& name) {
    CageFile file;
    file.cage.positions = pointsIn(arrays, name);
    visitFaces(arrays, file.cage.positions.size(), name, [&](std::span<const std::uint32_t> corners) {
        file.cage.faceSizes.push_back(static_cast<std::uint32_t>(corners.size()));
        file.cage.corners.insert(file.cage.corners.end(), corners.begin(), corners.end());
        return true;
    });
    return file;
}

PointFile pointsOf(const NamedArrays& arrays, const std::string& name) {
    PointFile file;
    file.positions = pointsIn(arrays, name);
    const std::size_t count = file.positions.size();
    file.normals = vectorsOf(arrays, "normals", count, name);
    const std::span<const float> radii = arrays.of("radii");
    if (!radii.empty() && radii.size() != count)
        refuseArrays(name, fmt::format("`radii` has {} numbers for {} points", radii.size(), count));
    requireFinite(radii, "radii", name);
    if (std::ranges::any_of(radii, [](float r) { return r < 0; })) refuseArrays(name, "`radii` has one below 0");
    file.radii.assign(radii.begin(), radii.end());
    const std::span<const std::uint32_t> counts = arrays.indices("counts");
    std::uint64_t sum = 0;
    for (const std::uint32_t one : counts) sum += one;
    if (!counts.empty() && sum != count)
        refuseArrays(name, fmt::format("the strands of `counts` have {} points, but there are {}", sum, count));
    file.strandSizes.assign(counts.begin(), counts.end());
    return file;
}

RgbImage imageOf(const NamedArrays& arrays, const std::string& name) {
    const auto [width, height, channels] = arrays.size;
    const std::span<const float> pixels = arrays.of("pixels");
    const auto expected = 3 * static_cast<std::size_t>(width) * static_cast<std::size_t>(height);
    if (channels != 3 || width < 1 || height < 1 || pixels.size() != expected)
        refuseArrays(name, "a picture has rows of pixels of three numbers");
    RgbImage image;
    image.window = image.display = {0, 0, width, height};
    image.rgb.assign(pixels.begin(), pixels.end());
    countFaults(image);
    return image;
}

} // namespace abbe
