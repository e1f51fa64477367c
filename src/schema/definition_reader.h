// From nodes to the header of a file and to definitions with their types.
#pragma once

#include "schema/entry.h"
#include "schema/scene_tree.h"

#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace abbe::schema {

// The first line of a file: `scene 1 length=mm rgb=acescg up=y`.
inline bool isHeader(const Node& node) { return node.name() == "scene"; }

// Reads and checks the header; a missing one means edition 1 and a warning.
Header readHeader(const Document&, Diagnostics&);

// The spaces that a message offers: "`lin_rec709_scene`, …".
std::string rgbSpaceList();
// Every word that names one, the identifiers first.
std::vector<std::string_view> rgbSpaceWords();

// Reads the value of a `space=` or `rgb=` key; nothing after a diagnostic.
std::optional<RgbSpaceName> readRgbSpace(const Value&, Diagnostics&);

// Steps of a transform that stand outside of its block: `rotate y 45 deg` as a property.

// translate, rotate, scale, matrix, look-at
std::span<const std::string_view> transformSteps();
bool isTransformStep(std::string_view word);

// One error for all such steps of `owner` ("`shape sphere`"), which are not empty, with the block that holds them.
// `given`: there is a transform already.
void reportLooseSteps(std::string_view owner, const std::vector<Node>& steps, bool given, Diagnostics&);

// `kind [name] type [arguments] { … }`

enum class Place : std::uint8_t { top, group }; // group: inside of a `group` or `object`

// Reads definitions; whatever is wrong with a head is reported, and the definition kept with what is known of it, so
// that its block can still be checked.
class DefinitionReader {
  public:
    // All names are read with the prefix in front.
    DefinitionReader(const TypeTable& table, Diagnostics& diagnostics, std::string prefix = {})
        : table_(table), diagnostics_(diagnostics), prefix_(std::move(prefix)) {}

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
    const std::string prefix_;
};

// Words that the language reserves and this version does not implement: they are located errors (E0206).
void reportPlanned(std::string_view word, Span, Diagnostics&);

} // namespace abbe::schema
