#include "geometry/subdivision_check.h"
#include "io/cage_file.h"
#include "scene/shape_subdivision.h"
#include "scene/shape_subdivision_words.h"

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

std::optional<Cage> cageFromFile(const schema::Text& file, double unit, Span span, Diagnostics& diagnostics) {
    const Span at = file.span.valid() ? file.span : span;
    try {
        CageFile read = readCage(file.value);
        for (Vec3& p : read.cage.positions) p = Vec3(Vec3d(p) * unit);
        if (read.ignoredTags > 0)
            diagnostics.warning(
                "W0660", at,
                fmt::format("{} tags of the file are left out, the first is `{}`", read.ignoredTags, read.ignoredTag),
                "not known here");
        return std::move(read.cage);
    } catch (const IoError& e) {
        diagnostics.error("E0402", at, e.what(), "cannot be read");
    } catch (const std::bad_alloc&) {
        diagnostics.error("E0404", at, fmt::format("`{}` does not fit into memory", file.value));
    }
    return std::nullopt;
}

void cageFault(Span span, Diagnostics& diagnostics, std::string what) {
    diagnostics.error("E0660", span, std::move(what), "damaged cage");
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

std::optional<Cage> loadCage(const SubdivisionParams& p, double unit, Span span, Diagnostics& diagnostics) {
    std::optional<Cage> cage;
    if (!p.file.value.empty()) {
        cage = cageFromFile(p.file, unit, span, diagnostics);
        if (!cage) return std::nullopt;
    } else {
        cage.emplace();
        for (const Vec3d point : p.points) cage->positions.push_back(Vec3(point));
        cage->faceSizes = p.faces.counts;
        cage->corners = p.faces.indices;
    }
    choose(cage->scheme, p.scheme.word, kSchemes);
    if (p.boundary) choose(cage->boundary, p.boundary->word, kBoundaries);
    if (p.faceVarying) choose(cage->faceVarying, p.faceVarying->word, kFaceVarying);
    if (p.creasing) choose(cage->creasing, p.creasing->word, kCreasings);
    if (const auto fault = findFault(*cage)) {
        cageFault(p.file.span.valid() ? p.file.span : span, diagnostics, *fault);
        return std::nullopt;
    }
    if (!addCreases(p.creases, *cage, diagnostics) || !addCorners(p.corners, *cage, diagnostics) ||
        !addHoles(p.holes, *cage, span, diagnostics))
        return std::nullopt;
    return cage;
}

} // namespace abbe
