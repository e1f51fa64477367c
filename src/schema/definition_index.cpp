#include "schema/layers.h"

#include <algorithm>

namespace abbe::schema {

namespace {

bool isSingle(Kind kind) { return kind == Kind::camera || kind == Kind::film || kind == Kind::render; }

} // namespace

Definition* DefinitionIndex::at(const Slot& slot) { return slot.nested ? slot.nested : &tree_.definitions[slot.top]; }

void DefinitionIndex::update() {
    for (; known_ < tree_.definitions.size(); ++known_) add(tree_.definitions[known_], {known_, nullptr});
}

void DefinitionIndex::add(Definition& d, Slot slot) {
    if (!d.name.empty()) {
        named_.emplace(Key{d.kind, d.name}, slot);
    } else if (!slot.nested && !d.target.empty()) {
        placed_[{d.kind, d.target}].push_back(slot.top);
    } else if (!slot.nested && d.type) {
        nameless_[{d.kind, tree_.fullName(d.span, d.type->name)}].push_back(slot.top);
    }
    if (!slot.nested && isSingle(d.kind)) singles_[d.kind].push_back(slot.top);
    addNested(d, 0);
}

void DefinitionIndex::addNested(Definition& parent, std::size_t from) {
    for (std::size_t i = from; i < parent.children.size(); ++i) add(parent.children[i], {0, &parent.children[i]});
}

void DefinitionIndex::noteAdded(Definition& group, std::size_t before, const Definition* old) {
    if (group.children.data() != old) // what was there has moved
        for (std::size_t i = 0; i < before; ++i) {
            Definition& child = group.children[i];
            const auto found = named_.find({child.kind, child.name});
            if (found != named_.end() && found->second.nested == old + i) found->second.nested = &child;
        }
    addNested(group, before);
}

// Those that are there still. What is gone is not looked at again.
void DefinitionIndex::collect(std::vector<std::size_t>& slots) {
    std::erase_if(slots, [&](std::size_t top) { return tree_.definitions[top].removed; });
    constexpr std::size_t kEnough = 8;
    for (std::size_t i = 0; i < slots.size() && i < kEnough; ++i) candidates_.push_back(&tree_.definitions[slots[i]]);
}

Definition* DefinitionIndex::find(Kind kind, const std::string& name, bool named) {
    update();
    candidates_.clear();
    if (!named) {
        collect(singles_[kind]);
    } else if (const auto found = named_.find({kind, name}); found != named_.end()) {
        candidates_.push_back(at(found->second));
    } else if (const auto typed = nameless_.find({kind, name}); typed != nameless_.end()) {
        collect(typed->second);
    } else if (const auto placed = placed_.find({kind, name}); placed != placed_.end()) {
        collect(placed->second);
    }
    return candidates_.size() == 1 ? candidates_.front() : nullptr;
}

Definition* DefinitionIndex::findIn(Definition& group, Kind kind, const std::string& name) {
    update();
    const auto found = named_.find({kind, name});
    if (found == named_.end() || !found->second.nested) return nullptr;
    Definition* const d = found->second.nested;
    const bool inside = !group.children.empty() && d >= group.children.data() && d <= &group.children.back();
    return inside ? d : nullptr;
}

std::pair<std::string_view, const Definition*> DefinitionIndex::nearest(Kind kind, std::string_view name) {
    update();
    std::vector<std::string_view> names;
    for (auto it = named_.lower_bound({kind, {}}); it != named_.end() && it->first.first == kind; ++it)
        names.push_back(it->first.second);
    const std::string_view found = schema::nearest(name, names);
    return found.empty()
               ? std::pair<std::string_view, const Definition*>{}
               : std::pair<std::string_view, const Definition*>{found, at(named_.at({kind, std::string(found)}))};
}

void DefinitionIndex::forget(Definition& d, Span span) {
    d.removed = anyRemoved_ = true;
    if (!d.name.empty()) {
        const auto found = named_.find({d.kind, d.name});
        if (found != named_.end() && at(found->second) == &d) named_.erase(found);
        tree_.removed.insert_or_assign({d.kind, d.name}, span);
    }
    for (Definition& child : d.children) forget(child, span);
}

bool DefinitionIndex::remove(Kind kind, const std::string& name, bool named, Span span) {
    Definition* const found = find(kind, name, named);
    const auto placed = named ? placed_.find({kind, name}) : placed_.end();
    if (placed != placed_.end()) {
        for (const std::size_t top : placed->second) forget(tree_.definitions[top], span);
        placed_.erase(placed);
        candidates_.clear();
        return true;
    }
    if (!found) return false;
    forget(*found, span);
    return true;
}

namespace {

void sweepRemoved(std::vector<Definition>& definitions) {
    std::erase_if(definitions, [](const Definition& d) { return d.removed; });
    for (Definition& d : definitions) sweepRemoved(d.children);
}

} // namespace

void DefinitionIndex::sweep() {
    if (anyRemoved_) sweepRemoved(tree_.definitions);
    named_.clear();
    nameless_.clear();
    placed_.clear();
    singles_.clear();
}

} // namespace abbe::schema
