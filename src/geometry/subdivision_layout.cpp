#include "geometry/subdivision_layout.h"

#include "base/check.h"

#include <opensubdiv/bfr/tessellation.h>
#include <opensubdiv/sdc/crease.h>
#include <optional>

namespace abbe {

using OpenSubdiv::Bfr::Parameterization;
using OpenSubdiv::Bfr::Tessellation;

const FacePattern& PatternMaker::pattern(const Parameterization& face, const std::vector<int>& rates) {
    if (rates == rates_) return pattern_; // the number of edges tells the parametrisations of one scheme apart
    rates_ = rates;
    pattern_.points.clear();
    pattern_.triangles.clear();
    pattern_.quads.clear();
    if (face.GetType() == Parameterization::QUAD && rates[0] == rates[2] && rates[1] == rates[3])
        grid(rates[0], rates[1]);
    else
        general(face, rates);
    return pattern_;
}

// A quad with equal rates on opposite edges: rows and columns, no transitions.
void PatternMaker::grid(int across, int along) {
    std::vector<Vec2>& p = pattern_.points;
    const auto at = [&](int i, int j) {
        p.push_back(
            {static_cast<float>(i) / static_cast<float>(across), static_cast<float>(j) / static_cast<float>(along)});
    };
    for (int i = 0; i < across; ++i) at(i, 0);
    for (int j = 0; j < along; ++j) at(across, j);
    for (int i = across; i > 0; --i) at(i, along);
    for (int j = along; j > 0; --j) at(0, j);
    pattern_.boundary = p.size();
    for (int j = 1; j < along; ++j)
        for (int i = 1; i < across; ++i) at(i, j);
    const int around = static_cast<int>(pattern_.boundary);
    const auto index = [&](int i, int j) {
        if (j == 0) return i;
        if (i == across) return across + j;
        if (j == along) return across + along + (across - i);
        if (i == 0) return 2 * across + along + (along - j);
        return around + (j - 1) * (across - 1) + (i - 1);
    };
    for (int j = 0; j < along; ++j)
        for (int i = 0; i < across; ++i)
            pattern_.quads.push_back({index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)});
}

void PatternMaker::general(const Parameterization& face, const std::vector<int>& rates) {
    Tessellation::Options options;
    options.PreserveQuads(true).SetFacetSize(4);
    const Tessellation cut(face, static_cast<int>(rates.size()), rates.data(), options);
    ABBE_CHECK(cut.IsValid());
    pattern_.boundary = static_cast<std::size_t>(cut.GetNumBoundaryCoords());
    pattern_.points.resize(static_cast<std::size_t>(cut.GetNumCoords()));
    cut.GetCoords(&pattern_.points[0].x);
    facets_.resize(static_cast<std::size_t>(cut.GetNumFacets()) * 4);
    cut.GetFacets(facets_.data());
    for (std::size_t i = 0; i < facets_.size(); i += 4) {
        const int* f = &facets_[i];
        if (f[3] < 0)
            pattern_.triangles.push_back({f[0], f[1], f[2]});
        else
            pattern_.quads.push_back({f[0], f[1], f[2], f[3]});
    }
}

using namespace osd;

namespace {

using Impl = SubdivisionSurface::Impl;

// The two sides of an edge across which the surface is smooth.
struct Crossing {
    std::uint32_t side[2];
    int face[2];
};

std::optional<Crossing> smoothCrossing(const Impl& s, int edge) {
    const Far::TopologyLevel& level = s.level();
    if (s.scheme == Sdc::SCHEME_BILINEAR || level.IsEdgeNonManifold(edge) ||
        Sdc::Crease::IsInfinite(level.GetEdgeSharpness(edge)))
        return std::nullopt;
    const Far::ConstIndexArray faces = level.GetEdgeFaces(edge);
    if (faces.size() != 2) return std::nullopt;
    const Far::ConstLocalIndexArray locals = level.GetEdgeFaceLocalIndices(edge);
    Crossing c{};
    for (int i = 0; i < 2; ++i) {
        c.face[i] = faces[i];
        if (!s.hasSurface[static_cast<std::size_t>(faces[i])]) return std::nullopt;
        c.side[i] = s.firstCorner[static_cast<std::size_t>(faces[i])] + locals[i];
    }
    return c;
}

std::uint32_t next(const Impl& s, int face, std::uint32_t corner) {
    const auto f = static_cast<std::size_t>(face);
    return corner + 1 == s.firstCorner[f + 1] ? s.firstCorner[f] : corner + 1;
}

// The corners at one end of the edge, on either side of it. Manifold edges run oppositely in their two faces.
std::array<std::uint32_t, 2> cornersAt(const Impl& s, const Crossing& c, int end) {
    if (end == 0) return {c.side[0], next(s, c.face[1], c.side[1])};
    return {next(s, c.face[0], c.side[0]), c.side[1]};
}

bool sameTexture(const Impl& s, const std::array<std::uint32_t, 2>& corners) {
    return s.uvCorners.empty() || s.uvCorners[corners[0]] == s.uvCorners[corners[1]];
}

// Where faces meet without a common tangent plane, whatever the edges between them: an infinitely sharp corner, or
// more than two infinitely sharp edges.
bool isCorner(const Impl& s, int vertex) {
    const Far::TopologyLevel& level = s.level();
    if (level.IsVertexNonManifold(vertex) || Sdc::Crease::IsInfinite(level.GetVertexSharpness(vertex))) return true;
    int sharp = 0;
    for (const int edge : level.GetVertexEdges(vertex)) sharp += Sdc::Crease::IsInfinite(level.GetEdgeSharpness(edge));
    return sharp > 2;
}

} // namespace

SubdivisionLayout::SubdivisionLayout(const Impl& s, const std::vector<int>& edgeRates) {
    joinCorners(s, false);
    numberCorners(s);
    numberSides(s, edgeRates);
    if (!s.uvCorners.empty()) {
        joinCorners(s, true);
        pairSmoothCorners(s);
    }
    joined_ = {};
}

std::uint32_t SubdivisionLayout::root(std::uint32_t corner) {
    while (joined_[corner] != corner) corner = joined_[corner] = joined_[joined_[corner]];
    return corner;
}

void SubdivisionLayout::joinCorners(const Impl& s, bool acrossTexture) {
    const Far::TopologyLevel& level = s.level();
    joined_.resize(s.firstCorner.back());
    for (std::uint32_t c = 0; c < joined_.size(); ++c) joined_[c] = c;
    std::vector<std::uint8_t> corner(static_cast<std::size_t>(level.GetNumVertices()));
    for (int v = 0; v < level.GetNumVertices(); ++v) corner[static_cast<std::size_t>(v)] = isCorner(s, v);
    for (int e = 0; e < level.GetNumEdges(); ++e) {
        const auto crossing = smoothCrossing(s, e);
        if (!crossing) continue;
        for (int end = 0; end < 2; ++end) {
            const auto pair = cornersAt(s, *crossing, end);
            const std::uint32_t inFace = pair[0] - s.firstCorner[static_cast<std::size_t>(crossing->face[0])];
            const int v = level.GetFaceVertices(crossing->face[0])[static_cast<int>(inFace)];
            if (corner[static_cast<std::size_t>(v)] || (!acrossTexture && !sameTexture(s, pair))) continue;
            const std::uint32_t a = root(pair[0]), b = root(pair[1]);
            joined_[std::max(a, b)] = std::min(a, b); // the first corner leads
        }
    }
}

void SubdivisionLayout::numberCorners(const Impl& s) {
    constexpr std::uint32_t none = 0xffffffffu;
    const Far::TopologyLevel& level = s.level();
    std::vector<std::uint32_t> firstOf(static_cast<std::size_t>(level.GetNumVertices()), none);
    cornerVertex.assign(joined_.size(), none);
    cornerLeads.assign(joined_.size(), 0);
    for (int f = 0; f < s.faceCount(); ++f) {
        if (!s.hasSurface[static_cast<std::size_t>(f)]) continue;
        const Far::ConstIndexArray vertices = level.GetFaceVertices(f);
        for (int i = 0; i < vertices.size(); ++i) {
            const std::uint32_t c = s.firstCorner[static_cast<std::size_t>(f)] + static_cast<std::uint32_t>(i);
            const std::uint32_t leader = root(c);
            if (leader == c) {
                cornerLeads[c] = 1;
                cornerVertex[c] = vertexCount++;
                std::uint32_t& first = firstOf[static_cast<std::size_t>(vertices[i])];
                if (first == none)
                    first = cornerVertex[c];
                else
                    seams.push_back({cornerVertex[c], first, 1});
            }
            cornerVertex[c] = cornerVertex[leader];
        }
    }
}

// Requires joined_ across seams of texture coordinates.
void SubdivisionLayout::pairSmoothCorners(const Impl& s) {
    for (int f = 0; f < s.faceCount(); ++f) {
        if (!s.hasSurface[static_cast<std::size_t>(f)]) continue;
        for (std::uint32_t c = s.firstCorner[static_cast<std::size_t>(f)];
             c < s.firstCorner[static_cast<std::size_t>(f) + 1]; ++c)
            if (const std::uint32_t first = root(c); cornerLeads[c] && first != c)
                smoothSeams.push_back({cornerVertex[c], cornerVertex[first], 1});
    }
}

void SubdivisionLayout::numberSides(const Impl& s, const std::vector<int>& edgeRates) {
    const Far::TopologyLevel& level = s.level();
    sideFirst.assign(cornerVertex.size(), 0);
    sideLeads.assign(cornerVertex.size(), 0);
    sideReversed.assign(cornerVertex.size(), 0);
    for (int e = 0; e < level.GetNumEdges(); ++e) {
        const auto inside = static_cast<std::uint32_t>(edgeRates[static_cast<std::size_t>(e)] - 1);
        const auto crossing = smoothCrossing(s, e);
        const bool shared =
            crossing && sameTexture(s, cornersAt(s, *crossing, 0)) && sameTexture(s, cornersAt(s, *crossing, 1));
        const Far::ConstIndexArray faces = level.GetEdgeFaces(e);
        const Far::ConstLocalIndexArray locals = level.GetEdgeFaceLocalIndices(e);
        std::optional<std::uint32_t> first;
        for (int k = 0; k < faces.size(); ++k) {
            const auto f = static_cast<std::size_t>(faces[k]);
            if (!s.hasSurface[f]) continue;
            const std::uint32_t side = s.firstCorner[f] + locals[k];
            sideReversed[side] = level.GetFaceVertices(faces[k])[locals[k]] != level.GetEdgeVertices(e)[0];
            if (first && shared) {
                sideFirst[side] = *first;
                continue;
            }
            sideLeads[side] = 1;
            sideFirst[side] = vertexCount;
            vertexCount += inside;
            if (!first)
                first = sideFirst[side];
            else if (inside > 0)
                seams.push_back({sideFirst[side], *first, inside});
            if (crossing && inside > 0 && sideFirst[side] != *first)
                smoothSeams.push_back({sideFirst[side], *first, inside});
        }
    }
}

} // namespace abbe
