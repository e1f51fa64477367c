// How much memory a render may take, and what is said and saved when that is too little.
#include "base/memory_limit.h"
#include "render_run/render_run.h"

#include <algorithm>
#include <fmt/format.h>

namespace abbe {

double RenderRun::memoryBudget() const { return memoryLimit(); }

// A merge reads them as often as it likes.
PixelBounds RenderRun::layersAtOnce() const {
    PixelBounds rows = film_.crop;
    if (!options_.parts.empty()) rows.y1 = std::min(rows.y1, rows.y0 + TileGrid::kSize);
    return rows;
}

// Sums, what becomes of them when they are written, and layers.
double RenderRun::filmBytes() const {
    const double pixels = static_cast<double>(film_.crop.width()) * film_.crop.height();
    constexpr double kResolved = 5 * sizeof(float); // RGB, variance, and the writer's rows
    const bool splats = integrator_->lightBlocks(built_.scene, settings_) > 0;
    const bool merged = splats && integrator_->merges(built_.scene, settings_);
    const auto replicates = static_cast<int>(built_.render.replicates);
    return pixels * kResolved +
           static_cast<double>(PixelFilm::memoryBytes(film_.crop, replicates, splats, merged) +
                               FilmLayers::memoryBytes(layersAtOnce(), built_.layers, splats + merged));
}

// Before the first sample. What is built already is measured, what is to come is counted; tiles of textures come as
// they are needed, which watch() sees.
ExitCode RenderRun::checkMemory() {
    if (alone()) return ExitCode::done;
    const double budget = memoryBudget(), film = filmBytes(), scene = static_cast<double>(residentMemory());
    const std::string owner = options_.memory ? "`--memory` allows" : "this machine has";
    if (film > budget)
        return refuse("E0650",
                      fmt::format("an image of {}×{} pixels needs {}; {} {}", film_.crop.width(), film_.crop.height(),
                                  memoryText(film), owner, memoryText(budget)),
                      "render parts of it with `crop` in the film", ExitCode::memory);
    if (film + scene <= budget) return ExitCode::done;
    const auto layers = static_cast<double>(FilmLayers::memoryBytes(layersAtOnce(), built_.layers));
    return refuse("E0675",
                  fmt::format("this render needs {}: {} for the scene as it is built, {} for the sums of {}×{} pixels "
                              "with {} replicates, {} for layers; {} {}",
                              memoryText(scene + film), memoryText(scene), memoryText(film - layers),
                              film_.crop.width(), film_.crop.height(), built_.render.replicates, memoryText(layers),
                              owner, memoryText(budget)),
                  film > scene ? "`--crop` renders a part of the image; fewer layers and replicates take less"
                               : "coarser `dicing`, `instances` in place of copies and smaller grids take less",
                  ExitCode::memory);
}

// The image takes memory of its own in the end. Without it the render is saved all the same.
void RenderRun::writeInMemory(const PixelFilm& film) {
    try {
        write(film);
        imageWritten_ = true;
    } catch (const std::bad_alloc&) {
        outOfMemory_ = summary_.partial = true;
        if (!checkpoint_) return;
        try {
            checkpoint_->save();
        } catch (const std::exception& e) {
            warn("W0662", fmt::format("the checkpoint was not written: {}", e.what()), {});
        }
    }
}

ExitCode RenderRun::refuseForMemory() {
    std::string why = beyondBudget_ > 0 ? fmt::format("the render came to {} of memory, more than the {} that {}",
                                                      memoryText(beyondBudget_), memoryText(memoryBudget()),
                                                      options_.memory ? "`--memory` allows" : "there are")
                                        : std::string("memory ran out");
    if (beyondBudget_ == 0 && !shortage_.empty()) why += ": " + shortage_;
    if (imageWritten_) why += fmt::format("; the image so far is in `{}`", summary_.image);
    if (checkpoint_ && checkpoint_->writes() > 0 && checkpoint_->isThere())
        why += fmt::format("; the render was saved as `{}`", checkpoint_->path());
    if (!olderCheckpoint_.empty()) why += fmt::format("; an earlier state of the render is in `{}`", olderCheckpoint_);
    return refuse("E0665", std::move(why),
                  beyondBudget_ > 0 ? "a smaller `--texture-cache`, fewer layers or `--crop` take less; `--resume` "
                                      "goes on with more `--memory`"
                                    : "give it more memory, fewer layers, or a smaller `--crop`",
                  ExitCode::memory);
}

} // namespace abbe
