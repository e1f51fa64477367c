#include "geometry/embree_scene_builder.h"

#include "base/check.h"
#include "geometry/embree_scene.h"
#include "render/material.h"

#include <algorithm>
#include <cmath>
#include <map>

namespace abbe {

struct EmbreeSceneBuilder::Impl {
    using Shapes = std::vector<std::pair<const Shape*, Binding>>;
    // What holds placements, the object placed, and the rays that see them.
    struct Inside {
        std::uint32_t holder = 0, object = 0;
        std::uint32_t visible = 0;
        auto operator<=>(const Inside&) const = default;
    };
    Shapes shapes;
    std::vector<Shapes> objects;
    std::map<Inside, std::vector<Placement>> placements;
    std::map<Inside, std::vector<Motion>> moving;
    Interval shutter;
    bool nested = false;

    // What is known of an object's scene once it is built.
    struct BuiltObject {
        RTCScene scene = nullptr;
        std::size_t firstRecord = 0;
        Bounds3 bounds;
        int levels = 0; // of objects inside of it
    };
    std::vector<BuiltObject> built;
    std::uint64_t instanceCount = 0;

    static EmbreeHandle<RTCScene, rtcReleaseScene> newScene(const EmbreeScene&);
    void fill(EmbreeScene&);
    void addShapes(EmbreeScene&, const Shapes&, BuiltObject&) const;
    void addTables(EmbreeScene&, std::uint32_t inside, std::size_t geometryId, BuiltObject&);
    void addMoving(EmbreeScene&, std::uint32_t inside, std::size_t geometryId, BuiltObject&);
    struct TablePlace {
        std::size_t geometryId;
        Visibility visible;
    };
    static const InstanceTable& addTable(EmbreeScene&, TablePlace, const BuiltObject& placed, BuiltObject& inside,
                                         std::unique_ptr<const InstanceTable>);
};

namespace {

std::unique_ptr<const FewTriangles>
fewTriangles(const std::vector<std::pair<const Shape*, EmbreeSceneBuilder::Binding>>& shapes) {
    FewTrianglesSink sink;
    for (const auto& [shape, binding] : shapes)
        if (!sink.add(*shape, binding.visible)) return nullptr;
    return sink.make();
}

} // namespace

EmbreeHandle<RTCScene, rtcReleaseScene> EmbreeSceneBuilder::Impl::newScene(const EmbreeScene& target) {
    EmbreeHandle<RTCScene, rtcReleaseScene> scene(rtcNewScene(target.device.get()));
    rtcSetSceneFlags(scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(scene.get(), RTC_BUILD_QUALITY_HIGH);
    return scene;
}

// Adds the shapes to the scene, their records to the target, and the bounds of the finite ones.
void EmbreeSceneBuilder::Impl::addShapes(EmbreeScene& target, const Shapes& added, BuiltObject& object) const {
    object.firstRecord = target.records.size();
    EmbreeSink sink(target.device.get(), object.scene, target.records, nested);
    for (const auto& [shape, binding] : added) {
        std::uint32_t space = GeometryRecord::kUntextured;
        if (binding.parametrized || shape->usesTextures() || (binding.material && binding.material->usesTextures())) {
            space = static_cast<std::uint32_t>(target.ownSpaces.size());
            target.ownSpaces.emplace_back(binding.toOwn.value_or(Transform{}));
        }
        sink.add(*shape, binding.material, binding.light, space, binding.visible);
        if (std::isfinite(shape->area())) object.bounds.add(shape->bounds());
    }
}

// Adds what is placed inside, with geometry ids from the given one on, which no record needs: hits name what they hit
// in the innermost object.
void EmbreeSceneBuilder::Impl::addTables(EmbreeScene& target, std::uint32_t inside, std::size_t geometryId,
                                         BuiltObject& object) {
    for (auto list = placements.lower_bound({inside, 0, 0}); list != placements.end() && list->first.holder == inside;
         ++list) {
        const BuiltObject& placed = built[list->first.object];
        const auto& table = addTable(target, {geometryId++, Visibility::fromBits(list->first.visible)}, placed, object,
                                     std::make_unique<const InstanceTable>(placed.scene, std::move(list->second),
                                                                           placed.firstRecord, instanceCount));
        if (inside == kScene) instanceCount += table.size();
    }
    addMoving(target, inside, geometryId, object);
    ABBE_CHECK(object.levels <= kMaxInstanceLevels);
}

void EmbreeSceneBuilder::Impl::addMoving(EmbreeScene& target, std::uint32_t inside, std::size_t geometryId,
                                         BuiltObject& object) {
    for (auto list = moving.lower_bound({inside, 0, 0}); list != moving.end() && list->first.holder == inside; ++list) {
        const BuiltObject& placed = built[list->first.object];
        const auto& table = addTable(target, {geometryId++, Visibility::fromBits(list->first.visible)}, placed, object,
                                     std::make_unique<const InstanceTable>(placed.scene, std::move(list->second),
                                                                           shutter, placed.firstRecord, instanceCount));
        if (inside == kScene) instanceCount += table.size();
    }
}

const InstanceTable& EmbreeSceneBuilder::Impl::addTable(EmbreeScene& target, TablePlace place,
                                                        const BuiltObject& placed, BuiltObject& inside,
                                                        std::unique_ptr<const InstanceTable> table) {
    table->attach(target.device.get(), inside.scene, place.geometryId, place.visible);
    inside.bounds.add(table->bounds(placed.bounds));
    inside.levels = std::max(inside.levels, placed.levels + 1);
    return *target.tables.emplace_back(std::move(table));
}

EmbreeSceneBuilder::EmbreeSceneBuilder() : impl_(std::make_unique<Impl>()) {}
EmbreeSceneBuilder::~EmbreeSceneBuilder() = default;

std::uint32_t EmbreeSceneBuilder::addShape(const Shape& shape, Binding binding) {
    impl_->shapes.emplace_back(&shape, binding);
    return static_cast<std::uint32_t>(impl_->shapes.size() - 1);
}

std::uint32_t EmbreeSceneBuilder::addObject(std::vector<std::pair<const Shape*, Binding>> shapes) {
    impl_->objects.push_back(std::move(shapes));
    return static_cast<std::uint32_t>(impl_->objects.size() - 1);
}

void EmbreeSceneBuilder::addInstance(std::uint32_t object, const Transform& map, std::uint32_t inside) {
    ABBE_CHECK(object < impl_->objects.size() &&
               (inside == kScene || (inside > object && inside < impl_->objects.size())));
    impl_->placements[{inside, object, kVisibleToAll.bits()}].emplace_back(map);
}

void EmbreeSceneBuilder::addInstances(std::uint32_t object, std::vector<Placement> placements, std::uint32_t inside,
                                      Visibility visible) {
    ABBE_CHECK(object < impl_->objects.size() &&
               (inside == kScene || (inside > object && inside < impl_->objects.size())));
    if (placements.empty()) return;
    auto& list = impl_->placements[{inside, object, visible.bits()}];
    if (list.empty())
        list = std::move(placements);
    else
        list.insert(list.end(), placements.begin(), placements.end());
}

void EmbreeSceneBuilder::setShutter(double open, double duration) { impl_->shutter = {open, duration}; }
Interval EmbreeSceneBuilder::shutter() const { return impl_->shutter; }
void EmbreeSceneBuilder::setNested(bool nested) { impl_->nested = nested; }

void EmbreeSceneBuilder::addMoving(std::uint32_t object, const Motion& motion, std::uint32_t inside,
                                   Visibility visible) {
    ABBE_CHECK(object < impl_->objects.size() &&
               (inside == kScene || (inside > object && inside < impl_->objects.size())));
    impl_->moving[{inside, object, visible.bits()}].push_back(motion);
}

void EmbreeSceneBuilder::Impl::fill(EmbreeScene& s) {
    s.scene = newScene(s);
    BuiltObject top;
    top.scene = s.scene.get();
    addShapes(s, shapes, top); // first: its records stand at its geometry ids
    const std::size_t firstTable = s.records.size();
    for (std::uint32_t i = 0; i < objects.size(); ++i) {
        BuiltObject object;
        object.scene = s.objectScenes.emplace_back(newScene(s)).get();
        addShapes(s, objects[i], object);
        addTables(s, i, s.records.size() - object.firstRecord, object);
        rtcCommitScene(object.scene);
        built.push_back(object);
    }
    addTables(s, kScene, firstTable, top);
    s.bounds_ = top.bounds;
    if (s.tables.empty()) s.few = fewTriangles(shapes);
    s.moving = std::ranges::any_of(s.records, [](const GeometryRecord& r) { return r.steps > 1; }) ||
               std::ranges::any_of(s.tables, [](const auto& table) { return table->moves(); });
    rtcCommitScene(s.scene.get());
    s.device.throwIfFailed();
}

std::unique_ptr<Intersector> EmbreeSceneBuilder::build() {
    auto result = std::make_unique<EmbreeScene>();
    try {
        impl_->fill(*result);
    } catch (...) {
        // Embree 3 ends the process when it releases a scene whose threads did not get their memory: that one stays.
        (void)result.release();
        throw;
    }
    return result;
}

} // namespace abbe
