#include "packs/pack_scene.h"

#include "base/enclosure.h"
#include "packs/manifest.h"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <set>
#include <utility>

namespace abbe {

namespace {

namespace fs = std::filesystem;

constexpr const char* kElsewhere = "files"; // the folder of what lies elsewhere

// Names that differ in case alone are one name on other systems. Of ASCII: that is enough to keep them apart mostly,
// and no harm if not.
std::string folded(std::string name) {
    for (char& c : name)
        if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    return name;
}

fs::path wholePath(const fs::path& path) {
    std::error_code error;
    return fs::absolute(path, error).lexically_normal();
}

fs::path realPath(const fs::path& path) {
    std::error_code error;
    const fs::path real = fs::canonical(path, error);
    return error ? wholePath(path) : real;
}

// The names in a pack and the files that they are of.
class NameBook {
  public:
    void reserve(const std::string& name) { taken_[folded(name)] = {name, {}}; }

    // Whether all of these can have these names: each is free, or that of the same file already.
    bool fits(const std::vector<ScenePack::File>& files) const {
        return std::ranges::all_of(files, [&](const ScenePack::File& file) { return fits(file); });
    }

    void add(const std::vector<ScenePack::File>& files) {
        for (const ScenePack::File& file : files) {
            taken_[folded(file.name)] = {file.name, realPath(file.path)};
            for (auto slash = file.name.find('/'); slash != std::string::npos; slash = file.name.find('/', slash + 1))
                folders_.insert(folded(file.name.substr(0, slash)));
            files_.emplace(file.name, file.path);
        }
    }

    std::vector<ScenePack::File> files() const {
        std::vector<ScenePack::File> list;
        for (const auto& [name, path] : files_) list.push_back({name, path});
        return list;
    }

  private:
    bool fits(const ScenePack::File& file) const {
        if (!nameFault(file.name).empty()) return false;
        const std::string name = folded(file.name);
        for (auto slash = name.find('/'); slash != std::string::npos; slash = name.find('/', slash + 1))
            if (taken_.contains(name.substr(0, slash))) return false;
        if (folders_.contains(name)) return false;
        const auto found = taken_.find(name);
        return found == taken_.end() ||
               (found->second.first == file.name && found->second.second == realPath(file.path));
    }

    std::map<std::string, std::pair<std::string, fs::path>> taken_; // by folded names
    std::set<std::string> folders_;                                 // folded
    std::map<std::string, fs::path> files_;
};

// A name as it may be in a pack.
std::string cleanName(std::string name) {
    if (nameFault(name).empty()) return name;
    for (char& c : name)
        if (c < 0x20 || c > 0x7e || c == '\\' || c == ':') c = '_';
    return nameFault(name).empty() ? name : "file";
}

// Gives the files of a scene their names.
class FileNames {
  public:
    FileNames(const fs::path& directory, const std::string& sceneName)
        : directory_(wholePath(directory.empty() ? "." : directory)) {
        book_.reserve(kManifestName);
        book_.reserve(sceneName);
    }

    // What the scene is to write for it.
    std::string add(const SceneFile& file) {
        const auto [known, fresh] = given_.emplace(file.named.path.lexically_normal(), std::string());
        if (fresh) known->second = place(file);
        return known->second;
    }

    std::vector<ScenePack::File> files() const { return book_.files(); }

  private:
    std::string place(const SceneFile& file) {
        const bool beside = std::ranges::all_of(
            file.parts, [&](const SceneFile::Part& part) { return isBelow(part.path, directory_); });
        if (beside)
            if (const auto name = placeBelow(file, directory_, {})) return *name;
        const fs::path top = topOf(file);
        constexpr int kTries = 100'000;
        for (int number = 1; number < kTries; ++number) {
            const fs::path folder = number == 1 ? fs::path(kElsewhere) : fs::path(kElsewhere) / std::to_string(number);
            if (const auto name = placeBelow(file, top, folder)) return *name;
            if (const auto name = file.parts.size() == 1 ? placeCleaned(file, folder) : std::nullopt) return *name;
        }
        throw UnpackableFile(file.named.path.string());
    }

    // The folder that all of it is below.
    static fs::path topOf(const SceneFile& file) {
        fs::path top = wholePath(file.named.path).parent_path();
        for (const SceneFile::Part& part : file.parts)
            while (!isBelow(part.path, top) && top.has_relative_path()) top = top.parent_path();
        return top;
    }

    std::optional<std::string> placeBelow(const SceneFile& file, const fs::path& top, const fs::path& folder) {
        std::vector<ScenePack::File> files;
        const auto nameOf = [&](const fs::path& path) {
            return (folder / wholePath(path).lexically_relative(top)).generic_string();
        };
        for (const SceneFile::Part& part : file.parts) files.push_back({nameOf(part.path), part.path});
        if (!book_.fits(files)) return std::nullopt;
        book_.add(files);
        return nameOf(file.named.path);
    }

    std::optional<std::string> placeCleaned(const SceneFile& file, const fs::path& folder) {
        const std::string name = (folder / cleanName(file.named.path.filename().string())).generic_string();
        if (file.parts[0].path != file.named.path) return std::nullopt; // a tile
        const std::vector<ScenePack::File> files{{name, file.parts[0].path}};
        if (!book_.fits(files)) return std::nullopt;
        book_.add(files);
        return name;
    }

    fs::path directory_;
    NameBook book_;
    std::map<fs::path, std::string> given_;
};

// --- the text

struct Edit {
    std::uint32_t begin = 0, end = 0;
    std::string text;
};

std::string edited(std::string_view text, std::vector<Edit> edits) {
    std::ranges::sort(edits, {}, &Edit::begin);
    std::string result;
    std::uint32_t done = 0;
    for (const Edit& edit : edits) {
        result += text.substr(done, edit.begin - done);
        result += edit.text;
        done = edit.end;
    }
    return result += text.substr(done);
}

std::string quotedForScene(std::string_view name) {
    std::string text = "\"";
    for (const char c : name) {
        if (c == '"' || c == '\\') text += '\\';
        if (c >= 0 && c < 0x20)
            text += fmt::format("\\u{{{:x}}}", static_cast<int>(c));
        else
            text += c;
    }
    return text + '"';
}

// The value of `-D`, whose texts need no quotes there. `files`: what the scene is to write for the names of files.
std::string givenText(const std::vector<schema::Value>& values, const SourceMap& sources,
                      const std::vector<Edit>& files) {
    std::string text;
    for (const schema::Value& value : values) {
        if (!text.empty()) text += ' ';
        const auto file = std::ranges::find(files, value.span.begin, &Edit::begin);
        if (file != files.end())
            text += file->text;
        else if (value.kind == schema::ValueKind::string)
            text += quotedForScene(value.text);
        else
            text += sources.text(value.span);
    }
    return text;
}

Span spanOfAll(const std::vector<schema::Value>& values) {
    return {values.front().span.file, values.front().span.begin, values.back().span.end};
}

} // namespace

namespace {

// Changes the texts of a scene's files so that they name what is in a pack.
class TextEditor {
  public:
    TextEditor(const schema::SceneTree& tree, const SourceMap& sources, const std::string& sceneName)
        : tree_(tree), sources_(sources), own_(tree.document->file), names_(tree.directory, sceneName) {
        for (const schema::NamedFile& include : tree.includes) add({include, {{{}, include.path}}});
        for (const auto& [file, insert] : tree.inserts)
            if (insert.written && !insert.source.empty())
                folders_[file] = fs::path(names_.add(fileAt(insert.source))).parent_path();
        for (const SceneFile& file : filesOf(tree)) add(file);
        for (const auto& [file, name] : named_) edit(file, name);
        parameters();
    }

    std::string sceneText() { return edited(sources_.text(own_), edits_[own_]) + choices(); }

    // With texts in the place of included files that were changed. A file that is included twice is the same each time.
    std::vector<ScenePack::File> files() {
        std::map<std::string, std::string> texts; // by names in the pack
        for (const auto& [file, insert] : tree_.inserts)
            if (insert.written && !insert.source.empty() && !edits_[file].empty())
                texts.try_emplace(names_.add(fileAt(insert.source)), edited(sources_.text(file), edits_[file]));
        std::vector<ScenePack::File> files = names_.files();
        for (ScenePack::File& file : files)
            if (const auto text = texts.find(file.name); text != texts.end()) file.text = text->second;
        return files;
    }

  private:
    static SceneFile fileAt(const fs::path& path) { return {{{}, {}, path}, {{{}, path}}}; }

    void add(const SceneFile& file) { named_.emplace_back(file.named, names_.add(file)); }

    // A name counts from the folder of the file that it stands in.
    void edit(const schema::NamedFile& named, const std::string& name) {
        const auto folder = folders_.find(named.span.file);
        const bool below = folder != folders_.end() && !folder->second.empty();
        const std::string relative = below ? fs::path(name).lexically_relative(folder->second).generic_string() : name;
        if (relative != named.written)
            edits_[named.span.file].push_back({named.span.begin, named.span.end, quotedForScene(relative)});
    }

    void parameters() {
        for (const schema::Document::Parameter& parameter : tree_.document->parameters) {
            if (parameter.given.empty() || parameter.written.empty()) continue;
            const Span written = spanOfAll(parameter.written);
            // What the written value named is not read.
            std::erase_if(edits_[own_],
                          [&](const Edit& e) { return e.begin >= written.begin && e.end <= written.end; });
            const std::vector<Edit>& files = edits_[parameter.given.front().span.file];
            edits_[own_].push_back({written.begin, written.end, givenText(parameter.given, sources_, files)});
        }
    }

    // What the command line chose, as statements at the end of the scene. What it set is a variant, since that is
    // applied after those that are chosen before.
    std::string choices() {
        constexpr const char* kSet = "command-line";
        std::string text, sets;
        for (const auto& [name, values] : tree_.given)
            text += fmt::format("param {} {}\n", quotedForScene(name),
                                givenText(values, sources_, edits_[values.front().span.file]));
        for (const auto& [file, insert] : tree_.inserts)
            if (insert.written && insert.source.empty())
                sets += "    " + edited(sources_.text(file), edits_[file]) + "\n";
        for (const std::string& variant : tree_.chosen) text += fmt::format("variant {}\n", quotedForScene(variant));
        if (!sets.empty()) text += fmt::format("variant {0} {{\n{1}}}\nvariant {0}\n", kSet, sets);
        return text.empty() ? text : "\n\n// Chosen on the command line of abbe pack.\n" + text;
    }

    const schema::SceneTree& tree_;
    const SourceMap& sources_;
    FileId own_;
    FileNames names_;
    std::map<FileId, fs::path> folders_; // of included files, in the pack
    std::vector<std::pair<schema::NamedFile, std::string>> named_;
    std::map<FileId, std::vector<Edit>> edits_; // of the scene, of included files, and of the values of `-D`
};

} // namespace

ScenePack packScene(const schema::SceneTree& tree, const SourceMap& sources) {
    ScenePack pack;
    pack.sceneName = cleanName(fs::path(sources.path(tree.document->file)).filename().string());
    if (folded(pack.sceneName) == kManifestName) pack.sceneName = "scene-" + pack.sceneName;
    TextEditor editor(tree, sources, pack.sceneName);
    pack.sceneText = editor.sceneText();
    pack.files = editor.files();
    return pack;
}

} // namespace abbe
