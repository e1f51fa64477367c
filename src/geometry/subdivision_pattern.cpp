#include "geometry/subdivision_pattern.h"

#include "base/check.h"

#include <opensubdiv/bfr/tessellation.h>

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

} // namespace abbe
