// The scene of a live view: read again whenever its files change. What was read and built last without errors stays.
#pragma once

#include "app/load.h"
#include "film/film_params.h"
#include "film/layer_plan.h"
#include "render/integrator.h"
#include "scene/build.h"
#include "scene/reuse.h"

#include <chrono>
#include <cstdint>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

namespace abbe {

// A diagnostic without the sources that it points into.
struct ViewDiagnostic {
    std::string severity, code;         // "error", "E0105"
    std::string file;                   // empty: about no place
    std::uint32_t line = 0, column = 0; // from 1, in characters; 0: none
    std::string message, label, help;
    bool operator==(const ViewDiagnostic&) const = default;
};

// By place, some hundreds at most.
std::vector<ViewDiagnostic> viewDiagnostics(const Diagnostics&, const SourceMap&);

// A scene as it was at one moment. Shared by all who look at it; only LiveRender changes its camera, frame and
// exposure, between renders.
struct LiveShot {
    std::uint64_t number = 0; // of the readings, from 1
    std::unique_ptr<LoadedScene> loaded;
    BuiltScene built;
    std::unique_ptr<const Camera> ownCamera; // as the scene has it; that of `built` is for the film in hand
    FilmSettings film;
    RenderSettings settings;
    std::unique_ptr<const Integrator> integrator;
    LayerPlan layers;        // that the view keeps: those of the film and what it shows besides
    std::string cameraWords; // what the file says about the camera: who has moved it goes on as long as this stays
    std::string cameraName, cameraType;
};

// What reading the files once came to.
struct LoadOutcome {
    std::shared_ptr<LiveShot> shot; // null after errors
    std::vector<ViewDiagnostic> diagnostics;
    std::vector<std::filesystem::path> files;   // that were read, or looked for
    std::vector<std::filesystem::path> folders; // where a file may be missing, after errors
    std::chrono::system_clock::time_point begun;
    ReuseCounters reuse;
    double readSeconds = 0, buildSeconds = 0, commitSeconds = 0; // of the clock
};

class LiveScene {
  public:
    LiveScene(SceneInput input, BuildOptions options) : input_(std::move(input)), options_(std::move(options)) {
        reuse_.keepView(true); // a camera that is edited moves no geometry
    }

    // Takes as long as reading and building do. Never throws: what is wrong is in the diagnostics, also a lack of
    // memory.
    LoadOutcome load();

    const SceneInput& input() const { return input_; }
    const BuildOptions& options() const { return options_; }
    // Where the scene file is: the only folder in which a view reads what a page asks for, and writes.
    std::filesystem::path folder() const;

  private:
    // Takes the scene if it can be rendered.
    void build(LoadOutcome&, std::unique_ptr<LoadedScene>&);

    SceneInput input_;
    BuildOptions options_;
    SceneReuse reuse_;
    std::uint64_t readings_ = 0;
};

// The most light groups that a view makes of the lights of a scene without groups.
inline constexpr std::size_t kMostOwnGroups = 12;
// The layers of a view's film: the scene's, those that denoising asks for, and a group for each light where the scene
// has none, as many as `most` bytes of memory hold.
LayerPlan viewLayers(const LayerPlan& scene, const Scene&, PixelBounds, double most);

} // namespace abbe
