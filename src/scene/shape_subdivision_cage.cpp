#include "geometry/subdivision_surface.h"
#include "io/mesh_file.h"
#include "scene/file_faults.h"
#include "scene/shape_subdivision.h"

#include <cmath>
#include <fmt/format.h>

namespace abbe {

using namespace subdivision_words;

namespace {

using Cage = SubdivisionCage;

template <typename Enum, std::size_t n>
void choose(Enum& out, const std::string& word, const std::string_view (&list)[n]) {
    for (std::size_t i = 0; i < n; ++i)
        if (list[i] == word) out = static_cast<Enum>(i);
}

std::optional<LoadedCage> cageFromFile(const schema::Text& file, double unit, Span span, Diagnostics& diagnostics) {
    const Span at = file.span.valid() ? file.span : span;
    std::optional<LoadedCage> cage;
    readsFile(file.value, at, diagnostics, [&] {
        CageFile read = readCage(file.value);
        for (Vec3& p : read.cage.positions) p = Vec3(Vec3d(p) * unit);
        if (read.ignoredTags > 0)
            diagnostics.warning(
                "W0660", at,
                fmt::format("{} tags of the file are left out, the first is `{}`", read.ignoredTags, read.ignoredTag),
                "not known here");
        cage = LoadedCage{std::move(read.cage), std::move(read.groups)};
    });
    return cage;
}

void cageFault(Span span, Diagnostics& diagnostics, std::string what) {
    diagnostics.error("E0660", span, std::move(what), "damaged cage");
}

// Texture coordinates written in place.
bool addUvs(const SubdivisionParams& p, Cage& cage, Span span, Diagnostics& diagnostics) {
    if (p.uvs.empty() && p.uvFaces.counts.empty()) return true;
    const auto fault = [&](std::string what) {
        cageFault(span, diagnostics, std::move(what));
        return false;
    };
    if (!p.file.value.empty()) return fault("`uvs` and `uv-faces` belong to `points`: a file has its own");
    if (p.uvs.size() % 2 != 0 || p.uvs.empty())
        return fault(fmt::format("`uvs` are pairs of numbers, but there are {}", p.uvs.size()));
    for (std::size_t i = 0; i < p.uvs.size(); i += 2)
        cage.uvs.push_back({static_cast<float>(p.uvs[i]), static_cast<float>(p.uvs[i + 1])});
    if (!p.uvFaces.counts.empty()) {
        if (p.uvFaces.counts.size() != cage.faceSizes.size())
            return fault(
                fmt::format("`uv-faces` has {} rows for {} faces", p.uvFaces.counts.size(), cage.faceSizes.size()));
        for (std::size_t f = 0; f < cage.faceSizes.size(); ++f)
            if (p.uvFaces.counts[f] != cage.faceSizes[f])
                return fault(fmt::format("row {} of `uv-faces` has {} corners, but the face has {}", f,
                                         p.uvFaces.counts[f], cage.faceSizes[f]));
        cage.uvCorners = p.uvFaces.indices;
        return true;
    }
    if (cage.uvs.size() != cage.positions.size())
        return fault(fmt::format("{} `uvs` for {} points: without `uv-faces` there is one for each", cage.uvs.size(),
                                 cage.positions.size()));
    cage.uvCorners = cage.corners;
    return true;
}

bool addCreases(const std::vector<schema::SharpRow>& rows, Cage& cage, Diagnostics& diagnostics) {
    for (const schema::SharpRow& row : rows) {
        if (row.vertices.size() < 2) {
            cageFault(row.span, diagnostics, "a crease is a row of at least two vertices");
            return false;
        }
        for (std::size_t i = 1; i < row.vertices.size(); ++i)
            cage.creases.push_back(
                {row.vertices[i - 1], row.vertices[i], static_cast<float>(std::min(row.sharpness.value_or(10), 1e6))});
        if (const auto fault = findFault(cage)) {
            cageFault(row.span, diagnostics, *fault);
            return false;
        }
    }
    return true;
}

bool addCorners(const std::vector<schema::SharpRow>& rows, Cage& cage, Diagnostics& diagnostics) {
    for (const schema::SharpRow& row : rows)
        for (const std::uint32_t v : row.vertices) {
            if (v >= cage.positions.size()) {
                cageFault(row.span, diagnostics,
                          fmt::format("a corner names vertex {}, but there are {} points", v, cage.positions.size()));
                return false;
            }
            cage.sharpCorners.push_back({v, static_cast<float>(std::min(row.sharpness.value_or(10), 1e6))});
        }
    return true;
}

bool addHoles(const std::vector<double>& holes, Cage& cage, Span span, Diagnostics& diagnostics) {
    for (const double f : holes) {
        if (f != std::floor(f) || !(f < static_cast<double>(cage.faceSizes.size()))) {
            cageFault(
                span, diagnostics,
                fmt::format("a hole names face {}, but there are {} faces, numbered from 0", f, cage.faceSizes.size()));
            return false;
        }
        cage.holes.push_back(static_cast<std::uint32_t>(f));
    }
    return true;
}

} // namespace

std::optional<LoadedCage> loadCage(const SubdivisionParams& p, double unit, Span span, Diagnostics& diagnostics) {
    std::optional<LoadedCage> loaded;
    if (!p.file.value.empty()) {
        loaded = cageFromFile(p.file, unit, span, diagnostics);
        if (!loaded) return std::nullopt;
    } else {
        loaded.emplace();
        for (const Vec3d point : p.points) loaded->cage.positions.push_back(Vec3(point));
        loaded->cage.faceSizes = p.faces.counts;
        loaded->cage.corners = p.faces.indices;
    }
    Cage& cage = loaded->cage;
    if (!addUvs(p, cage, span, diagnostics)) return std::nullopt;
    if (!addAttributes(p.attributes, !p.file.value.empty(), cage.positions.size(), cage.attributes, diagnostics))
        return std::nullopt;
    choose(cage.scheme, p.scheme.word, kSchemes);
    if (p.boundary) choose(cage.boundary, p.boundary->word, kBoundaries);
    if (p.faceVarying) choose(cage.faceVarying, p.faceVarying->word, kFaceVarying);
    if (p.creasing) choose(cage.creasing, p.creasing->word, kCreasings);
    if (const auto fault = findFault(cage)) {
        cageFault(p.file.span.valid() ? p.file.span : span, diagnostics, *fault);
        return std::nullopt;
    }
    if (!addCreases(p.creases, cage, diagnostics) || !addCorners(p.corners, cage, diagnostics) ||
        !addHoles(p.holes, cage, span, diagnostics))
        return std::nullopt;
    return loaded;
}

} // namespace abbe
