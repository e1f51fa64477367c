#include "language_server/analysis.h"

#include "base/enclosure.h"
#include "parser/layer_files.h"
#include "parser/presets.h"
#include "scene/registry.h"
#include "schema/definition_reader.h"
#include "schema/layers.h"
#include "schema/preset_library.h"
#include "spectrum/named_spectra.h"

#include <algorithm>

namespace abbe::lsp {

using schema::FieldInfo;
using schema::FieldType;
using schema::Kind;
using schema::Node;
using schema::TypeInfo;
using schema::Value;

Language::Language() : types(makeTypeTable()) {
    Diagnostics diagnostics; // the library has no faults
    addPresets(types, sources, diagnostics);
}

Analysis::Analysis(const Language& language, const std::filesystem::path& path, std::string text,
                   const Workspace* workspace)
    : language_(language), file_(sources_.add(path.string(), std::move(text))) {
    if (!workspace) {
        read(path, {});
        return;
    }
    read(path, [&](SourceMap& sources, const std::filesystem::path& file, Diagnostics& found) {
        included_.emplace_back(file, workspace->stampOf(file));
        return workspace->read(sources, file, found);
    });
}

Analysis::Analysis(const Language& language, const std::filesystem::path& path, const Workspace& workspace,
                   const std::map<std::filesystem::path, std::string>& texts)
    : language_(language), file_() {
    const auto given = [&](SourceMap& sources, const std::filesystem::path& file, Diagnostics& found) {
        const auto text = texts.find(realPathOf(file));
        return text == texts.end() ? workspace.read(sources, file, found)
                                   : std::optional(sources.add(file.string(), text->second));
    };
    const auto own = given(sources_, path, diagnostics_);
    file_ = own ? *own : sources_.add(path.string(), {});
    read(path, given);
}

void Analysis::read(const std::filesystem::path& path, const Reader& reader) {
    LayerOptions options;
    options.read = reader;
    const FileReach reach(path.parent_path(), {});
    const schema::LayerFiles files = readLayerFiles(sources_, file_, path, options, diagnostics_);
    document_ = files.files.front().document;
    syntaxErrors_ = std::ranges::any_of(diagnostics_.all(), [&](const Diagnostic& d) {
        return d.severity == Severity::error && d.code.starts_with("E01") && d.span.file == file_;
    });
    tree_ = schema::resolve(files, language_.types, diagnostics_);
}

bool Analysis::isCurrent(const Workspace& workspace) const {
    return std::ranges::all_of(included_,
                               [&](const auto& file) { return workspace.stampOf(file.first) == file.second; });
}

const TextLines& Analysis::lines(FileId file) const {
    const auto found = lines_.find(file);
    return found != lines_.end() ? found->second : lines_.emplace(file, TextLines(sources_.text(file))).first->second;
}

const FieldInfo* Scope::find(std::string_view property) const {
    const auto found = std::ranges::find(fields, property, &FieldInfo::name);
    return found == fields.end() ? nullptr : &*found;
}

bool isContainer(Kind kind) { return kind == Kind::group || kind == Kind::object; }

bool isTyped(Kind kind) {
    return !isContainer(kind) && kind != Kind::instance && kind != Kind::instances && kind != Kind::atmosphere &&
           kind != Kind::spectrum;
}

std::optional<Kind> namedBy(const FieldInfo& field, std::string_view key) {
    if (key == "camera") return Kind::camera;
    if (key == "on" && field.type == FieldType::place) return Kind::shape;
    if (key.empty() && field.name == "over" && field.type == FieldType::text) return Kind::shape;
    return std::nullopt;
}

std::vector<std::string_view> dataNames(std::string_view form) {
    if (form == "illuminant") return illuminantNames();
    if (form == "measured") return measuredNames();
    if (form == "glass") return glassNames();
    return form == "metal" ? metalNames() : std::vector<std::string_view>{};
}

std::vector<Value> writtenValues(const Node& node) {
    std::vector<Value> values;
    const std::size_t count = node.allNumbers() ? 1 : node.valueCount();
    for (std::size_t i = 0; i < count; ++i) {
        const Value value = node.value(i);
        if (value.use.valid() && !values.empty() && values.back().use == value.use) continue;
        values.push_back(value);
    }
    return values;
}

namespace {

// `transform` and `visible-to`, which groups, objects and instances take as shapes do.
std::span<const FieldInfo> placementFields(const schema::TypeTable& types) {
    static const std::vector<FieldInfo> fields = [&] {
        std::vector<FieldInfo> found;
        const TypeInfo* const sphere = types.find(Kind::shape, "sphere");
        for (const std::string_view name : {"transform", "visible-to"})
            if (const FieldInfo* const field = sphere ? sphere->find(name) : nullptr) found.push_back(*field);
        return found;
    }();
    return fields;
}

Scope nothingIn(std::string_view title) {
    Scope scope;
    scope.place = Scope::Place::nothing;
    scope.title = title;
    return scope;
}

Scope fieldsOf(Kind kind, const TypeInfo* type, std::string_view title) {
    if (!type) return nothingIn(title);
    Scope scope;
    scope.place = Scope::Place::fields;
    scope.kind = kind;
    scope.type = type;
    scope.fields = type->fields;
    scope.title = title;
    return scope;
}

Scope definitionScope(const Node& node, const Language& language) {
    const auto kind = schema::findKind(node.name());
    if (!kind || *kind == Kind::atmosphere || *kind == Kind::spectrum) {
        Scope scope = nothingIn(node.name());
        if (kind == Kind::spectrum) scope.place = Scope::Place::rows; // of a table
        return scope;
    }
    if (isContainer(*kind) || *kind == Kind::instance) {
        Scope scope;
        scope.place = isContainer(*kind) ? Scope::Place::container : Scope::Place::fields;
        scope.kind = *kind;
        scope.fields = placementFields(language.types);
        scope.title = node.name();
        return scope;
    }
    if (*kind == Kind::instances) return fieldsOf(*kind, language.types.defaultOf(*kind), node.name());
    Diagnostics ignored;
    std::vector<schema::Definition> read;
    schema::DefinitionReader(language.types, ignored).read(node, read, schema::Place::top);
    return fieldsOf(*kind, read.empty() ? nullptr : read[0].type, node.name());
}

Scope blockOf(const FieldInfo& field, Scope::Place place) {
    Scope scope;
    scope.place = place;
    scope.fields = field.block;
    scope.owner = &field;
    scope.title = field.name;
    return scope;
}

} // namespace

Scope Analysis::inlineScope(Kind kind, const Node& node, std::size_t word) const {
    if (node.valueCount() <= word || !node.value(word).isText())
        return fieldsOf(kind, language_.types.defaultOf(kind), keyword(kind));
    const TypeInfo* type = language_.types.find(kind, node.value(word).text);
    if (schema::isPreset(type) && language_.types.presets() && node.valueCount() > word + 1) {
        schema::Definition definition;
        definition.kind = kind;
        definition.type = type;
        definition.arguments = {node.value(word + 1)};
        Diagnostics ignored;
        expandPreset(definition, language_.types, ignored);
        type = definition.type;
    }
    return fieldsOf(kind, type, keyword(kind));
}

// An `override` holds properties of what it changes, a variant holds statements of a file.
Scope Analysis::layerScope(const Node& node) const {
    Scope scope = nothingIn(node.name());
    if (node.name() == "variant") scope.place = Scope::Place::file;
    if (node.name() != "override" || node.valueCount() == 0 || !node.value(0).isText()) return scope;
    const auto kind = schema::findKind(node.value(0).text);
    if (!kind) return scope;
    const Value name = node.valueCount() > 1 ? node.value(1) : Value{};
    const schema::Definition* changed = nullptr;
    if (name.isText())
        changed = tree_.find(*kind, name.text, name.span);
    else if (const auto only = std::ranges::find(tree_.definitions, *kind, &schema::Definition::kind);
             only != tree_.definitions.end())
        changed = &*only;
    if (isContainer(*kind)) {
        scope.place = Scope::Place::container;
        scope.kind = *kind;
        scope.fields = placementFields(language_.types);
        return scope;
    }
    return fieldsOf(*kind, changed ? changed->type : language_.types.defaultOf(*kind), node.name());
}

Scope Analysis::scopeOf(const Scope& outer, const Node& node) const {
    if (node.name().starts_with("x-")) return nothingIn(node.name());
    switch (outer.place) {
    case Scope::Place::file:
        return schema::isLayerWord(node.name()) ? layerScope(node) : definitionScope(node, language_);
    case Scope::Place::container:
        if (!outer.find(node.name())) return definitionScope(node, language_);
        break;
    case Scope::Place::steps: // `at TIME { … }`
        return node.name() == "at" ? outer : blockOf(*outer.owner, Scope::Place::rows);
    case Scope::Place::fields:
        break;
    default:
        return nothingIn(node.name());
    }
    const FieldInfo* const field = outer.find(node.name());
    if (!field) return nothingIn(node.name());
    switch (field->type) {
    case FieldType::transform:
        return blockOf(*field, Scope::Place::steps);
    case FieldType::complexIndex:
        return blockOf(*field, Scope::Place::spectra);
    case FieldType::reference:
    case FieldType::weighted:
        return inlineScope(field->referenceKind, node, 0);
    default:
        break;
    }
    const std::size_t word = field->type == FieldType::stop ? 1 : 0;
    const bool texture = (field->texturable || field->type == FieldType::stop) && node.valueCount() > word &&
                         !node.allNumbers() && node.value(word).isText() &&
                         language_.types.find(Kind::texture, node.value(word).text);
    if (texture) return inlineScope(Kind::texture, node, word);
    return blockOf(*field, field->block.empty() ? Scope::Place::rows : Scope::Place::fields);
}

const Meaning* Analysis::meaningAt(std::size_t offset) const {
    const auto& all = meanings();
    const auto after = std::ranges::upper_bound(all, offset, {}, [](const Meaning& m) { return m.span.begin; });
    for (auto m = after; m != all.begin() && after - m < 4;) { // of words that touch, the one that begins here
        --m;
        if (m->span.begin <= offset && offset <= m->span.end) return &*m;
    }
    return nullptr;
}

std::optional<Subject> Analysis::subjectOf(const Meaning& m) const {
    const bool parameter = m.sense == Sense::parameter || m.sense == Sense::parameterUse;
    if (!parameter && m.sense != Sense::name && m.sense != Sense::reference) return std::nullopt;
    const std::string name = m.as.empty() ? std::string(m.text) : std::string(m.as) + ":" + std::string(m.text);
    return Subject{parameter, parameter ? Kind::shape : m.kind, tree_.fullName(m.span, name)};
}

std::vector<Meaning> Analysis::occurrences(const Subject& subject) const {
    std::vector<Meaning> found;
    for (const auto part : allMeanings())
        for (const Meaning& m : part) {
            const bool parameter = m.sense == Sense::parameter || m.sense == Sense::parameterUse;
            if (parameter != subject.parameter || !subject.name.ends_with(m.text)) continue;
            if (subjectOf(m) == subject) found.push_back(m);
        }
    return found;
}

std::vector<Meaning> Analysis::occurrences(const Meaning& of) const {
    const auto subject = subjectOf(of);
    return subject ? occurrences(*subject) : std::vector<Meaning>{};
}

} // namespace abbe::lsp
