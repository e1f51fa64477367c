// The scene language: text in, tree of nodes out, and the layout of the text. Syntax is KDL 2.0.0
// (docs/language/syntax.md); the meaning of the nodes is the schema's business.
#pragma once

#include "base/diagnostic.h"
#include "base/source.h"
#include "schema/document.h"

#include <cstdint>
#include <filesystem>
#include <functional>
#include <iosfwd>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace abbe {

// `-D name=value` of the command line. The value is a text of its own in the SourceMap, under the path "-D name", so
// that diagnostics can show it.
struct ParameterOverride {
    std::string name;
    FileId value = FileId::none;
    bool ifThere = false; // no fault if the scene has no such parameter; a number then keeps the unit that was written
};

// Takes `name=value` apart; nothing after a diagnostic.
std::optional<ParameterOverride> readOverride(SourceMap&, std::string_view nameAndValue, Diagnostics&);

struct ParseOptions {
    std::vector<ParameterOverride> overrides; // of equal names the last one counts
    std::uint32_t maxDepth = 256;             // blocks inside blocks
    // The text is one of several of a scene (parser/layer_files.h). Who reads them says which parameters are unknown or
    // unused; those of an outer file may have the name of one of this file, and then have its values; and those that
    // are inherited hold as if they stood in the text.
    bool layered = false;
    std::function<const std::vector<schema::Value>*(std::string_view name)> outer = {};
    std::vector<schema::Document::Parameter> inherited = {};
};

// Reads one file into a tree, reports everything that is wrong with its syntax, and puts the values of parameters where
// `$name` stood. Never null: what could be understood is in the tree, and nodes that lost something say so (damaged()).
// The SourceMap must outlive the document, whose texts point into it.
std::shared_ptr<schema::Document> parse(const SourceMap&, FileId, const ParseOptions&, Diagnostics&);

// The text in the layout of docs/language/syntax.md, "Layout": comments, texts and the spelling of numbers stay as they
// are, and so do spaces inside of lines. What is laid out so stays so. Requires: parse() found no errors in the text.
std::string layOut(std::string_view text);
// What `abbe fmt` leaves of a text: one spelling for each unit, in that layout. Requires the same.
std::string formatted(std::string_view text);
// The text with `scene 1` behind the comments that it begins with. Requires the same, and that it has no edition.
std::string withEdition(std::string_view text);
// Whether two texts without errors are the same tree: names, values, keys and blocks, wherever they stand.
bool sameMeaning(const schema::Document&, const schema::Document&);

// Adds the file at `path` to the map. Nothing after a diagnostic: missing, unreadable, larger than 4 GiB, not UTF-8.
std::optional<FileId> readSceneFile(SourceMap&, const std::filesystem::path& path, Diagnostics&);
// The same for a text that comes from a stream and is called `name`.
std::optional<FileId> readSceneText(SourceMap&, const std::string& name, std::istream&, Diagnostics&);

} // namespace abbe
