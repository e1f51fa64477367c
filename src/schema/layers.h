// Layers: what `include`, `override`, `remove`, `variant` and `--set` make of the files of a scene.
// docs/language/layers.md.
#pragma once

#include "schema/scene_tree.h"

#include <cstdint>
#include <filesystem>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

namespace abbe::schema {

// A file of a scene as one `include` brings it in; one that is included under two prefixes is there twice, each with a
// text of its own in the SourceMap.
struct LayerFile {
    std::shared_ptr<const Document> document;
    std::filesystem::path path;
    std::string prefix = {};                            // of all names in it: "car:"
    Span includer = {};                                 // the file's name in the `include` node
    std::map<std::uint32_t, std::size_t> includes = {}; // by the offset of the node: which file it brings in
};

// The files of a scene, read and not yet understood; parser/layer_files.h makes them. Everything lives as long as the
// SourceMap of the documents.
struct LayerFiles {
    std::vector<LayerFile> files;                           // the first one is the scene's own
    std::vector<NamedFile> included = {};                   // what the `include` nodes name
    std::vector<std::pair<std::string, Span>> chosen = {};  // variants of the command line, by their whole names
    std::vector<std::shared_ptr<const Document>> sets = {}; // `--set`: each a document of one `override` node
    std::vector<std::pair<std::string, std::vector<Value>>> given = {}; // see SceneTree::given
};

// Finds definitions of a tree while layers are read into it: by name, nested ones included, and at the top level what
// has no name, by its type (`light sky`), by what it places (`instance chair`), or as the only one of its kind
// (`camera`). Adding to the tree is noticed; all of it takes a time that grows with the number of definitions, whatever
// is asked.
class DefinitionIndex {
  public:
    explicit DefinitionIndex(SceneTree& tree) : tree_(tree) {}

    // What a layer calls `name`, a whole name, or without one the only definition of its kind; null if there is none or
    // several (isAmbiguous()). Valid until something is added.
    Definition* find(Kind, const std::string& name, bool named);
    bool isAmbiguous() const { return candidates_.size() > 1; }
    std::vector<const Definition*> candidates() const { return {candidates_.begin(), candidates_.end()}; }
    // The child of that name; null if there is none.
    Definition* findIn(Definition& group, Kind, const std::string& name);
    // The name that is nearest to this one, of a definition of that kind.
    std::pair<std::string_view, const Definition*> nearest(Kind, std::string_view name);
    // The children of `group` are more than the first `before`, which were at `old`.
    void noteAdded(Definition& group, std::size_t before, const Definition* old);
    // Marks what is called so, instances all of them, and keeps the names that are gone. False if find() would be null.
    bool remove(Kind, const std::string& name, bool named, Span at);
    // Takes out what was removed. Nothing is found afterwards.
    void sweep();

  private:
    struct Slot {
        std::size_t top = 0;          // of the tree's definitions
        Definition* nested = nullptr; // not at the top level: in it
    };
    using Key = std::pair<Kind, std::string>;

    void update();
    void add(Definition&, Slot);
    void addNested(Definition& parent, std::size_t from);
    Definition* at(const Slot&);
    void collect(std::vector<std::size_t>& slots);
    void forget(Definition&, Span at);

    SceneTree& tree_;
    std::size_t known_ = 0; // definitions at the top level
    std::map<Key, Slot> named_;
    std::map<Key, std::vector<std::size_t>> nameless_, placed_;
    std::map<Kind, std::vector<std::size_t>> singles_;
    std::vector<Definition*> candidates_;
    bool anyRemoved_ = false;
};

// Reads all statements into the tree, in order: files, chosen variants, `--set`. What unchosen variants hold is
// returned: it is no part of the scene, and yet what it names is used.
std::vector<Node> readLayers(const LayerFiles&, SceneTree&, const TypeTable&, Diagnostics&);

// A word of this page: include, override, remove, variant.
bool isLayerWord(std::string_view word);

} // namespace abbe::schema
