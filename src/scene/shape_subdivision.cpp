#include "scene/shape_subdivision.h"

#include "geometry/mesh.h"
#include "geometry/subdivision_check.h"
#include "scene/scene_builder.h"
#include "scene/shape_deform.h"

#include <algorithm>

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
                                              Span span, Diagnostics& diagnostics,
                                              std::vector<DicedSurface::Face>* faces) {
    for (Vec3& p : cage.positions) p = Vec3(place.point(Vec3d(p))); // the limit of the image is the image of the limit
    if (findFault(cage)) {
        diagnostics.error("E0605", span, "a shape reaches farther than 1e15 m from the camera", "too far away");
        return nullptr;
    }
    auto diced = dice(cage, dicing, memory, span, diagnostics);
    if (!diced) return nullptr;
    if (faces) *faces = std::move(diced->faces);
    if (place.determinant() < 0) turnRound(diced->mesh);
    return unlessEmpty(std::make_unique<const Mesh>(std::move(diced->mesh)), span, diagnostics);
}

std::unique_ptr<const Shape> placeDisplaced(const Cage& cage, const Displacement& displacement, const Dicing& dicing,
                                            double memory, const Transform& place, Span span, Diagnostics& diagnostics,
                                            std::vector<DicedSurface::Face>* faces) {
    Dicing placed = dicing;
    placed.place = place;
    auto diced = dice(cage, placed, memory, span, diagnostics, &displacement);
    if (!diced) return nullptr;
    if (faces) *faces = std::move(diced->faces);
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
    SubdivisionParams stated = *params;
    if (!useFirstKey(stated, diagnostics_)) return true;
    auto loaded = loadCage(stated, tree_.header.length, d.span, diagnostics_);
    if (!checkDicingCamera(params->dicing) || !loaded || !dicing) return true;
    if (!params->file.value.empty()) built_->facts.files.push_back(params->file.value);
    auto keys = loadCageKeys(*params, loaded->cage, tree_.header.length, diagnostics_);
    if (!keys) return true;
    noteFiles(params->keys);
    const auto choices = cageChoices(*params, *loaded);
    if (!choices) return true;
    const Texture* const map = textureFor(params->displacementMap, TextureUse::heights,
                                          params->displacement ? params->displacement->span : d.span);
    auto displacement = chooseDisplacement(*params, map, loaded->cage, diagnostics_);
    if (!displacement) return true;
    if (displacement->moves && leavesOut({SwitchedEffect::displacement}, d.span)) displacement.emplace();
    shape.sound = true;
    shape.deforms = !keys->times.empty() && deforms(keys->times);
    if (holdsMedium(*params)) shape.cageEdges = openEdges(loaded->cage);
    const auto cage = std::make_shared<const Cage>(std::move(loaded->cage));
    shape.place = [this, &shape, cage, dicing = *dicing, asked = params->dicing, offscreen = params->offscreen,
                   memory = params->memory, choices = *choices, displacement = *displacement, keys = std::move(*keys),
                   span = d.span](const Transform& t) {
        const Dicing rate = dicingFor(dicing, asked, offscreen, *cage, t);
        std::vector<DicedSurface::Face> faces;
        const Displacement* const moves = displacement.moves ? &displacement.displacement : nullptr;
        auto placed =
            !keys.times.empty()
                ? placeCageKeys(*cage, keys, embree_.shutter(), moves, rate, memory, t, span, diagnostics_, &faces)
            : displacement.moves
                ? placeDisplaced(*cage, displacement.displacement, rate, memory, t, span, diagnostics_, &faces)
                : placeSubdivision(*cage, rate, memory, t, span, diagnostics_, &faces);
        if (!placed) return placed;
        shape.dicedTriangles = faces.back().firstTriangle;
        shape.dicedQuads = faces.back().firstQuad;
        if (choices.empty()) return placed;
        shape.faceMaterials.assign(shape.dicedTriangles + shape.dicedQuads, 0);
        for (std::size_t f = 0; f < choices.size(); ++f) {
            auto* const first = shape.faceMaterials.data();
            std::fill(first + faces[f].firstTriangle, first + faces[f + 1].firstTriangle, choices[f]);
            std::fill(first + shape.dicedTriangles + faces[f].firstQuad,
                      first + shape.dicedTriangles + faces[f + 1].firstQuad, choices[f]);
        }
        return placed;
    };
    return true;
}

// The material of each face of a cage, as groupChoices() numbers them: empty if all have the shape's own.
std::optional<std::vector<std::uint16_t>> SceneBuilder::cageChoices(const ShapeParams& params,
                                                                    const LoadedCage& loaded) {
    if (params.groupMaterials.empty()) return std::vector<std::uint16_t>{};
    std::vector<std::string> names;
    for (const CageFile::Group& group : loaded.groups) names.push_back(group.name);
    const auto ofGroup = groupChoices(params, names);
    if (!ofGroup) return std::nullopt;
    std::vector<std::uint16_t> ofFace(loaded.cage.faceSizes.size());
    for (std::size_t g = 0; g < names.size(); ++g)
        std::fill(ofFace.begin() + static_cast<std::ptrdiff_t>(loaded.groups[g].firstFace), ofFace.end(),
                  (*ofGroup)[g]); // the next group begins where this one ends
    return ofFace;
}

} // namespace abbe
