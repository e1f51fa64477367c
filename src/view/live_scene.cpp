#include "view/live_scene.h"

#include "base/memory_limit.h"
#include "base/stopwatch.h"
#include "film/film_layers.h"
#include "film/film_planes.h"
#include "io/file.h"
#include "packs/scene_files.h"
#include "pictures/picture_figures.h"
#include "rendering/path_tracer.h"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace abbe {

namespace {

namespace fs = std::filesystem;

constexpr double kShareOfMemory = 0.25;  // that layers of a view may take
constexpr double kMostForLayers = 2e9;   // bytes
constexpr std::size_t kMostFolders = 64; // below the scene's, where a missing file is waited for
constexpr std::size_t kMostTold = 500;   // diagnostics

// Of everything that was read, as far as reading came.
void collectFiles(LoadOutcome& outcome, const LoadedScene& loaded, const BuiltScene* built) {
    std::set<fs::path> all;
    std::error_code error;
    for (std::size_t i = 0; i < loaded.sources.fileCount(); ++i)
        if (const fs::path path = loaded.sources.path(static_cast<FileId>(i)); fs::is_regular_file(path, error))
            all.insert(path);
    if (built) all.insert(built->facts.files.begin(), built->facts.files.end());
    for (const auto& [file, insert] : loaded.tree.inserts) all.insert(insert.source);
    try {
        for (const SceneFile& file : filesOf(loaded.tree))
            for (const SceneFile::Part& part : file.parts) all.insert(part.path);
    } catch (const std::exception&) { // a file that went away meanwhile, which is told when the scene is read again
        outcome.folders.push_back(loaded.tree.directory);
    }
    outcome.files.insert(outcome.files.end(), all.begin(), all.end());
}

// The folder of the scene and those in it: a missing file may appear there.
std::vector<fs::path> foldersOf(const fs::path& folder) {
    std::vector<fs::path> folders{folder};
    std::error_code error;
    for (fs::directory_iterator it(folder, fs::directory_options::skip_permission_denied, error), end;
         !error && it != end && folders.size() < kMostFolders; it.increment(error))
        if (it->is_directory(error)) folders.push_back(it->path());
    return folders;
}

// The head of the camera's definition and its properties: as long as they stay, a camera that was moved stays there.
std::string wordsOf(const LoadedScene& loaded, Span camera) {
    for (const schema::Definition& d : loaded.tree.definitions) {
        if (!(d.span == camera)) continue;
        std::string words(loaded.sources.text(d.span));
        for (const schema::Node& property : d.properties)
            words += ' ' + std::string(loaded.sources.text(property.span()));
        return words;
    }
    return {};
}

const schema::Definition* definitionAt(const LoadedScene& loaded, Span span) {
    const auto found = std::ranges::find(loaded.tree.definitions, span, &schema::Definition::span);
    return found == loaded.tree.definitions.end() ? nullptr : &*found;
}

} // namespace

std::vector<ViewDiagnostic> viewDiagnostics(const Diagnostics& found, const SourceMap& sources) {
    std::vector<ViewDiagnostic> list;
    for (const Diagnostic* d : sortedByPlace(found)) {
        if (list.size() >= kMostTold) break;
        ViewDiagnostic told{
            d->severity == Severity::error ? "error" : "warning", d->code, {}, 0, 0, d->message, d->label, d->help};
        if (d->span.valid()) {
            const LineColumn at = sources.lineColumn(d->span.file, d->span.begin);
            told.file = sources.path(d->span.file);
            told.line = at.line;
            told.column = at.column;
        }
        for (const std::string& note : d->notes) told.help += (told.help.empty() ? "" : "\n") + note;
        list.push_back(std::move(told));
    }
    return list;
}

LayerPlan viewLayers(const LayerPlan& scene, const Scene& built, PixelBounds bounds, double most) {
    LayerPlan plan = scene;
    plan.deep.reset(); // which nobody sees, and which may take any amount of memory
    plan.albedo = plan.normal = plan.depth = true;
    const auto fits = [&] {
        return static_cast<double>(FilmLayers::memoryBytes(bounds, plan, static_cast<int>(kSplatKinds))) <= most;
    };
    if (!plan.groups.empty() || built.lights.size() < 2) return plan;
    std::set<std::string> names;
    for (const auto& light : built.lights)
        if (const auto name = built.names.find(light.get()); name != built.names.end()) names.insert(name->second);
    if (names.size() < 2) return plan;
    for (const std::string& name : names)
        if (plan.groups.size() < kMostOwnGroups) plan.groups.push_back({name, {name}});
    while (!plan.groups.empty() && !fits()) plan.groups.pop_back();
    return plan;
}

fs::path LiveScene::folder() const {
    std::error_code error;
    const fs::path path = fs::absolute(input_.path, error).lexically_normal();
    return path.parent_path();
}

void LiveScene::build(LoadOutcome& outcome, std::unique_ptr<LoadedScene>& loaded) {
    auto shot = std::make_shared<LiveShot>();
    shot->number = readings_;
    Stopwatch watch;
    Diagnostics& diagnostics = loaded->diagnostics;
    shot->built = buildScene(loaded->tree, loaded->types, options_, diagnostics, &reuse_);
    outcome.reuse = reuse_.counters();
    outcome.commitSeconds = shot->built.commitSeconds;
    if (!diagnostics.hasErrors())
        for (const FilmFault& fault : findFaults(shot->built.film))
            diagnostics.error(std::string(fault.code), {}, fault.message).help = fault.help;
    collectFiles(outcome, *loaded, &shot->built);
    if (!diagnostics.hasErrors() && shot->built.scene.intersector && shot->built.scene.camera) {
        shot->film = filmSettings(shot->built.film);
        const PixelBounds frame{0, 0, shot->film.width, shot->film.height};
        shot->film.crop = common(shot->film.crop, frame); // what lies beyond the edges is not shown
        if (isEmpty(shot->film.crop)) shot->film.crop = frame;
        shot->settings = renderSettings(shot->built.render);
        shot->settings.pilot = options_.pilot.value_or(RenderSettings::kPilotByWork);
        shot->settings.timeLimit = 0; // somebody looks on, who ends it
        shot->integrator = makePathTracer(shot->built.scene.effects);
        shot->layers = viewLayers(shot->built.layers, shot->built.scene, frame,
                                  std::min(kMostForLayers, kShareOfMemory * memoryLeft()));
        shot->cameraWords = wordsOf(*loaded, shot->built.cameraSpan);
        if (const schema::Definition* camera = definitionAt(*loaded, shot->built.cameraSpan)) {
            shot->cameraName = camera->name;
            shot->cameraType = camera->type ? camera->type->name : std::string();
        }
        outcome.diagnostics = viewDiagnostics(diagnostics, loaded->sources);
        shot->loaded = std::move(loaded);
        outcome.shot = std::move(shot);
    }
    outcome.buildSeconds = watch.lap() - outcome.commitSeconds;
}

LoadOutcome LiveScene::load() {
    LoadOutcome outcome;
    outcome.begun = std::chrono::system_clock::now();
    outcome.files.push_back(input_.path);
    ++readings_;
    const auto fail = [&](std::string code, std::string message, std::string help) {
        outcome.shot.reset();
        outcome.diagnostics.push_back(
            {"error", std::move(code), input_.path, 0, 0, std::move(message), {}, std::move(help)});
    };
    try {
        auto loaded = loadScene(input_);
        outcome.readSeconds = loaded->parseSeconds + loaded->resolveSeconds;
        if (loaded->readable)
            build(outcome, loaded);
        else
            collectFiles(outcome, *loaded, nullptr);
        if (!outcome.shot) outcome.diagnostics = viewDiagnostics(loaded->diagnostics, loaded->sources);
    } catch (const std::bad_alloc& e) {
        fail("E0780", fmt::format("out of memory: {}", memoryReason(e)), "the scene needs more than there is");
    } catch (const std::exception& e) {
        fail("E0780", e.what(), {});
    }
    if (!outcome.shot) {
        auto folders = foldersOf(folder());
        outcome.folders.insert(outcome.folders.end(), folders.begin(), folders.end());
    }
    return outcome;
}

} // namespace abbe
