// Meshes and cages with keys.
#include "geometry/mesh.h"
#include "geometry/mesh_cleanup.h"
#include "scene/shape_builder.h"
#include "scene/shape_deform.h"
#include "scene/shape_subdivision.h"

#include <fmt/format.h>

namespace abbe {

namespace {

template <typename Faces> std::optional<std::size_t> firstDifference(const Faces& a, const Faces& b) {
    for (std::size_t i = 0; i < a.size(); ++i)
        if (a[i] != b[i]) return i;
    return std::nullopt;
}

bool sameTopology(const MeshData& first, const MeshData& key, Span span, Diagnostics& diagnostics) {
    const auto faces = [](const MeshData& m) { return m.triangles.size() + m.quads.size(); };
    if (first.positions.size() != key.positions.size() || faces(first) != faces(key))
        return mismatch(span, diagnostics,
                        fmt::format("{} points and {} faces, but {} and {} in the first key", key.positions.size(),
                                    faces(key), first.positions.size(), faces(first)));
    if (first.quads.size() != key.quads.size())
        return mismatch(span, diagnostics,
                        fmt::format("{} triangles and {} quads, but {} and {} in the first key", key.triangles.size(),
                                    key.quads.size(), first.triangles.size(), first.quads.size()));
    if (const auto i = firstDifference(first.triangles, key.triangles))
        return mismatch(span, diagnostics, fmt::format("triangle {} has other corners than in the first key", *i));
    if (const auto i = firstDifference(first.quads, key.quads))
        return mismatch(span, diagnostics, fmt::format("quad {} has other corners than in the first key", *i));
    if (first.normals.size() != key.normals.size())
        return mismatch(span, diagnostics,
                        fmt::format("{} normals, but {} in the first key", key.normals.size(), first.normals.size()));
    return true;
}

bool moveTo(MeshStep& step, const Transform& place) {
    for (Vec3& p : step.positions) {
        const Vec3d q = place.point(Vec3d(p));
        if (!isFinite(q) || !(maxComponent(abs(q)) < kLargestCoordinate)) return false;
        p = Vec3(q);
    }
    for (Vec3& n : step.normals) {
        const Vec3d m = place.normal(Vec3d(n));
        n = length(m) > 0 ? Vec3(normalize(m)) : Vec3{};
    }
    return true;
}

} // namespace

std::optional<MeshKeys> loadMeshKeys(const MeshParams& params, double unit, bool zUp, FaceGroups* groups,
                                     Diagnostics& diagnostics) {
    MeshKeys keys;
    for (const ShapeKey& key : params.keys) {
        const bool first = keys.states.empty();
        auto mesh =
            statedMesh(key.file, unit, key.points, params.faces, key.span, diagnostics, zUp, first ? groups : nullptr);
        if (!mesh) return std::nullopt;
        MeshData checked = *mesh; // faces without area stay: at another time they have one
        if (const MeshCleanup cleanup = cleanMesh(checked); cleanup.error) {
            diagnostics.error("E0611", key.span, *cleanup.error, "damaged mesh");
            return std::nullopt;
        }
        if (!first) {
            if (!sameTopology(keys.states[0], *mesh, key.span, diagnostics)) return std::nullopt;
            *mesh = {std::move(mesh->positions), std::move(mesh->normals), {}, {}, {}};
        }
        keys.times.push_back(key.time);
        keys.states.push_back(std::move(*mesh));
    }
    return keys;
}

bool useFirstKey(SubdivisionParams& params, Diagnostics& diagnostics) {
    if (params.keys.empty()) return true;
    const bool ownPoints = !params.file.value.empty() || !params.points.empty();
    if (!checkKeys(params, params.keys, ownPoints, false, diagnostics)) return false;
    params.file = params.keys[0].file;
    params.points = params.keys[0].points;
    return true;
}

std::optional<CageKeys> loadCageKeys(const SubdivisionParams& params, const SubdivisionCage& first, double unit,
                                     Diagnostics& diagnostics) {
    if (params.keys.empty()) return CageKeys();
    CageKeys keys{{params.keys[0].time}, {first.positions}};
    for (const ShapeKey& key : std::span(params.keys).subspan(1)) {
        SubdivisionParams here = params;
        here.file = key.file;
        here.points = key.points;
        auto loaded = loadCage(here, unit, key.span, diagnostics);
        if (!loaded) return std::nullopt;
        const SubdivisionCage& cage = loaded->cage;
        if (cage.positions.size() != first.positions.size() || cage.faceSizes.size() != first.faceSizes.size()) {
            mismatch(key.span, diagnostics,
                     fmt::format("{} points and {} faces, but {} and {} in the first key", cage.positions.size(),
                                 cage.faceSizes.size(), first.positions.size(), first.faceSizes.size()));
            return std::nullopt;
        }
        if (cage.faceSizes != first.faceSizes || cage.corners != first.corners) {
            mismatch(key.span, diagnostics, "faces have other corners than in the first key");
            return std::nullopt;
        }
        keys.times.push_back(key.time);
        keys.states.push_back(std::move(loaded->cage.positions));
    }
    return keys;
}

std::unique_ptr<const Shape> placeMeshSteps(MeshData faces, std::vector<MeshStep> steps, const Transform& place,
                                            Span span, Diagnostics& diagnostics) {
    for (MeshStep& step : steps)
        if (!moveTo(step, place)) {
            diagnostics.error("E0605", span, "a shape reaches farther than 1e15 m from the camera", "too far away");
            return nullptr;
        }
    if (place.determinant() < 0) { // a mirror turns windings: turn them back, so that outside stays outside
        for (auto& t : faces.triangles) std::swap(t[1], t[2]);
        for (auto& q : faces.quads) std::swap(q[1], q[3]);
    }
    std::unique_ptr<const Shape> shape;
    if (steps.size() == 1) {
        faces.positions = std::move(steps[0].positions);
        faces.normals = std::move(steps[0].normals);
        shape = std::make_unique<const Mesh>(std::move(faces));
    } else {
        shape = std::make_unique<const DeformingMesh>(std::move(faces), std::move(steps));
    }
    if (shape->area() > 0) return shape;
    diagnostics.error("E0604", span, "this shape has no faces with an area", "nothing to see here");
    return nullptr;
}

std::unique_ptr<const Shape> placeMeshKeys(const MeshKeys& keys, Interval shutter, const Transform& place, Span span,
                                           Diagnostics& diagnostics) {
    const KeyGrid grid = gridOf(keys.times, shutter);
    const auto positions = [](const MeshData& m) -> const std::vector<Vec3>& { return m.positions; };
    std::vector<MeshStep> steps;
    for (const KeyPosition p : grid.steps)
        steps.push_back(
            {stateAt(keys, p, positions), directionsAt(
                                              keys, p, [](const MeshData& m) -> const auto& { return m.normals; })});
    warnOffGrid(
        grid, [&](std::size_t i) -> const auto& { return keys.states[i].positions; },
        [&](std::size_t i) -> const auto& { return steps[i].positions; }, place, span, diagnostics);
    MeshData faces;
    faces.triangles = keys.states[0].triangles;
    faces.quads = keys.states[0].quads;
    faces.uvs = keys.states[0].uvs;
    faces.attributes = keys.states[0].attributes;
    return placeMeshSteps(std::move(faces), std::move(steps), place, span, diagnostics);
}

void deformMesh(const MeshParams& params, ShapeBuilder& builder, LoadedShape& shape) {
    const ShapeContext context = builder.contextOf(*shape.definition);
    const bool ownPoints = !params.file.value.empty() || !params.points.empty();
    if (!checkKeys(params, params.keys, ownPoints, false, context.diagnostics)) return;
    FaceGroups groups;
    const bool grouped = !params.groupMaterials.empty();
    auto keys = loadMeshKeys(params, context.unit, context.zUp, grouped ? &groups : nullptr, context.diagnostics);
    if (!keys ||
        !addPointData(params, !params.keys[0].file.value.empty(), keys->states[0], context.span, context.diagnostics))
        return;
    builder.noteFiles(params.keys);
    shape.mesh = std::make_shared<const MeshData>(keys->states[0]);
    shape.sound = true;
    shape.deforms = builder.motion.deforms(keys->times);
    if (grouped) builder.chooseFaceMaterials(shape, groups);
    shape.place = [kept = std::make_shared<const MeshKeys>(std::move(*keys)), context](const Transform& place) {
        return placeMeshKeys(*kept, context.shutter, place, context.span, context.diagnostics);
    };
}

} // namespace abbe
