#include "scene/shape_subdivision.h"

#include "geometry/mesh.h"
#include "geometry/place_shape.h"
#include "geometry/subdivision_check.h"
#include "scene/camera_builder.h"
#include "scene/shape_builder.h"
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

namespace {

// The material of each face of a cage, as groupChoices() numbers them: empty if all have the shape's own.
std::optional<std::vector<std::uint16_t>> cageChoices(const ShapeParams& params, const LoadedCage& loaded,
                                                      ShapeBuilder& builder) {
    if (params.groupMaterials.empty()) return std::vector<std::uint16_t>{};
    std::vector<std::string> names;
    for (const CageFile::Group& group : loaded.groups) names.push_back(group.name);
    const auto ofGroup = builder.groupChoices(params, names);
    if (!ofGroup) return std::nullopt;
    std::vector<std::uint16_t> ofFace(loaded.cage.faceSizes.size());
    for (std::size_t g = 0; g < names.size(); ++g)
        std::fill(ofFace.begin() + static_cast<std::ptrdiff_t>(loaded.groups[g].firstFace), ofFace.end(),
                  (*ofGroup)[g]); // the next group begins where this one ends
    return ofFace;
}

// Everything about a subdivision surface that does not depend on where it stands.
struct CageToPlace {
    std::shared_ptr<const Cage> cage;
    CageKeys keys;
    Dicing dicing;
    schema::Quantity asked; // of the dicing
    double offscreen, memory;
    std::vector<std::uint16_t> choices; // see cageChoices
    DisplacementChoice displacement;
};

// Places it, and counts in `shape` what it is diced into.
std::unique_ptr<const Shape> placeCage(const CageToPlace& c, const ShapeContext& context, CameraBuilder& cameras,
                                       bool inObject, const Transform& place, LoadedShape& shape) {
    const Dicing rate = cameras.dicingFor(c.dicing, c.asked, c.offscreen, *c.cage, place, inObject);
    std::vector<DicedSurface::Face> faces;
    const Displacement* const moves = c.displacement.moves ? &c.displacement.displacement : nullptr;
    const Span span = context.span;
    auto placed = !c.keys.times.empty() ? placeCageKeys(*c.cage, c.keys, context.shutter, moves, rate, c.memory, place,
                                                        span, context.diagnostics, &faces)
                  : moves ? placeDisplaced(*c.cage, *moves, rate, c.memory, place, span, context.diagnostics, &faces)
                          : placeSubdivision(*c.cage, rate, c.memory, place, span, context.diagnostics, &faces);
    if (!placed) return placed;
    shape.dicedTriangles = faces.back().firstTriangle;
    shape.dicedQuads = faces.back().firstQuad;
    if (c.choices.empty()) return placed;
    shape.faceMaterials.assign(shape.dicedTriangles + shape.dicedQuads, 0);
    for (std::size_t f = 0; f < c.choices.size(); ++f) {
        auto* const first = shape.faceMaterials.data();
        std::fill(first + faces[f].firstTriangle, first + faces[f + 1].firstTriangle, c.choices[f]);
        std::fill(first + shape.dicedTriangles + faces[f].firstQuad,
                  first + shape.dicedTriangles + faces[f + 1].firstQuad, c.choices[f]);
    }
    return placed;
}

} // namespace

void loadSubdivision(const SubdivisionParams& params, ShapeBuilder& builder, LoadedShape& shape) {
    const ShapeContext context = builder.contextOf(*shape.definition);
    Diagnostics& diagnostics = context.diagnostics;
    shape.subdivided = true;
    const auto dicing = dicingOf(params.dicing, diagnostics);
    SubdivisionParams stated = params;
    if (!useFirstKey(stated, diagnostics)) return;
    auto loaded = loadCage(stated, context.unit, context.span, diagnostics);
    if (!builder.cameras.checkDicingCamera(params.dicing) || !loaded || !dicing) return;
    if (!params.file.value.empty()) builder.scene.noteFile(params.file.value);
    auto keys = loadCageKeys(params, loaded->cage, context.unit, diagnostics);
    if (!keys) return;
    builder.noteFiles(params.keys);
    auto choices = cageChoices(params, *loaded, builder);
    if (!choices) return;
    const Texture* const map = builder.textures.textureFor(
        params.displacementMap, TextureUse::heights, params.displacement ? params.displacement->span : context.span);
    auto displacement = chooseDisplacement(params, map, loaded->cage, diagnostics);
    if (!displacement) return;
    if (displacement->moves && builder.scene.leavesOut({SwitchedEffect::displacement}, context.span))
        displacement.emplace();
    shape.sound = true;
    shape.deforms = !keys->times.empty() && builder.motion.deforms(keys->times);
    if (builder.materials.holdsMedium(params)) shape.cageEdges = openEdges(loaded->cage);
    CageToPlace cage{std::make_shared<const Cage>(std::move(loaded->cage)),
                     std::move(*keys),
                     *dicing,
                     params.dicing,
                     params.offscreen,
                     params.memory,
                     std::move(*choices),
                     *displacement};
    shape.place = [&builder, &shape, context, cage = std::move(cage)](const Transform& place) {
        return placeCage(cage, context, builder.cameras, builder.placesInObject(), place, shape);
    };
}

} // namespace abbe
