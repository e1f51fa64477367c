#include "commands/measured_scene.h"

#include <algorithm>
#include <cmath>

namespace abbe {

namespace {

Vec2i smallSize(const LoadedScene& loaded, const BuildOptions& options, int side) {
    BuildOptions look = options;
    look.geometry = false;
    Diagnostics ignored; // they come again
    const Vec2d size = buildScene(loaded.tree, loaded.types, look, ignored).film.size;
    const double scale = std::min(1.0, side / std::max({size.x, size.y, 1.0}));
    const auto scaled = [scale](double v) { return std::max(1, static_cast<int>(std::lround(v * scale))); };
    return {scaled(size.x), scaled(size.y)};
}

} // namespace

MeasuredScene loadMeasured(const SceneInput& input, const BuildOptions& options, int side, RenderReport& messages) {
    SceneInput seen = input;
    seen.camera = options.camera;
    MeasuredScene scene{loadScene(seen), options, {}};
    LoadedScene& loaded = *scene.loaded;
    if (!options.size && loaded.readable && !loaded.diagnostics.hasErrors())
        scene.options.size = smallSize(loaded, options, side);
    if (loaded.readable) scene.built = buildScene(loaded.tree, loaded.types, scene.options, loaded.diagnostics);
    messages.diagnostics(loaded.diagnostics, loaded.sources);
    scene.code = loaded.exitCode();
    if (scene.code != ExitCode::done) return scene;
    scene.built.film.crop.reset(); // pixels of the size that the scene asks for
    scene.built.film.overscan.clear();
    const auto faults = findFaults(scene.built.film);
    if (faults.empty()) return scene;
    Diagnostics first;
    first.error(std::string(faults[0].code), {}, faults[0].message).help = faults[0].help;
    messages.diagnostics(first, loaded.sources);
    scene.code = ExitCode::usage;
    return scene;
}

} // namespace abbe
