#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "math/warp.h"
#include "scene_checks/checks.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace abbe::checks {

namespace {

class FaceReader final : public GeometrySink {
  public:
    struct Part {
        std::span<const Vec3> vertices; // as long as the shape
        Triangles triangles;
        Quads quads;
    };
    void triangles(TimeSteps<Vec3> vertices, Triangles t) override { parts.push_back({vertices[0], t, {}}); }
    void quads(TimeSteps<Vec3> vertices, Quads q) override { parts.push_back({vertices[0], {}, q}); }
    void curves(CurveBasis, CurveForm, TimeSteps<SizedPoint>, std::span<const std::uint32_t>,
                std::span<const std::uint8_t>) override {
        extents = true;
    }
    void points(PointForm, TimeSteps<SizedPoint>, TimeSteps<Vec3>) override { extents = true; }
    void analytic(const Bounds3&) override { formulas = true; }

    std::vector<Part> parts;
    bool extents = false, formulas = false; // curves or points; shapes that intersect rays themselves
};

// Six times the volume of the tetrahedra between the faces and a point.
double sixVolumes(const FaceReader::Part& part, Vec3d middle) {
    const auto at = [&](std::uint32_t i) { return Vec3d(part.vertices[i]) - middle; };
    double sum = 0;
    for (const auto& t : part.triangles) sum += dot(at(t[0]), cross(at(t[1]), at(t[2])));
    for (const auto& q : part.quads)
        sum += dot(at(q[0]), cross(at(q[1]), at(q[2]))) + dot(at(q[0]), cross(at(q[2]), at(q[3])));
    return sum;
}

void countEdges(const FaceReader::Part& part, std::span<const FaceReader::Part> all, FaceReport& report) {
    std::size_t sides = 0;
    for (const auto& p : all) sides += 3 * p.triangles.size() + 4 * p.quads.size();
    EdgeCounter counter(part.vertices, sides);
    for (const auto& p : all) {
        for (const auto& t : p.triangles) counter.add(t);
        for (const auto& q : p.quads) counter.add(q);
    }
    report.edges = counter.count(&report.ends);
}

} // namespace

FaceReport readFaces(const Shape& shape) {
    FaceReader reader;
    shape.commit(reader);
    FaceReport report;
    if (reader.extents) return report;
    if (reader.formulas && reader.parts.empty()) report.kind = FaceReport::Kind::analytic;
    if (reader.formulas || reader.parts.empty()) return report;
    // All parts of one mesh share its vertices.
    const auto& first = reader.parts.front();
    for (const auto& part : reader.parts)
        if (part.vertices.data() != first.vertices.data()) return report;
    report.kind = FaceReport::Kind::faces;
    report.vertices = first.vertices;
    const Bounds3 box = shape.bounds();
    const Vec3d middle = (Vec3d(box.lower) + Vec3d(box.upper)) / 2;
    for (const auto& part : reader.parts) report.volume += sixVolumes(part, middle) / 6;
    countEdges(first, reader.parts, report);
    return report;
}

// Stands for a solid: the tree gives back the material that a shape was bound to, and nothing asks for its scattering.
class SolidTree::Marker final : public Material {
  public:
    const Bsdf* bsdf(const SurfaceHit&, const Wavelengths&, Arena&) const noexcept override { return nullptr; }
};

SolidTree::SolidTree(const std::vector<Solid>& solids, const std::vector<std::size_t>& chosen)
    : solids_(solids), markers_(solids.size()) {
    EmbreeSceneBuilder builder;
    for (const std::size_t i : chosen) {
        markers_[i] = std::make_unique<const Marker>();
        const auto* faces = dynamic_cast<const FaceMaterials*>(solids[i].shape); // would answer with its own materials
        builder.addShape(faces ? faces->inner() : *solids[i].shape, {markers_[i].get()});
    }
    tree_ = builder.build();
}

SolidTree::~SolidTree() = default;

void SolidTree::walk(Vec3 through, Vec3 direction, double reach, std::span<const std::size_t> of,
                     std::span<std::vector<Crossing>> crossings) const {
    constexpr int kMostHits = 4096; // of all solids; more is a soup that no check of this kind is for
    const auto far = static_cast<float>(reach);
    Ray ray{through - direction * far, direction, 2 * far};
    SurfaceHit hit;
    for (int i = 0; i < kMostHits && tree_->intersect(ray, hit); ++i) {
        const double at = dot(Vec3d(hit.p) - Vec3d(through), Vec3d(direction));
        for (std::size_t k = 0; k < of.size(); ++k)
            if (hit.material == markers_[of[k]].get()) crossings[k].push_back({at, dot(hit.ng, direction) < 0});
        ray.origin = spawnOrigin(hit, direction);
        ray.tMax = far - static_cast<float>(at);
        if (!(ray.tMax > 0)) return;
    }
}

SolidTree::Stretches SolidTree::stretchesOf(std::size_t solid, const std::vector<Crossing>& crossings) const {
    constexpr double kNever = std::numeric_limits<double>::infinity();
    const bool endless = !std::isfinite(solids_[solid].shape->area());
    std::vector<Stretch> stretches;
    double entered = 0;
    int depth = endless && !crossings.empty() && !crossings.front().enters ? 1 : 0;
    if (depth > 0) entered = -kNever;
    for (const Crossing& crossing : crossings) {
        depth += crossing.enters ? 1 : -1;
        if (depth < 0) return std::nullopt;
        if (crossing.enters && depth == 1) entered = crossing.at;
        if (!crossing.enters && depth == 0) stretches.push_back({entered, crossing.at});
    }
    if (depth > 0 && !endless) return std::nullopt;
    if (depth > 0) stretches.push_back({entered, kNever});
    return stretches;
}

namespace {

// From a point as far as the shape reaches, whatever the direction; of what has no end as far as numbers are precise.
double reachOf(const Shape& shape, Vec3 from) {
    constexpr double kEndless = 1e4;
    const Bounds3 box = shape.bounds();
    return std::isfinite(shape.area())
               ? 1.01 * static_cast<double>(length(box.diagonal()) + length(box.centre() - from))
               : kEndless;
}

} // namespace

SolidTree::Stretches SolidTree::inside(std::size_t solid, Vec3 through, Vec3 direction) const {
    std::vector<Crossing> crossings;
    walk(through, direction, reachOf(*solids_[solid].shape, through), {&solid, 1}, {&crossings, 1});
    return stretchesOf(solid, crossings);
}

std::pair<SolidTree::Stretches, SolidTree::Stretches> SolidTree::inside(std::size_t a, std::size_t b, Vec3 through,
                                                                        Vec3 direction) const {
    std::array<std::vector<Crossing>, 2> crossings;
    const std::array<std::size_t, 2> both{a, b};
    walk(through, direction, std::max(reachOf(*solids_[a].shape, through), reachOf(*solids_[b].shape, through)), both,
         crossings);
    return {stretchesOf(a, crossings[0]), stretchesOf(b, crossings[1])};
}

bool SolidTree::contains(std::size_t solid, Vec3 p) const {
    constexpr std::uint32_t kLines = 7;
    std::uint32_t found = 0;
    for (std::uint32_t i = 0; i < kLines; ++i) {
        const EvenPoint u = evenPoint(i + 1);
        const auto stretches = inside(solid, p, directionOf(u.u[0], u.u[1]));
        found += stretches && std::ranges::any_of(*stretches, [](Stretch s) { return s.from < 0 && s.to > 0; });
    }
    return 2 * found > kLines;
}

double SolidTree::openShare(std::size_t solid) const {
    constexpr std::uint32_t kLines = 64;
    const Bounds3 box = solids_[solid].shape->bounds();
    std::uint32_t open = 0;
    for (std::uint32_t i = 0; i < kLines; ++i) {
        const EvenPoint u = evenPoint(i + 1);
        open += !inside(solid, u.within(box), directionOf(u.u[3], u.u[4]));
    }
    return open / static_cast<double>(kLines);
}

Vec3 EvenPoint::within(const Bounds3& box) const {
    const Vec3 share{static_cast<float>(u[0]), static_cast<float>(u[1]), static_cast<float>(u[2])};
    return box.lower + multiply(box.diagonal(), share);
}

EvenPoint evenPoint(std::uint32_t i) {
    constexpr double root = 1.1347241384015194; // of x⁶ = x + 1
    EvenPoint result{};
    double power = 1;
    for (double& u : result.u) {
        power /= root;
        const double turn = power * i + 0.5;
        u = turn - std::floor(turn);
    }
    return result;
}

Vec3 directionOf(double u, double v) {
    const double z = 1 - 2 * u, r = safeSqrt(1 - z * z), turn = 2 * kPiD * v;
    return Vec3(Vec3d{r * std::cos(turn), r * std::sin(turn), z});
}

} // namespace abbe::checks
