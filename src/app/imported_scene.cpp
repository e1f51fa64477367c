#include "app/imported_scene.h"

#include "base/enclosure.h"
#include "base/private_folder.h"
#include "exchange/importer/importer.h"
#include "io/file.h"
#include "parser/parse.h"
#include "scene/shape_mesh.h"
#include "spectrum/upsampling_table.h"

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <iterator>
#include <unistd.h>

namespace abbe {

namespace {

namespace fs = std::filesystem;

constexpr double kForgotten = 24 * 3600; // s after which a folder that nobody uses is removed

[[noreturn]] void failImport(const fs::path& path, int error) {
    throw IoError(fmt::format("cannot import to `{}`: {}", path.string(), std::strerror(error)));
}

} // namespace

fs::path importCacheDirectory() {
    if (const fs::path cache = UpsamplingTable::cacheDirectory(); !cache.empty()) return cache / "imports";
    std::error_code error;
    return fs::temp_directory_path(error) / fmt::format("abbe-imports-{}", ::geteuid());
}

ImportFolder::ImportFolder() {
    const fs::path cache = importCacheDirectory();
    if (const int error = makePrivateFolder(cache)) failImport(cache, error);
    removeUnusedFolders(cache, kForgotten);
    std::string name = (cache / "XXXXXX").string();
    if (!::mkdtemp(name.data())) failImport(cache, errno);
    path_ = name;
    use_ = std::make_unique<const FolderUse>(path_);
}

ImportFolder::~ImportFolder() {
    std::error_code error;
    fs::remove_all(path_, error);
    fs::remove(path_.string() + ".lock", error);
}

ImportedScene::ImportedScene(const exchange::ImportFormat& format, const fs::path& foreign,
                             const exchange::ImportChoice& choice, SourceMap& sources, Diagnostics& diagnostics) {
    scene_ = folder_.path() / foreign.filename().replace_extension(".scene");
    text_ = exchange::importScene(format, foreign, scene_, sources, diagnostics, choice);
    ofFrame_ = format.make && choice.frame;
}

// --- models

namespace {

// Nothing that a shape with the materials of its file may state refers to anything.
class NoReferences final : public schema::Resolver {
  public:
    const Curve* curve(const schema::SpectrumValue&, schema::SpectrumRole, Diagnostics&) override { return nullptr; }
    schema::ComplexIndex metal(std::string_view, Span, Diagnostics&) override { return {}; }
    schema::Reference reference(const schema::Definition&, Diagnostics&) override { return {}; }
    const Texture* texture(const schema::TextureRequest&, Diagnostics&) override { return nullptr; }
};

bool isSwitchedOn(const schema::Value& value) {
    return value.kind == schema::ValueKind::boolean ? value.boolean : value.text == "on";
}

constexpr std::string_view kMaterials = "materials";

// Whether it says `materials on`, in its block or on its line.
bool takesMaterials(const schema::Definition& d) {
    if (d.kind != schema::Kind::shape || !d.type || d.type->name != "mesh") return false;
    for (const schema::Key& key : d.keys)
        if (key.name == kMaterials && isSwitchedOn(key.value)) return true;
    for (const schema::Node& property : d.properties)
        if (property.name() == kMaterials && property.valueCount() > 0 && isSwitchedOn(property.value(0))) return true;
    return false;
}

void collectNames(const std::vector<schema::Definition>& definitions, std::set<std::string>& names) {
    for (const schema::Definition& d : definitions) {
        if (!d.name.empty()) names.insert(d.name);
        collectNames(d.children, names);
    }
}

// What is referred to stands at the top level, the rest where the shape was.
bool isSeen(const schema::Definition& d) {
    using enum schema::Kind;
    return d.kind == shape || d.kind == group || d.kind == instance || d.kind == instances;
}

// Faults of a model stand where the scene names it, with the place in the model beside them.
void addAt(Span named, const Diagnostics& found, Diagnostics& diagnostics) {
    for (Diagnostic d : found.all()) {
        if (d.span.valid() && d.span.end > 0) d.related.insert(d.related.begin(), {d.span, "here in the file"});
        d.span = named;
        d.label = "with the materials of this file";
        diagnostics.add(std::move(d));
    }
}

} // namespace

PlacedModels::~PlacedModels() = default;

void PlacedModels::place(schema::SceneTree& tree) {
    tree_ = &tree;
    walk(tree.definitions);
    std::ranges::move(referred_, std::back_inserter(tree.definitions));
    referred_.clear();
}

void PlacedModels::walk(std::vector<schema::Definition>& definitions) {
    for (schema::Definition& d : definitions)
        if (takesMaterials(d))
            replace(d);
        else
            walk(d.children);
}

// What belongs to a mesh of one material contradicts those of the file.
bool PlacedModels::mayHaveMaterials(const schema::Definition& shape) {
    const auto refuse = [&](Span span, std::string_view property, std::string help) {
        diagnostics_.error("E0616", span, fmt::format("`materials on` leaves no room for `{}`", property), "not both")
            .help = std::move(help);
        return false;
    };
    for (const schema::Node& property : shape.properties) {
        const std::string_view name = property.name();
        if (name == "material" || name == "emission" || name == "interior")
            return refuse(property.headSpan(), name,
                          name == "material"
                              ? "leave one of them out; with `materials off` the shape has this material"
                              : "what the file's materials emit and hold is theirs; `abbe import` makes a scene of it "
                                "that can be changed");
        if (name == "at" || name == "points" || name == "faces" || name == "uvs" || name == "attribute")
            return refuse(property.headSpan(), name, "write `materials off`, and a `material`");
    }
    return true;
}

void PlacedModels::replace(schema::Definition& shape) {
    schema::Definition group;
    group.kind = schema::Kind::group;
    group.name = shape.name;
    group.nameSpan = shape.nameSpan;
    group.span = shape.span;
    for (const schema::Node& property : shape.properties)
        if (property.name() == "transform" || property.name() == "visible-to") group.properties.push_back(property);
    if (mayHaveMaterials(shape)) {
        MeshParams params;
        NoReferences none;
        Diagnostics found;
        // What is wrong is said when the scene is built.
        if (!schema::bind(shape, *tree_, types_, none, &params, found)) return;
        group.children = read(shape, params);
    }
    shape = std::move(group);
}

std::string PlacedModels::freePrefix(const std::string& wish) {
    if (names_.empty()) collectNames(tree_->definitions, names_);
    for (int number = 1;; ++number) {
        std::string prefix = number == 1 ? wish + "/" : fmt::format("{}-{}/", wish, number);
        const auto next = names_.lower_bound(prefix);
        if (next != names_.end() && next->starts_with(prefix)) continue;
        names_.insert(prefix);
        return prefix;
    }
}

std::vector<schema::Definition> PlacedModels::read(const schema::Definition& shape, const MeshParams& params) {
    const fs::path file = params.file.value;
    const Span named = params.file.span.valid() ? params.file.span : shape.span;
    if (file.empty() || !exchange::isModel(file)) {
        diagnostics_
            .error("E0616", named,
                   file.empty() ? "there is no file to take materials of" : "this file has no materials",
                   "`materials on`")
            .help = "glTF files and OBJ models with `.mtl` libraries have some; for others write a `material`";
        return {};
    }
    if (!folder_) {
        folder_ = std::make_unique<const ImportFolder>();
        // Files that a model names were judged when it was read.
        reach_ = std::make_unique<const FileReach>(folder_->path(), std::vector<std::string>{"/"});
    }
    tree_->made = folder_->path();
    const fs::path scene = folder_->path() / std::to_string(++count_) / file.filename().replace_extension(".scene");
    const std::string prefix = freePrefix(shape.name.empty() ? file.stem().string() : shape.name);
    Diagnostics found;
    auto model = exchange::importModel(file, scene, {prefix, gltfSelection(params.file)}, sources_, found);
    addAt(named, found, diagnostics_);
    if (!model) return {};
    for (schema::NamedFile& one : *tree_->namedFiles)
        if (one.path == file) one.beside.insert(one.beside.end(), model->read.begin(), model->read.end());
    // glTF states axes and unit. What states neither is as the scene is.
    schema::Header header = tree_->header;
    if (model->metresYUp) header = {};
    const bool turn = model->metresYUp && tree_->header.zUp;
    if (turn) model->text += "group { transform { rotate x 90 deg } }\n";
    const FileId text = sources_.add(params.file.value + "/" + prefix + "scene", std::move(model->text));
    auto definitions = schema::readInsert(
        *tree_, {parse(sources_, text, {}, diagnostics_), header, scene.parent_path(), file.string()}, types_,
        diagnostics_);
    std::vector<schema::Definition> seen, turned;
    if (turn) {
        turned.push_back(std::move(definitions.back()));
        definitions.pop_back();
    }
    for (schema::Definition& d : definitions) (isSeen(d) ? seen : referred_).push_back(std::move(d));
    if (!turn) return seen;
    turned.front().children = std::move(seen);
    return turned;
}

} // namespace abbe
