// The meaning layer: definitions with their types resolved against the TypeTable, ready to be bound to structs.
#pragma once

#include "base/diagnostic.h"
#include "math/motion.h"
#include "schema/document.h"
#include "schema/type.h"

#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace abbe {
struct RgbSpace;
}

namespace abbe::schema {

// Colour space of `rgb` values; ids are those of the Color Interop Forum.
enum class RgbSpaceName : std::uint8_t { linRec709, linRec2020, linP3D65, linAp1, linAp0 };
std::optional<RgbSpaceName> findRgbSpace(std::string_view idOrAlias);
std::string_view rgbSpaceId(RgbSpaceName);
const RgbSpace& rgbSpace(RgbSpaceName);

class ParameterScopes;

// `scene 1 length=mm rgb=acescg up=y`, and what else holds for the texts of a scene.
struct Header {
    int edition = 1;
    double length = 1; // metres per unit of a bare length
    RgbSpaceName rgb = RgbSpaceName::linRec709;
    bool zUp = false; // rotate the scene so that z is up
    Span span;
    // The parameters that texts in the place of numbers may name; null: none.
    std::shared_ptr<const ParameterScopes> parameters = nullptr;
};

// `kind [name] type [arguments] { properties }`, named or inline in a slot.
struct Definition {
    Kind kind = Kind::shape;
    std::string name;                 // empty: unnamed
    Span nameSpan;                    // of the name, else of the keyword
    Span span;                        // of the head
    const TypeInfo* type = nullptr;   // null for containers, placements, spectra, and after an unknown type
    std::vector<Value> arguments;     // after the type word; spectrum: everything after the name
    std::vector<Key> keys;            // key=value after the arguments
    bool damaged = false;             // a syntax error took something out of the head
    bool removed = false;             // by a layer that stands behind it; soon gone
    std::vector<Node> properties;     // everything in the block that is not a nested definition
    std::vector<Definition> children; // nested definitions of group and object
    std::string target;               // what instance, instances (an object) and atmosphere (a medium) place
    Span targetSpan;
};

// Named definitions in sorted order, for SceneTree::find. A copied tree starts without one and searches linearly.
struct NameIndex {
    NameIndex() = default;
    NameIndex(const NameIndex&) noexcept {}
    NameIndex(NameIndex&&) noexcept = default;
    NameIndex& operator=(const NameIndex&) noexcept { return *this = NameIndex(); }
    NameIndex& operator=(NameIndex&&) noexcept = default;
    std::vector<const Definition*> sorted;
    bool filled = false;              // a scene without names has an empty one
    mutable std::size_t compared = 0; // letters, by SceneTree::nearestName
};

// A file that a definition names, as it was found.
struct NamedFile {
    Span span;                                      // of the name; that of a parameter's value where `$name` stood
    std::string written;                            // as it stands there
    std::filesystem::path path;                     // with `<UDIM>` for its tiles
    std::vector<std::filesystem::path> beside = {}; // files that this one names and that are read with it
};

// A text that stands in a scene beside its own, with the meaning of bare numbers and the folder of files in it.
struct Insert {
    std::shared_ptr<const Document> document;
    Header header;
    std::filesystem::path directory;
    std::string source;      // the file that it is, or that the text was made of
    bool written = false;    // a file of the scene (`include`, `--set`), and not made of a model
    std::string prefix = {}; // of the names in it, those that it defines and those that it refers to: "car:"
    Span includer = {};      // the name in the `include` node that brings it in, or nowhere
};

// Adds those of `found` from the first `known` on, each with the chain of files that led to where it stands.
struct SceneTree;
void addWithIncluders(const SceneTree&, const Diagnostics& found, std::size_t known, Diagnostics& to);

// A variant that a file of the scene defines.
struct VariantName {
    std::string name; // with the prefix of its file
    Span span;        // of the name
    bool chosen = false;
};

// Everything that a scene defines, from its file and those that it includes. Holds views into the documents.
struct SceneTree {
    Header header;
    std::vector<Definition> definitions;
    std::filesystem::path directory; // files are looked up here
    std::shared_ptr<const Document> document;
    std::optional<int> frame; // of an animation, whose moment is shown
    // Made by resolve(), filled by bind(): after a scene was built all that it names, some perhaps several times.
    // Those in inserted texts are not among them: what made the text knows what that depends on.
    std::shared_ptr<std::vector<NamedFile>> namedFiles;
    std::map<FileId, Insert> inserts; // by the file of their text
    std::filesystem::path made;       // the folder that holds the files that were made for them, or empty
    NameIndex index;                  // filled by resolve()
    bool damaged = false;             // a syntax error took something out of a node
    // What is in force of all files, in order: headers, definitions, overrides, removals, and those of chosen variants.
    std::vector<Node> statements;
    std::vector<NamedFile> includes;                      // the files of `include` nodes
    std::vector<VariantName> variants;                    // in the order of the files
    std::vector<std::string> chosen;                      // variants that the command line chose, in its order
    std::map<std::pair<Kind, std::string>, Span> removed; // where names were removed
    // Parameters of included files that the command line set, by their names from here: "car:turn".
    std::vector<std::pair<std::string, std::vector<Value>>> given;

    // What holds for the text at a place: that of an insert, or of the scene.
    const Header& headerOf(Span) const;
    const std::filesystem::path& directoryOf(Span) const;
    // Whether the text there is of no file: a value of `-D` or a line of `--set`.
    bool isOfCommandLine(Span) const;

    // The first definition of that name, nested ones included.
    const Definition* find(Kind, std::string_view name) const;
    // The whole name of what the text at a place calls `name`: in a file that is included `as=car` it begins `car:`.
    std::string fullName(Span at, std::string_view name) const;
    const Definition* find(Kind, std::string_view name, Span at) const;
    // Says where a name was removed that is now unknown.
    void noteRemoved(Kind, std::string_view name, Span at, Diagnostic&) const;

    // What is compared with names for suggestions, in all: about a second. More unknown names are reported without one.
    static constexpr std::size_t kMostCompared = 10'000'000;
    // The nearest name (see nearest) of a definition of one of the kinds; nothing once kMostCompared is spent.
    // Requires: the index is filled.
    std::string_view nearestName(std::span<const Kind>, std::string_view word) const;
    // The same for what the text at a place calls `word`; the name as it is called there, so without the prefix.
    std::string_view nearestName(std::span<const Kind>, std::string_view word, Span at) const;
};

// The spectrum values of the language, as written and checked for arity and units, not yet a curve.
struct SpectrumValue {
    enum class Form : std::uint8_t {
        flat,       // numbers = {value}
        rgb,        // numbers = {r, g, b} linear in `space`
        table,      // numbers = {nm, value, nm, value, …}; a file has been read into it
        blackbody,  // numbers = {kelvin}
        illuminant, // text = name
        line,       // numbers = {nm} (a monochromatic line)
        measured,   // text = name of a measured spectrum
        glass,      // text = name of a dispersive index
        metal,      // text = name; the real part n when used as a curve
        sellmeier,  // numbers = {B1, C1, B2, C2, B3, C3}, C in µm²
        cauchy,     // numbers = {A, B, …}: A + B/λ² + C/λ⁴, λ in µm
    };
    Form form = Form::flat;
    std::vector<double> numbers;
    std::string text;
    RgbSpaceName space = RgbSpaceName::linRec709;
    Span span;
};

// A texture in the place of a spectrum or a number.
struct TextureRequest {
    const Definition& definition;     // named or inline
    std::optional<SpectrumRole> role; // of the spectrum; nothing: a number
    Span span;                        // of the name or type
};

// What binding needs from the scene that is being built.
class Resolver {
  public:
    virtual ~Resolver() = default;
    // The curve of a value in a role; null after a diagnostic (the field then stays unset).
    virtual const Curve* curve(const SpectrumValue&, SpectrumRole, Diagnostics&) = 0;
    // n and k of a metal by name; both null after a diagnostic.
    virtual ComplexIndex metal(std::string_view name, Span, Diagnostics&) = 0;
    // The index of a definition, building it first if need be; invalid after a diagnostic. An unnamed definition is an
    // inline one: it lives only during the call, so its address must not be remembered. A definition with an unknown
    // type (type == nullptr) has been reported already.
    virtual Reference reference(const Definition&, Diagnostics&) = 0;
    // The texture of a definition, built like other definitions; null after a diagnostic.
    virtual const Texture* texture(const TextureRequest&, Diagnostics&) = 0;
};

// First pass over the files of a scene: headers, kinds, names, types, layers. Unknown words are errors with a
// suggestion, names are unique per kind, missing types get the kind's default. `complete` may change the definitions
// before names are checked.
struct LayerFiles;
SceneTree resolve(const LayerFiles&, const TypeTable&, Diagnostics&,
                  const std::function<void(SceneTree&)>& complete = {});
// The same for a scene of one document, which includes nothing.
SceneTree resolve(std::shared_ptr<const Document>, const TypeTable&, std::filesystem::path directory, Diagnostics&,
                  const std::function<void(SceneTree&)>& complete = {});

// The definitions of a text that becomes part of the tree; where they stand in it is up to the caller.
std::vector<Definition> readInsert(SceneTree&, Insert, const TypeTable&, Diagnostics&);

// Second pass: checks every property and argument of one definition against its type (names, units, ranges, arity,
// groups, required ones, existing files) and stores what is given, and the defaults, into `params`. A definition whose
// type is unknown is bound with params == nullptr: what is wrong in every type of its kind is still reported. False if
// anything was wrong, with a diagnostic here or, where a syntax error took something out, an earlier one: `params` are
// not to be used then.
bool bind(const Definition&, const SceneTree&, const TypeTable&, Resolver&, void* params, Diagnostics&);

// Words as a field of that type has them; nothing after an error.
std::optional<Words> bindWords(const FieldInfo&, const Node& property, const SceneTree&, Diagnostics&);

// The transform of a `transform { … }` block, top to bottom as applied to the object, or its keys `at TIME { … }`; the
// identity after an error.
// True if the block has keys.
bool hasKeys(const Node& block);
KeyedTransform bindMotion(const Node& block, const Header&, Diagnostics&);
// The same where nothing can move: keys are an error.
Transform bindTransform(const Node& block, const Header&, Diagnostics&);

// The names offered by `did you mean`: the nearest candidate within a third of the word's length, or empty.
std::string_view nearest(std::string_view word, const std::vector<std::string_view>& candidates);

} // namespace abbe::schema
