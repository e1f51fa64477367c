#include "schema/definition_reader.h"
#include "schema/header.h"
#include "schema/spectrum_reader.h"
#include "schema/usage.h"

#include <algorithm>

namespace abbe::schema {

namespace {

bool byName(const Definition* a, const Definition* b) {
    return a->kind != b->kind ? a->kind < b->kind : a->name < b->name;
}

// Nested definitions follow their owner, so stable sorting keeps file order among equals.
void collectNamed(const std::vector<Definition>& definitions, std::vector<const Definition*>& out) {
    for (const Definition& d : definitions) {
        if (!d.name.empty() && d.kind != Kind::instance) out.push_back(&d);
        collectNamed(d.children, out);
    }
}

const Definition* findLinear(const std::vector<Definition>& definitions, Kind kind, std::string_view name) {
    for (const Definition& d : definitions) {
        if (d.kind == kind && d.name == name) return &d;
        if (const Definition* nested = findLinear(d.children, kind, name)) return nested;
    }
    return nullptr;
}

} // namespace

const Definition* SceneTree::find(Kind kind, std::string_view name) const {
    if (name.empty()) return nullptr;
    if (!index.filled) return findLinear(definitions, kind, name);
    const auto before = [&](const Definition* d, std::string_view n) {
        return d->kind != kind ? d->kind < kind : d->name < n;
    };
    const auto found = std::lower_bound(index.sorted.begin(), index.sorted.end(), name, before);
    const bool hit = found != index.sorted.end() && (*found)->kind == kind && (*found)->name == name;
    return hit ? *found : nullptr;
}

std::string_view SceneTree::nearestName(std::span<const Kind> kinds, std::string_view word) const {
    if (index.compared >= kMostCompared) return {};
    std::vector<std::string_view> names;
    for (const Definition* d : index.sorted)
        if (std::ranges::find(kinds, d->kind) != kinds.end()) names.push_back(d->name);
    index.compared += index.sorted.size() + names.size() * word.size();
    return nearest(word, names);
}

SceneTree resolve(std::shared_ptr<const Document> document, const TypeTable& table, std::filesystem::path directory,
                  Diagnostics& diagnostics) {
    SceneTree tree;
    tree.document = std::move(document);
    tree.damaged = std::ranges::any_of(tree.document->nodes, [](const auto& node) { return node.damaged; });
    tree.directory = std::move(directory);
    tree.header = readHeader(*tree.document, diagnostics);
    const DefinitionReader reader(table, diagnostics);
    for (const Node node : tree.document->roots())
        if (!isHeader(node)) reader.read(node, tree.definitions, Place::top);
    collectNamed(tree.definitions, tree.index.sorted);
    std::ranges::stable_sort(tree.index.sorted, byName);
    tree.index.filled = true;
    checkNames(tree, table, diagnostics);
    checkSpectra(tree, diagnostics);
    checkUsage(tree, diagnostics);
    return tree;
}

} // namespace abbe::schema
