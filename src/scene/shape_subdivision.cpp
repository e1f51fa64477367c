#include "scene/shape_subdivision.h"

#include "geometry/mesh.h"
#include "geometry/subdivision_check.h"
#include "scene/scene_builder.h"

namespace abbe {

using Cage = SubdivisionCage;

namespace {

// A mirror turns a surface inside out: this turns it back.
void turnRound(MeshData& mesh) {
    for (Vec3& n : mesh.normals) n = -n;
    for (auto& t : mesh.triangles) std::swap(t[1], t[2]);
    for (auto& q : mesh.quads) std::swap(q[1], q[3]);
}

std::optional<DicedSurface> dice(const Cage& cage, const Dicing& dicing, double memory, Span span,
                                 Diagnostics& diagnostics, const Displacement* displacement = nullptr) {
    const SubdivisionSurface surface(cage);
    const DicingPlan plan = surface.plan(dicing, static_cast<std::uint64_t>(memory * (1 << 20)), displacement);
    if (plan.coarser > 1) warnOfBudget(surface, dicing, plan, memory, span, diagnostics, displacement);
    try {
        return surface.dice(plan, displacement);
    } catch (const std::bad_alloc&) {
        diagnostics.error("E0404", span, "the diced surface does not fit into memory", describe(plan));
        return std::nullopt;
    }
}

std::unique_ptr<const Shape> unlessEmpty(std::unique_ptr<const Mesh> shape, Span span, Diagnostics& diagnostics) {
    if (shape->area() > 0) return shape;
    diagnostics.error("E0604", span, "this subdivision surface has no faces with an area", "nothing to see here").help =
        "holes are left out, and with `boundary none` all faces at open edges";
    return nullptr;
}

} // namespace

std::unique_ptr<const Shape> placeSubdivision(Cage cage, const Dicing& dicing, double memory, const Transform& place,
                                              Span span, Diagnostics& diagnostics) {
    for (Vec3& p : cage.positions) p = Vec3(place.point(Vec3d(p))); // the limit of the image is the image of the limit
    if (findFault(cage)) {
        diagnostics.error("E0605", span, "a shape reaches farther than 1e15 m from the camera", "too far away");
        return nullptr;
    }
    auto diced = dice(cage, dicing, memory, span, diagnostics);
    if (!diced) return nullptr;
    if (place.determinant() < 0) turnRound(diced->mesh);
    return unlessEmpty(std::make_unique<const Mesh>(std::move(diced->mesh)), span, diagnostics);
}

std::unique_ptr<const Shape> placeDisplaced(const Cage& cage, const Displacement& displacement, const Dicing& dicing,
                                            double memory, const Transform& place, Span span,
                                            Diagnostics& diagnostics) {
    Dicing placed = dicing;
    placed.place = place;
    auto diced = dice(cage, placed, memory, span, diagnostics, &displacement);
    if (!diced) return nullptr;
    auto shape = placeMesh(std::move(diced->mesh), place, span, diagnostics);
    if (!shape) return nullptr;
    return unlessEmpty(std::unique_ptr<const Mesh>(static_cast<const Mesh*>(shape.release())), span, diagnostics);
}

// For geometry that is seen from many places, or from none that is known yet.
std::unique_ptr<const Shape> SceneBuilder::placeInObject(const LoadedShape& shape, const Transform& toObject) {
    inObject_ = true;
    auto placed = shape.place(toObject);
    inObject_ = false;
    return placed;
}

bool SceneBuilder::loadSubdivision(const Definition& d, LoadedShape& shape) {
    if (!d.type || d.type->name != "subdivision") return false;
    const auto params = bound<SubdivisionParams>(d);
    if (!params) return true;
    shape.common = *params;
    const auto dicing = dicingOf(params->dicing, diagnostics_);
    auto loaded = loadCage(*params, tree_.header.length, d.span, diagnostics_);
    if (!loaded || !dicing) return true;
    if (!params->file.value.empty()) built_->facts.files.push_back(params->file.value);
    const auto displacement = chooseDisplacement(*params, textureOf(params->displacementMap), *loaded, diagnostics_);
    if (!displacement) return true;
    shape.sound = true;
    const auto cage = std::make_shared<const Cage>(std::move(*loaded));
    shape.place = [this, &shape, cage, wanted = *dicing, memory = params->memory, displacement = *displacement,
                   span = d.span](const Transform& t) {
        Dicing rate = wanted;
        if (rate.mode == Dicing::Mode::pixels && !built_->scene.camera) {
            rate.mode = Dicing::Mode::level; // the camera itself asks where the shape is
            rate.rate = 2;
        } else if (rate.mode == Dicing::Mode::pixels && inObject_) {
            Bounds3d box;
            for (const Vec3 p : cage->positions) box.add(t.point(Vec3d(p)));
            rate.pixelSize = [size = length(box.upper - box.lower) / built_->film.size.y](Vec3) { return size; };
        } else if (rate.mode == Dicing::Mode::pixels) {
            rate.pixelSize = pixelSizeOf(*built_->scene.camera, built_->film.size);
        }
        auto placed = displacement.moves
                          ? placeDisplaced(*cage, displacement.displacement, rate, memory, t, span, diagnostics_)
                          : placeSubdivision(*cage, rate, memory, t, span, diagnostics_);
        if (placed) {
            const MeshData& mesh = static_cast<const Mesh&>(*placed).data();
            shape.dicedTriangles = mesh.triangles.size();
            shape.dicedQuads = mesh.quads.size();
        }
        return placed;
    };
    return true;
}

} // namespace abbe
