#include "scene/instance_builder.h"

#include "geometry/instance_table.h"
#include "geometry/round_shapes.h"
#include "schema/suggest.h"

#include <fmt/format.h>

namespace abbe {

using schema::Kind;

namespace {

// More than any machine holds: nested objects multiply quickly.
constexpr std::size_t kMaxInstances = 100'000'000;
constexpr std::size_t kMaxUnshared = 1'000'000;
constexpr std::size_t kMostFocusing = 4096; // boxes that one line of the scene makes

// Takes the polygons of a shape apart into triangles.
class TriangleSink final : public GeometrySink {
  public:
    explicit TriangleSink(ScatterSurface& surface) : surface_(surface) {}
    void triangles(TimeSteps<Vec3> steps, Triangles indices) override {
        const std::span<const Vec3> vertices = steps[0]; // where instances are scattered once and for all
        for (const auto& t : indices) add(vertices[t[0]], vertices[t[1]], vertices[t[2]]);
    }
    void quads(TimeSteps<Vec3> steps, Quads indices) override {
        const std::span<const Vec3> vertices = steps[0];
        for (const auto& q : indices) {
            add(vertices[q[0]], vertices[q[1]], vertices[q[3]]);
            add(vertices[q[2]], vertices[q[3]], vertices[q[1]]);
        }
    }
    void curves(CurveBasis, CurveForm, TimeSteps<SizedPoint>, std::span<const std::uint32_t>,
                std::span<const std::uint8_t>) override {}
    void points(PointForm, TimeSteps<SizedPoint>, TimeSteps<Vec3>) override {}
    void analytic(const Bounds3&) override {}

  private:
    void add(Vec3 a, Vec3 b, Vec3 c) {
        const double area = 0.5 * length(cross(Vec3d(b) - Vec3d(a), Vec3d(c) - Vec3d(a)));
        if (!(area > 0)) return;
        surface_.triangles.push_back({Vec3d(a), Vec3d(b), Vec3d(c)});
        surface_.areaSums.push_back((surface_.areaSums.empty() ? 0 : surface_.areaSums.back()) + area);
    }
    ScatterSurface& surface_;
};

// How many places are asked for by number; 0 where a file tells.
double placesAskedFor(const InstancesParams& p) {
    return p.grid ? p.grid->x * p.grid->y * p.grid->z : p.count.value_or(0);
}

std::size_t saturated(std::size_t a, std::size_t b) {
    std::size_t product = 0;
    return __builtin_mul_overflow(a, b, &product) ? ~std::size_t{0} : product;
}

} // namespace

// The named shape where it stands, in the space of the definitions around it.
bool InstanceBuilder::scatterSurface(const schema::Text& over, const std::vector<Definition>& siblings,
                                     ScatterSurface& surface) {
    std::vector<std::string_view> names;
    const std::string wanted = context_.tree.fullName(over.span, over.value);
    for (const Definition& d : siblings) {
        if (d.kind != Kind::shape) continue;
        if (!d.name.empty()) names.push_back(d.name);
        if (d.name != wanted) continue;
        LoadedShape& loaded = shapes_.loaded(d);
        if (!loaded.sound) return false;
        const auto shape = shapes_.placed(loaded, loaded.common.transform.at(motion_.opening()), true);
        if (!shape) return false;
        TriangleSink sink(surface);
        shape->commit(sink);
        if (const auto* disk = dynamic_cast<const Disk*>(&shape->primitives()))
            surface.disk = {disk->centre(), disk->normal(), disk->radius()};
        if (surface.disk || !surface.triangles.empty()) return true;
        context_.diagnostics.error("E0632", over.span, fmt::format("nothing can be scattered over `{}`", over.value),
                                   "neither a round disk nor made of polygons");
        return false;
    }
    const auto meant = schema::nearest(over.value, names);
    auto& error = context_.diagnostics.error("E0632", over.span, fmt::format("no shape here is named `{}`", over.value),
                                             meant.empty() ? "unknown name" : schema::didYouMean(meant));
    if (context_.tree.find(Kind::shape, wanted))
        error.help = "it must stand in the same group or object as the instances, or with them at the top level";
    return false;
}

std::vector<Placement> InstanceBuilder::placements(const Definition& d, const InstancesParams* params,
                                                   const std::vector<Definition>& siblings, const Transform& outwards) {
    std::vector<Placement> result;
    const auto refuse = [&] {
        context_.diagnostics.error("E0607", d.span, "more than 100 million instances", "here they end");
    };
    const auto add = [&](const Transform& map) {
        if (const auto fault = Placement::findFault(map)) {
            const std::string which = params ? fmt::format("place {}", result.size()) : "this place";
            context_.diagnostics.error("E0631", d.span, fmt::format("{} cannot be used: {}", which, *fault),
                                       "from here");
        } else if (++instanceCount_ > kMaxInstances) {
            refuse();
        } else {
            result.emplace_back(map);
            return true;
        }
        result.clear();
        return false;
    };
    if (instanceCount_ > kMaxInstances) return result; // has been reported
    if (!params) {
        add(outwards);
        return result;
    }
    if (static_cast<double>(instanceCount_) + placesAskedFor(*params) > static_cast<double>(kMaxInstances)) {
        refuse(); // before memory is taken for them
        return result;
    }
    ScatterSurface surface;
    PlaceContext context{context_.tree.header.zUp ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0},
                         context_.tree.headerOf(d.span).length, nullptr, d.span};
    if (!params->over.value.empty()) {
        if (!scatterSurface(params->over, siblings, surface)) return result;
        context.surface = &surface;
    }
    if (!params->points.value.empty()) context_.noteFile(params->points.value);
    if (params->count) result.reserve(static_cast<std::size_t>(*params->count));
    std::vector<Transform>* const noted = context_.instancePlaces ? &(*context_.instancePlaces)[&d] : nullptr;
    if (noted) noted->clear();
    visitPlaces(*params, context, context_.diagnostics, [&](std::uint64_t, const Transform& place) {
        if (noted) noted->push_back(place);
        return add(place.then(outwards));
    });
    return result;
}

void InstanceBuilder::place(const Definition& d, const std::vector<Definition>& siblings, const Place& outer) {
    const std::size_t before = context_.diagnostics.errorCount();
    std::optional<InstancesParams> params;
    if (d.kind == Kind::instances) {
        params = context_.bound<InstancesParams>(d);
        if (!params) return;
    }
    const Placing own = params ? Placing{params->transform, visibilityOf(params->visibleTo)} : placer_.ownPlacing(d);
    const ObjectGeometry* geometry = instanced(d, outer);
    if (!geometry || context_.diagnostics.errorCount() != before) return;
    Place seen = outer;
    seen.visible = seen.visible & own.visible;
    placer_.noteVisible(seen.visible, geometry->passing, d);
    if (outer.object) outer.object->passing.add(geometry->passing);
    if (!params && motion_.moves(own.transform)) {
        Place place = seen;
        place.motion = motion_.within(outer.motion, own.transform);
        context_.noteEffect(Effect::motion, d.span, "it moves while the shutter is open");
        return placeMoving(d, *geometry, place);
    }
    placer_.carry(own.transform, seen, d.span, [&](const Place& place) {
        placeStill(d, placements(d, params ? &*params : nullptr, siblings, motion_.atOpening(place.motion)), *geometry,
                   place);
    });
}

// In the place, which may itself move.
void InstanceBuilder::placeStill(const Definition& d, std::vector<Placement> places, const ObjectGeometry& geometry,
                                 const Place& place) {
    if (places.empty() || (place.into && !placer_.nest(*place.into, geometry.levels, d.targetSpan))) return;
    (place.object ? place.object->shown : context_.built.facts.instances) += saturated(places.size(), geometry.shown);
    if (geometry.hasUnshared) {
        const Motion carried = place.motion.moves() ? motion_.fromOpening(place.motion) : Motion();
        if (place.object)
            place.object->nested.push_back({&geometry, places, carried, place.visible});
        else
            for (const Placement& p : places)
                placeUnshared(geometry, Motion(p.map()).then(carried), d.span, place.visible);
    }
    Bounds3 box;
    if (!geometry.bounds.empty())
        for (const Placement& p : places) box.add(p.toOuter(geometry.bounds));
    placer_.noteBounds(d, box, place, places.size());
    if (place.into)
        place.into->bounds.add(box);
    else if (!box.empty())
        placer_.extend(box);
    placeFocusing(geometry.focusing, places, place.into);
    if (!geometry.embreeObject) return;
    if (place.into)
        place.into->placed.push_back({*geometry.embreeObject, std::move(places), place.visible});
    else
        placer_.embree.addInstances(*geometry.embreeObject, std::move(places), EmbreeSceneBuilder::kScene,
                                    place.visible);
}

// A box for each place, or, of very many, one for all of them: light paths aim at some dozens of clusters at most.
void InstanceBuilder::placeFocusing(const std::vector<FocusingShape>& shared, const std::vector<Placement>& places,
                                    Assembly* into) {
    std::vector<FocusingShape>& all = placer_.focusingIn(into);
    const bool each = saturated(shared.size(), places.size()) <= kMostFocusing;
    for (const FocusingShape& shape : shared) {
        Bounds3 box;
        for (const Placement& p : places) {
            if (each) box = Bounds3();
            box.add(p.toOuter(shape.box));
            if (each) all.push_back({box, shape.name});
        }
        if (!each) all.push_back({box, shape.name});
    }
}

// An instance with keys of its own.
void InstanceBuilder::placeMoving(const Definition& d, const ObjectGeometry& geometry, const Place& place) {
    if (!motion_.check(place.motion, d.span)) return;
    ++instanceCount_;
    (place.object ? place.object->shown : context_.built.facts.instances) += geometry.shown;
    placer_.noteBounds(d, Placement(motion_.atOpening(place.motion)).toOuter(geometry.bounds), place);
    if (geometry.hasUnshared) {
        if (place.object)
            place.object->nested.push_back({&geometry, {Placement(Transform())}, place.motion, place.visible});
        else
            placeUnshared(geometry, place.motion, d.span, place.visible);
    }
    if (geometry.embreeObject)
        placer_.addMoving(*geometry.embreeObject, geometry.levels, geometry.bounds, geometry.focusing, place.motion,
                          place.base, d.targetSpan, place.visible);
}

// Emitters are made anew for every instance, because each is a light of its own; so are planes, which have no end to
// transform.
void InstanceBuilder::placeUnshared(const ObjectGeometry& geometry, const Motion& toRender, Span where,
                                    Visibility visible) {
    unsharedCount_ += geometry.unshared.size();
    if (unsharedCount_ > kMaxUnshared) {
        if (unsharedCount_ - geometry.unshared.size() <= kMaxUnshared)
            context_.diagnostics.error("E0607", where, "instances make more than a million copies of lights and planes",
                                       "each of them is one of its own");
        return;
    }
    for (const auto& part : geometry.unshared) {
        Place place;
        place.motion = part.motion.then(toRender);
        place.visible = part.visible & visible;
        if (part.definition->kind == Kind::light)
            placer_.placeLight(*part.definition, place);
        else
            placer_.placeShape(*part.definition, place);
    }
    for (const NestedObject& nested : geometry.nested)
        for (const Placement& place : nested.placements)
            placeUnshared(*nested.object, Motion(place.map()).then(nested.carried).then(toRender), where,
                          nested.visible & visible);
}

// The object of an instance. One inside the object that is being built stays an object of its own: a level that rays
// enter, not a copy. Null after an error; an unknown name has been reported by resolve().
const ObjectGeometry* InstanceBuilder::instanced(const Definition& d, const Place& place) {
    const Definition* object = context_.tree.find(Kind::object, d.target);
    if (!object) return nullptr;
    const auto known = objects_.find(object);
    if (known != objects_.end() && known->second.busy) {
        std::string chain;
        for (const Definition* c : chain_) chain += fmt::format("`{}` → ", c->name);
        context_.diagnostics.error("E0602", d.targetSpan, fmt::format("object `{}` contains itself", object->name),
                                   fmt::format("{}`{}`", chain, object->name));
        return nullptr;
    }
    if (known == objects_.end() && place.object && chain_.size() > kMaxInstanceLevels) {
        placer_.tooDeep(d.targetSpan);
        return nullptr;
    }
    return &this->object(*object);
}

ObjectGeometry& InstanceBuilder::object(const Definition& definition) {
    const auto [found, isNew] = objects_.try_emplace(&definition);
    ObjectGeometry& geometry = found->second;
    if (!isNew) return geometry;
    ++context_.built.facts.objects;
    geometry.name = definition.name;
    geometry.busy = true;
    chain_.push_back(&definition);
    Assembly parts;
    const Placing own = placer_.ownPlacing(definition);
    placer_.carry(own.transform, {Motion(), &parts, &parts, &geometry, own.visible}, definition.span,
                  [&](const Place& place) { placer_.placeAll(definition.children, place); });
    chain_.pop_back();
    geometry.busy = false;

    geometry.bounds = parts.bounds;
    geometry.focusing = std::move(parts.focusing);
    geometry.levels = parts.levels;
    geometry.shown += geometry.hasShapes;
    geometry.hasUnshared = !geometry.unshared.empty() || !geometry.nested.empty();
    if (!parts.shapes.empty() || !parts.placed.empty() || !parts.moving.empty())
        geometry.embreeObject = placer_.addAssembly(std::move(parts));
    return geometry;
}

} // namespace abbe
