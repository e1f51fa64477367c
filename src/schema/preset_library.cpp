#include "schema/preset_library.h"

#include "schema/definition_reader.h"
#include "schema/entry.h"
#include "schema/suggest.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::schema {

namespace {

constexpr std::string_view kWord = "preset";

// The text of a private node `name "text"` among the children, or empty.
std::string_view privateText(const NodeRange& nodes, std::string_view name) {
    for (const Node node : nodes)
        if (node.name() == name && node.valueCount() > 0) return node.value(0).text;
    return {};
}

bool isPrivate(const Node& node) { return node.name().starts_with("x-"); }

void unknownPreset(const Definition& d, const Value& word, const PresetLibrary& library, Diagnostics& diagnostics) {
    std::vector<std::string_view> names;
    for (const Preset& preset : library.all())
        if (preset.kind == d.kind) names.push_back(preset.name);
    const auto meant = nearest(word.text, names);
    const Kind other = d.kind == Kind::material ? Kind::medium : Kind::material;
    std::string label = meant.empty() ? "unknown name" : didYouMean(meant);
    if (library.find(other, word.text)) label = fmt::format("this is a {} of the library", keyword(other));
    reportAt(diagnostics, word, "E0771", fmt::format("the library has no {} `{}`", keyword(d.kind), word.text), label)
        .help = "`abbe explain presets` lists them";
}

// The definition that `preset NAME` stands for; nothing after a diagnostic.
const Preset* named(const Definition& d, const PresetLibrary* library, Diagnostics& diagnostics) {
    if (d.arguments.empty() || !d.arguments[0].isText()) {
        report(diagnostics, d.arguments.empty() ? d.nameSpan : place(d.arguments[0]), "E0770",
               fmt::format("`preset` needs the name of a {} of the library", keyword(d.kind)),
               "write it behind the word")
            .help = "`abbe explain presets` lists them";
        return nullptr;
    }
    if (d.arguments.size() > 1)
        reportAt(diagnostics, d.arguments[1], "E0306", "`preset` takes one name", "unexpected").help =
            "what shall differ stands in the block: `preset gold { roughness 0.3 }`";
    static const PresetLibrary none;
    const PresetLibrary& presets = library ? *library : none;
    const Preset* const found = presets.find(d.kind, d.arguments[0].text);
    if (!found) unknownPreset(d, d.arguments[0], presets, diagnostics);
    return found;
}

// True if the definition itself says what the library's property `name` says.
bool isReplaced(const Definition& d, const TypeInfo& type, std::string_view name) {
    const auto states = [&](std::string_view given) {
        if (given == name) return true;
        const FieldInfo* const mine = type.find(given);
        const FieldInfo* const theirs = type.find(name);
        return mine && theirs && !mine->group.empty() && mine->group == theirs->group;
    };
    return std::ranges::any_of(d.properties, [&](const Node& node) { return states(node.name()); }) ||
           std::ranges::any_of(d.keys, [&](const Key& key) { return states(key.name); });
}

} // namespace

void PresetLibrary::add(std::shared_ptr<const Document> document) {
    const std::string_view group = privateText(document->roots(), "x-group");
    for (const Node node : document->roots()) {
        const auto kind = findKind(node.name());
        if ((kind != Kind::material && kind != Kind::medium) || node.valueCount() < 2) continue;
        presets_.push_back({*kind, node.value(0).text, privateText(node.children(), "x-doc"),
                            privateText(node.children(), "x-source"), group, node, document->source});
    }
    documents_.push_back(std::move(document));
}

const Preset* PresetLibrary::find(Kind kind, std::string_view name) const {
    const auto found =
        std::ranges::find_if(presets_, [&](const Preset& p) { return p.kind == kind && p.name == name; });
    return found == presets_.end() ? nullptr : &*found;
}

TypeInfo presetType(Kind kind) {
    const bool material = kind == Kind::material;
    return {.kind = kind,
            .name = kWord,
            .doc = material ? "A material of the library, by name; what the block says replaces what the library says."
                            : "A medium of the library, by name; what the block says replaces what the library says.",
            .example = material ? "material ring preset gold { roughness 0.3 }" : "medium drink preset milk",
            .fields = {}};
}

bool isPreset(const TypeInfo* type) { return type && type->name == kWord; }

void expandPreset(Definition& d, const TypeTable& table, Diagnostics& diagnostics) {
    const Preset* const preset = named(d, table.presets(), diagnostics);
    d.type = nullptr;
    d.arguments.clear();
    if (!preset) return;
    std::vector<Definition> read;
    DefinitionReader(table, diagnostics).read(preset->definition, read, Place::top);
    if (read.empty() || !read[0].type) return;
    const Definition& library = read[0];
    d.type = library.type;
    d.arguments = library.arguments;
    std::vector<Node> properties;
    for (const Node& node : library.properties)
        if (!isPrivate(node) && !isReplaced(d, *d.type, node.name())) properties.push_back(node);
    properties.insert(properties.end(), d.properties.begin(), d.properties.end());
    d.properties = std::move(properties);
}

namespace {

// The definition as it stands in the library.
std::string_view textOf(const Preset& preset) {
    const Span span = preset.definition.span();
    return preset.text.substr(span.begin, span.end - span.begin);
}

} // namespace

std::string presetListText(const PresetLibrary& library) {
    std::string text = "The library of materials and media: `material ring preset gold { roughness 0.3 }`.\n";
    std::size_t width = 0;
    for (const Preset& preset : library.all()) width = std::max(width, preset.name.size());
    std::string_view group;
    for (const Preset& preset : library.all()) {
        if (preset.group != group) text += fmt::format("{}\n", group = preset.group);
        text += fmt::format("  {:<{}}  {:<8}  {}\n", preset.name, width, keyword(preset.kind), preset.doc);
    }
    return text;
}

std::string presetText(const PresetLibrary& library, std::string_view name) {
    std::string text;
    for (const Preset& preset : library.all()) {
        if (preset.name != name) continue;
        text +=
            fmt::format("{} preset {}\n  {}\n  Source: {}\n", keyword(preset.kind), name, preset.doc, preset.source);
        text += fmt::format("{}\n", textOf(preset));
    }
    return text;
}

std::string presetMarkdown(const PresetLibrary& library) {
    std::string text = R"(# The library of materials

Made by `abbe explain library > docs/materials_library.md`; the definitions are in `materials/library/`.

```kdl
material ring preset gold
material worn preset gold { roughness 0.4 }
shape bust mesh "bust.obj" { material preset marble }
shape drink mesh "drink.obj" { material dielectric { ior 0.882 }; interior preset milk }
```

What the block says replaces what the library says. Materials are complete. Where the table has a medium, too, that is what the
material has inside, for the `interior` of a shape with a surface of its own: milk in a glass.
`abbe explain presets` lists them, `abbe explain gold` shows one with its figures. Where no measurement is named, the
figures are approximate, and say so.

![One ball of each](images/materials.png)

`tools/contact_sheet.sh` renders this sheet: `scenes/shader-ball` with each of them, balls of 10 cm across.
)";
    std::string_view group;
    for (const Preset& preset : library.all()) {
        if (preset.group != group)
            text += fmt::format("\n## {}\n\n| name | | what | source |\n|---|---|---|---|\n", group = preset.group);
        text += fmt::format("| `{}` | {} | {} | {} |\n", preset.name, keyword(preset.kind), preset.doc, preset.source);
    }
    return text;
}

} // namespace abbe::schema
