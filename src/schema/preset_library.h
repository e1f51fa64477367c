// Definitions that come with the program, taken by name: `material ring preset gold { roughness 0.3 }`.
#pragma once

#include "schema/scene_tree.h"

#include <span>

namespace abbe::schema {

// One definition of the library. Its texts are private nodes of the definition itself.
struct Preset {
    Kind kind = Kind::material;
    std::string_view name;
    std::string_view doc;    // `x-doc`: what it is, one line
    std::string_view source; // `x-source`: where its figures come from
    std::string_view group;  // `x-group` of its file: "Metals"
    Node definition;
    std::string_view text; // of the whole file, to show the definition
};

// Made once, before the first scene is resolved; immutable afterwards.
class PresetLibrary {
  public:
    // A file of the library: named materials and media, which name nothing outside of themselves, and one `x-group`
    // for their heading. Their order is kept. Nodes of other kinds are left out.
    void add(std::shared_ptr<const Document>);

    const Preset* find(Kind, std::string_view name) const;
    std::span<const Preset> all() const { return presets_; }

  private:
    std::vector<std::shared_ptr<const Document>> documents_;
    std::vector<Preset> presets_;
};

// The type `preset` of a kind: a row of the TypeTable that no definition keeps once it has been read.
TypeInfo presetType(Kind);
bool isPreset(const TypeInfo*);

// Puts the library's definition in the place of `preset NAME`: its type, and those of its properties that the
// definition does not give itself. A property also replaces what else
// states the same (the fields of its group). The definition keeps its name and its spans. Without such a preset the
// type is null, after a diagnostic. Requires: isPreset(definition.type).
void expandPreset(Definition&, const TypeTable&, Diagnostics&);

// For `abbe explain`: the list of all presets, and one of them (empty if there is none).
std::string presetListText(const PresetLibrary&);
std::string presetText(const PresetLibrary&, std::string_view name);
// docs/materials_library.md.
std::string presetMarkdown(const PresetLibrary&);

} // namespace abbe::schema
