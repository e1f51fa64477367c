// What an edit costs:  bench_rebuild [SCENE…]
// Builds each scene (all that are shipped, without arguments) anew, and again with what a building before it left,
// after edits of different kinds: processor seconds of all threads, from definitions to what can be rendered. Prints a
// table, and in its last column what was made anew after the edit of a material.
#include "measure.h"
#include "parser/parse.h"
#include "parser/presets.h"
#include "scene/build.h"
#include "scene/registry.h"
#include "scene/reuse.h"

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <sstream>

namespace {

using namespace abbe;
namespace fs = std::filesystem;

// What goes with any scene, so that it can be edited.
constexpr std::string_view kProbe = "\nmaterial bench-probe diffuse {{ reflectance {} }}\n"
                                    "shape sphere {{ center 0 0 0 m; radius {} m; material bench-probe }}\n"
                                    "light point {{ position 0 5 0 m; power {} W }}\n";

struct Built {
    SourceMap sources;
    schema::TypeTable types = makeTypeTable();
    schema::SceneTree tree;
    Diagnostics diagnostics;
    BuiltScene scene;
    double reading = 0, building = 0; // s
};

class Bench {
  public:
    explicit Bench(const fs::path& path) : path_(path) {
        std::stringstream text;
        text << std::ifstream(path).rdbuf();
        text_ = text.str();
    }

    std::unique_ptr<Built> build(double reflectance, double radius, double power, SceneReuse* reuse) {
        auto built = std::make_unique<Built>();
        const double start = seconds(CLOCK_PROCESS_CPUTIME_ID);
        const FileId file = built->sources.add(path_.string(), text_ + fmt::format(kProbe, reflectance, radius, power));
        addPresets(built->types, built->sources, built->diagnostics);
        built->tree = schema::resolve(parse(built->sources, file, {}, built->diagnostics), built->types,
                                      path_.parent_path(), built->diagnostics);
        const double read = seconds(CLOCK_PROCESS_CPUTIME_ID);
        built->scene = buildScene(built->tree, built->types, {}, built->diagnostics, reuse);
        built->reading = read - start;
        built->building = seconds(CLOCK_PROCESS_CPUTIME_ID) - read;
        return built;
    }

    void run() {
        const std::string name = path_.stem().string();
        auto full = build(0.3, 0.05, 10, nullptr);
        if (full->diagnostics.hasErrors()) {
            fmt::print("{:<24} has errors\n", name);
            return;
        }
        full = build(0.3, 0.05, 10, nullptr); // what the process loads once is there
        SceneReuse reuse;
        auto last = build(0.3, 0.05, 10, &reuse);
        last = build(0.4, 0.05, 10, &reuse);
        const ReuseCounters c = reuse.counters();
        const auto light = build(0.4, 0.05, 20, &reuse);
        const auto shape = build(0.4, 0.06, 20, &reuse);
        fmt::print("{:<24} {:7.3f} {:9.3f} {:9.3f} {:9.3f} {:9.3f}   {}\n", name, full->reading, full->building,
                   last->building, light->building, shape->building,
                   fmt::format("{} of {} shapes, {} of {} places, {} of {} trees, {} of {} textures, {} of {} volumes, "
                               "{} of {} tables",
                               c.shapesLoaded, c.shapesLoaded + c.shapesKept, c.placesMade, c.placesMade + c.placesKept,
                               c.structuresBuilt, c.structuresBuilt + c.structuresKept, c.texturesRead,
                               c.texturesRead + c.texturesKept, c.volumesRead, c.volumesRead + c.volumesKept,
                               c.tablesMade, c.tablesMade + c.tablesKept));
        std::fflush(stdout);
    }

  private:
    fs::path path_;
    std::string text_;
};

} // namespace

int main(int argc, char** argv) {
    std::vector<fs::path> scenes(argv + 1, argv + argc);
    if (scenes.empty())
        for (const auto& entry : fs::recursive_directory_iterator(fs::path(ABBE_SOURCE_DIR) / "scenes"))
            if (entry.path().extension() == ".scene") scenes.push_back(entry.path());
    std::ranges::sort(scenes);
    fmt::print("{:<24} {:>7} {:>9} {:>9} {:>9} {:>9}   {}\n", "scene", "reading", "building", "material", "light",
               "shape", "made after the edit of a material");
    for (const fs::path& path : scenes) Bench(path).run();
    return EXIT_SUCCESS;
}
