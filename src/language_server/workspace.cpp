#include "language_server/workspace.h"

#include "language_server/documents.h"
#include "parser/parse.h"

#include <algorithm>
#include <utility>

namespace abbe::lsp {

namespace fs = std::filesystem;

fs::path realPathOf(const fs::path& path) {
    std::error_code error;
    fs::path real = fs::weakly_canonical(path, error);
    return error ? path.lexically_normal() : real;
}

void Workspace::open(const OpenText& text) { open_[realPathOf(text.path())] = &text; }

void Workspace::close(const OpenText& text) {
    std::erase_if(open_, [&](const auto& entry) { return entry.second == &text; });
}

const OpenText* Workspace::find(const fs::path& path) const {
    const auto found = open_.find(realPathOf(path));
    return found == open_.end() ? nullptr : found->second;
}

Workspace::Stamp Workspace::stampOf(const fs::path& path) const {
    if (const OpenText* const text = find(path)) return {text, text->version(), {}};
    return {nullptr, 0, identityOf(path.string())};
}

std::optional<FileId> Workspace::read(SourceMap& sources, const fs::path& path, Diagnostics& diagnostics) const {
    const OpenText* const text = find(path);
    // What an editor holds was checked to be Unicode when it came.
    if (text) return sources.add(path.string(), text->text());
    const FileIdentity identity = identityOf(path.string());
    const auto kept = kept_.find(path);
    if (kept != kept_.end() && kept->second.identity == identity) return sources.add(path.string(), kept->second.text);
    if (kept != kept_.end()) {
        keptBytes_ -= kept->second.text.size();
        kept_.erase(kept);
    }
    const auto file = readSceneFile(sources, path, diagnostics);
    if (!file) return file;
    const std::string_view read = sources.text(*file);
    if (keptBytes_ + read.size() > kMostKept) kept_.clear(), keptBytes_ = 0;
    if (read.size() > kMostKept / 4) return file;
    kept_.emplace(path, Kept{identity, std::string(read)});
    keptBytes_ += read.size();
    return file;
}

std::optional<std::string> Workspace::textOf(const fs::path& path) const {
    SourceMap sources;
    Diagnostics ignored;
    const auto file = read(sources, path, ignored);
    return file ? std::optional<std::string>(sources.text(*file)) : std::nullopt;
}

// Scenes of the workspace. Folders whose names begin with a dot are private to other programs.
std::set<fs::path> Workspace::scenes(const std::set<fs::path>& files) const {
    std::set<fs::path> found;
    const auto take = [&](const fs::path& path) {
        if (path.extension() == ".scene" && found.size() < kMostScenes) found.insert(realPathOf(path));
    };
    for (const auto& [path, text] : open_) take(path);
    std::error_code error;
    std::size_t seen = 0; // a folder may be very large
    for (const fs::path& folder : folders)
        for (fs::recursive_directory_iterator at(folder, fs::directory_options::skip_permission_denied, error), end;
             !error && at != end && seen < 20 * kMostScenes; at.increment(error), ++seen) {
            if (at->path().filename().native().starts_with('.')) at.disable_recursion_pending();
            if (at->is_regular_file(error)) take(at->path());
        }
    if (!folders.empty()) return found;
    for (const fs::path& file : files)
        for (fs::directory_iterator at(file.parent_path(), error), end; !error && at != end && seen < 20 * kMostScenes;
             at.increment(error), ++seen)
            if (at->is_regular_file(error)) take(at->path());
    return found;
}

// The files that a scene includes itself, by their real paths.
std::vector<fs::path> Workspace::includesOf(const fs::path& path) const {
    std::vector<fs::path> included;
    const auto text = textOf(path);
    if (!text || text->find("include") == std::string::npos) return included;
    SourceMap sources;
    Diagnostics ignored;
    const auto document = parse(sources, sources.add(path.string(), *text), {}, ignored);
    for (const schema::Node node : document->roots())
        if (node.name() == "include" && node.valueCount() == 1 && node.value(0).isText())
            included.push_back(realPathOf(path.parent_path() / std::string(node.value(0).text)));
    return included;
}

std::vector<fs::path> Workspace::scenesIncluding(const std::set<fs::path>& files) const {
    std::map<fs::path, std::vector<fs::path>> includers;
    for (const fs::path& scene : scenes(files))
        for (const fs::path& included : includesOf(scene)) includers[included].push_back(scene);
    std::set<fs::path> reached = files;
    std::vector<fs::path> toDo(files.begin(), files.end()), found;
    while (!toDo.empty()) {
        const fs::path file = std::move(toDo.back());
        toDo.pop_back();
        for (const fs::path& includer : includers[file])
            if (reached.insert(includer).second) {
                found.push_back(includer);
                toDo.push_back(includer);
            }
    }
    std::ranges::sort(found);
    return found;
}

} // namespace abbe::lsp
