// Learning a PathGuide from paths: what surfaces give off first, and then where light comes from.
#pragma once

#include "guiding/path_guide.h"

#include <optional>
#include <span>
#include <vector>

namespace abbe {

// A vertex of a path from the camera; those of a path follow each other. Light means the mean over a path's
// wavelengths, each over its density.
struct PilotVertex {
    Vec3 p, w;             // where it is, and where the path goes on to
    std::uint8_t face = 0; // faceOf() the normal on the side of the eye
    bool spreads = false;  // whether its surface scatters light from everywhere: then what is found here is kept
    bool goesOn = false;   // to the vertex that follows
    float scatter = 0;     // f |cos θ| towards w, 1/sr
    float pdf = 0;         // with which w was drawn, 1/sr; 0: it is nothing to learn from, as of delta lobes
    float ownPdf = 0;      // with which the surface alone would have drawn it
    float survival = 1;    // with which the path went on after that
    float weight = 0;      // of its light in the pixel, over what the pixel shows against the frame's mean
    float carried = 0;     // what becomes of light from w on its way back along the path, survival counted
    float emission = 0;    // that the vertex gives off towards the one before
    float lit = 0;         // that it scatters there, as found by next-event estimation
    float lightShare = 1;  // of such vertices, at which that is made
    float beyond = 0;      // that arrives from w and belongs to no vertex: of what is around the scene
};

// Means over small cells of surfaces that scatter light from everywhere: light that was found at any vertex spreads
// from cell to cell along all paths. So one path tells as much of the light from a direction as all that came by where
// it leads to [Dahm2017, of the same idea]. Cells see no direction: what glossy coats do is a mean, and so, for the
// cache alone, is what media do that scatter ahead.
class GivenOff {
  public:
    // `vertices` outlives it.
    explicit GivenOff(std::span<const PilotVertex> vertices);
    // From the direction in which the path goes on at a vertex; light as PilotVertex has it.
    float arriving(std::size_t vertex) const;
    // For who looks up places that no vertex was at; requires no more of this.
    RadianceCache cache() && { return {std::move(tree_), std::move(radiance_)}; }

  private:
    GivenOff(std::span<const PilotVertex> vertices, std::vector<SpaceTree::Place> places);
    static constexpr std::uint32_t kNone = 0xffffffff;
    // Where light comes from: `known`, and that share of what a cell gives off, if any.
    struct Source {
        float known = 0, share = 0;
        std::uint32_t cell = kNone;
    };
    // Of what arrives from the direction in which the path goes on at a vertex.
    Source source(std::size_t vertex) const;
    void spread(std::size_t cells);

    std::span<const PilotVertex> vertices_;
    SpaceTree tree_;                   // of cells
    std::vector<std::uint32_t> cells_; // of vertices
    std::vector<float> radiance_;      // of cells
};

struct TrainedGuide {
    PathGuide guide;
    // What of the relative variance of all samples together the guide takes away, as far as the vertices tell.
    double gain = 0;
};

// Each vertex tells of the light from its direction what all paths have found where it leads to (GivenOff). In every
// region of space directions get the density that is best for a mean over all that was recorded there: in proportion to
// the root of the mean square of what a direction brings [Rath2020, eq. 9]; that distance of the sphere on which they
// are looked at [Ruppert2020, of parallax]; and that share of guided ones whose second moment, foreseen from the same
// vertices, is the least. One half of them judges what was learnt from the other, so that chance does not count as
// knowledge. `frameRadiance`: of the paths of the frame in the mean, above 0. A region with a density of its own has at
// least so many vertices. The same for the same vertices.
inline constexpr std::size_t kRegionVertices = 2500;
TrainedGuide trainGuide(std::span<const PilotVertex>, double frameRadiance,
                        std::size_t regionVertices = kRegionVertices);

} // namespace abbe
