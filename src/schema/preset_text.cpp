#include "schema/preset_library.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe::schema {

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
