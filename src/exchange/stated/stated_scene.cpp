#include "exchange/stated/stated_scene.h"

#include "schema/binding.h"
#include "spectrum/named_spectra.h"

#include <algorithm>
#include <iterator>
#include <utility>

namespace abbe::exchange {

using schema::BoundValue;
using schema::Definition;

namespace {

using ValueStore = std::function<void(void*, const BoundValue&)>;
using StoredValues = std::map<std::string, std::vector<BoundValue>, std::less<>>;

void storeByName(std::vector<schema::FieldInfo>& fields, const std::string& prefix) {
    for (schema::FieldInfo& field : fields) {
        const std::string name = prefix + std::string(field.name);
        field.store = [name](void* to, const BoundValue& value) {
            (*static_cast<StoredValues*>(to))[name].push_back(value);
        };
        if (field.append) // the values of all moments, one after the other, and their times
            field.append = [times = name + ".time"](void* to, double time, Span) {
                (*static_cast<StoredValues*>(to))[times].push_back(time);
                return to;
            };
        storeByName(field.block, name + ".");
    }
}

schema::TypeTable tableByName(const schema::TypeTable& types) {
    schema::TypeTable table;
    for (schema::TypeInfo type : types.all()) {
        storeByName(type.fields, {});
        table.add(std::move(type));
    }
    // Presets belong to the other table, which lives longer.
    table.setPresets(std::shared_ptr<const schema::PresetLibrary>(types.presets(), [](const auto*) {}));
    return table;
}

// References to textures are pointers to an incomplete type here: they stand for things and are never followed.
const Texture* handleOf(const StatedThing& thing) { return reinterpret_cast<const Texture*>(&thing); }
const StatedThing* thingOf(const Texture* handle) { return reinterpret_cast<const StatedThing*>(handle); }

// Times of the blocks `at` of a transform, in s.
std::vector<double> keyTimes(const schema::Node& transform, const schema::Header& header) {
    Diagnostics repeated;
    schema::FieldInfo moments;
    moments.name = "at";
    std::map<const schema::FieldInfo*, double> last;
    std::vector<double> times;
    for (const schema::Node child : transform.children())
        if (child.name() == "at")
            if (const auto time = schema::bindMoment(moments, child, last, header, repeated)) times.push_back(*time);
    return times;
}

std::vector<double> keyTimesOf(const Definition& definition, const schema::SceneTree& tree) {
    for (const schema::Node node : definition.properties)
        if (node.name() == "transform") return keyTimes(node, tree.headerOf(node.headSpan()));
    return {};
}

void noteGiven(const schema::Node& node, const std::string& prefix, std::map<std::string, Span, std::less<>>& given) {
    given.emplace(prefix + std::string(node.name()), node.headSpan());
}

} // namespace

const std::vector<BoundValue>* StatedThing::find(std::string_view property) const {
    used_.emplace(property);
    const auto found = values_.find(property);
    return found == values_.end() || found->second.empty() ? nullptr : &found->second;
}

bool StatedThing::has(std::string_view property) const {
    used_.emplace(property);
    return given_.contains(property);
}

std::optional<double> StatedThing::number(std::string_view property) const {
    const auto* const all = find(property);
    if (!all) return std::nullopt;
    const BoundValue& v = all->front();
    if (const auto* d = std::get_if<double>(&v)) return *d;
    if (const auto* i = std::get_if<std::int64_t>(&v)) return static_cast<double>(*i);
    if (const auto* q = std::get_if<schema::Quantity>(&v)) return q->value;
    if (const auto* t = std::get_if<schema::TexturedNumber>(&v); t && !t->texture) return t->value;
    if (const auto* l = std::get_if<schema::Location>(&v)) return l->distance;
    if (const auto* c = std::get_if<schema::Choice>(&v)) return c->number;
    return std::nullopt;
}

double StatedThing::number(std::string_view property, double otherwise) const {
    return number(property).value_or(otherwise);
}

const schema::Quantity* StatedThing::quantity(std::string_view property) const {
    return value<schema::Quantity>(property);
}

std::optional<Vec3d> StatedThing::vector(std::string_view property) const {
    const auto* const v = value<Vec3d>(property);
    return v ? std::optional(*v) : std::nullopt;
}

std::optional<Vec2d> StatedThing::pair(std::string_view property) const {
    const auto* const v = value<Vec2d>(property);
    return v ? std::optional(*v) : std::nullopt;
}

std::string StatedThing::word(std::string_view property) const {
    const auto* const all = find(property);
    if (!all) return {};
    const BoundValue& v = all->front();
    if (const auto* choice = std::get_if<schema::Choice>(&v)) return choice->word;
    if (const auto* text = std::get_if<schema::Text>(&v)) return text->value;
    if (const auto* flag = std::get_if<bool>(&v)) return *flag ? "on" : "off";
    if (const auto* place = std::get_if<schema::Location>(&v)) return place->shape;
    return {};
}

StatedNumber StatedThing::textured(std::string_view property, double otherwise) const {
    const auto* const t = value<schema::TexturedNumber>(property);
    if (t && t->texture) return {otherwise, thingOf(t->texture)};
    return {number(property, otherwise), nullptr};
}

StatedSpectrum StatedThing::spectrum(std::string_view property) const {
    const auto* const all = find(property);
    if (!all) return {};
    if (const auto* curve = std::get_if<const Curve*>(&all->front()))
        return {static_cast<const StatedCurve*>(*curve), nullptr};
    const auto* const t = std::get_if<schema::TexturedSpectrum>(&all->front());
    if (!t) return {};
    return {static_cast<const StatedCurve*>(t->curve), t->texture ? thingOf(t->texture) : nullptr};
}

std::vector<std::pair<double, StatedSpectrum>> StatedThing::stops(std::string_view property) const {
    std::vector<std::pair<double, StatedSpectrum>> list;
    if (const auto* const all = find(property))
        for (const BoundValue& v : *all)
            if (const auto* stop = std::get_if<schema::SpectrumStop>(&v)) {
                const schema::TexturedSpectrum& value = stop->value;
                list.push_back(
                    {stop->position,
                     {static_cast<const StatedCurve*>(value.curve), value.texture ? thingOf(value.texture) : nullptr}});
            }
    return list;
}

const StatedThing* StatedThing::reference(std::string_view property) const {
    const auto* const all = find(property);
    if (!all) return nullptr;
    for (const BoundValue& v : *all) {
        if (const auto* r = std::get_if<schema::Reference>(&v)) return scene_->thing(*r);
        if (const auto* w = std::get_if<schema::WeightedReference>(&v)) return scene_->thing(w->reference);
    }
    return nullptr;
}

bool StatedThing::usesCoordinates(bool alsoStretched, int depth) const {
    constexpr int kDeepest = 16;
    if (depth > kDeepest) return false;
    if (kind == schema::Kind::texture) return true;
    const auto inner = [&](schema::Reference r) {
        return r.valid() && scene_->thing(r)->usesCoordinates(alsoStretched, depth + 1);
    };
    for (const auto& [property, all] : values_)
        for (const BoundValue& v : all) {
            if (const auto* spectrum = std::get_if<schema::TexturedSpectrum>(&v); spectrum && spectrum->texture)
                return true;
            const auto* const number = std::get_if<schema::TexturedNumber>(&v);
            const bool stretched = alsoStretched && property.ends_with("anisotropy");
            if (number && (number->texture || (stretched && number->value != 0))) return true;
            if (const auto* to = std::get_if<schema::Reference>(&v); to && inner(*to)) return true;
            if (const auto* to = std::get_if<schema::WeightedReference>(&v); to && inner(to->reference)) return true;
        }
    return false;
}

bool StatedThing::usesPosition(int depth) const {
    constexpr int kDeepest = 16;
    if (depth > kDeepest) return false;
    const auto inner = [&](const StatedThing* to) { return to && to->usesPosition(depth + 1); };
    if (kind == schema::Kind::texture && (type == "noise" || type == "triplanar")) return true;
    for (const auto& [property, all] : values_)
        for (const BoundValue& v : all) {
            const auto* const choice = std::get_if<schema::Choice>(&v);
            if (property == "over" && choice && (choice->word == "x" || choice->word == "y" || choice->word == "z"))
                return true;
            const auto* const q = std::get_if<schema::Quantity>(&v);
            if (type == "checker" && q && q->dimension == schema::Dimension::length) return true;
            const auto* const spectrum = std::get_if<schema::TexturedSpectrum>(&v);
            if (spectrum && spectrum->texture && inner(thingOf(spectrum->texture))) return true;
            const auto* const number = std::get_if<schema::TexturedNumber>(&v);
            if (number && number->texture && inner(thingOf(number->texture))) return true;
            const auto* const stop = std::get_if<schema::SpectrumStop>(&v);
            if (stop && stop->value.texture && inner(thingOf(stop->value.texture))) return true;
            if (const auto* to = std::get_if<schema::Reference>(&v); to && inner(scene_->thing(*to))) return true;
            const auto* const weighted = std::get_if<schema::WeightedReference>(&v);
            if (weighted && inner(scene_->thing(weighted->reference))) return true;
        }
    return false;
}

std::vector<StatedThing::Unused> StatedThing::takeUnused() const {
    std::vector<Unused> list;
    for (const auto& [property, where] : given_)
        if (used_.insert(property).second) list.push_back({property, where});
    return list;
}

StatedScene::StatedScene(const schema::SceneTree& tree, const schema::TypeTable& types, MakeCurve makeCurve,
                         FindPlaces findPlaces)
    : tree_(tree), table_(tableByName(types)), makeCurve_(std::move(makeCurve)), findPlaces_(std::move(findPlaces)),
      zUp_(tree.header.zUp) {
    schema::SpectrumValue d65;
    d65.form = schema::SpectrumValue::Form::illuminant;
    d65.text = "D65";
    daylight_ = static_cast<const StatedCurve*>(curve(d65, schema::SpectrumRole::shape, repeated_));
    for (const Definition& d : tree.definitions) {
        if (d.kind == schema::Kind::camera) cameras_.push_back(&bound(d));
        if (d.kind == schema::Kind::film) film_ = &bound(d);
        if (d.kind == schema::Kind::render) render_ = &bound(d);
        if (d.kind == schema::Kind::atmosphere)
            if (const Definition* medium = tree.find(schema::Kind::medium, d.target)) atmosphere_ = &named(*medium);
    }
    if (!cameras_.empty()) time_ = cameras_[0]->number("time", 0);
    collect(tree.definitions, {}, {}, placed_);
}

StatedScene::~StatedScene() = default;

const std::vector<Placed>& StatedScene::object(const std::string& name) const {
    static const std::vector<Placed> kNone;
    const auto found = objects_.find(name);
    return found == objects_.end() ? kNone : found->second;
}

const StatedThing& StatedScene::bound(const Definition& definition) {
    StatedThing& thing = things_.emplace_back();
    thing.kind = definition.kind;
    thing.name = definition.name;
    thing.type = definition.type ? definition.type->name : std::string_view();
    thing.target = definition.target;
    thing.span = definition.span;
    thing.scene_ = this;
    thing.index_ = static_cast<std::uint32_t>(things_.size() - 1);
    for (const schema::Node node : definition.properties) {
        noteGiven(node, {}, thing.given_);
        for (const schema::Node child : node.children())
            if (const auto* field = definition.type ? definition.type->find(node.name()) : nullptr;
                field && !field->block.empty())
                noteGiven(child, std::string(node.name()) + ".", thing.given_);
    }
    for (const schema::Key& key : definition.keys) thing.given_.emplace(key.name, key.nameSpan);
    if (!definition.type) return thing;
    if (!definition.arguments.empty())
        for (const schema::FieldInfo& field : definition.type->fields)
            if (field.argument == 0) thing.given_.emplace(field.name, definition.span);
    Definition own = definition; // with the type whose fields store by name
    own.type = table_.find(definition.kind, definition.type->name);
    StoredValues values;
    schema::bind(own, tree_, table_, *this, &values, repeated_);
    thing.values_ = std::move(values);
    for (const double time : keyTimesOf(definition, tree_))
        thing.values_[std::string(StatedThing::kTransformTimes)].push_back(time);
    return thing;
}

const StatedThing& StatedScene::named(const Definition& definition) {
    if (definition.name.empty()) return bound(definition);
    const StatedThing*& thing = named_[{definition.kind, definition.name}];
    if (!thing) thing = &bound(definition);
    return *named_[{definition.kind, definition.name}];
}

KeyedTransform StatedScene::transformOf(const Definition& definition) const {
    Diagnostics repeated;
    for (const schema::Node node : definition.properties)
        if (node.name() == "transform") return schema::bindMotion(node, tree_.headerOf(node.headSpan()), repeated);
    return {};
}

// The places of a grid, each as an instance; false for other places, which need the built scene.
bool StatedScene::placeGrid(const Placed& all, std::vector<Placed>& out) {
    constexpr double kMost = 100000;
    const auto grid = all.thing->vector("grid");
    if (!grid || !(grid->x * grid->y * grid->z <= kMost)) return false;
    const Vec3d spacing = all.thing->vector("spacing").value_or(Vec3d(1, 1, 1)),
                middle = (*grid - Vec3d(1, 1, 1)) * 0.5;
    for (double z = 0; z < grid->z; ++z)
        for (double y = 0; y < grid->y; ++y)
            for (double x = 0; x < grid->x; ++x) {
                const Vec3d at = Vec3d(x, y, z) - middle;
                Placed one = all;
                one.object = all.thing->target;
                one.thing = nullptr;
                const auto step = Transform::translate({at.x * spacing.x, at.y * spacing.y, at.z * spacing.z});
                one.toWorld = step.then(all.toWorld);
                one.motion = Motion(step).then(all.motion);
                out.push_back(std::move(one));
            }
    return true;
}

void StatedScene::place(const Definition& d, const Placed& outer, const std::vector<std::string>& visible,
                        std::vector<Placed>& out) {
    Placed placed{nullptr, {}, {}, false, {}, {}, visible, d.span, nullptr};
    const KeyedTransform own = transformOf(d);
    placed.toWorld = own.at(time_).then(outer.toWorld);
    placed.motion = Motion().then(own).then(outer.motion);
    placed.moves = placed.motion.moves();
    const std::vector<double> times = keyTimesOf(d, tree_);
    std::ranges::set_union(times, outer.times, std::back_inserter(placed.times));
    for (const schema::Node node : d.properties) {
        if (node.name() != "visible-to") continue;
        placed.visibleTo.clear();
        for (std::size_t i = 0; i < node.valueCount(); ++i) placed.visibleTo.emplace_back(node.value(i).text);
    }
    if (d.kind == schema::Kind::group) return collect(d.children, placed, placed.visibleTo, out);
    if (d.kind == schema::Kind::instance)
        placed.object = d.target;
    else
        placed.thing = &bound(d);
    if (d.kind == schema::Kind::instances) {
        if (!findPlaces_ && placeGrid(placed, out)) return;
        placed.definition = &d;
    }
    if (placed.thing) {
        placed.thing->find("transform");
        placed.thing->find("visible-to");
    }
    out.push_back(std::move(placed));
}

void StatedScene::collect(const std::vector<Definition>& definitions, const Placed& outer,
                          const std::vector<std::string>& visible, std::vector<Placed>& out) {
    for (const Definition& d : definitions) {
        if (d.kind == schema::Kind::object) {
            const KeyedTransform own = transformOf(d);
            Placed around;
            around.toWorld = own.at(time_);
            around.motion = Motion().then(own);
            around.times = keyTimesOf(d, tree_);
            std::vector<Placed> inside;
            collect(d.children, around, {}, inside);
            objects_[d.name] = std::move(inside);
        } else if (d.kind == schema::Kind::shape || d.kind == schema::Kind::light || d.kind == schema::Kind::volume ||
                   d.kind == schema::Kind::group || d.kind == schema::Kind::instance ||
                   d.kind == schema::Kind::instances)
            place(d, outer, visible, out);
    }
}

const Curve* StatedScene::curve(const schema::SpectrumValue& value, schema::SpectrumRole role, Diagnostics& found) {
    const Curve* const made = makeCurve_(value, role, found);
    return made ? &curves_.emplace_back(value, role, *made) : nullptr;
}

schema::ComplexIndex StatedScene::metal(std::string_view name, Span span, Diagnostics&) {
    const auto found = findMetal(name);
    if (!found) return {};
    const Curve& n = *metals_.emplace_back(indexCurve(*found));
    const Curve& k = *metals_.emplace_back(extinctionCurve(*found));
    schema::SpectrumValue value;
    value.form = schema::SpectrumValue::Form::metal;
    value.text = found->name;
    value.span = span;
    return {&curves_.emplace_back(value, schema::SpectrumRole::index, n),
            &curves_.emplace_back(value, schema::SpectrumRole::unbounded, k)};
}

schema::Reference StatedScene::reference(const Definition& definition, Diagnostics&) {
    return {named(definition).index_};
}

const Texture* StatedScene::texture(const schema::TextureRequest& request, Diagnostics&) {
    return handleOf(named(request.definition));
}

} // namespace abbe::exchange
