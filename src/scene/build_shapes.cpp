#include "scene/registry.h"
#include "scene/scene_builder.h"

#include <fmt/format.h>
#include <utility>

namespace abbe {

using schema::Kind;

const Shape* SceneBuilder::keepShape(std::unique_ptr<const Shape> shape) {
    return shapes_.emplace_back(std::move(shape)).get();
}

const std::string& SceneBuilder::nameOf(const Definition& d) {
    if (!d.name.empty()) return d.name;
    // Inline definitions have no lasting address.
    std::string& name = givenNames_[{static_cast<std::uint32_t>(d.span.file), d.span.begin}];
    if (name.empty()) {
        const auto type = std::string(d.type ? d.type->name : schema::keyword(d.kind));
        name = fmt::format("{}-{}", type, ++nameless_[type]);
    }
    return name;
}

const Material* SceneBuilder::plainMaterial(double reflectance) {
    auto& index = plainMaterials_[reflectance];
    if (!index) {
        index = static_cast<std::uint32_t>(materials_.size());
        materials_.push_back(makePlainMaterial(curves_.constant(reflectance)));
    }
    return materials_[*index].get();
}

const Material* SceneBuilder::materialOf(const ShapeParams& params) {
    if (!params.material.valid()) return filled(plainMaterial(0.5), params);
    usedMaterials_.insert(params.material.index);
    return filled(materials_[params.material.index].get(), params);
}

SceneBuilder::LoadedShape& SceneBuilder::loadedShape(const Definition& d) {
    const auto [found, isNew] = loaded_.try_emplace(&d);
    LoadedShape& shape = found->second;
    if (!isNew) return shape;
    shape.definition = &d;
    const auto take = [&](const auto& params) -> const auto& {
        shape.common = params;
        shape.sound = true;
        return params;
    };
    const std::string_view type = d.type ? d.type->name : "";
    const Vec3d up = tree_.header.zUp ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0};
    Diagnostics& diagnostics = diagnostics_;
    const Span span = d.span;
    if (type == "quad") {
        if (const auto p = bound<QuadParams>(d))
            shape.place = [&diagnostics, span, q = take(*p)](const Transform& t) {
                return makeQuad(q.points, q.size, t, span, diagnostics);
            };
    } else if (type == "sphere") {
        if (const auto p = bound<SphereParams>(d))
            shape.place = [&diagnostics, span, s = take(*p)](const Transform& t) {
                return makeSphere(s.center, s.radius, t, span, diagnostics);
            };
    } else if (type == "disk") {
        if (const auto p = bound<DiskParams>(d))
            shape.place = [&diagnostics, span, up, s = take(*p)](const Transform& t) {
                return makeDisk(s.center, s.normal.value_or(up), s.radius, t, span, diagnostics);
            };
    } else if (type == "plane") {
        shape.infinite = true;
        if (const auto p = bound<PlaneParams>(d))
            shape.place = [&diagnostics, span, up, s = take(*p)](const Transform& t) {
                return makePlane(s.center, s.normal.value_or(up), t, span, diagnostics);
            };
    } else if (type == "mesh") {
        loadMeshShape(d, shape);
    } else if (!loadParametric(d, shape, up) && !loadCurves(d, shape) && !loadSubdivision(d, shape)) {
        bound<ShapeParams>(d); // unknown type: report what is wrong besides
    }
    if (shape.sound && !shape.common.groupMaterials.empty())
        shape.place = [this, &shape, inner = std::move(shape.place)](const Transform& t) {
            auto placed = inner(t);
            return placed ? withFaceMaterials(shape, std::move(placed)) : nullptr;
        };
    if (shape.sound && shape.infinite && emissionOf(shape).radiance.curve) {
        diagnostics_.error("E0606", d.span, "an infinite plane cannot emit", "give it an end: use a quad or a disk");
        shape.sound = false;
    }
    checkInterior(shape);
    return shape;
}

void SceneBuilder::loadMeshShape(const Definition& d, LoadedShape& shape) {
    const auto params = bound<MeshParams>(d);
    if (!params) return;
    shape.common = *params;
    if (!params->keys.empty()) return deformMesh(d, *params, shape);
    FaceGroups groups;
    const bool grouped = !params->groupMaterials.empty();
    shape.meshOrigin = farMiddle(params->points);
    auto mesh = loadMesh(params->file, tree_.header.length, relativeTo(shape.meshOrigin, params->points), params->faces,
                         d.span, diagnostics_, tree_.header.zUp, grouped ? &groups : nullptr);
    if (!mesh || !addPointData(*params, !params->file.value.empty(), *mesh, d.span, diagnostics_)) return;
    if (!params->file.value.empty()) built_->facts.files.push_back(params->file.value);
    shape.mesh = std::make_shared<const MeshData>(std::move(*mesh));
    shape.sound = true;
    if (grouped) chooseFaceMaterials(shape, groups);
    shape.place = [this, &shape, span = d.span](const Transform& t) {
        return placeMesh(*shape.mesh, Transform::translate(shape.meshOrigin).then(t), span, diagnostics_);
    };
}

void SceneBuilder::countShape(const LoadedShape& shape) {
    SceneFacts& facts = built_->facts;
    ++facts.shapes;
    if (shape.mesh) {
        facts.triangles += shape.mesh->triangles.size();
        facts.quads += shape.mesh->quads.size();
    } else if (shape.dicedTriangles + shape.dicedQuads > 0) {
        facts.triangles += shape.dicedTriangles;
        facts.quads += shape.dicedQuads;
    } else if (shape.segments + shape.points > 0) {
        facts.strands += shape.strands;
        facts.segments += shape.segments;
        facts.points += shape.points;
    } else if (shape.definition->type->name == "quad") {
        ++facts.quads;
    } else {
        ++facts.analytic;
    }
}

// Emitters and planes are placed once for each instance of an object, each by itself; everything else once in it.
void SceneBuilder::placeShape(const Definition& d, const Place& outer) {
    LoadedShape& loaded = loadedShape(d);
    if (!loaded.sound) return;
    if (outer.object && (loaded.infinite || emissionOf(loaded).radiance.curve)) {
        outer.object->unshared.push_back({&d, outer.motion, outer.visible});
        return;
    }
    carry(loaded.common.transform, outer, d.span, [&](const Place& place) { placeLoaded(loaded, place); });
}

void SceneBuilder::placeLoaded(LoadedShape& loaded, const Place& place) {
    if (loaded.infinite && place.motion.moves()) {
        diagnostics_
            .error("E0634", loaded.definition->span, "an infinite plane cannot move", "it or what holds it moves")
            .help = "give it an end: use a quad or a disk";
        return;
    }
    const Transform here = atOpening(place.motion);
    auto shape = place.object ? placeInObject(loaded, here) : loaded.place(here);
    if (!shape) return;
    countShape(loaded);
    noteShape(loaded);
    if (place.object) place.object->hasShapes = true;
    const Shape* placed = keepShape(std::move(shape));
    built_->scene.names[placed] = nameOf(*loaded.definition);
    built_->declared[placed] = loaded.definition->nameSpan;
    noteBounds(*loaded.definition, loaded.infinite ? kEverything : placed->bounds(), place);
    if (!std::exchange(loaded.texturesChecked, true)) checkTextures(loaded, *placed);
    const Visibility visible = place.visible & visibilityOf(loaded.common.visibleTo);
    const Passing passing = passingOf(loaded.common);
    noteVisible(visible, passing, *loaded.definition);
    if (place.object) place.object->passing.add(passing);
    addPlaced(*placed,
              {materialOf(loaded.common), emitterOf(loaded, *placed, place.motion, visible), here.inverse(),
               emissionOf(loaded).texture != nullptr, visible},
              place);
}

void SceneBuilder::addPlaced(const Shape& shape, EmbreeSceneBuilder::Binding binding, const Place& place) {
    const Bounds3 box = shape.bounds();
    notePlaced(*binding.material, place.into ? kEverything : box, place.object != nullptr);
    noteFocusing(*binding.material, {box, built_->scene.names[&shape]}, place.into);
    built_->scene.surfaces.push_back({&shape, binding.material, place.into != nullptr});
    if (place.into) {
        place.into->shapes.emplace_back(&shape, binding);
        place.into->bounds.add(box);
        return;
    }
    if (std::isfinite(shape.area())) bounds_.add(Bounds3d{Vec3d(box.lower), Vec3d(box.upper)});
    embree_.addShape(shape, binding);
}

void SceneBuilder::placeGroup(const Definition& d, const Place& outer) {
    const Placing own = ownPlacing(d);
    Place place = outer;
    place.visible = place.visible & own.visible;
    carry(own.transform, place, d.span, [&](const Place& inside) { placeAll(d.children, inside); });
}

void SceneBuilder::placeAll(const std::vector<Definition>& definitions, const Place& place) {
    for (const Definition& d : definitions) {
        switch (d.kind) {
        case Kind::shape:
            placeShape(d, place);
            break;
        case Kind::light:
            placeLight(d, place);
            break;
        case Kind::group:
            placeGroup(d, place);
            break;
        case Kind::atmosphere:
            placeAtmosphere(d);
            break;
        case Kind::volume:
            placeVolume(d, place);
            break;
        case Kind::instance:
        case Kind::instances:
            placeInstances(d, definitions, place);
            break;
        default:
            break;
        }
    }
}

} // namespace abbe
