#include "schema/binding.h"
#include "schema/definition_reader.h"
#include "schema/foreign_words.h"
#include "schema/layers.h"
#include "schema/suggest.h"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <map>
#include <utility>

namespace abbe::schema {

namespace {

bool isPrivate(std::string_view name) { return name.starts_with("x-"); }

// The argument fields of a type in their order.
std::vector<const FieldInfo*> argumentFields(const TypeInfo& type) {
    std::vector<const FieldInfo*> fields;
    for (const FieldInfo& field : type.fields)
        if (field.argument >= 0) fields.push_back(&field);
    std::ranges::sort(fields, {}, [](const FieldInfo* f) { return f->argument; });
    return fields;
}

bool isReference(const FieldInfo& field) {
    return field.type == FieldType::reference || field.type == FieldType::weighted;
}

Span spanOf(const std::vector<Value>& values) { return join(place(values.front()), place(values.back())); }

class Binding {
  public:
    Binding(const Definition& definition, const BindContext& context, void* params)
        : definition_(definition), type_(*definition.type), context_(context), params_(params) {}

    // False if a value is missing, be it for an error that was reported when another definition was bound.
    bool run() {
        arguments();
        for (const Node& property : definition_.properties) this->property(property);
        looseSteps();
        required();
        defaults();
        return complete_;
    }

  private:
    // Notes that a field is given, and reports a second time. False if it must not be bound.
    bool give(const FieldInfo& field, Span span) {
        const auto [first, fresh] = given_.emplace(&field, span);
        if (!fresh && field.repeats) return true;
        if (!fresh) {
            auto& d =
                report(context_.diagnostics, span, "E0208", fmt::format("`{}` is given twice", field.name), "second");
            d.related.push_back({first->second, "first"});
            return false;
        }
        if (field.group.empty()) return true;
        const auto [member, alone] = groups_.emplace(field.group, std::pair{&field, span});
        if (alone) return true;
        auto& d = report(context_.diagnostics, span, "E0310",
                         fmt::format("{} states its {} twice", title(definition_), field.group),
                         fmt::format("second {}", field.group));
        d.related.push_back({member->second.second, fmt::format("first {}", field.group)});
        d.notes.push_back(fmt::format("keep one of `{}` and `{}`", member->second.first->name, field.name));
        // Its value is still checked, but not stored.
        return true;
    }

    // The same for a reference with a key, `material horn group=horns`: once for each value of the key. Nothing for
    // other properties.
    std::optional<bool> giveKeyed(const FieldInfo& field, const Node& node) {
        if (field.type != FieldType::reference || field.keys.empty()) return std::nullopt;
        for (const Key& key : node.keys()) {
            if (key.name != field.keys[0].name) continue;
            const auto [first, fresh] = keyed_.emplace(std::pair{&field, key.value.text}, node.headSpan());
            if (fresh) return true;
            auto& d = report(context_.diagnostics, node.headSpan(), "E0208",
                             fmt::format("`{}` is given twice for `{}`", field.name, key.value.text), "second");
            d.related.push_back({first->second, "first"});
            return false;
        }
        return std::nullopt;
    }

    bool isSecondOfGroup(const FieldInfo& field) const {
        const auto found = groups_.find(field.group);
        return found != groups_.end() && found->second.first != &field;
    }

    void store(const FieldInfo& field, const std::optional<BoundValue>& value) {
        complete_ = complete_ && value;
        if (value && params_ && field.store) field.store(params_, *value);
    }

    // Binds the properties that stand on the line as `g=0.85`, one value each, and returns the other keys.
    std::vector<Key> keyProperties() {
        std::vector<Key> others;
        const auto fields = argumentFields(type_);
        for (const Key& key : definition_.keys) {
            const FieldInfo* const field = type_.find(key.name);
            const bool argumentKey = !fields.empty() && std::ranges::find(fields.back()->keys, key.name,
                                                                          &FieldKey::name) != fields.back()->keys.end();
            if (!field || argumentKey || field->type == FieldType::moments) {
                others.push_back(key);
                continue;
            }
            const Entry entry(field->name, join(key.nameSpan, place(key.value)), {key.value});
            if (give(*field, entry.span()) && !isSecondOfGroup(*field))
                store(*field, bindField(*field, entry, context_));
        }
        return others;
    }

    void arguments() {
        if (definition_.damaged) return;
        const auto fields = argumentFields(type_);
        const auto& values = definition_.arguments;
        const auto own = keyProperties();
        // Keys behind the arguments are those of the last one, but for properties on the line.
        const bool keyed = !values.empty() && !fields.empty() && !fields.back()->keys.empty();
        for (const Key& key : keyed ? std::span<const Key>() : std::span(own))
            report(context_.diagnostics, key.nameSpan, "E0210",
                   fmt::format("{} has no key `{}`", title(definition_), key.name), "unknown key");
        std::size_t next = 0;
        for (std::size_t i = 0; i < fields.size() && next < values.size(); ++i) {
            // The last field takes what is left; the ones before it take one value each.
            const std::size_t end = i + 1 == fields.size() ? values.size() : next + 1;
            const std::vector<Value> part(values.begin() + static_cast<std::ptrdiff_t>(next),
                                          values.begin() + static_cast<std::ptrdiff_t>(end));
            const bool last = i + 1 == fields.size() || end == values.size();
            const Entry entry(fields[i]->name, spanOf(part), part,
                              keyed && last ? std::span<const Key>(own) : std::span<const Key>());
            if (give(*fields[i], entry.span())) store(*fields[i], bindField(*fields[i], entry, context_));
            next = end;
        }
        if (next == values.size()) return;
        auto& d = reportAt(context_.diagnostics, values[next], "E0306",
                           fmt::format("`{} {}` takes no arguments", keyword(type_.kind), type_.name), "unexpected");
        d.help = "properties stand in the block: `{ property value }`";
    }

    void property(const Node& node) {
        if (isPrivate(node.name())) return;
        const FieldInfo* const field = type_.find(node.name());
        if (!field) return unknown(node);
        if (field->type == FieldType::moments) return moment(*field, node);
        const auto keyed = giveKeyed(*field, node);
        if (!(keyed ? *keyed : give(*field, node.headSpan())) || node.damaged()) return;
        const auto value = bindField(*field, Entry(node), context_);
        if (!isSecondOfGroup(*field)) store(*field, value);
        if (!field->block.empty() && node.hasBlock()) settings(*field, node);
    }

    // The block behind a value.
    void settings(const FieldInfo& field, const Node& node) {
        std::vector<std::string_view> names;
        for (const FieldInfo& f : field.block) names.push_back(f.name);
        for (const Node child : node.children()) {
            if (isPrivate(child.name())) continue;
            const auto found = std::ranges::find(field.block, child.name(), &FieldInfo::name);
            if (found != field.block.end()) {
                if (give(*found, child.headSpan()) && !child.damaged())
                    store(*found, bindField(*found, Entry(child), context_));
                continue;
            }
            const auto meant = nearest(child.name(), names);
            report(context_.diagnostics, child.nameSpan(), "E0201",
                   fmt::format("the block of `{}` has no property `{}`", field.name, child.name()),
                   meant.empty() ? "unknown property" : didYouMean(meant))
                .help = "its properties are " + quotedList(names);
        }
    }

    // `at TIME { … }`: one element of a list, with its own fields.
    void moment(const FieldInfo& field, const Node& node) {
        given_.emplace(&field, node.headSpan());
        if (node.damaged()) return;
        const auto time =
            bindMoment(field, node, momentTimes_, context_.tree.headerOf(node.headSpan()), context_.diagnostics);
        void* const owner = params_;
        params_ = owner && time ? field.append(owner, *time, node.headSpan()) : nullptr;
        const auto ownersFields = std::exchange(given_, {});
        settings(field, node);
        given_ = ownersFields;
        params_ = owner;
    }

    void unknown(const Node& node) {
        const std::string_view name = node.name();
        if (name == "at") return reportPlanned("at (deformation)", node.nameSpan(), context_.diagnostics);
        if (isLayerWord(name)) {
            report(context_.diagnostics, node.nameSpan(), "E0232",
                   fmt::format("`{}` belongs at the top level of a file", name), "not in a definition");
            return;
        }
        if (isTransformStep(name) && type_.find("transform")) return looseSteps_.push_back(node);
        auto& d = report(context_.diagnostics, node.nameSpan(), "E0201",
                         fmt::format("{} has no property `{}`", typeTitle(), name), "unknown property");
        if (const FieldInfo* meant = suggestField(type_, name)) {
            const ForeignProperty foreign = translate(type_, *meant, node);
            d.help = foreign.help.empty() ? fmt::format("did you mean {}?", fieldHint(*meant)) : foreign.help;
            if (foreign.certain) d.fixes.push_back({node.nameSpan(), std::string(meant->name)});
            meant_.push_back(meant);
            return;
        }
        std::string advice = adviceFor(type_, name);
        if (advice.empty()) advice = adviceForControl(name);
        if (!advice.empty()) {
            d.help = std::move(advice);
            return;
        }
        for (const TypeInfo* other : context_.table.of(type_.kind))
            if (const FieldInfo* field = other->find(name); field && !field->elsewhere.empty()) {
                d.help = field->elsewhere;
                return;
            }
        std::vector<std::string_view> names;
        for (const FieldInfo& field : type_.fields) names.push_back(field.name);
        d.help = names.empty() ? "it has no properties" : "its properties are " + quotedList(names);
    }

    void looseSteps() {
        if (looseSteps_.empty()) return;
        reportLooseSteps(typeTitle(), looseSteps_, isGiven(*type_.find("transform")), context_.diagnostics);
    }

    std::string typeTitle() const {
        return type_.isDefault ? fmt::format("`{}`", keyword(type_.kind))
                               : fmt::format("`{} {}`", keyword(type_.kind), type_.name);
    }

    // A misspelt property is not also a missing one.
    bool isGiven(const FieldInfo& field) const {
        return given_.contains(&field) || std::ranges::find(meant_, &field) != meant_.end();
    }

    bool groupGiven(std::string_view group) const {
        return std::ranges::any_of(type_.fields, [&](const FieldInfo& f) { return f.group == group && isGiven(f); });
    }

    void required() {
        if (definition_.damaged) return;
        std::vector<std::string_view> reported; // groups
        for (const FieldInfo& field : type_.fields) {
            if (!field.required || isGiven(field)) continue;
            if (field.group.empty()) {
                missing(fmt::format("`{}`", field.name), field);
            } else if (!groupGiven(field.group) && std::ranges::find(reported, field.group) == reported.end()) {
                reported.push_back(field.group);
                std::vector<std::string_view> names;
                for (const FieldInfo& other : type_.fields)
                    if (other.group == field.group) names.push_back(other.name);
                missing(quotedList(names, "or"), field);
            }
        }
    }

    void missing(const std::string& what, const FieldInfo& field) {
        auto& d = report(context_.diagnostics, definition_.span, "E0207",
                         fmt::format("{} needs {}", title(definition_), what), "is missing here");
        if (!field.example.empty()) d.help = fmt::format("for example `{}`", field.example);
    }

    void defaults() {
        for (const FieldInfo& field : type_.fields) {
            if (field.defaultText.empty() || isGiven(field)) continue;
            if (!field.group.empty() && groupGiven(field.group)) continue;
            const auto document = documentOf(field.name, field.defaultText);
            store(field, bindField(field, Entry(*document->roots().begin()), context_));
        }
    }

    const Definition& definition_;
    const TypeInfo& type_;
    const BindContext& context_;
    void* params_;
    bool complete_ = true;
    std::map<const FieldInfo*, Span> given_;
    std::map<std::string_view, std::pair<const FieldInfo*, Span>> groups_; // the first given field of each group
    std::map<std::pair<const FieldInfo*, std::string_view>, Span> keyed_;
    std::map<const FieldInfo*, double> momentTimes_; // of the last moment of each
    std::vector<const FieldInfo*> meant_;            // by misspelt properties
    std::vector<Node> looseSteps_;                   // of a transform, without its block
};

// The type is unknown, but what every type of the kind would refuse is wrong all the same.
class UntypedBinding {
  public:
    UntypedBinding(const Definition& definition, const BindContext& context)
        : definition_(definition), context_(context) {}

    void run() {
        if (!definition_.damaged && !definition_.arguments.empty()) {
            const Value argument = definition_.arguments[0];
            const Entry entry(keyword(definition_.kind), place(argument), {argument});
            check(entry, [](const FieldInfo& field) { return field.argument == 0; });
        }
        for (const Node& node : definition_.properties)
            if (!isPrivate(node.name()) && !node.damaged())
                check(Entry(node), [&](const FieldInfo& field) { return field.name == node.name(); });
    }

  private:
    template <typename Matches> void check(const Entry& entry, Matches matches) {
        Diagnostics first;
        bool any = false;
        for (const TypeInfo* type : context_.table.of(definition_.kind))
            for (const FieldInfo& field : type->fields) {
                if (!matches(field)) continue;
                if (isReference(field)) { // alike in every type, and built only once
                    bindField(field, entry, context_);
                    return;
                }
                Diagnostics found;
                bindField(field, entry, {context_.tree, context_.table, context_.resolver, found});
                if (!found.hasErrors()) return;
                if (!any) first = std::move(found);
                any = true;
            }
        for (const Diagnostic& d : first.all()) context_.diagnostics.add(d);
    }

    const Definition& definition_;
    const BindContext& context_;
};

// Whether a syntax error took something out of a node or of what is in it.
bool isDamaged(const Node& node) {
    if (node.damaged()) return true;
    for (const Node child : node.children())
        if (isDamaged(child)) return true;
    return false;
}

} // namespace

bool bind(const Definition& definition, const SceneTree& tree, const TypeTable& table, Resolver& resolver, void* params,
          Diagnostics& diagnostics) {
    const std::size_t before = diagnostics.errorCount();
    const BindContext context{tree, table, resolver, diagnostics};
    if (!definition.type) UntypedBinding(definition, context).run();
    const bool complete = definition.type && Binding(definition, context, params).run();
    if (diagnostics.errorCount() != before || !definition.type || (!complete && diagnostics.hasErrors())) return false;
    // Most scenes have no fault of syntax, and some have a million nodes.
    return !tree.damaged || (!definition.damaged && std::ranges::none_of(definition.properties, isDamaged));
}

namespace {

Value parseValue(std::string_view word) {
    Value value;
    value.text = word;
    value.kind = ValueKind::word;
    if (word.size() > 1 && word.front() == '"' && word.back() == '"') {
        value.kind = ValueKind::string;
        value.text = word.substr(1, word.size() - 2);
        return value;
    }
    double number = 0;
    const auto [stop, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    const bool digits = word.find_first_of("0123456789") != std::string_view::npos; // not `inf`
    if (error == std::errc() && stop == word.data() + word.size() && digits) {
        value.kind = ValueKind::number;
        value.number = number;
    }
    return value;
}

} // namespace

std::unique_ptr<Document> documentOf(std::string_view name, std::string_view text) {
    auto document = std::make_unique<Document>();
    Document::NodeRecord node;
    node.name = document->intern(std::string(name));
    std::string_view rest = document->intern(std::string(text));
    while (true) {
        const auto start = rest.find_first_not_of(' ');
        if (start == std::string_view::npos) break;
        rest.remove_prefix(start);
        const auto end = rest.find(' ');
        document->values.push_back(parseValue(rest.substr(0, end)));
        ++node.valueCount;
        if (end == std::string_view::npos) break;
        rest.remove_prefix(end);
    }
    document->nodes.push_back(node);
    return document;
}

} // namespace abbe::schema
