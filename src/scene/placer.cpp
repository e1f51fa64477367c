#include "scene/placer.h"

#include "geometry/instance_table.h"
#include "scene/instance_builder.h"
#include "scene/registry.h"

#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace abbe {

using schema::Kind;

void Placer::countShape(const LoadedShape& shape) {
    SceneFacts& facts = context_.built.facts;
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
    } else if (shape.quads > 0) {
        facts.quads += shape.quads;
    } else {
        ++facts.analytic;
    }
}

// Emitters and planes are placed once for each instance of an object, each by itself; everything else once in it.
void Placer::placeShape(const Definition& d, const Place& outer) {
    LoadedShape& loaded = shapes_.loaded(d);
    if (!loaded.sound) return;
    if (outer.object && (loaded.infinite || shapes_.emissionOf(loaded).radiance.curve)) {
        outer.object->unshared.push_back({&d, outer.motion, outer.visible});
        return;
    }
    carry(loaded.common.transform, outer, d.span, [&](const Place& place) { placeLoaded(loaded, place); });
}

void Placer::placeLoaded(LoadedShape& loaded, const Place& place) {
    if (loaded.infinite && place.motion.moves()) {
        context_.diagnostics
            .error("E0634", loaded.definition->span, "an infinite plane cannot move", "it or what holds it moves")
            .help = "give it an end: use a quad or a disk";
        return;
    }
    const Transform here = motion_.atOpening(place.motion);
    auto shape = shapes_.placed(loaded, here, place.object != nullptr);
    if (!shape) return;
    countShape(loaded);
    noteEffects(loaded);
    if (place.object) place.object->hasShapes = true;
    const Shape* placed = shapes_.keep(std::move(shape));
    context_.built.scene.names[placed] = context_.nameOf(*loaded.definition);
    context_.built.declared[placed] = loaded.definition->nameSpan;
    noteBounds(*loaded.definition, loaded.infinite ? kEverything : placed->bounds(), place);
    if (!std::exchange(loaded.texturesChecked, true)) checkTextures(loaded, *placed);
    const Visibility visible = place.visible & visibilityOf(loaded.common.visibleTo);
    const Passing passing = passingOf(loaded.common);
    noteVisible(visible, passing, *loaded.definition);
    if (place.object) place.object->passing.add(passing);
    add(*placed,
        {materials_.ofShape(loaded.common), lights_.emitterOf(loaded, *placed, place.motion, visible), here.inverse(),
         shapes_.emissionOf(loaded).texture != nullptr, visible},
        place);
}

void Placer::add(const Shape& shape, EmbreeSceneBuilder::Binding binding, const Place& place) {
    const Bounds3 box = shape.bounds();
    media_.notePlaced(*binding.material, place.into ? kEverything : box, place.object != nullptr);
    noteFocusing(*binding.material, {box, context_.built.scene.names[&shape]}, place.into);
    context_.built.scene.surfaces.push_back({&shape, binding.material, place.into != nullptr});
    if (place.into) {
        place.into->shapes.emplace_back(&shape, binding);
        place.into->bounds.add(box);
        return;
    }
    if (std::isfinite(shape.area())) extend(box);
    embree.addShape(shape, binding);
}

void Placer::placeGroup(const Definition& d, const Place& outer) {
    const Placing own = ownPlacing(d);
    Place place = outer;
    place.visible = place.visible & own.visible;
    carry(own.transform, place, d.span, [&](const Place& inside) { placeAll(d.children, inside); });
}

void Placer::placeVolume(const Definition& d, const Place& place) {
    if (place.object || place.motion.moves()) {
        context_.diagnostics
            .error("E0644", d.span, "a volume stands still, at the top level or in a group",
                   place.object ? "in an object" : "what holds it moves")
            .help = "media that fill shapes (`interior`) may move and be instanced";
        return;
    }
    MadeMedium made = media_.makeVolume(d, motion_.atOpening(place.motion));
    if (!made.medium) return;
    if (made.light) lights_.add(std::move(made.light), d);
    media_.noteOpen(media_[{media_.keep(std::move(made.medium), d)}], d.span);
}

// An unknown name has been reported.
void Placer::placeAtmosphere(const Definition& d) {
    const Definition* const named = context_.tree.find(Kind::medium, d.target);
    if (!named) return;
    if (const schema::Reference medium = context_.reference(*named);
        medium.valid() && !context_.leavesOut({SwitchedEffect::medium, context_.nameOf(*named)}, d.span))
        media_.noteOpen(media_[medium], d.span);
}

void Placer::noteEffects(const LoadedShape& shape) {
    const Definition& d = *shape.definition;
    if (shape.deforms) context_.noteEffect(Effect::motion, d.span, "it changes its shape while the shutter is open");
    if (shape.strands > 0) context_.noteEffect(Effect::curves, d.span, "it is made of curves");
    if (!shape.subdivided) return;
    context_.noteEffect(Effect::subdivision, d.span, "its surface is the limit of a cage");
    for (const schema::Node& property : d.properties)
        if (property.name() == "displacement")
            context_.noteEffect(Effect::displacement, property.headSpan(), "a map moves its surface");
}

void Placer::noteBounds(const Definition& d, const Bounds3& box, const Place& place, std::size_t places) {
    SceneFacts::ShapeFact fact;
    const bool placement = d.kind == schema::Kind::instance || d.kind == schema::Kind::instances;
    fact.kind = schema::keyword(d.kind);
    fact.name = placement ? d.target : context_.nameOf(d);
    if (d.type) fact.type = d.type->name;
    fact.places = places;
    if (place.object) fact.inside = place.object->name;
    if (!box.empty()) {
        const Vec3d origin = place.object ? Vec3d() : context_.built.scene.origin;
        fact.bounds = {Vec3d(box.lower) + origin, Vec3d(box.upper) + origin};
    }
    context_.built.facts.shapeList.push_back(std::move(fact));
}

void Placer::checkTextures(LoadedShape& loaded, const Shape& shape) {
    const TexturedShape on{*loaded.definition, shape, loaded.uvOnFaces};
    shapes_.textures.check(loaded.common.material, on);
    for (const schema::GroupReference& group : loaded.common.groupMaterials)
        shapes_.textures.check(group.reference, on);
}

void Placer::noteFocusing(const Material& material, FocusingShape shape, Assembly* into) {
    if (material.focuses()) focusingIn(into).push_back(std::move(shape));
}

void Placer::placeLight(const Definition& d, const Place& place) {
    if (place.object) {
        place.object->unshared.push_back({&d, place.motion, place.visible});
        return;
    }
    LightSite site(d, place, *this, lights_);
    const auto bindInto = context_.binder(d);
    if (d.type)
        makerOf<MakeLight> (*d.type)(bindInto, site);
    else
        bindInto(nullptr); // unknown type: report what is wrong besides
}

void Placer::placeAll(const std::vector<Definition>& definitions, const Place& place) {
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
            instances_.place(d, definitions, place);
            break;
        default:
            break;
        }
    }
}

// What moves while the shutter is open is built where it is when the shutter opens, and carried on from there as one
// instance.

void Placer::carry(const KeyedTransform& own, const Place& outer, Span where,
                   const std::function<void(const Place&)>& build) {
    Place place = outer;
    place.motion = motion_.within(outer.motion, own);
    if (!place.motion.moves() || (outer.into != outer.base && !motion_.moves(own))) return build(place);
    if (!motion_.check(place.motion, where)) return;
    context_.noteEffect(Effect::motion, where, "it moves while the shutter is open");
    const Motion onwards = motion_.fromOpening(place.motion);
    if (!motion_.check(onwards, where)) return;
    Assembly carried;
    place.into = &carried;
    build(place);
    if (carried.shapes.empty() && carried.placed.empty()) return;
    const Bounds3 bounds = carried.bounds;
    const std::vector<FocusingShape> focusing = std::move(carried.focusing);
    const int levels = carried.levels;
    addMoving(addAssembly(std::move(carried)), levels, bounds, focusing, onwards, outer.base, where);
}

std::uint32_t Placer::addAssembly(Assembly parts) {
    const std::uint32_t number = embree.addObject(std::move(parts.shapes));
    for (auto& [object, places, visible] : parts.placed)
        embree.addInstances(object, std::move(places), number, visible);
    for (const auto& [object, motion, visible] : parts.moving) embree.addMoving(object, motion, number, visible);
    return number;
}

void Placer::addMoving(std::uint32_t object, int levels, const Bounds3& bounds,
                       const std::vector<FocusingShape>& focusing, const Motion& motion, Assembly* into, Span where,
                       Visibility visible) {
    const Bounds3 box = motion_.swept(motion, bounds);
    for (const FocusingShape& shape : focusing)
        focusingIn(into).push_back({motion_.swept(motion, shape.box), shape.name});
    if (!into) {
        if (!box.empty()) extend(box);
        embree.addMoving(object, motion, EmbreeSceneBuilder::kScene, visible);
    } else if (nest(*into, levels, where)) {
        into->bounds.add(box);
        into->moving.push_back({object, motion, visible});
    }
}

bool Placer::nest(Assembly& into, int levels, Span where) {
    if (levels + 2 > kMaxInstanceLevels) return tooDeep(where), false; // the scene itself is one more
    into.levels = std::max(into.levels, levels + 1);
    return true;
}

void Placer::tooDeep(Span where) {
    context_.diagnostics.error("E0633", where, fmt::format("objects nest more than {} levels deep", kMaxInstanceLevels),
                               "this one is too deep");
}

// Shapes that some kinds of rays do not see.

namespace {

const schema::FieldInfo& visibleOfPlacement() {
    static const schema::FieldInfo field = visibleField<VisibleParams>();
    return field;
}

// Light goes into it, or through its surface without being scattered.
bool isEntered(const Material& material) {
    return material.ior() || material.isBoundary() || material.interior() || material.absorption();
}

Span visibleSpan(const schema::Definition& d) {
    for (const schema::Node& property : d.properties)
        if (property.name() == "visible-to") return property.headSpan();
    return d.span;
}

} // namespace

// Of groups, objects and instances, which have no type.
Placing Placer::ownPlacing(const Definition& d) {
    Placing result;
    for (const schema::Node& property : d.properties) {
        if (property.name() == "transform") {
            result.transform =
                schema::bindMotion(property, context_.tree.headerOf(property.headSpan()), context_.diagnostics);
        } else if (property.name() == "visible-to") {
            if (const auto words =
                    schema::bindWords(visibleOfPlacement(), property, context_.tree, context_.diagnostics))
                result.visible = visibilityOf(*words);
        } else {
            context_.diagnostics.error(
                "E0201", property.nameSpan(),
                fmt::format("`{}` has no property `{}`", schema::keyword(d.kind), property.name()),
                "only `transform` and `visible-to` are possible here");
        }
    }
    return result;
}

Passing Placer::passingOf(const ShapeParams& params) {
    Passing passing;
    const auto add = [&](const Material* material) {
        if (!material) return;
        passing.add({isEntered(*material), material->mayBeOpen()});
    };
    add(materials_.ofShape(params));
    for (const schema::GroupReference& group : params.groupMaterials) add(&materials_[group.reference]);
    passing.entered = passing.entered || materials_.holdsMedium(params);
    return passing;
}

void Placer::noteVisible(Visibility visible, Passing passing, const Definition& definition) {
    if (visible == kVisibleToAll) return;
    if (passing.entered) {
        context_.diagnostics
            .error("E0635", visibleSpan(definition), "light goes through this shape, so all rays have to see it",
                   "hides glass, a boundary or an interior")
            .help = "only opaque shapes can be hidden, and thin sheets, which have no inside";
        return;
    }
    if (passing.open && !seenAlike(visible)) {
        context_.diagnostics
            .error("E0635", visibleSpan(definition), "shadows and reflections have to see the same openings",
                   "hides a shape whose `opacity` is below 1 from one of them")
            .help = "name both `shadows` and `reflections`, or neither of them";
        return;
    }
    HiddenShapes& hidden = context_.built.scene.hidden;
    hidden.fromCamera = hidden.fromCamera || !visible.has(RayKind::camera);
    hidden.splits =
        hidden.splits || !seenAlike(visible) || (visible.has(RayKind::camera) && !visible.has(RayKind::scattered));
}

// Light paths follow one kind of rays from lights to what they light.
void Placer::checkLightPathsSeeAll() {
    const Technique::LightPaths choice = context_.built.render.lightPaths;
    const bool demanded = choice == Technique::LightPaths::always || choice == Technique::LightPaths::alone;
    if (!context_.built.scene.hidden.splits || !demanded) return;
    context_.diagnostics
        .error("E0636", context_.tree.header.span,
               fmt::format("`light-paths {}` does not go with shapes that only some rays see", word(choice)),
               "`visible-to` of a shape names `shadows` without `reflections`, the other way round, or `camera` alone")
        .help = "leave `light-paths` to `automatic`: camera paths do the work then";
}

} // namespace abbe
