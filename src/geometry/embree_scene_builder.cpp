#include "geometry/embree_scene_builder.h"

#include "base/check.h"
#include "geometry/embree_scene.h"
#include "render/material.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <unordered_map>

namespace abbe {

struct EmbreeSceneBuilder::Impl {
    using Shapes = std::vector<std::pair<const Shape*, Binding>>;
    using Inside = EmbreeStructure::Placed;
    using Owners = std::unordered_map<const Shape*, std::shared_ptr<const Shape>>;
    Shapes shapes;
    std::vector<Shapes> objects;
    std::map<Inside, std::vector<Placement>> placements;
    std::map<Inside, std::vector<Motion>> moving;
    Interval shutter;
    bool nested = false;

    // What is known of an object's scene once it is built.
    struct BuiltObject {
        std::shared_ptr<const ShapeTree> tree;
        std::size_t firstRecord = 0;
        Bounds3 bounds;
        int levels = 0; // of objects inside of it
    };
    std::vector<BuiltObject> built;
    std::uint64_t instanceCount = 0;
    Owners owners;

    bool isLeaf(std::uint32_t object) const { return !holds(placements, object) && !holds(moving, object); }
    template <typename Lists> static bool holds(const Lists& lists, std::uint32_t holder) {
        const auto first = lists.lower_bound({holder, 0, 0});
        return first != lists.end() && first->first.holder == holder;
    }
    ShapeUse useOf(const std::pair<const Shape*, Binding>&) const;
    std::vector<ShapeUse> usesOf(const Shapes&) const;
    std::shared_ptr<ShapeTree> plant(const std::shared_ptr<const EmbreeDevice>&, const Shapes&) const;
    using Trees = std::vector<std::shared_ptr<const ShapeTree>>;
    std::shared_ptr<const ShapeTree> leafOf(const Trees& last, std::size_t object) const;
    void fill(EmbreeStructure&, KeptGeometry&, const Trees& last);
    void addTables(EmbreeStructure&, std::uint32_t inside, RTCScene, BuiltObject&);
    void addTable(EmbreeStructure&, const Inside&, RTCScene, BuiltObject&, std::unique_ptr<const InstanceTable>);
    bool isSame(const EmbreeStructure&) const;
    template <typename Lists, typename Same>
    static bool areSame(const EmbreeStructure&, const Lists&, std::uint32_t holder, std::size_t& table, Same);
    void bind(EmbreeScene&) const;
    static void bind(EmbreeScene&, const ShapeTree&, const Shapes&);
};

namespace {

std::unique_ptr<const FewShapes>
fewShapes(const std::vector<std::pair<const Shape*, EmbreeSceneBuilder::Binding>>& shapes) {
    FewShapesSink sink;
    for (const auto& [shape, binding] : shapes)
        if (!sink.add(*shape, binding.visible)) return nullptr;
    return sink.make();
}

} // namespace

ShapeUse EmbreeSceneBuilder::Impl::useOf(const std::pair<const Shape*, Binding>& shape) const {
    const Binding& binding = shape.second;
    return {&shape.first->primitives(), binding.visible, nested && binding.material && binding.material->ior()};
}

std::vector<ShapeUse> EmbreeSceneBuilder::Impl::usesOf(const Shapes& all) const {
    std::vector<ShapeUse> uses;
    uses.reserve(all.size());
    for (const auto& shape : all) uses.push_back(useOf(shape));
    return uses;
}

// Not committed, since more may be placed in it.
std::shared_ptr<ShapeTree> EmbreeSceneBuilder::Impl::plant(const std::shared_ptr<const EmbreeDevice>& device,
                                                           const Shapes& all) const {
    auto tree = std::make_shared<ShapeTree>();
    tree->device = device;
    tree->scene.reset(rtcNewScene(device->get()));
    rtcSetSceneFlags(tree->scene.get(), RTC_SCENE_FLAG_ROBUST);
    rtcSetSceneBuildQuality(tree->scene.get(), RTC_BUILD_QUALITY_HIGH);
    tree->uses = usesOf(all);
    EmbreeSink sink(device->get(), tree->scene.get(), tree->slots);
    for (const ShapeUse& use : tree->uses) {
        tree->firstSlots.push_back(tree->slots.size());
        sink.add(use);
    }
    tree->firstSlots.push_back(tree->slots.size());
    for (const auto& [shape, binding] : all)
        if (const auto owner = owners.find(shape); owner != owners.end()) tree->owners.push_back(owner->second);
    return tree;
}

// One of the last building over the same shapes, or null.
std::shared_ptr<const ShapeTree> EmbreeSceneBuilder::Impl::leafOf(const Trees& last, std::size_t object) const {
    const Shapes& all = objects[object];
    if (all.empty()) return nullptr;
    const ShapeUse first = useOf(all.front());
    const auto matches = [&](const auto& tree) {
        return tree->leaf && tree->uses.size() == all.size() && tree->uses.front() == first &&
               tree->uses == usesOf(all);
    };
    if (object < last.size() && matches(last[object])) return last[object];
    const auto found = std::ranges::find_if(last, matches);
    return found == last.end() ? nullptr : *found;
}

// Adds what is placed inside, with geometry ids behind those of shapes, which no record needs: hits name what they hit
// in the innermost object.
void EmbreeSceneBuilder::Impl::addTables(EmbreeStructure& target, std::uint32_t inside, RTCScene scene,
                                         BuiltObject& object) {
    for (auto list = placements.lower_bound({inside, 0, 0}); list != placements.end() && list->first.holder == inside;
         ++list) {
        const BuiltObject& placed = built[list->first.object];
        addTable(target, list->first, scene, object,
                 std::make_unique<const InstanceTable>(placed.tree->scene.get(), std::move(list->second),
                                                       placed.firstRecord, instanceCount));
    }
    for (auto list = moving.lower_bound({inside, 0, 0}); list != moving.end() && list->first.holder == inside; ++list) {
        const BuiltObject& placed = built[list->first.object];
        addTable(target, list->first, scene, object,
                 std::make_unique<const InstanceTable>(placed.tree->scene.get(), std::move(list->second), shutter,
                                                       placed.firstRecord, instanceCount));
    }
    ABBE_CHECK(object.levels <= kMaxInstanceLevels);
}

void EmbreeSceneBuilder::Impl::addTable(EmbreeStructure& target, const Inside& where, RTCScene scene,
                                        BuiltObject& inside, std::unique_ptr<const InstanceTable> table) {
    const BuiltObject& placed = built[where.object];
    const std::size_t before = target.placed.size();
    std::size_t id = inside.tree->slots.size(); // behind those of shapes and the tables before
    for (std::size_t i = before; i > 0 && target.placed[i - 1].holder == where.holder; --i) ++id;
    table->attach(inside.tree->device->get(), scene, id, Visibility::fromBits(where.visible));
    inside.bounds.add(table->bounds(placed.bounds));
    inside.levels = std::max(inside.levels, placed.levels + 1);
    if (where.holder == kScene) instanceCount += table->size();
    target.placed.push_back(where);
    target.tables.push_back(std::move(table));
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

void EmbreeSceneBuilder::Impl::fill(EmbreeStructure& s, KeptGeometry& kept, const Trees& last) {
    const auto device = last.empty() ? std::make_shared<const EmbreeDevice>() : last.back()->device;
    const auto boundsOf = [](const Shapes& all) {
        Bounds3 box;
        for (const auto& [shape, binding] : all)
            if (std::isfinite(shape->area())) box.add(shape->bounds());
        return box;
    };
    const auto scene = plant(device, shapes); // first: its records stand at its geometry ids
    BuiltObject top{scene, 0, boundsOf(shapes), 0};
    s.top = scene;
    std::size_t records = scene->slots.size();
    for (std::uint32_t i = 0; i < objects.size(); ++i) {
        BuiltObject object{isLeaf(i) ? leafOf(last, i) : nullptr, records, boundsOf(objects[i]), 0};
        if (object.tree) {
            ++kept.kept;
        } else {
            const auto tree = plant(device, objects[i]);
            tree->leaf = isLeaf(i);
            object.tree = tree;
            addTables(s, i, tree->scene.get(), object);
            rtcCommitScene(tree->scene.get());
            ++kept.built;
        }
        records += object.tree->slots.size();
        s.objects.push_back(object.tree);
        built.push_back(std::move(object));
    }
    addTables(s, kScene, scene->scene.get(), top);
    s.bounds = top.bounds;
    if (s.tables.empty()) s.few = fewShapes(shapes);
    const auto moves = [](const auto& tree) {
        return std::ranges::any_of(tree->slots, [](const GeometrySlot& slot) { return slot.steps > 1; });
    };
    s.moving = moves(s.top) || std::ranges::any_of(s.objects, moves) ||
               std::ranges::any_of(s.tables, [](const auto& table) { return table->moves(); });
    rtcCommitScene(scene->scene.get());
    ++kept.built;
    device->throwIfFailed();
}

template <typename Lists, typename Same>
bool EmbreeSceneBuilder::Impl::areSame(const EmbreeStructure& s, const Lists& lists, std::uint32_t holder,
                                       std::size_t& table, Same same) {
    for (auto list = lists.lower_bound({holder, 0, 0}); list != lists.end() && list->first.holder == holder; ++list) {
        if (table == s.tables.size() || s.placed[table] != list->first || !same(*s.tables[table], list->second))
            return false;
        ++table;
    }
    return true;
}

// Whether the structure is what fill() would make.
bool EmbreeSceneBuilder::Impl::isSame(const EmbreeStructure& s) const {
    if (s.objects.size() != objects.size() || s.top->uses != usesOf(shapes)) return false;
    for (std::size_t i = 0; i < objects.size(); ++i)
        if (s.objects[i]->uses != usesOf(objects[i])) return false;
    const auto still = [](const InstanceTable& table, const auto& places) { return table.placesAs(places); };
    const auto moved = [&](const InstanceTable& table, const auto& motions) {
        return table.placesAs(motions, shutter);
    };
    std::size_t table = 0;
    for (std::uint32_t i = 0; i <= objects.size(); ++i) {
        const std::uint32_t holder = i < objects.size() ? i : kScene;
        if (!areSame(s, placements, holder, table, still) || !areSame(s, moving, holder, table, moved)) return false;
    }
    return table == s.tables.size();
}

// The records of a tree's geometries: what they are made of here.
void EmbreeSceneBuilder::Impl::bind(EmbreeScene& target, const ShapeTree& tree, const Shapes& all) {
    for (std::size_t i = 0; i < all.size(); ++i) {
        const auto& [shape, binding] = all[i];
        std::uint32_t space = GeometryRecord::kUntextured;
        if (binding.parametrized || shape->usesTextures() || (binding.material && binding.material->usesTextures())) {
            space = static_cast<std::uint32_t>(target.ownSpaces.size());
            target.ownSpaces.emplace_back(binding.toOwn.value_or(Transform{}));
        }
        for (std::size_t slot = tree.firstSlots[i]; slot < tree.firstSlots[i + 1]; ++slot) {
            const GeometrySlot& g = tree.slots[slot];
            target.records.push_back({shape, binding.material, binding.light, space, g.part, g.kind, g.steps});
        }
    }
}

void EmbreeSceneBuilder::Impl::bind(EmbreeScene& target) const {
    bind(target, *target.structure->top, shapes);
    for (std::size_t i = 0; i < objects.size(); ++i) bind(target, *target.structure->objects[i], objects[i]);
}

std::unique_ptr<Intersector> EmbreeSceneBuilder::build() {
    KeptGeometry none;
    return build(none, {});
}

std::unique_ptr<Intersector> EmbreeSceneBuilder::build(KeptGeometry& kept,
                                                       std::span<const std::shared_ptr<const Shape>> owners) {
    kept.built = kept.kept = 0;
    std::shared_ptr<const EmbreeStructure> structure = kept.last;
    if (structure && impl_->isSame(*structure)) {
        kept.kept = 1 + structure->objects.size();
    } else {
        for (const auto& owner : owners) impl_->owners.emplace(owner.get(), owner);
        Impl::Trees last; // of objects, and behind them any, for its device
        if (structure) {
            last = structure->objects;
            const auto none = std::make_shared<ShapeTree>();
            none->device = structure->top->device;
            last.push_back(none);
            // Before another one takes its memory, if nothing renders with it any more.
            structure.reset();
            kept.last.reset();
        }
        auto made = std::make_unique<EmbreeStructure>();
        try {
            impl_->fill(*made, kept, last);
        } catch (...) {
            // Embree 3 ends the process when it releases a scene whose threads did not get their memory: that one
            // stays. Its device has reported the fault for good.
            (void)made.release();
            throw;
        }
        structure = std::move(made);
    }
    auto result = std::make_unique<EmbreeScene>(structure);
    impl_->bind(*result);
    kept.last = std::move(structure);
    return result;
}

} // namespace abbe
