#include "schema/definition_reader.h"
#include "schema/entry.h"
#include "schema/expression.h"
#include "schema/layers.h"
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
    if (node.packedRows() > 0) return; // of numbers alone
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
    const auto meant = tree.nearestName({&kind, 1}, reference.target); // both whole names
    auto& d = report(diagnostics, reference.targetSpan, "E0202",
                     fmt::format("no {} is named `{}`", keyword(kind), reference.target),
                     meant.empty() ? "unknown name" : didYouMean(meant));
    if (meant.empty())
        d.help = help;
    else
        d.related.push_back({tree.find(kind, meant)->nameSpan, "defined here"});
    tree.noteRemoved(kind, reference.target, {}, d);
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

// What a file includes is there to be chosen from.
bool isIncluded(const SceneTree& tree, const Definition& d) {
    const auto found = tree.inserts.find(d.nameSpan.file);
    return found != tree.inserts.end() && found->second.written;
}

// `left:paint`, which a file that is included `as=left` calls `paint`.
bool isUsedInside(const SceneTree& tree, const Definition& d, const Texts& uses) {
    return d.name.find(':') != std::string::npos && std::ranges::any_of(tree.inserts, [&](const auto& entry) {
               const std::string& prefix = entry.second.prefix;
               return !prefix.empty() && d.name.starts_with(prefix) &&
                      uses.contains(std::string_view(d.name).substr(prefix.size()));
           });
}

// `unchosen`: what variants hold that are not part of the scene, but may be.
void checkUnused(const SceneTree& tree, const std::vector<const Definition*>& instances,
                 const std::vector<Node>& unchosen, Diagnostics& diagnostics) {
    std::size_t budget = 1'000'000;
    Texts texts, targets;
    collectTexts(tree.definitions, texts);
    for (const Node& node : unchosen) {
        collectTexts(node, texts);
        collectTexts(node, targets);
    }
    for (const Definition* instance : instances) targets.insert(instance->target);
    for (const Definition* d : tree.index.sorted) {
        const bool slot = d->kind == Kind::material || d->kind == Kind::spectrum || d->kind == Kind::texture;
        if ((!slot && d->kind != Kind::object) || isIncluded(tree, *d)) continue;
        const Texts& uses = slot ? texts : targets;
        if (uses.contains(d->name) || isUsedInside(tree, *d, uses) || mayBeMisspelt(d->name, uses, budget)) continue;
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
        error.help =
            fmt::format("to change the first one in a layer, write `override {0} {1} {{ … }}`; to put another in its "
                        "place, `remove {0} {1}` before it",
                        keyword(d->kind), d->name);
    }
}

void checkUsage(const SceneTree& tree, const std::vector<Node>& unchosen, Diagnostics& diagnostics) {
    std::vector<const Definition*> instances;
    collectInstances(tree.definitions, instances);
    checkTargets(tree, instances, diagnostics);
    checkAtmospheres(tree, diagnostics);
    CycleCheck cycles(tree, diagnostics);
    for (const Definition* d : tree.index.sorted)
        if (d->kind == Kind::object) cycles.from(d);
    if (!diagnostics.hasErrors()) checkUnused(tree, instances, unchosen, diagnostics);
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

const Definition* SceneTree::find(Kind kind, std::string_view name, Span at) const {
    const auto found = inserts.find(at.file);
    const bool prefixed = found != inserts.end() && !found->second.prefix.empty() && !name.empty();
    return prefixed ? find(kind, found->second.prefix + std::string(name)) : find(kind, name);
}

std::string SceneTree::fullName(Span at, std::string_view name) const {
    const auto found = inserts.find(at.file);
    return found == inserts.end() ? std::string(name) : found->second.prefix + std::string(name);
}

std::string_view SceneTree::nearestName(std::span<const Kind> kinds, std::string_view word, Span at) const {
    const std::string full = fullName(at, word);
    const std::size_t prefix = full.size() - word.size();
    const std::string_view found = nearestName(kinds, full);
    const bool reachable = found.size() > prefix && found.starts_with(std::string_view(full).substr(0, prefix));
    return reachable ? found.substr(prefix) : std::string_view();
}

void SceneTree::noteRemoved(Kind kind, std::string_view name, Span at, Diagnostic& d) const {
    if (removed.empty()) return;
    if (const auto found = removed.find({kind, fullName(at, name)}); found != removed.end())
        d.related.push_back({found->second, "removed here"});
}

const Header& SceneTree::headerOf(Span span) const {
    const auto found = inserts.find(span.file);
    return found == inserts.end() ? header : found->second.header;
}

const std::filesystem::path& SceneTree::directoryOf(Span span) const {
    const auto found = inserts.find(span.file);
    return found == inserts.end() ? directory : found->second.directory;
}

bool SceneTree::isOfCommandLine(Span span) const {
    if (document && span.file == document->file) return false;
    const auto found = inserts.find(span.file);
    return found == inserts.end() || found->second.source.empty();
}

std::vector<Definition> readInsert(SceneTree& tree, Insert insert, const TypeTable& table, Diagnostics& diagnostics) {
    std::vector<Definition> definitions;
    const DefinitionReader reader(table, diagnostics);
    for (const Node node : insert.document->roots())
        if (!isHeader(node)) reader.read(node, definitions, Place::top);
    tree.inserts.insert_or_assign(insert.document->file, std::move(insert));
    return definitions;
}

namespace {

bool isDamagedText(const Document& document) {
    return std::ranges::any_of(document.nodes, [](const auto& node) { return node.damaged; });
}

// What holds for the text of a layer that is not the scene's own.
void addInsert(SceneTree& tree, const LayerFile& layer, const Header& header, std::string source) {
    tree.damaged |= isDamagedText(*layer.document);
    tree.inserts.emplace(layer.document->file, Insert{layer.document, header, layer.path.parent_path(),
                                                      std::move(source), true, layer.prefix, layer.includer});
}

// Directions mean the same in all files of a scene.
void checkAxes(const SceneTree& tree, const Header& header, const LayerFile& layer, Diagnostics& diagnostics) {
    if (header.zUp == tree.header.zUp) return;
    const Span at = header.span.valid() ? header.span : Span{layer.document->file, 0, 0};
    auto& d = report(
        diagnostics, at, "E0234",
        fmt::format("`up={}` here, and `up={}` in the scene", header.zUp ? "z" : "y", tree.header.zUp ? "z" : "y"),
        "all files of a scene have the same vertical axis");
    if (tree.header.span.valid()) d.related.push_back({tree.header.span, "the scene's header"});
    d.help = "include it where `up` is the same, and turn what it shows by `transform` of a group";
}

} // namespace

namespace {

SceneTree resolveAll(const LayerFiles& layers, const TypeTable& table, Diagnostics& diagnostics,
                     const std::function<void(SceneTree&)>& complete) {
    SceneTree tree;
    const LayerFile& own = layers.files.front();
    const auto scopes = std::make_shared<ParameterScopes>();
    tree.document = own.document;
    tree.namedFiles = std::make_shared<std::vector<NamedFile>>();
    tree.damaged = isDamagedText(*tree.document);
    tree.directory = own.path.parent_path();
    tree.header = readHeader(*tree.document, diagnostics);
    for (std::size_t i = 0; i < layers.files.size(); ++i) {
        const LayerFile& layer = layers.files[i];
        scopes->add(layer.document->file, layer.document);
        if (i == 0) continue;
        Header header = readHeader(*layer.document, diagnostics);
        checkAxes(tree, header, layer, diagnostics);
        header.parameters = scopes;
        addInsert(tree, layer, header, layer.path.string());
    }
    tree.header.parameters = scopes;
    for (const auto& set : layers.sets) addInsert(tree, {set, own.path}, tree.header, {});
    tree.includes = layers.included;
    tree.given = layers.given;
    for (const auto& [name, span] : layers.chosen) tree.chosen.push_back(name);
    const std::vector<Node> unchosen = readLayers(layers, tree, table, diagnostics);
    if (complete) complete(tree);
    collectNamed(tree.definitions, tree.index.sorted);
    std::ranges::stable_sort(tree.index.sorted, byName);
    tree.index.filled = true;
    checkNames(tree, table, diagnostics);
    checkSpectra(tree, diagnostics);
    checkUsage(tree, unchosen, diagnostics);
    return tree;
}

} // namespace

namespace {

// Counts what `found` has and does not list, as one more of a code of which no more are listed.
void countUnlisted(const Diagnostics& found, Severity severity, std::size_t missing, Diagnostics& to) {
    std::map<std::string_view, std::size_t> listed;
    for (const Diagnostic& d : found.all()) {
        if (d.severity != severity || ++listed[d.code] < Diagnostics::kMostOfACode) continue;
        for (; missing > 0; --missing) to.add(d);
        return;
    }
}

} // namespace

void addWithIncluders(const SceneTree& tree, const Diagnostics& found, std::size_t known, Diagnostics& to) {
    for (const Diagnostic& one : std::span(found.all()).subspan(known)) {
        Diagnostic d = one;
        auto insert = tree.inserts.find(d.span.file);
        for (; insert != tree.inserts.end() && insert->second.includer.valid();
             insert = tree.inserts.find(insert->second.includer.file))
            d.related.push_back({insert->second.includer, "included from here"});
        to.add(std::move(d));
    }
    countUnlisted(found, Severity::error, found.errorCount() - std::min(found.errorCount(), to.errorCount()), to);
    countUnlisted(found, Severity::warning, found.warningCount() - std::min(found.warningCount(), to.warningCount()),
                  to);
}

SceneTree resolve(const LayerFiles& layers, const TypeTable& table, Diagnostics& diagnostics,
                  const std::function<void(SceneTree&)>& complete) {
    if (layers.files.size() == 1) return resolveAll(layers, table, diagnostics, complete);
    Diagnostics found = diagnostics; // what is wrong so far counts
    const std::size_t known = found.all().size();
    SceneTree tree = resolveAll(layers, table, found, complete);
    addWithIncluders(tree, found, known, diagnostics);
    return tree;
}

SceneTree resolve(std::shared_ptr<const Document> document, const TypeTable& table, std::filesystem::path directory,
                  Diagnostics& diagnostics, const std::function<void(SceneTree&)>& complete) {
    LayerFiles alone;
    alone.files.push_back({std::move(document), std::move(directory) / "scene"});
    return resolve(alone, table, diagnostics, complete);
}

} // namespace abbe::schema
