// `kind [name] type [arguments] { … }`: from nodes to definitions with their types.
#pragma once

#include "schema/scene_tree.h"

namespace abbe::schema {

enum class Place : std::uint8_t { top, group }; // group: inside of a `group` or `object`

// Reads definitions; whatever is wrong with a head is reported, and the definition kept with what is known of it, so
// that its block can still be checked.
class DefinitionReader {
  public:
    DefinitionReader(const TypeTable& table, Diagnostics& diagnostics) : table_(table), diagnostics_(diagnostics) {}

    void read(const Node&, std::vector<Definition>& out, Place) const;

    // The inline definition of a slot: `material dielectric { … }`. Nothing after a diagnostic.
    std::optional<Definition> readInline(Kind, const Node& property) const;

    // Reports an unknown type `word`; the types of the kind are offered.
    void unknownType(Kind, const Value& word) const;

  private:
    void unknownKind(const Node&) const;
    std::size_t nameAndType(const Node&, Definition&) const;
    void typedHead(const Node&, Definition&) const;
    void missingType(Definition&, const Value* word) const;
    void spectrumHead(const Node&, Definition&) const;
    void containerHead(const Node&, Definition&) const;
    void containerBlock(const Node&, Definition&) const;
    void setName(Definition&, const Value&) const;

    const TypeTable& table_;
    Diagnostics& diagnostics_;
};

// Words that the language reserves and this version does not implement: they are located errors (E0206).
bool isPlanned(std::string_view word);
void reportPlanned(std::string_view word, Span, Diagnostics&);

} // namespace abbe::schema
