// The limit surface, face by face (OpenSubdiv underneath). Included by the subdivision sources only.
#pragma once

#include "geometry/displacement.h"
#include "geometry/subdivision_surface.h"

#include <memory>
#include <mutex>
#include <opensubdiv/bfr/refinerSurfaceFactory.h>
#include <opensubdiv/bfr/surface.h>
#include <opensubdiv/bfr/surfaceFactoryCache.h>
#include <opensubdiv/far/topologyRefiner.h>
#include <shared_mutex>
#include <vector>

namespace abbe {

namespace osd = OpenSubdiv;

// Relative to their middle: differences stay exact far from the origin.
struct CagePoints {
    explicit CagePoints(std::span<const Vec3> positions);

    Vec3 center;
    std::vector<Vec3d> offsets;
};

// Immutable after construction and shared by threads: the factory's cache locks itself.
struct SubdivisionSurface::Impl {
    using Factory = osd::Bfr::RefinerSurfaceFactory<osd::Bfr::SurfaceFactoryCacheThreaded<
        std::shared_mutex, std::shared_lock<std::shared_mutex>, std::unique_lock<std::shared_mutex>>>;

    explicit Impl(const SubdivisionCage&);
    const osd::Far::TopologyLevel& level() const { return refiner->GetLevel(0); }
    int faceCount() const { return static_cast<int>(hasSurface.size()); }
    // Index of an edge of a face: corner i to i + 1.
    int edge(int face, int i) const { return level().GetFaceEdges(face)[i]; }

    CagePoints points;
    std::vector<Vec2> uvs;
    std::vector<std::uint32_t> uvCorners;
    struct Attribute {
        std::string name;
        int channels;
        std::vector<double> values;
    };
    std::vector<Attribute> attributes;      // of the points
    std::vector<std::uint32_t> firstCorner; // of each face, and one past the last
    std::unique_ptr<osd::Far::TopologyRefiner> refiner;
    std::unique_ptr<Factory> factory;
    std::vector<std::uint8_t> hasSurface; // per face
    osd::Sdc::SchemeType scheme;
};

struct LimitPoint {
    Vec3 position; // in the cage's own space
    Vec3 normal;   // unit length, or 0 if the face is degenerate all over
};

// A point of the displaced surface: position + direction * length, in the cage's own space.
struct DisplacedLimit {
    Vec3d position; // of the limit surface
    Vec2 texture;
    DisplacedPoint moved;

    Vec3 place() const { return Vec3(position + moved.direction * moved.length); }
};

// One face at a time; each thread has its own.
class FaceEvaluator {
  public:
    explicit FaceEvaluator(const SubdivisionSurface::Impl& surface) : FaceEvaluator(surface, surface.points) {}
    // The surface of the same cage with other points, which must outlive this.
    FaceEvaluator(const SubdivisionSurface::Impl& surface, const CagePoints& points)
        : surface_(surface), points_(points) {}

    // Requires hasSurface[face].
    void setFace(int face, bool withTexture);
    // (u, v) in the parametrisation of the face.
    LimitPoint point(float u, float v) const;
    Vec3 position(float u, float v) const;
    Vec2 texture(float u, float v) const;
    // Writes the values of the cage's attributes, in their order, to those of a vertex.
    void attributes(float u, float v, std::vector<MeshAttribute>& to, std::uint32_t vertex) const;
    // Requires setFace(…, true) if the cage has texture coordinates.
    DisplacedLimit displaced(float u, float v, const Displacement&) const;
    osd::Bfr::Parameterization parameterization() const { return limit_.GetParameterization(); }

  private:
    bool normal(double u, double v, LimitPoint&) const;
    void towardsInside(double by, double uv[2]) const;
    SurfaceJet jet(const double uv[2], bool bentTexture) const; // second derivatives of the texture too?

    const SubdivisionSurface::Impl& surface_;
    const CagePoints& points_;
    // Patches about irregular points shrink with every level, and what is left of their differences in float is noise.
    osd::Bfr::Surface<double> limit_;
    osd::Bfr::Surface<float> texture_;
    std::vector<double> patch_;
    std::vector<float> texturePatch_;
    std::vector<std::vector<double>> attributePatches_;
    double smallTangent_ = 0;
    bool textured_ = false;
    Vec2 home_; // texture coordinates of the middle
};

} // namespace abbe
