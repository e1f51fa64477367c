#include "geometry/subdivision_limit.h"

#include "base/check.h"
#include "math/bounds.h"

#include <algorithm>
#include <opensubdiv/far/topologyDescriptor.h>

namespace abbe {

using namespace osd;

namespace {

Sdc::SchemeType schemeOf(SubdivisionCage::Scheme s) {
    return s == SubdivisionCage::Scheme::catmullClark ? Sdc::SCHEME_CATMARK
           : s == SubdivisionCage::Scheme::loop       ? Sdc::SCHEME_LOOP
                                                      : Sdc::SCHEME_BILINEAR;
}

Sdc::Options optionsOf(const SubdivisionCage& cage) {
    Sdc::Options o;
    // The enumerators of the cage stand in the order of the library's.
    static_assert(static_cast<int>(SubdivisionCage::Boundary::edgeAndCorner) ==
                  Sdc::Options::VTX_BOUNDARY_EDGE_AND_CORNER);
    static_assert(static_cast<int>(SubdivisionCage::FaceVarying::all) == Sdc::Options::FVAR_LINEAR_ALL);
    o.SetVtxBoundaryInterpolation(static_cast<Sdc::Options::VtxBoundaryInterpolation>(cage.boundary));
    o.SetFVarLinearInterpolation(static_cast<Sdc::Options::FVarLinearInterpolation>(cage.faceVarying));
    o.SetCreasingMethod(cage.creasing == SubdivisionCage::Creasing::chaikin ? Sdc::Options::CREASE_CHAIKIN
                                                                            : Sdc::Options::CREASE_UNIFORM);
    o.SetTriangleSubdivision(cage.smoothTriangles ? Sdc::Options::TRI_SUB_SMOOTH : Sdc::Options::TRI_SUB_CATMARK);
    return o;
}

const int* ints(const std::vector<std::uint32_t>& v) { return reinterpret_cast<const int*>(v.data()); }

std::unique_ptr<Far::TopologyRefiner> makeRefiner(const SubdivisionCage& cage) {
    std::vector<int> creaseEnds;
    std::vector<float> creaseWeights;
    for (const auto& c : cage.creases) {
        creaseEnds.insert(creaseEnds.end(), {static_cast<int>(c.a), static_cast<int>(c.b)});
        creaseWeights.push_back(std::min(c.sharpness, 10.f));
    }
    std::vector<int> cornerVertices;
    std::vector<float> cornerWeights;
    for (const auto& c : cage.sharpCorners) {
        cornerVertices.push_back(static_cast<int>(c.vertex));
        cornerWeights.push_back(std::min(c.sharpness, 10.f));
    }
    Far::TopologyDescriptor d;
    d.numVertices = static_cast<int>(cage.positions.size());
    d.numFaces = static_cast<int>(cage.faceSizes.size());
    d.numVertsPerFace = ints(cage.faceSizes);
    d.vertIndicesPerFace = ints(cage.corners);
    d.numCreases = static_cast<int>(creaseWeights.size());
    d.creaseVertexIndexPairs = creaseEnds.data();
    d.creaseWeights = creaseWeights.data();
    d.numCorners = static_cast<int>(cornerWeights.size());
    d.cornerVertexIndices = cornerVertices.data();
    d.cornerWeights = cornerWeights.data();
    d.numHoles = static_cast<int>(cage.holes.size());
    d.holeIndices = ints(cage.holes);
    Far::TopologyDescriptor::FVarChannel channel;
    if (!cage.uvCorners.empty()) {
        channel.numValues = static_cast<int>(cage.uvs.size());
        channel.valueIndices = ints(cage.uvCorners);
        d.numFVarChannels = 1;
        d.fvarChannels = &channel;
    }
    using RefinerFactory = Far::TopologyRefinerFactory<Far::TopologyDescriptor>;
    std::unique_ptr<Far::TopologyRefiner> refiner(
        RefinerFactory::Create(d, RefinerFactory::Options(schemeOf(cage.scheme), optionsOf(cage))));
    ABBE_CHECK(refiner != nullptr); // findFault() refuses what the library refuses
    return refiner;
}

// Sharpnesses above this level end as infinite ones, which is too early to be unseen.
int sharpLevel(const SubdivisionCage& cage) {
    float sharpest = 0;
    const auto add = [&](float s) {
        if (s < 10) sharpest = std::max(sharpest, s);
    };
    for (const auto& c : cage.creases) add(c.sharpness);
    for (const auto& c : cage.sharpCorners) add(c.sharpness);
    return std::clamp(static_cast<int>(std::ceil(sharpest)), 8, 10);
}

} // namespace

CagePoints::CagePoints(std::span<const Vec3> positions) {
    Bounds3 box;
    for (const Vec3 p : positions) box.add(p);
    center = box.lower * 0.5f + box.upper * 0.5f;
    offsets.reserve(positions.size());
    for (const Vec3 p : positions) offsets.push_back(Vec3d(p) - Vec3d(center));
}

SubdivisionSurface::Impl::Impl(const SubdivisionCage& cage)
    : points(cage.positions), uvs(cage.uvs), uvCorners(cage.uvCorners), refiner(makeRefiner(cage)),
      scheme(schemeOf(cage.scheme)) {
    for (const MeshAttribute& a : cage.attributes)
        attributes.push_back({a.name, a.channels, {a.values.begin(), a.values.end()}});
    Factory::Options options;
    options.SetApproxLevelSharp(sharpLevel(cage)).SetApproxLevelSmooth(7);
    factory = std::make_unique<Factory>(*refiner, options);
    const std::size_t faces = cage.faceSizes.size();
    firstCorner.reserve(faces + 1);
    hasSurface.reserve(faces);
    std::uint32_t first = 0;
    for (std::size_t f = 0; f < faces; ++f) {
        firstCorner.push_back(first);
        first += cage.faceSizes[f];
        hasSurface.push_back(factory->FaceHasLimitSurface(static_cast<int>(f)));
    }
    firstCorner.push_back(first);
}

SubdivisionSurface::SubdivisionSurface(const SubdivisionCage& cage) : impl_(std::make_unique<Impl>(cage)) {}
SubdivisionSurface::~SubdivisionSurface() = default;

void FaceEvaluator::setFace(int face, bool withTexture) {
    bool good = surface_.factory->InitVertexSurface(face, &limit_);
    ABBE_CHECK(good);
    patch_.resize(static_cast<std::size_t>(limit_.GetNumPatchPoints()) * 3);
    limit_.PreparePatchPoints(&points_.offsets[0].x, 3, patch_.data(), 3);
    Bounds3d box;
    const auto controls = static_cast<std::size_t>(limit_.GetNumControlPoints());
    for (std::size_t i = 0; i < controls; ++i) box.add(Vec3d(patch_[3 * i], patch_[3 * i + 1], patch_[3 * i + 2]));
    smallTangent_ = 1e-7 * maxComponent(box.upper - box.lower);
    attributePatches_.resize(surface_.attributes.size());
    for (std::size_t i = 0; i < attributePatches_.size(); ++i) {
        const auto& [name, channels, values] = surface_.attributes[i];
        attributePatches_[i].resize(static_cast<std::size_t>(limit_.GetNumPatchPoints() * channels));
        limit_.PreparePatchPoints(values.data(), channels, attributePatches_[i].data(), channels);
    }
    textured_ = withTexture;
    if (!withTexture) return;
    good = surface_.factory->InitFaceVaryingSurface(face, &texture_, 0);
    ABBE_CHECK(good);
    texturePatch_.resize(static_cast<std::size_t>(texture_.GetNumPatchPoints()) * 2);
    texture_.PreparePatchPoints(&surface_.uvs[0].x, 2, texturePatch_.data(), 2);
    float middle[2];
    limit_.GetParameterization().GetCenterCoord(middle);
    texture_.Evaluate(middle, texturePatch_.data(), 2, &home_.x);
}

bool FaceEvaluator::normal(double u, double v, LimitPoint& out) const {
    const double uv[2] = {u, v};
    Vec3d p, du, dv;
    limit_.Evaluate(uv, patch_.data(), 3, &p.x, &du.x, &dv.x);
    out.position = Vec3(p + Vec3d(points_.center));
    const double lu = length(du), lv = length(dv);
    if (!(lu > smallTangent_) || !(lv > smallTangent_)) return false;
    const Vec3d n = cross(du * (1 / lu), dv * (1 / lv));
    const double l = length(n); // the sine of the angle between the tangents
    if (!(l > 1e-5)) return false;
    out.normal = Vec3(n * (1 / l));
    return true;
}

void FaceEvaluator::towardsInside(double by, double uv[2]) const {
    const Bfr::Parameterization param = limit_.GetParameterization();
    if (param.GetType() == Bfr::Parameterization::QUAD_SUBFACES) {
        double local[2];
        const int subFace = param.ConvertCoordToNormalizedSubFace(uv, local);
        for (double& x : local) x += by * (0.5 - x);
        param.ConvertNormalizedSubFaceToCoord(subFace, local, uv);
        return;
    }
    const double middle = param.GetType() == Bfr::Parameterization::TRI ? 1 / 3.0 : 0.5;
    for (int i = 0; i < 2; ++i) uv[i] += by * (middle - uv[i]);
}

LimitPoint FaceEvaluator::point(float u, float v) const {
    LimitPoint result;
    if (normal(u, v, result)) return result;
    // The tangents vanish or are parallel here: the limit from inside the face (docs/hard_cases.md, cases 13 and 14).
    for (const double by : {1e-4, 1e-3, 1e-2, 0.1, 0.5}) {
        double uv[2] = {u, v};
        towardsInside(by, uv);
        LimitPoint inside;
        if (!normal(uv[0], uv[1], inside)) continue;
        result.normal = inside.normal;
        break;
    }
    return result;
}

Vec3 FaceEvaluator::position(float u, float v) const {
    const double uv[2] = {u, v};
    Vec3d p;
    limit_.Evaluate(uv, patch_.data(), 3, &p.x);
    return Vec3(p + Vec3d(points_.center));
}

Vec2 FaceEvaluator::texture(float u, float v) const {
    const float uv[2] = {u, v};
    Vec2 t;
    texture_.Evaluate(uv, texturePatch_.data(), 2, &t.x);
    return t;
}

void FaceEvaluator::attributes(float u, float v, std::vector<MeshAttribute>& to, std::uint32_t vertex) const {
    const double uv[2] = {static_cast<double>(u), static_cast<double>(v)};
    for (std::size_t i = 0; i < to.size(); ++i) {
        const auto channels = static_cast<std::size_t>(to[i].channels);
        double value[3];
        limit_.Evaluate(uv, attributePatches_[i].data(), to[i].channels, value);
        for (std::size_t c = 0; c < channels; ++c) to[i].values[vertex * channels + c] = static_cast<float>(value[c]);
    }
}

SurfaceJet FaceEvaluator::jet(const double uv[2], bool bentTexture) const {
    SurfaceJet s;
    limit_.Evaluate(uv, patch_.data(), 3, &s.p.x, &s.u.x, &s.v.x, &s.uu.x, &s.uv.x, &s.vv.x);
    if (!textured_) return s;
    const float at[2] = {static_cast<float>(uv[0]), static_cast<float>(uv[1])};
    Vec2 t[6];
    if (bentTexture)
        texture_.Evaluate(at, texturePatch_.data(), 2, &t[0].x, &t[1].x, &t[2].x, &t[3].x, &t[4].x, &t[5].x);
    else
        texture_.Evaluate(at, texturePatch_.data(), 2, &t[0].x, &t[1].x, &t[2].x);
    Vec2d* const to[6] = {&s.t, &s.tu, &s.tv, &s.tuu, &s.tuv, &s.tvv};
    for (int i = 0; i < 6; ++i) *to[i] = {static_cast<double>(t[i].x), static_cast<double>(t[i].y)};
    return s;
}

DisplacedLimit FaceEvaluator::displaced(float u, float v, const Displacement& d) const {
    const Vec3d center(points_.center);
    const double uv[2] = {u, v};
    const bool bent = d.space == Displacement::Space::tangent;
    const SurfaceJet here = jet(uv, bent);
    DisplacedLimit result;
    result.position = here.p + center;
    result.texture = {static_cast<float>(here.t.x), static_cast<float>(here.t.y)};
    auto moved = displace(here, d, center, home_, smallTangent_);
    if (moved) result.moved = *moved;
    // Where the limit surface or the displaced one has no normal: that of the displacement a little way inside.
    for (const double by : {1e-4, 1e-3, 1e-2, 0.1, 0.5}) {
        if (lengthSquared(result.moved.normal) > 0) break;
        double inside[2] = {u, v};
        towardsInside(by, inside);
        SurfaceJet near = jet(inside, bent);
        near.p = here.p;
        near.t = here.t;
        const auto other = displace(near, d, center, home_, smallTangent_);
        if (!other) continue;
        if (!moved) moved = result.moved = *other;
        result.moved.normal = other->normal;
    }
    return result;
}

} // namespace abbe
