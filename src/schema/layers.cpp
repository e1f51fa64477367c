#include "schema/layers.h"

#include "schema/definition_reader.h"
#include "schema/expression.h"
#include "schema/suggest.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <set>
#include <unordered_set>

namespace abbe::schema {

namespace {

constexpr auto kLayerWords = std::to_array<std::string_view>({"include", "override", "remove", "variant"});
// Properties that overrides compare, in all: some seconds. No scene comes near.
constexpr std::size_t kMostReplaced = 100'000'000;
constexpr std::size_t kMostSuggestions = 100; // of names; each looks at all of them

bool isContainer(Kind kind) { return kind == Kind::group || kind == Kind::object; }

// What an override gives, as names of properties and, for references with a key, the values of the key.
class Replacement {
  public:
    Replacement(const TypeInfo* type, const std::vector<Node>& properties, std::span<const Key> keys) : type_(type) {
        for (const Node& node : properties) add(node.name(), node.keys());
        for (const Key& key : keys) add(key.name, {});
    }

    bool replaces(std::string_view name, std::span<const Key> keys) const {
        if (names_.contains(name)) return true;
        const FieldInfo* const field = type_ ? type_->find(name) : nullptr;
        if (!field) return false;
        if (!field->group.empty() && groups_.contains(field->group)) return true;
        return isKeyed(*field) && keyed_.contains({name, keyOf(*field, keys)});
    }

  private:
    // `material horn group=horns` may stand once for each group.
    static bool isKeyed(const FieldInfo& field) { return field.type == FieldType::reference && !field.keys.empty(); }
    static std::string_view keyOf(const FieldInfo& field, std::span<const Key> keys) {
        const auto key = std::ranges::find(keys, field.keys[0].name, &Key::name);
        return key == keys.end() ? std::string_view() : key->value.text;
    }

    void add(std::string_view name, std::span<const Key> keys) {
        const FieldInfo* const field = type_ ? type_->find(name) : nullptr;
        if (field && isKeyed(*field))
            keyed_.emplace(name, keyOf(*field, keys));
        else
            names_.insert(name);
        if (field && !field->group.empty()) groups_.insert(field->group);
    }

    const TypeInfo* type_;
    std::unordered_set<std::string_view> names_, groups_;
    std::set<std::pair<std::string_view, std::string_view>> keyed_;
};

// The statements of all layers in their order. What changes a definition looks for it among those that stand before.
class LayerReader {
  public:
    LayerReader(const LayerFiles& layers, SceneTree& tree, const TypeTable& table, Diagnostics& diagnostics)
        : layers_(layers), tree_(tree), table_(table), diagnostics_(diagnostics), index_(tree) {}

    std::vector<Node> read() {
        file(0);
        for (const auto& [name, span] : layers_.chosen) choose(name, span, {});
        for (const Choice& choice : choices_) apply(choice);
        for (const auto& set : layers_.sets)
            for (const Node node : set->roots()) statement(node, {});
        for (const Pending& p : pending_) reportMissing(p);
        index_.sweep();
        std::vector<Node> unchosen;
        for (const Variant& v : variants_)
            if (!v.applied)
                for (const Node child : v.node.children()) unchosen.push_back(child);
        return unchosen;
    }

  private:
    struct Variant {
        Node node;
        std::string name, prefix;
        bool applied = false;
    };
    struct Choice {
        std::string name;
        Span span;
        std::string prefix; // of the file that chooses it
    };
    // What an override or a removal did not find.
    struct Pending {
        Node node;
        Kind kind;
        std::optional<Value> word;
        std::string name; // the whole one
        bool inGroup = false;
    };

    void file(std::size_t at) {
        const LayerFile& layer = layers_.files[at];
        for (const Node node : layer.document->roots()) {
            if (isHeader(node)) {
                tree_.statements.push_back(node);
            } else if (node.name() == "include") {
                include(layer, node);
            } else if (node.name() == "variant") {
                variant(node, layer.prefix);
            } else {
                statement(node, layer.prefix);
            }
        }
    }

    // What cannot be included has been reported, unless nothing may be.
    void include(const LayerFile& layer, const Node& node) {
        if (const auto found = layer.includes.find(node.nameSpan().begin); found != layer.includes.end())
            return file(found->second);
        if (tree_.inserts.empty() && layers_.included.empty() && !diagnostics_.hasErrors())
            report(diagnostics_, node.nameSpan(), "E0226", "this text cannot include files", "is not read from a file");
    }

    void statement(const Node& node, const std::string& prefix) {
        tree_.statements.push_back(node);
        if (node.name() == "override") return override(node, prefix);
        if (node.name() == "remove") return remove(node, prefix);
        DefinitionReader(table_, diagnostics_, prefix).read(node, tree_.definitions, Place::top);
    }

    // --- variants

    void variant(const Node& node, const std::string& prefix) {
        if (node.damaged()) return;
        if (node.valueCount() != 1 || !node.value(0).isText() || node.value(0).text.empty() || !node.keys().empty()) {
            report(diagnostics_, node.headSpan(), "E0232", "`variant` needs one name", "write `variant dusk { … }`");
            return;
        }
        const Value word = node.value(0);
        std::string name = prefix + std::string(word.text);
        if (!node.hasBlock()) return choose(name, place(word), prefix);
        if (const auto first = variantPlaces_.emplace(std::pair{name, word.span.file}, word.span); !first.second) {
            auto& d = report(diagnostics_, word.span, "E0203", fmt::format("variant `{}` is defined twice", word.text),
                             "second definition");
            d.related.push_back({first.first->second, "the first definition is here"});
            return;
        }
        for (const Node child : node.children()) {
            const bool layer =
                child.name() == "include" || child.name() == "variant" || child.name() == "param" || isHeader(child);
            if (layer)
                report(diagnostics_, child.nameSpan(), "E0232",
                       fmt::format("`{}` does not belong in a variant", child.name()),
                       "stands at the top level of a file");
        }
        if (std::ranges::find(tree_.variants, name, &VariantName::name) == tree_.variants.end())
            tree_.variants.push_back({name, word.span});
        variants_.push_back({node, std::move(name), prefix});
    }

    // Once: what is chosen by a file and by the command line is applied where the file's choice stands.
    void choose(const std::string& name, Span span, const std::string& prefix) {
        if (std::ranges::find(choices_, name, &Choice::name) == choices_.end())
            choices_.push_back({name, span, prefix});
    }

    // Of all files that define one of that name, in their order.
    void apply(const Choice& choice) {
        bool found = false;
        for (Variant& v : variants_) {
            if (v.name != choice.name) continue;
            found = v.applied = true;
            for (const Node child : v.node.children()) {
                const std::string_view word = child.name();
                if (word != "include" && word != "variant" && word != "param" && !isHeader(child))
                    statement(child, v.prefix);
            }
        }
        for (VariantName& known : tree_.variants) known.chosen |= known.name == choice.name;
        if (!found) unknownVariant(choice);
    }

    void unknownVariant(const Choice& choice) {
        std::vector<std::string_view> names;
        for (const VariantName& v : tree_.variants) names.push_back(v.name);
        const std::string_view meant = nearest(choice.name, names);
        auto& d = report(diagnostics_, choice.span, "E0231", fmt::format("the scene has no variant `{}`", choice.name),
                         meant.empty() ? "unknown variant" : didYouMean(meant));
        if (const auto found = std::ranges::find(tree_.variants, meant, &VariantName::name);
            found != tree_.variants.end())
            d.related.push_back({found->span, "defined here"});
        else
            d.help = names.empty() ? "it has none: `variant NAME { override … }` defines one"
                                   : "its variants are " + quotedList(names);
    }

    // --- override and remove

    // `override kind [name] …`: the kind and the name; nothing after a diagnostic.
    std::optional<std::pair<Kind, std::optional<Value>>> target(const Node& node) {
        if (node.damaged()) return std::nullopt;
        const bool text = node.valueCount() > 0 && !node.allNumbers() && node.value(0).isText();
        const auto kind = text ? findKind(node.value(0).text) : std::nullopt;
        if (!kind) {
            unknownTarget(node, text);
            return std::nullopt;
        }
        std::optional<Value> name;
        if (node.valueCount() > 1) {
            name = node.value(1);
            if (!name->isText()) {
                reportAt(diagnostics_, *name, "E0232",
                         fmt::format("`{}` needs the name of a {}", node.name(), keyword(*kind)), "not a name");
                return std::nullopt;
            }
        }
        return std::pair{*kind, name};
    }

    void unknownTarget(const Node& node, bool text) {
        const Value word = text ? node.value(0) : Value{};
        auto& d = report(diagnostics_, text ? place(word) : node.headSpan(), "E0232",
                         text ? fmt::format("`{}` is not a kind of definition", word.text)
                              : fmt::format("`{}` needs a kind and a name", node.name()),
                         text ? "unknown kind" : fmt::format("write `{} material skin`, say", node.name()));
        if (!text) return;
        if (word.text == "param")
            d.help = "a `param` of the same name in this file gives that of an included file its value";
        else if (const auto kind = suggestKind(word.text))
            d.label = didYouMean(keyword(*kind));
        else
            d.help = fmt::format("write the kind and the name: `{} material {}`", node.name(), word.text);
    }

    void override(const Node& node, const std::string& prefix) {
        const auto wanted = target(node);
        if (!wanted) return;
        const auto& [kind, word] = *wanted;
        const std::string name = word ? prefix + std::string(word->text) : std::string();
        Definition* const found = index_.find(kind, name, word.has_value());
        if (found) return merge(*found, node, word ? 2 : 1, prefix);
        if (index_.isAmbiguous()) return reportAmbiguous(node, kind, word);
        const bool implied = !word && (kind == Kind::film || kind == Kind::render);
        if (!implied) {
            pending_.push_back({node, kind, word, name});
            return;
        }
        // Every scene has a film and settings, written or not.
        Definition& made = tree_.definitions.emplace_back();
        made.kind = kind;
        made.nameSpan = node.value(0).span;
        made.span = node.headSpan();
        made.type = table_.defaultOf(kind);
        merge(made, node, 1, prefix);
    }

    void reportAmbiguous(const Node& node, Kind kind, const std::optional<Value>& word) {
        const Span at = word ? place(*word) : node.headSpan();
        auto& d = report(diagnostics_, at, "E0230",
                         word ? fmt::format("several `{} {}` have no name", keyword(kind), word->text)
                              : fmt::format("there are several of `{}`", keyword(kind)),
                         "which of them?");
        for (const Definition* one : index_.candidates()) d.related.push_back({one->nameSpan, "one of them"});
        d.help = word ? "give them names" : fmt::format("write the name: `{} {} NAME`", node.name(), keyword(kind));
    }

    void remove(const Node& node, const std::string& prefix) {
        const auto wanted = target(node);
        if (!wanted) return;
        const auto& [kind, word] = *wanted;
        if (node.valueCount() > (word ? 2u : 1u) || !node.keys().empty() || node.hasBlock())
            report(diagnostics_, node.headSpan(), "E0232", "`remove` takes a kind and a name, and nothing else",
                   node.hasBlock() ? "remove the block" : "unexpected");
        const std::string name = word ? prefix + std::string(word->text) : std::string();
        if (index_.remove(kind, name, word.has_value(), node.headSpan())) return;
        if (index_.isAmbiguous()) return reportAmbiguous(node, kind, word);
        pending_.push_back({node, kind, word, name});
    }

    void reportMissing(const Pending& p) {
        const bool removal = p.node.name() == "remove";
        const std::string what = removal ? "remove" : "override";
        const Span at = p.word ? place(*p.word) : p.node.headSpan();
        const Definition* const now = p.inGroup ? nullptr : index_.find(p.kind, p.name, p.word.has_value());
        auto& d = report(diagnostics_, at, "E0229",
                         p.word ? fmt::format("no {} is named `{}`", keyword(p.kind), p.word->text)
                                : fmt::format("the scene has no `{}`", keyword(p.kind)),
                         fmt::format("nothing to {}", what));
        if (now) {
            d.message = p.word ? fmt::format("{} `{}` is defined further down", keyword(p.kind), p.word->text)
                               : fmt::format("`{}` is defined further down", keyword(p.kind));
            d.label = fmt::format("`{}` stands behind what it changes", what);
            d.related.push_back({now->nameSpan, "defined here"});
            return;
        }
        if (const auto gone = tree_.removed.find({p.kind, p.name}); gone != tree_.removed.end()) {
            d.related.push_back({gone->second, "removed here"});
            return;
        }
        if (p.kind == Kind::instance || p.kind == Kind::instances)
            d.help = "instances are named after the object that they place";
        if (p.inGroup) d.help = "to add something to the group, write its type as well";
        if (!p.word || ++suggested_ > kMostSuggestions) return;
        const auto [near, definition] = index_.nearest(p.kind, p.name);
        if (!definition) return;
        d.label += "; " + didYouMean(near);
        d.related.push_back({definition->nameSpan, "defined here"});
    }

    // --- merging

    // Replaces in a definition what an override gives, whose values behind kind and name begin at `rest`.
    void merge(Definition& target, const Node& node, std::size_t rest, const std::string& prefix) {
        if (!mergeHead(target, node, rest)) return;
        target.damaged |= node.damaged();
        std::vector<Node> properties, nested;
        for (const Node child : node.children())
            (isContainer(target.kind) && child.name() != "transform" && child.name() != "visible-to" ? nested
                                                                                                     : properties)
                .push_back(child);
        std::vector<Key> keys(node.keys().begin(), node.keys().end());
        replaced_ += target.properties.size() + target.keys.size() + properties.size();
        if (replaced_ > kMostReplaced) {
            if (!std::exchange(tired_, true))
                report(diagnostics_, node.headSpan(), "E0228",
                       "too many overrides of definitions with too many properties",
                       "write the properties where they are defined");
            return;
        }
        const Replacement given(target.type, properties, keys);
        std::erase_if(target.properties, [&](const Node& old) { return given.replaces(old.name(), old.keys()); });
        dropArguments(target, given);
        std::erase_if(target.keys, [&](const Key& old) { return given.replaces(old.name, {}); });
        target.properties.insert(target.properties.end(), properties.begin(), properties.end());
        target.keys.insert(target.keys.end(), keys.begin(), keys.end());
        for (const Node& child : nested) mergeNested(target, child, prefix);
    }

    // A property that stood behind the type, as in `mesh "a.ply"`, with its keys.
    static void dropArguments(Definition& target, const Replacement& given) {
        if (!target.type || target.arguments.empty()) return;
        for (const FieldInfo& field : target.type->fields) {
            if (field.argument < 0 || !given.replaces(field.name, {})) continue;
            target.arguments.clear();
            std::erase_if(target.keys, [&](const Key& key) {
                return std::ranges::find(field.keys, key.name, &FieldKey::name) != field.keys.end();
            });
        }
    }

    // What stands behind the name: the same type, or new arguments; all of a spectrum.
    bool mergeHead(Definition& target, const Node& node, std::size_t rest) {
        std::vector<Value> values;
        for (std::size_t i = rest; i < node.valueCount(); ++i) values.push_back(node.value(i));
        if (target.kind != Kind::spectrum && !values.empty() && values[0].isText())
            if (const TypeInfo* const type = table_.find(target.kind, values[0].text)) {
                if (type != target.type) {
                    auto& d = reportAt(diagnostics_, values[0], "E0230",
                                       fmt::format("an override cannot make {} a `{}`", title(target), type->name),
                                       "another type");
                    d.related.push_back({target.nameSpan, "defined here"});
                    d.help = fmt::format("`remove {}{}{}` first, and define it anew", keyword(target.kind),
                                         target.name.empty() ? "" : " ", target.name);
                    return false;
                }
                values.erase(values.begin());
            }
        if (values.empty()) return true;
        if (isContainer(target.kind) || (!target.type && target.kind != Kind::spectrum)) {
            reportAt(diagnostics_, values[0], "E0306",
                     fmt::format("`override {}` takes one name", keyword(target.kind)), "unexpected");
            return false;
        }
        target.arguments = std::move(values);
        if (target.kind == Kind::spectrum) target.keys.clear();
        return true;
    }

    // `override group room { shape wall { … } }`: by name, or new with its type.
    void mergeNested(Definition& group, const Node& node, const std::string& prefix) {
        const auto kind = findKind(node.name());
        const bool named = node.valueCount() > 0 && !node.allNumbers() && node.value(0).isText();
        if (kind && named) {
            const Value word = node.value(0);
            const std::string name = prefix + std::string(word.text);
            if (Definition* const found = index_.findIn(group, *kind, name)) return merge(*found, node, 1, prefix);
            const bool placed = *kind == Kind::instance || *kind == Kind::instances || isContainer(*kind);
            const bool typed = node.valueCount() > 1 || table_.find(*kind, word.text) || placed;
            if (!typed) {
                pending_.push_back({node, *kind, word, name, true});
                return;
            }
        }
        const std::size_t before = group.children.size();
        const Definition* const old = group.children.data();
        DefinitionReader(table_, diagnostics_, prefix).read(node, group.children, Place::group);
        if (group.children.size() > before) index_.noteAdded(group, before, old);
    }

    const LayerFiles& layers_;
    SceneTree& tree_;
    const TypeTable& table_;
    Diagnostics& diagnostics_;
    DefinitionIndex index_;
    std::vector<Variant> variants_;
    std::map<std::pair<std::string, FileId>, Span> variantPlaces_;
    std::vector<Choice> choices_;
    std::vector<Pending> pending_;
    std::size_t replaced_ = 0, suggested_ = 0;
    bool tired_ = false;
};

} // namespace

bool isLayerWord(std::string_view word) { return std::ranges::find(kLayerWords, word) != kLayerWords.end(); }

std::vector<Node> readLayers(const LayerFiles& layers, SceneTree& tree, const TypeTable& table,
                             Diagnostics& diagnostics) {
    return LayerReader(layers, tree, table, diagnostics).read();
}

} // namespace abbe::schema
