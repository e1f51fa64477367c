#include "geometry/embree_sink.h"

#include "geometry/instance_table.h"
#include "render/material.h"

namespace abbe {

namespace {

// Callbacks of shapes that intersect themselves. The geometry's user pointer is the shape.
const Shape& shapeOf(void* user) { return *static_cast<const Shape*>(user); }

const RayContext& contextOf(const RTCIntersectContext* context) {
    return *reinterpret_cast<const RayContext*>(context);
}

// Filters the hits of meshes.
void skipMesh(const RTCFilterFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;
    if (contextOf(args->context).skips(&shapeOf(args->geometryUserPtr))) args->valid[0] = 0;
}

void analyticBounds(const RTCBoundsFunctionArguments* args) {
    const Bounds3 b = shapeOf(args->geometryUserPtr).bounds();
    *args->bounds_o = {b.lower.x, b.lower.y, b.lower.z, 0, b.upper.x, b.upper.y, b.upper.z, 0};
}

std::optional<RawHit> analyticHit(const Shape& shape, const RTCRay& r) {
    const Vec3 direction(r.dir_x, r.dir_y, r.dir_z);
    // Shapes know no near end: a ray cast again past a false hit starts there.
    const Vec3 origin = Vec3(r.org_x, r.org_y, r.org_z) + (r.tnear > kNearestHit ? direction * r.tnear : Vec3());
    auto hit = shape.intersect({origin, direction, r.tfar - r.tnear});
    if (hit) hit->distance += r.tnear;
    return hit;
}

void analyticIntersect(const RTCIntersectFunctionNArguments* args) {
    auto& rayHit = *reinterpret_cast<RTCRayHit*>(args->rayhit);
    if (args->N != 1 || args->valid[0] == 0) return;
    const Shape& shape = shapeOf(args->geometryUserPtr);
    if (contextOf(args->context).skips(&shape)) return;
    const auto hit = analyticHit(shape, rayHit.ray);
    if (!hit) return;
    rayHit.ray.tfar = hit->distance;
    rayHit.hit.u = hit->u; // the shape's own words
    rayHit.hit.v = hit->v;
    rayHit.hit.primID = args->primID;
    rayHit.hit.geomID = args->geomID;
    rayHit.hit.instID[0] = args->context->instID[0];
}

void analyticOccluded(const RTCOccludedFunctionNArguments* args) {
    auto& ray = *reinterpret_cast<RTCRay*>(args->ray);
    if (args->N != 1 || args->valid[0] == 0) return;
    if (analyticHit(shapeOf(args->geometryUserPtr), ray)) ray.tfar = -kInfinity;
}

} // namespace

void attachGeometry(RTCScene scene, RTCGeometry geometry, std::size_t id, Visibility visible) {
    rtcSetGeometryMask(geometry, visible.bits());
    rtcCommitGeometry(geometry);
    rtcAttachGeometryByID(scene, geometry, static_cast<unsigned>(id));
    rtcReleaseGeometry(geometry);
}

EmbreeSink::EmbreeSink(RTCDevice device, RTCScene scene, std::vector<GeometryRecord>& records, bool nested)
    : device_(device), scene_(scene), records_(records), firstRecord_(records.size()), nested_(nested) {}

void EmbreeSink::add(const Shape& shape, const Material* material, const SurfaceLight* light, std::uint32_t space,
                     Visibility visible) {
    visible_ = visible;
    next_ = {&shape, material, light, space, 0, PrimitiveKind::analytic, 1};
    shape.commit(*this);
}

// A buffer per time step; Embree refuses other numbers of them than the geometry has.
template <typename T>
void EmbreeSink::shareSteps(RTCGeometry geometry, RTCBufferType type, RTCFormat format, TimeSteps<T> steps) {
    next_.steps = static_cast<std::uint8_t>(steps.size());
    if (steps.size() > 1) rtcSetGeometryTimeStepCount(geometry, static_cast<unsigned>(steps.size()));
    for (std::size_t i = 0; i < steps.size(); ++i)
        rtcSetSharedGeometryBuffer(geometry, type, static_cast<unsigned>(i), format, steps[i].data(), 0, sizeof(T),
                                   steps[i].size());
}

void EmbreeSink::triangles(TimeSteps<Vec3> vertices, Triangles indices) {
    mesh(RTC_GEOMETRY_TYPE_TRIANGLE, RTC_FORMAT_UINT3, vertices, indices.data(), sizeof(indices[0]), indices.size());
}

void EmbreeSink::quads(TimeSteps<Vec3> vertices, Quads indices) {
    mesh(RTC_GEOMETRY_TYPE_QUAD, RTC_FORMAT_UINT4, vertices, indices.data(), sizeof(indices[0]), indices.size());
}

void EmbreeSink::mesh(RTCGeometryType type, RTCFormat format, TimeSteps<Vec3> vertices, const void* indices,
                      std::size_t stride, std::size_t count) {
    RTCGeometry geometry = rtcNewGeometry(device_, type);
    shareSteps(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT3, vertices);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, format, indices, 0, stride, count);
    if (nested_ && next_.material && next_.material->ior()) {
        rtcSetGeometryUserData(geometry, const_cast<Shape*>(next_.shape)); // read back as const
        rtcSetGeometryIntersectFilterFunction(geometry, skipMesh);
    }
    attach(geometry, type == RTC_GEOMETRY_TYPE_QUAD ? PrimitiveKind::quads : PrimitiveKind::triangles);
}

namespace {

void confirmHit(const RTCFilterFunctionNArguments* args) {
    if (args->N != 1 || args->valid[0] == 0) return;
    const auto& r = *reinterpret_cast<const RTCRay*>(args->ray);
    const auto& h = *reinterpret_cast<const RTCHit*>(args->hit);
    const Ray ray{Vec3(r.org_x, r.org_y, r.org_z), Vec3(r.dir_x, r.dir_y, r.dir_z), kInfinity, r.time};
    const RawHit hit{.u = h.u, .v = h.v, .distance = r.tfar, .primitive = h.primID};
    if (!shapeOf(args->geometryUserPtr).confirms(hit, ray)) args->valid[0] = 0;
}

RTCGeometryType curveType(CurveBasis basis, CurveForm form) {
    const bool round = form == CurveForm::round;
    switch (basis) {
    case CurveBasis::linear:
        return round ? RTC_GEOMETRY_TYPE_ROUND_LINEAR_CURVE : RTC_GEOMETRY_TYPE_FLAT_LINEAR_CURVE;
    case CurveBasis::bspline:
        return round ? RTC_GEOMETRY_TYPE_ROUND_BSPLINE_CURVE : RTC_GEOMETRY_TYPE_FLAT_BSPLINE_CURVE;
    case CurveBasis::catmullRom:
        return round ? RTC_GEOMETRY_TYPE_ROUND_CATMULL_ROM_CURVE : RTC_GEOMETRY_TYPE_FLAT_CATMULL_ROM_CURVE;
    case CurveBasis::bezier:
        break;
    }
    return round ? RTC_GEOMETRY_TYPE_ROUND_BEZIER_CURVE : RTC_GEOMETRY_TYPE_FLAT_BEZIER_CURVE;
}

static_assert(sizeof(SizedPoint) == 4 * sizeof(float));
static_assert(int(kPreviousSegment) == int(RTC_CURVE_FLAG_NEIGHBOR_LEFT));
static_assert(int(kNextSegment) == int(RTC_CURVE_FLAG_NEIGHBOR_RIGHT));

} // namespace

void EmbreeSink::curves(CurveBasis basis, CurveForm form, TimeSteps<SizedPoint> points,
                        std::span<const std::uint32_t> firstPoints, std::span<const std::uint8_t> neighbours) {
    RTCGeometry geometry = rtcNewGeometry(device_, curveType(basis, form));
    shareSteps(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, points);
    rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_INDEX, 0, RTC_FORMAT_UINT, firstPoints.data(), 0,
                               sizeof(std::uint32_t), firstPoints.size());
    if (!neighbours.empty())
        rtcSetSharedGeometryBuffer(geometry, RTC_BUFFER_TYPE_FLAGS, 0, RTC_FORMAT_UCHAR, neighbours.data(), 0, 1,
                                   neighbours.size());
    if (basis == CurveBasis::linear && form == CurveForm::round) {
        rtcSetGeometryUserData(geometry, const_cast<Shape*>(next_.shape)); // read back as const
        rtcSetGeometryIntersectFilterFunction(geometry, confirmHit);
        rtcSetGeometryOccludedFilterFunction(geometry, confirmHit);
    }
    attach(geometry, PrimitiveKind::curves);
}

void EmbreeSink::points(PointForm form, TimeSteps<SizedPoint> points, TimeSteps<Vec3> normals) {
    RTCGeometry geometry = rtcNewGeometry(device_, form == PointForm::sphere ? RTC_GEOMETRY_TYPE_SPHERE_POINT
                                                   : form == PointForm::disk ? RTC_GEOMETRY_TYPE_DISC_POINT
                                                                             : RTC_GEOMETRY_TYPE_ORIENTED_DISC_POINT);
    shareSteps(geometry, RTC_BUFFER_TYPE_VERTEX, RTC_FORMAT_FLOAT4, points);
    if (!normals.empty()) shareSteps(geometry, RTC_BUFFER_TYPE_NORMAL, RTC_FORMAT_FLOAT3, normals);
    attach(geometry, PrimitiveKind::points);
}

void EmbreeSink::analytic(const Bounds3&) {
    RTCGeometry geometry = rtcNewGeometry(device_, RTC_GEOMETRY_TYPE_USER);
    rtcSetGeometryUserPrimitiveCount(geometry, 1);
    rtcSetGeometryUserData(geometry, const_cast<Shape*>(next_.shape)); // read back as const
    rtcSetGeometryBoundsFunction(geometry, analyticBounds, nullptr);
    rtcSetGeometryIntersectFunction(geometry, analyticIntersect);
    rtcSetGeometryOccludedFunction(geometry, analyticOccluded);
    attach(geometry, PrimitiveKind::analytic);
}

void EmbreeSink::attach(RTCGeometry geometry, PrimitiveKind kind) {
    attachGeometry(scene_, geometry, records_.size() - firstRecord_, visible_);
    next_.kind = kind;
    records_.push_back(next_);
    ++next_.part;
}

} // namespace abbe
