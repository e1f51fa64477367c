#include "geometry/disk.h"
#include "geometry/instance_table.h"
#include "scene/scene_builder.h"
#include "schema/suggest.h"

#include <fmt/format.h>

namespace abbe {

using schema::Kind;

namespace {

// More than any machine holds: nested objects multiply quickly.
constexpr std::size_t kMaxInstances = 100'000'000;
constexpr std::size_t kMaxUnshared = 1'000'000;

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

std::size_t saturated(std::size_t a, std::size_t b) {
    std::size_t product = 0;
    return __builtin_mul_overflow(a, b, &product) ? ~std::size_t{0} : product;
}

} // namespace

// The named shape where it stands, in the space of the definitions around it.
bool SceneBuilder::scatterSurface(const schema::Text& over, const std::vector<Definition>& siblings,
                                  ScatterSurface& surface) {
    std::vector<std::string_view> names;
    for (const Definition& d : siblings) {
        if (d.kind != Kind::shape) continue;
        if (!d.name.empty()) names.push_back(d.name);
        if (d.name != over.value) continue;
        LoadedShape& loaded = loadedShape(d);
        if (!loaded.sound) return false;
        const auto shape = placeInObject(loaded, loaded.common.transform);
        if (!shape) return false;
        TriangleSink sink(surface);
        shape->commit(sink);
        if (const auto* disk = dynamic_cast<const Disk*>(shape.get()))
            surface.disk = {disk->centre(), disk->normal(), disk->radius()};
        if (surface.disk || !surface.triangles.empty()) return true;
        diagnostics_.error("E0632", over.span, fmt::format("nothing can be scattered over `{}`", over.value),
                           "neither a round disk nor made of polygons");
        return false;
    }
    const auto meant = schema::nearest(over.value, names);
    auto& error = diagnostics_.error("E0632", over.span, fmt::format("no shape here is named `{}`", over.value),
                                     meant.empty() ? "unknown name" : schema::didYouMean(meant));
    if (tree_.find(Kind::shape, over.value))
        error.help = "it must stand in the same group or object as the instances, or with them at the top level";
    return false;
}

// Where an `instance` or `instances` puts its object; nothing after an error.
std::vector<Placement> SceneBuilder::placements(const Definition& d, const std::vector<Definition>& siblings,
                                                const Transform& toParent) {
    std::vector<Placement> result;
    const auto add = [&](const Transform& map) {
        if (const auto fault = Placement::findFault(map)) {
            const std::string which = d.kind == Kind::instance ? "this place" : fmt::format("place {}", result.size());
            diagnostics_.error("E0631", d.span, fmt::format("{} cannot be used: {}", which, *fault), "from here");
        } else if (++instanceCount_ > kMaxInstances) {
            diagnostics_.error("E0607", d.span, "more than 100 million instances", "here they end");
        } else {
            result.emplace_back(map);
            return true;
        }
        result.clear();
        return false;
    };
    if (instanceCount_ > kMaxInstances) return result; // has been reported
    if (d.kind == Kind::instance) {
        add(ownTransform(d).then(toParent));
        return result;
    }
    const auto params = bound<InstancesParams>(d);
    if (!params) return result;
    ScatterSurface surface;
    PlaceContext context{tree_.header.zUp ? Vec3d{0, 0, 1} : Vec3d{0, 1, 0}, tree_.header.length, nullptr, d.span};
    if (!params->over.value.empty()) {
        if (!scatterSurface(params->over, siblings, surface)) return result;
        context.surface = &surface;
    }
    if (!params->points.value.empty()) built_->facts.files.push_back(params->points.value);
    const Transform outwards = params->transform.then(toParent);
    if (params->count) result.reserve(static_cast<std::size_t>(*params->count));
    visitPlaces(*params, context, diagnostics_,
                [&](std::uint64_t, const Transform& place) { return add(place.then(outwards)); });
    return result;
}

void SceneBuilder::placeInstances(const Definition& d, const std::vector<Definition>& siblings,
                                  const Transform& toRender) {
    const Definition* object = tree_.find(Kind::object, d.target);
    const std::size_t before = diagnostics_.errorCount();
    if (const auto keys = ownKeys(d)) {
        if (diagnostics_.errorCount() == before) placeMoving(d, Motion().then(*keys).then(toRender));
        return;
    }
    std::vector<Placement> places = placements(d, siblings, toRender);
    if (!object || places.empty()) return; // an unknown name has been reported by resolve()
    const ObjectGeometry& geometry = objectGeometry(*object);
    built_->facts.instances += saturated(places.size(), geometry.shown);
    for (const Placement& place : places) {
        if (geometry.hasUnshared) placeUnshared(geometry, place.map(), d.span);
        if (geometry.bounds.empty()) continue;
        const Bounds3 b = place.toOuter(geometry.bounds);
        bounds_.add(Bounds3d{Vec3d(b.lower), Vec3d(b.upper)});
    }
    if (geometry.embreeObject) embree_.addInstances(*geometry.embreeObject, std::move(places));
}

void SceneBuilder::placeMoving(const Definition& d, const Motion& toRender) {
    const Definition* object = tree_.find(Kind::object, d.target);
    if (!object) return;
    const ObjectGeometry& geometry = objectGeometry(*object);
    if (geometry.hasUnshared) {
        diagnostics_.error("E0634", d.span, fmt::format("`{}` cannot move: a lamp or a plane is part of it", d.target),
                           "this instance has keys");
        return;
    }
    if (!geometry.embreeObject) return;
    constexpr int samples = 64; // of the way, for faults and the scene's bounds
    for (int i = 0; i <= samples; ++i) {
        const Transform map = toRender.at(built_->shutter * i / samples);
        if (const auto fault = Placement::findFault(map)) {
            diagnostics_.error("E0631", d.span, fmt::format("this place cannot be used: {}", *fault),
                               fmt::format("{:.6g} s after the shutter opens", built_->shutter * i / samples));
            return;
        }
        const Bounds3 b = Placement(map).toOuter(geometry.bounds);
        if (!geometry.bounds.empty()) bounds_.add(Bounds3d{Vec3d(b.lower), Vec3d(b.upper)});
    }
    ++instanceCount_;
    built_->facts.instances += geometry.shown;
    embree_.addMoving(*geometry.embreeObject, toRender);
}

// Emitters are made anew for every instance, because each is a light of its own; so are planes, which have no end to
// transform.
void SceneBuilder::placeUnshared(const ObjectGeometry& geometry, const Transform& toRender, Span asker) {
    unsharedCount_ += geometry.unshared.size();
    if (unsharedCount_ > kMaxUnshared) {
        if (unsharedCount_ - geometry.unshared.size() <= kMaxUnshared)
            diagnostics_.error("E0607", asker, "instances make more than a million copies of lights and planes",
                               "each of them is one of its own");
        return;
    }
    for (std::size_t i = 0; i < geometry.unshared.size(); ++i) {
        const Transform place = geometry.unsharedPlace[i].then(toRender);
        if (geometry.unshared[i]->kind == Kind::light)
            placeLight(*geometry.unshared[i], place);
        else
            placeShape(*geometry.unshared[i], place);
    }
    for (const NestedObject& nested : geometry.nested)
        for (const Placement& place : nested.placements)
            placeUnshared(*nested.object, place.map().then(toRender), asker);
}

// The parts of an object that its instances share are built once, in the object's own space.
void SceneBuilder::collect(const std::vector<Definition>& definitions, const Transform& toObject, ObjectGeometry& out,
                           SharedShapes& shared) {
    for (const Definition& d : definitions) {
        if (d.kind == Kind::group) {
            collect(d.children, ownTransform(d).then(toObject), out, shared);
        } else if (d.kind == Kind::instance || d.kind == Kind::instances) {
            collectNested(d, definitions, toObject, out);
        } else if (d.kind == Kind::light) {
            out.unshared.push_back(&d);
            out.unsharedPlace.push_back(toObject);
        } else if (d.kind == Kind::shape) {
            LoadedShape& loaded = loadedShape(d);
            if (!loaded.sound) continue;
            if (loaded.common.emission || loaded.infinite) {
                out.unshared.push_back(&d);
                out.unsharedPlace.push_back(toObject);
            } else if (auto shape = placeInObject(loaded, loaded.common.transform.then(toObject))) {
                countShape(loaded);
                shared.emplace_back(keepShape(std::move(shape)),
                                    EmbreeSceneBuilder::Binding{materialOf(loaded.common), nullptr});
            }
        }
    }
}

// An object inside the one that is being built stays an object of its own: a level that rays enter, not a copy.
void SceneBuilder::collectNested(const Definition& d, const std::vector<Definition>& siblings,
                                 const Transform& toObject, ObjectGeometry& out) {
    const Definition* object = tree_.find(Kind::object, d.target);
    if (!object) return;
    const auto known = objects_.find(object);
    if (known != objects_.end() && known->second.busy) {
        std::string chain;
        for (const Definition* c : chain_) chain += fmt::format("`{}` → ", c->name);
        diagnostics_.error("E0602", d.targetSpan, fmt::format("object `{}` contains itself", object->name),
                           fmt::format("{}`{}`", chain, object->name));
        return;
    }
    const auto tooDeep = [&] {
        diagnostics_.error("E0633", d.targetSpan,
                           fmt::format("objects nest more than {} levels deep", kMaxInstanceLevels),
                           fmt::format("`{}` is too deep", object->name));
    };
    if (known == objects_.end() && chain_.size() > kMaxInstanceLevels) return tooDeep();
    const ObjectGeometry& inner = objectGeometry(*object);
    if (inner.levels + 2 > kMaxInstanceLevels) return tooDeep();
    out.nested.push_back({&inner, placements(d, siblings, toObject)});
    out.levels = std::max(out.levels, inner.levels + 1);
}

SceneBuilder::ObjectGeometry& SceneBuilder::objectGeometry(const Definition& object) {
    const auto [found, isNew] = objects_.try_emplace(&object);
    ObjectGeometry& geometry = found->second;
    if (!isNew) return geometry;
    ++built_->facts.objects;
    geometry.busy = true;
    chain_.push_back(&object);
    SharedShapes shared;
    collect(object.children, ownTransform(object), geometry, shared);
    chain_.pop_back();
    geometry.busy = false;

    for (const auto& [shape, binding] : shared) geometry.bounds.add(shape->bounds());
    geometry.shown = shared.empty() ? 0 : 1;
    geometry.hasUnshared = !geometry.unshared.empty();
    bool visible = !shared.empty();
    for (const NestedObject& nested : geometry.nested) {
        geometry.hasUnshared |= nested.object->hasUnshared;
        visible |= nested.object->embreeObject.has_value() && !nested.placements.empty();
        geometry.shown += saturated(nested.placements.size(), nested.object->shown);
    }
    if (visible) geometry.embreeObject = embree_.addObject(std::move(shared));
    for (NestedObject& nested : geometry.nested) {
        if (!nested.object->embreeObject || nested.placements.empty()) continue;
        if (!nested.object->bounds.empty())
            for (const Placement& place : nested.placements) geometry.bounds.add(place.toOuter(nested.object->bounds));
        if (nested.object->hasUnshared) // its lights will ask where they are
            embree_.addInstances(*nested.object->embreeObject, nested.placements, *geometry.embreeObject);
        else
            embree_.addInstances(*nested.object->embreeObject, std::move(nested.placements), *geometry.embreeObject);
    }
    std::erase_if(geometry.nested, [](const NestedObject& nested) { return !nested.object->hasUnshared; });
    return geometry;
}

} // namespace abbe
