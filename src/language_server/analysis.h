// A text as the language understands it: its tree, and what each word of it means. Completion, hover and navigation
// read this; what is wrong with a scene is found elsewhere (checking.h), as it may take long.
#pragma once

#include "base/diagnostic.h"
#include "language_server/protocol.h"
#include "language_server/workspace.h"
#include "schema/scene_tree.h"

#include <array>
#include <filesystem>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace abbe::lsp {

// The types of all kinds, with the library of presets. Made once.
struct Language {
    Language();
    SourceMap sources; // of the library
    schema::TypeTable types;
};

// What a word of a text is.
enum class Sense : std::uint8_t {
    kind,         // `shape`, `scene`
    type,         // `sphere`
    name,         // of a definition, where it is defined
    property,     // `radius`; also a step of a transform and a part of a block
    key,          // `space=`
    unit,         // `mm`
    word,         // one of the choices of a property or key
    form,         // `rgb`, `blackbody`
    data,         // what comes with the program: a metal, a glass, an illuminant, a preset
    file,         // the name of a file
    reference,    // the name of a definition, where it is used
    parameter,    // its name behind `param`
    parameterUse, // `$name`
};

// Views into the analysis and the language.
struct Meaning {
    Span span;
    Sense sense = Sense::word;
    std::string_view text;                    // the word itself, without quotes and `$`
    schema::Kind kind = schema::Kind::shape;  // of a type, a name, a reference
    const schema::TypeInfo* type = nullptr;   // of a type or name; whose property
    const schema::FieldInfo* field = nullptr; // the property, or whose value, unit, key
    std::string_view as = {};                 // of a parameter that an `include` gives its value: the prefix there
};

// Words that stand for one definition or parameter, wherever they are: by its whole name.
struct Subject {
    bool parameter = false;
    schema::Kind kind = schema::Kind::shape; // of a definition
    std::string name;

    auto operator<=>(const Subject&) const = default;
};

// What may stand in a block.
struct Scope {
    enum class Place : std::uint8_t {
        file,      // definitions, the header, parameters
        container, // of `group`, `object`: definitions, and some properties
        fields,    // properties
        steps,     // of a transform
        spectra,   // `n` and `k` of a complex index
        rows,      // rows of numbers
        nothing,   // not known, or private
    };
    Place place = Place::file;
    schema::Kind kind = schema::Kind::shape;   // of the definition around
    const schema::TypeInfo* type = nullptr;    // whose properties; null in the block behind a value
    std::span<const schema::FieldInfo> fields; // properties of `container` and `fields`
    const schema::FieldInfo* owner = nullptr;  // the property whose block it is
    std::string_view title;                    // of the node that has the block

    const schema::FieldInfo* find(std::string_view property) const;
};

// One version of a text. Not movable: all else refers to it.
class Analysis {
  public:
    // `path` names the text and says where its files are; those that it includes are read from there, or as the
    // workspace has them.
    Analysis(const Language&, const std::filesystem::path& path, std::string text, const Workspace* = nullptr);
    // With other texts for some of the files, by their real paths.
    Analysis(const Language&, const std::filesystem::path& path, const Workspace&,
             const std::map<std::filesystem::path, std::string>& texts);
    Analysis(const Analysis&) = delete;
    Analysis& operator=(const Analysis&) = delete;

    const Language& language() const { return language_; }
    const SourceMap& sources() const { return sources_; }
    FileId file() const { return file_; }
    std::string_view text() const { return sources_.text(file_); }
    const schema::Document& document() const { return *document_; }
    const schema::SceneTree& tree() const { return tree_; }
    bool hasSyntaxErrors() const { return syntaxErrors_; }
    // Of syntax and names.
    std::size_t errorCount() const { return diagnostics_.errorCount(); }
    // Whether the files that it includes are what they were.
    bool isCurrent(const Workspace&) const;
    // Of all words of the text, by their places.
    const std::vector<Meaning>& meanings() const;
    // Likewise of the text, and of the files that it includes.
    std::array<std::span<const Meaning>, 2> allMeanings() const;
    const TextLines& lines(FileId) const;
    // Of the word that begins before, holds, or ends at `offset`; null where there is none.
    const Meaning* meaningAt(std::size_t offset) const;
    // What a word stands for; nothing for words that stand for neither a definition nor a parameter.
    std::optional<Subject> subjectOf(const Meaning&) const;
    // All words that stand for it, its definition among them, in all files of the scene, those of the text first.
    std::vector<Meaning> occurrences(const Subject&) const;
    std::vector<Meaning> occurrences(const Meaning&) const;

    // The block of a node that stands in `outer`.
    Scope scopeOf(const Scope& outer, const schema::Node&) const;
    // The block of an inline definition, whose values follow from `word` on: `material dielectric { … }`.
    Scope inlineScope(schema::Kind, const schema::Node&, std::size_t word) const;

  private:
    using Reader = std::function<std::optional<FileId>(SourceMap&, const std::filesystem::path&, Diagnostics&)>;
    void read(const std::filesystem::path& path, const Reader&);
    Scope layerScope(const schema::Node&) const;

    const Language& language_;
    SourceMap sources_;
    FileId file_;
    Diagnostics diagnostics_;
    bool syntaxErrors_ = false;
    std::shared_ptr<const schema::Document> document_;
    schema::SceneTree tree_;
    std::vector<std::pair<std::filesystem::path, Workspace::Stamp>> included_;
    mutable std::optional<std::vector<Meaning>> meanings_, includedMeanings_;
    mutable std::map<FileId, TextLines> lines_;
};

// Where a text is being written.
struct Cursor {
    Scope scope;                              // of the block
    std::optional<schema::Node> node;         // whose values are being written; nothing: a new one begins here
    std::vector<schema::Value> before;        // its values up to here
    std::string_view key;                     // `space=` is before the word, of its node
    std::size_t wordBegin = 0, wordEnd = 0;   // what is written of the word, up to the place
    bool quoted = false;                      // the word is in quotes, which begin before wordBegin
    std::vector<std::string_view> neighbours; // names of the other nodes of the block
};
Cursor cursorAt(const Analysis&, std::size_t offset);

// What has definitions in its block.
bool isContainer(schema::Kind);
// Kinds that have types.
bool isTyped(schema::Kind);
// A property whose text is the name of a definition, though its table does not say so: `over ground`, `camera=main`.
std::optional<schema::Kind> namedBy(const schema::FieldInfo&, std::string_view key);
// The names of the data behind a form of spectrum: `metal Au`.
std::vector<std::string_view> dataNames(std::string_view form);
// Values of a node by the words that stand for them: those of one `$name` count as one, packed rows as their first.
std::vector<schema::Value> writtenValues(const schema::Node&);
// Where a value stands: at its `$name` if it came from a parameter.
inline Span placeOf(const schema::Value& value) { return value.use.valid() ? value.use : value.span; }

} // namespace abbe::lsp
