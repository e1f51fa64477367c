#include "schema/definition_reader.h"
#include "schema/entry.h"
#include "schema/scene_tree.h"
#include "schema/spectrum_reader.h"
#include "schema/suggest.h"

#include <algorithm>
#include <fmt/format.h>
#include <span>
#include <unordered_map>
#include <unordered_set>

namespace abbe::schema {

namespace {

using Definitions = std::vector<Definition>;
using Texts = std::unordered_set<std::string_view>;

bool isPlacement(const Definition& d) { return d.kind == Kind::instance || d.kind == Kind::instances; }

void collectTexts(const Node& node, Texts& out) {
    if (!node.allNumbers())
        for (std::size_t i = 0; i < node.valueCount(); ++i)
            if (const Value value = node.value(i); value.isText()) out.insert(value.text);
    for (const Key& key : node.keys())
        if (key.value.isText()) out.insert(key.value.text);
    for (const Node child : node.children()) collectTexts(child, out);
}

void collectTexts(const Definitions& definitions, Texts& out) {
    for (const Definition& d : definitions) {
        for (const Key& key : d.keys)
            if (key.value.isText()) out.insert(key.value.text);
        for (const Node& property : d.properties) collectTexts(property, out);
        collectTexts(d.children, out);
    }
}

void collectInstances(const Definitions& definitions, std::vector<const Definition*>& out) {
    for (const Definition& d : definitions) {
        if (isPlacement(d)) out.push_back(&d);
        collectInstances(d.children, out);
    }
}

// The instances that appear wherever `owner` appears. An object inside of it is only defined there.
void collectPlaced(const Definition& owner, std::vector<const Definition*>& out) {
    for (const Definition& d : owner.children) {
        if (isPlacement(d)) out.push_back(&d);
        if (d.kind == Kind::group) collectPlaced(d, out);
    }
}

// Reports that nothing of this kind has the name that `reference` names, with the nearest one. `help` if there is none.
void reportTarget(const SceneTree& tree, const Definition& reference, Kind kind, const std::string& help,
                  Diagnostics& diagnostics) {
    const auto meant = tree.nearestName({&kind, 1}, reference.target);
    auto& d = report(diagnostics, reference.targetSpan, "E0202",
                     fmt::format("no {} is named `{}`", keyword(kind), reference.target),
                     meant.empty() ? "unknown name" : didYouMean(meant));
    if (meant.empty())
        d.help = help;
    else
        d.related.push_back({tree.find(kind, meant)->nameSpan, "defined here"});
}

void checkTargets(const SceneTree& tree, const std::vector<const Definition*>& instances, Diagnostics& diagnostics) {
    for (const Definition* instance : instances) {
        if (instance->target.empty() || tree.find(Kind::object, instance->target)) continue;
        const bool shape = tree.find(Kind::shape, instance->target) != nullptr;
        reportTarget(tree, *instance, Kind::object,
                     shape ? fmt::format("`{0}` is a shape; wrap it: `object {0} {{ … }}`", instance->target) : "",
                     diagnostics);
    }
}

void checkAtmospheres(const SceneTree& tree, Diagnostics& diagnostics) {
    for (const Definition& d : tree.definitions) {
        if (d.kind != Kind::atmosphere || d.target.empty() || tree.find(Kind::medium, d.target)) continue;
        reportTarget(tree, d, Kind::medium,
                     fmt::format("define it: `medium {} homogeneous {{ extinction 0.02 per-km }}`", d.target),
                     diagnostics);
    }
}

// Depth-first search with its own stack: a long chain of objects must not exhaust the program's.
class CycleCheck {
  public:
    CycleCheck(const SceneTree& tree, Diagnostics& diagnostics) : tree_(tree), diagnostics_(diagnostics) {}

    void from(const Definition* root) {
        if (state_[root] != State::unseen) return;
        enter(root);
        while (!stack_.empty()) {
            Level& top = stack_.back();
            if (top.next == top.placed.size()) {
                state_[top.object] = State::done;
                stack_.pop_back();
                continue;
            }
            const Definition* const instance = top.placed[top.next++];
            const Definition* const target = tree_.find(Kind::object, instance->target);
            if (!target || state_[target] == State::done) continue;
            if (state_[target] == State::open)
                reportCycle(*instance, target);
            else
                enter(target);
        }
    }

  private:
    enum class State : std::uint8_t { unseen, open, done };
    struct Level {
        const Definition* object;
        std::vector<const Definition*> placed;
        std::size_t next = 0;
    };

    void enter(const Definition* object) {
        state_[object] = State::open;
        depth_[object] = stack_.size();
        Level level{object, {}};
        collectPlaced(*object, level.placed);
        stack_.push_back(std::move(level));
    }

    void reportCycle(const Definition& instance, const Definition* target) {
        constexpr std::size_t kShown = 12;
        const auto cycle = std::span(stack_).subspan(depth_[target]);
        std::string chain;
        for (const Level& level : cycle.first(std::min(cycle.size(), kShown))) chain += level.object->name + " → ";
        if (cycle.size() > kShown) chain += "… → ";
        auto& d = report(diagnostics_, instance.targetSpan, "E0213",
                         fmt::format("object `{}` contains itself", target->name), "placed inside of itself");
        d.related.push_back({target->nameSpan, "the object"});
        d.notes.push_back("the chain is " + chain + target->name);
    }

    const SceneTree& tree_;
    Diagnostics& diagnostics_;
    std::unordered_map<const Definition*, State> state_;
    std::unordered_map<const Definition*, std::size_t> depth_; // of those open
    std::vector<Level> stack_;
};

// True if some used text is so near to `name` that a typing error may be why the name is unused. `budget` bounds the
// comparisons of one file.
bool mayBeMisspelt(std::string_view name, const Texts& texts, std::size_t& budget) {
    if (texts.size() > budget) return false;
    budget -= texts.size();
    return std::ranges::any_of(texts, [&](std::string_view t) { return !nearest(t, {name}).empty(); });
}

void checkUnused(const SceneTree& tree, const std::vector<const Definition*>& instances, Diagnostics& diagnostics) {
    std::size_t budget = 1'000'000;
    Texts texts, targets;
    collectTexts(tree.definitions, texts);
    for (const Definition* instance : instances) targets.insert(instance->target);
    for (const Definition* d : tree.index.sorted) {
        const bool slot = d->kind == Kind::material || d->kind == Kind::spectrum || d->kind == Kind::texture;
        if (!slot && d->kind != Kind::object) continue;
        const Texts& uses = slot ? texts : targets;
        if (uses.contains(d->name) || mayBeMisspelt(d->name, uses, budget)) continue;
        diagnostics.warning("W0201", d->nameSpan, fmt::format("{} `{}` is never used", keyword(d->kind), d->name),
                            "unused");
    }
}

void checkNames(const SceneTree& tree, const TypeTable& table, Diagnostics& diagnostics) {
    const Definition* first = nullptr; // sorted stably: the first of equals is the first of the file
    for (const Definition* d : tree.index.sorted) {
        if (!first || first->kind != d->kind || first->name != d->name) {
            first = d;
            if ((d->kind == Kind::material || d->kind == Kind::texture) && table.find(d->kind, d->name))
                diagnostics.warning("W0202", d->nameSpan,
                                    fmt::format("the name `{}` hides a type of {}", d->name, keyword(d->kind)),
                                    "names win over types");
            continue;
        }
        auto& error = report(diagnostics, d->nameSpan, "E0203",
                             fmt::format("{} `{}` is defined twice", keyword(d->kind), d->name), "second definition");
        error.related.push_back({first->nameSpan, "the first definition is here"});
    }
}

void checkUsage(const SceneTree& tree, Diagnostics& diagnostics) {
    std::vector<const Definition*> instances;
    collectInstances(tree.definitions, instances);
    checkTargets(tree, instances, diagnostics);
    checkAtmospheres(tree, diagnostics);
    CycleCheck cycles(tree, diagnostics);
    for (const Definition* d : tree.index.sorted)
        if (d->kind == Kind::object) cycles.from(d);
    if (!diagnostics.hasErrors()) checkUnused(tree, instances, diagnostics);
}

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

const Header& SceneTree::headerOf(Span span) const {
    const auto found = inserts.find(span.file);
    return found == inserts.end() ? header : found->second.header;
}

const std::filesystem::path& SceneTree::directoryOf(Span span) const {
    const auto found = inserts.find(span.file);
    return found == inserts.end() ? directory : found->second.directory;
}

std::vector<Definition> readInsert(SceneTree& tree, Insert insert, const TypeTable& table, Diagnostics& diagnostics) {
    std::vector<Definition> definitions;
    const DefinitionReader reader(table, diagnostics);
    for (const Node node : insert.document->roots())
        if (!isHeader(node)) reader.read(node, definitions, Place::top);
    tree.inserts.insert_or_assign(insert.document->file, std::move(insert));
    return definitions;
}

SceneTree resolve(std::shared_ptr<const Document> document, const TypeTable& table, std::filesystem::path directory,
                  Diagnostics& diagnostics, const std::function<void(SceneTree&)>& complete) {
    SceneTree tree;
    tree.document = std::move(document);
    tree.namedFiles = std::make_shared<std::vector<NamedFile>>();
    tree.damaged = std::ranges::any_of(tree.document->nodes, [](const auto& node) { return node.damaged; });
    tree.directory = std::move(directory);
    tree.header = readHeader(*tree.document, diagnostics);
    const DefinitionReader reader(table, diagnostics);
    for (const Node node : tree.document->roots())
        if (!isHeader(node)) reader.read(node, tree.definitions, Place::top);
    if (complete) complete(tree);
    collectNamed(tree.definitions, tree.index.sorted);
    std::ranges::stable_sort(tree.index.sorted, byName);
    tree.index.filled = true;
    checkNames(tree, table, diagnostics);
    checkSpectra(tree, diagnostics);
    checkUsage(tree, diagnostics);
    return tree;
}

} // namespace abbe::schema
