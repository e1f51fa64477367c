#include "scene/registry.h"
#include "scene/scene_builder.h"

#include <fmt/format.h>

namespace abbe {

using schema::Kind;

const Shape* SceneBuilder::keepShape(std::unique_ptr<const Shape> shape) {
    return shapes_.emplace_back(std::move(shape)).get();
}

Transform SceneBuilder::ownTransform(const Definition& d) {
    Transform result;
    for (const schema::Node& property : d.properties) {
        if (property.name() == "transform")
            result = schema::bindTransform(property, tree_.header, diagnostics_);
        else
            diagnostics_.error("E0201", property.nameSpan(),
                               fmt::format("`{}` has no property `{}`", schema::keyword(d.kind), property.name()),
                               "only `transform` is possible here");
    }
    return result;
}

std::optional<KeyedTransform> SceneBuilder::ownKeys(const Definition& d) {
    for (const schema::Node& property : d.properties)
        if (property.name() == "transform" && schema::hasKeys(property))
            return schema::bindMotion(property, tree_.header, diagnostics_);
    return std::nullopt;
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
    } else if (!loadParametric(d, shape, up) && !loadCurves(d, shape) && !loadSubdivision(d, shape) &&
               !checkPlanned(d)) {
        bound<ShapeParams>(d); // unknown type: report what is wrong besides
    }
    if (shape.sound && shape.infinite && shape.common.emission) {
        diagnostics_.error("E0606", d.span, "an infinite plane cannot emit", "give it an end: use a quad or a disk");
        shape.sound = false;
    }
    return shape;
}

void SceneBuilder::loadMeshShape(const Definition& d, LoadedShape& shape) {
    const auto params = bound<MeshParams>(d);
    if (!params) return;
    shape.common = *params;
    auto mesh = loadMesh(params->file, tree_.header.length, params->points, params->faces, d.span, diagnostics_,
                         tree_.header.zUp);
    if (!mesh) return;
    if (!params->file.value.empty()) built_->facts.files.push_back(params->file.value);
    shape.mesh = std::make_shared<const MeshData>(std::move(*mesh));
    shape.sound = true;
    shape.place = [this, &shape, span = d.span](const Transform& t) {
        return placeMesh(*shape.mesh, t, span, diagnostics_);
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

void SceneBuilder::placeShape(const Definition& d, const Transform& toRender) {
    LoadedShape& loaded = loadedShape(d);
    if (!loaded.sound) return;
    auto shape = loaded.place(loaded.common.transform.then(toRender));
    if (!shape) return;
    countShape(loaded);
    const Shape* placed = keepShape(std::move(shape));
    if (!loaded.infinite) bounds_.add(Bounds3d{Vec3d(placed->bounds().lower), Vec3d(placed->bounds().upper)});
    embree_.addShape(*placed, {materialOf(loaded.common), emitterOf(loaded, *placed)});
}

void SceneBuilder::placeAll(const std::vector<Definition>& definitions, const Transform& toRender) {
    for (const Definition& d : definitions) {
        switch (d.kind) {
        case Kind::shape:
            placeShape(d, toRender);
            break;
        case Kind::light:
            placeLight(d, toRender);
            break;
        case Kind::group:
            placeAll(d.children, ownTransform(d).then(toRender));
            break;
        case Kind::volume:
            placeVolume(d, toRender);
            break;
        case Kind::instance:
        case Kind::instances:
            placeInstances(d, definitions, toRender);
            break;
        default:
            break;
        }
    }
}

} // namespace abbe
