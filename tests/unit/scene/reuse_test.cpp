// Building a scene again: what is taken over from the building before, and that nothing of it shows.
#include "base/diagnostic_format.h"
#include "parser/parse.h"
#include "parser/presets.h"
#include "rendering/path_tracer.h"
#include "scene/build.h"
#include "scene/registry.h"
#include "scene/reuse.h"
#include "support/same_bits.h"
#include "support/scene_test.h"

#include <chrono>
#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

namespace abbe::test {
namespace {

namespace fs = std::filesystem;

// A text as it was built once.
struct Building {
    SourceMap sources;
    schema::TypeTable types = makeTypeTable();
    schema::SceneTree tree;
    Diagnostics diagnostics;
    BuiltScene built;

    std::string report() const { return formatShort(diagnostics, sources); }
    TestImage render() const {
        TestImage image{RecordingFilm(built.film, static_cast<int>(built.render.replicates)), {}};
        RenderSettings settings = renderSettings(built.render);
        settings.pilot = 0;
        const auto tracer = makePathTracer(built.scene.effects);
        image.film.keepSplatsOf(*tracer, built.scene, settings);
        image.statistics = tracer->render(built.scene, image.film, settings, {});
        return image;
    }
};

std::unique_ptr<Building> buildText(const std::string& text, SceneReuse* reuse, BuildOptions options = {},
                                    const fs::path& folder = ABBE_SOURCE_DIR) {
    auto b = std::make_unique<Building>();
    if (!options.size) options.size = Vec2i{16, 12};
    if (!options.samples) options.samples = 2;
    const FileId file = b->sources.add("test.scene", text);
    addPresets(b->types, b->sources, b->diagnostics);
    b->tree = schema::resolve(parse(b->sources, file, {}, b->diagnostics), b->types, folder, b->diagnostics);
    b->built = buildScene(b->tree, b->types, options, b->diagnostics, reuse);
    return b;
}

// Builds again and again, and each time compares with a building of its own.
class Series {
  public:
    explicit Series(fs::path folder = ABBE_SOURCE_DIR) : folder_(std::move(folder)) {}

    const ReuseCounters& next(const std::string& text, const BuildOptions& options = {}) {
        last_ = buildText(text, &reuse, options, folder_);
        INFO(last_->report());
        const auto fresh = buildText(text, nullptr, options, folder_);
        CHECK(last_->report() == fresh->report());
        CHECK(last_->built.facts.files == fresh->built.facts.files);
        CHECK(last_->diagnostics.hasErrors() == false);
        if (last_->diagnostics.hasErrors()) return reuse.counters();
        CHECK(last_->built.facts.triangles == fresh->built.facts.triangles);
        const TestImage a = last_->render(), b = fresh->render();
        CHECK(sameBits(a.film, b.film));
        CHECK(sameCounts(a.statistics, b.statistics));
        return reuse.counters();
    }

    SceneReuse reuse;
    const Building& last() const { return *last_; }

  private:
    fs::path folder_;
    std::unique_ptr<Building> last_;
};

std::string replaced(std::string text, const std::string& from, const std::string& to) {
    const std::size_t at = text.find(from);
    REQUIRE(at != std::string::npos);
    return text.replace(at, from.size(), to);
}

// A folder of files that is gone with the test.
class Folder {
  public:
    Folder() : path_(fs::temp_directory_path() / ("abbe_reuse_test_" + std::to_string(getpid()))) {
        fs::create_directories(path_);
    }
    ~Folder() { fs::remove_all(path_); }
    const fs::path& path() const { return path_; }
    // Old enough that its times are trusted.
    void write(const std::string& name, const std::string& text) const {
        std::ofstream(path_ / name) << text;
        std::this_thread::sleep_for(std::chrono::milliseconds(60));
    }

  private:
    fs::path path_;
};

const std::string kHead =
    "scene 1\ncamera { from 0 1 5; look-at 0 0.5 0 }\nfilm { size 16 12 }\n"
    "light sky { radiance 1 }\nlight key quad { size 1 1; radiance 5; transform { rotate x 90 deg; "
    "translate 0 3 0 } }\n";
const std::string kShapes =
    "material red diffuse { reflectance 0.4 }\n"
    "shape floor plane { material red }\n"
    "shape ball sphere { center 0 0.5 0; radius 0.5; material red }\n"
    "shape box { center 1 0.5 0; material dielectric }\n"
    "object thing { shape mesh { points { - 0 0 0; - 1 0 0; - 0 1 0; - 0 0 1 }; faces { - 0 2 1; - "
    "0 1 3; - 0 3 2; - 1 2 3 } }; shape sphere { center 0 1 0; radius 0.2 } }\n"
    "instance thing { transform { translate -1 0 0 } }\n"
    "instance thing { transform { translate -1 0 -1 } }\n";
const std::string kTetrahedron = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";

} // namespace

TEST_CASE("reuse: what surfaces are made of, lights, camera and film leave geometry as it is") {
    const std::string text = kHead + kShapes;
    Series series;
    const ReuseCounters first = series.next(text);
    CHECK(first.shapesLoaded == 1);
    CHECK(first.placesMade == 6);
    CHECK(first.structuresBuilt == 2);
    CHECK(first.placesKept + first.shapesKept + first.structuresKept == 0);
    const auto isKept = [&](const ReuseCounters& c) {
        CHECK(c.shapesLoaded == 0);
        CHECK(c.shapesKept == 1);
        CHECK(c.placesMade == 0);
        CHECK(c.placesKept == 6);
        CHECK(c.structuresBuilt == 0);
        CHECK(c.structuresKept == 2);
        CHECK_FALSE(c.viewKept);
    };
    isKept(series.next(text));
    isKept(series.next(replaced(text, "reflectance 0.4", "reflectance 0.8")));
    isKept(series.next(replaced(text, "radiance 5", "radiance 9")));
    isKept(series.next(replaced(text, "sky { radiance 1 }", "sky { luminance 3000 nits }")));
    isKept(series.next(replaced(text, "camera {", "camera { fov 20 deg;")));
    isKept(series.next("// moved down by a line\n\n" + replaced(text, "film {", "render { samples 3 }\nfilm {")));
    BuildOptions small;
    small.size = Vec2i{8, 8};
    isKept(series.next(text, small));
    std::string renamed = text;
    for (std::size_t at = 0; (at = renamed.find("material red", at)) != std::string::npos; ++at)
        renamed.replace(at, 12, "material rot");
    isKept(series.next(renamed));
}

TEST_CASE("reuse: what changed of the geometry is made, and nothing else") {
    const std::string text = kHead + kShapes;
    Series series;
    series.next(text);
    ReuseCounters c = series.next(replaced(text, "radius 0.5;", "radius 0.6;"));
    CHECK(c.placesMade == 1);
    CHECK(c.placesKept == 5);
    CHECK(c.shapesKept == 1);
    CHECK(c.structuresBuilt == 1); // of the scene
    CHECK(c.structuresKept == 1);  // of the object
    c = series.next(text + "shape sphere { center 2 1 0; radius 0.3 }\n");
    CHECK(c.placesMade == 2);
    CHECK(c.structuresBuilt == 1);
    c = series.next(replaced(text, "shape box { center 1 0.5 0; material dielectric }", ""));
    CHECK(c.placesMade == 0);
    CHECK(c.structuresBuilt == 1);
    c = series.next(replaced(text, "translate -1 0 -1", "translate -1 0 -2")); // with the box again
    CHECK(c.placesMade == 1);
    CHECK(c.structuresBuilt == 1);
    CHECK(c.structuresKept == 1);
    c = series.next(replaced(text, "radius 0.2", "radius 0.3")); // in the object
    CHECK(c.structuresBuilt == 2);
    c = series.next(replaced(text, "plane {", "plane { visible-to shadows reflections;"));
    CHECK(c.placesMade == 1);
    CHECK(c.structuresBuilt == 2); // the object is as it was again
}

// Rays may have to pass over surfaces of glass in glass, for which trees are built.
TEST_CASE("reuse: glass in other glass is another tree") {
    const std::string text = kHead + kShapes;
    Series series;
    series.next(text);
    const ReuseCounters c = series.next(replaced(text, "red diffuse { reflectance 0.4 }", "red dielectric"));
    CHECK(c.placesMade == 0);
    CHECK(c.structuresBuilt == 1);
    CHECK(c.structuresKept == 1);
}

TEST_CASE("reuse: a camera that moves takes the origin of render space along") {
    const std::string text = kHead + kShapes, moved = replaced(text, "from 0 1 5", "from 0.5 1 5");
    Series series;
    series.next(text);
    ReuseCounters c = series.next(moved);
    CHECK(c.placesMade == 4); // those of the object stand in its own space
    CHECK(c.placesKept == 2);
    CHECK(c.shapesKept == 1);
    CHECK(c.structuresKept == 1);
    series.reuse.keepView(true);
    const auto kept = buildText(text, &series.reuse);
    c = series.reuse.counters();
    CHECK(c.viewKept);
    CHECK(c.placesMade == 0);
    CHECK(c.structuresBuilt == 0);
    CHECK(kept->built.scene.eye.x == doctest::Approx(-0.5));
    // The same picture, but for rounding, which turns a few samples at edges.
    const auto fresh = buildText(text, nullptr);
    const TestImage a = kept->render(), b = fresh->render();
    int other = 0;
    for (int y = 0; y < 12; ++y)
        for (int x = 0; x < 16; ++x) {
            const double one = a.film.mean(x, y).y, two = b.film.mean(x, y).y;
            other += std::abs(one - two) > 0.001 * two;
        }
    CHECK(other <= 10);
    // Too far for single precision: everything moves.
    buildText(replaced(text, "from 0 1 5", "from 0 1 5000"), &series.reuse);
    CHECK_FALSE(series.reuse.counters().viewKept);
    CHECK(series.reuse.counters().placesMade == 4);
}

TEST_CASE("reuse: files count by what they are, and warnings are told again where they belong") {
    const Folder folder;
    folder.write("a.obj", kTetrahedron + "f 1 1 2\n");
    const std::string text = kHead + "shape mesh \"a.obj\" { material diffuse { reflectance 0.4 } }\n";
    Series series(folder.path());
    CHECK(series.next(text).shapesLoaded == 1);
    CHECK(series.last().report().find("W0603") != std::string::npos);
    const ReuseCounters c = series.next("// a line more\n" + replaced(text, "0.4", "0.5"));
    CHECK(c.shapesLoaded == 0);
    CHECK(c.shapesKept == 1);
    CHECK(c.structuresKept == 1);
    CHECK(series.last().report().find(":7:") != std::string::npos); // the warning, a line further down
    folder.write("a.obj", replaced(kTetrahedron, "v 1 0 0", "v 2 0 0"));
    CHECK(series.next(text).shapesLoaded == 1);
    CHECK(series.next(text).shapesKept == 1);
    // Of the same size, in the same file.
    folder.write("a.obj", replaced(kTetrahedron, "v 1 0 0", "v 3 0 0"));
    CHECK(series.next(text).shapesLoaded == 1);
    // As editors save.
    folder.write("new", replaced(kTetrahedron, "v 1 0 0", "v 4 0 0"));
    fs::rename(folder.path() / "new", folder.path() / "a.obj");
    CHECK(series.next(text).shapesLoaded == 1);
    // Units of the header are part of what a mesh is.
    CHECK(series.next(replaced(text, "scene 1", "scene 1 length=cm")).shapesLoaded == 1);
}

TEST_CASE("reuse: faulty buildings forget nothing") {
    const std::string text = kHead + kShapes;
    SceneReuse reuse;
    buildText(text, &reuse);
    for (const char* fault :
         {"shape mesh \"missing.obj\"\n", "shape sphere { radius -1 }\n", "material x nonsense\n"}) {
        CHECK(buildText(text + fault, &reuse)->diagnostics.hasErrors());
        CHECK(buildText(kHead + fault, &reuse)->diagnostics.hasErrors());
    }
    buildText(text, &reuse);
    CHECK(reuse.counters().placesKept == 6);
    CHECK(reuse.counters().structuresBuilt == 0);
    // What a faultless one does not use is forgotten.
    buildText(kHead, &reuse);
    buildText(text, &reuse);
    CHECK(reuse.counters().placesMade == 5);
}

TEST_CASE("reuse: what was built stays whole while the next one is built, and after") {
    const std::string text = kHead + kShapes;
    auto reuse = std::make_unique<SceneReuse>();
    const auto first = buildText(text, reuse.get());
    const TestImage before = first->render();
    auto second = buildText(replaced(text, "radius 0.5;", "radius 0.7;"), reuse.get());
    auto third = buildText(replaced(text, "reflectance 0.4", "reflectance 0.9"), reuse.get());
    reuse.reset();
    second.reset();
    CHECK(sameBits(before.film, first->render().film));
    third.reset();
    CHECK(sameBits(before.film, first->render().film));
}

TEST_CASE("reuse: shapes that are alike at one place are not one") {
    const std::string twice = "shape sphere { center 0 0.5 0; radius 0.5; material dielectric }\n";
    Series series;
    series.next(kHead + twice + twice);
    const ReuseCounters c = series.next(kHead + twice + twice);
    CHECK(c.placesKept == 3);
    CHECK(series.last().built.scene.shapes.size() == 3);
}

TEST_CASE("reuse: what a text computes changes with the parameters of its file") {
    const std::string shapes = "param side 1\nparam half \"$side / 2\"\nparam shade 0.4\n"
                               "shape mesh { points { - 0 0 0; - \"$half * 2\" 0 0; - 0 1 0; - 0 0 1 }; "
                               "faces { - 0 2 1; - 0 1 3; - 0 3 2; - 1 2 3 } }\n"
                               "shape sphere { center -1 0.5 0; radius \"$half\"; "
                               "material diffuse { reflectance \"$shade\" } }\n";
    Series series;
    series.next(kHead + shapes);
    ReuseCounters c = series.next(kHead + replaced(shapes, "side 1", "side 0.7"));
    CHECK(c.shapesLoaded == 1);
    CHECK(c.placesMade >= 2);
    c = series.next(kHead + replaced(shapes, "side 1", "side 0.7"));
    CHECK(c.shapesLoaded == 0);
    CHECK(c.placesMade == 0);
}

TEST_CASE("reuse: materials by face") {
    const Folder folder;
    folder.write("a.obj", "g one\n" + replaced(kTetrahedron, "f 1 4 3", "g two\nf 1 4 3"));
    const std::string text = kHead + "material a diffuse { reflectance 0.2 }\nmaterial b diffuse { reflectance 0.8 }\n"
                                     "shape mesh \"a.obj\" { material a; material b group=two }\n";
    Series series(folder.path());
    series.next(text);
    ReuseCounters c = series.next(replaced(text, "0.8", "0.5"));
    CHECK(c.structuresKept == 1);
    CHECK(c.placesMade == 0);
    c = series.next(replaced(text, "b group=two", "b group=one"));
    CHECK(c.shapesLoaded == 1);
}

TEST_CASE("reuse: dicing and displacement") {
    const std::string cage =
        "shape subdivision { points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 1 0 }; faces { - 0 1 2 3 }; dicing 4 "
        "px; displacement 0.1 { map bumps } }\ntexture bumps noise { scale 0.3 }\n";
    const std::string text = kHead + cage;
    Series series;
    series.next(text);
    ReuseCounters c = series.next(replaced(text, "radiance 5", "radiance 6"));
    CHECK(c.placesMade == 0);
    c = series.next(replaced(text, "scale 0.3", "scale 0.4"));
    CHECK(c.placesMade == 1);
    CHECK(c.placesKept == 1);
    c = series.next(replaced(text, "camera {", "camera { fov 30 deg;")); // other pixels
    CHECK(c.placesMade == 1);
    BuildOptions large;
    large.size = Vec2i{32, 24};
    series.next(text);
    CHECK(series.next(text, large).placesMade == 1);
    series.reuse.keepView(true);
    buildText(text, &series.reuse);
    CHECK(series.reuse.counters().placesMade == 0);
    CHECK(series.reuse.counters().viewKept);
}

TEST_CASE("reuse: motion, keys and the shutter") {
    const std::string text =
        replaced(kHead, "camera {", "camera { shutter \"1/10\" s;") +
        "shape sphere { radius 0.3; transform { at 0 s { translate 0 0 0 }; at 1 s { translate 1 0 0 } } }\n"
        "shape mesh { faces { - 0 1 2 }; at 0 s { points { - 0 0 0; - 1 0 0; - 0 1 0 } }; at 1 s { points { - 0 0 0; - "
        "1 0 "
        "0; - 0 2 0 } } }\n";
    Series series;
    series.next(text);
    ReuseCounters c = series.next(replaced(text, "radiance 5", "radiance 6"));
    CHECK(c.structuresBuilt == 0);
    CHECK(c.placesMade == 0);
    c = series.next(replaced(text, "\"1/10\" s", "\"1/20\" s"));
    CHECK(c.shapesLoaded == 0);
    CHECK(c.placesMade == 1); // what deforms does so in other steps
    c = series.next(replaced(text, "translate 1 0 0", "translate 2 0 0"));
    CHECK(c.structuresBuilt >= 1);
}

// Every scene that is shipped, and edits that go with any of them.
TEST_CASE("reuse: shipped scenes") {
    const std::string probe = "\nmaterial reuse-probe diffuse { reflectance 0.3 }\n"
                              "shape sphere { center 0 0 0 m; radius 0.05 m; material reuse-probe }\n"
                              "light point { position 0 5 0 m; power 10 W }\n"
                              "camera reuse-other { from 3 2 4 m; look-at 0 0 0 m; exposure 0 stops }\n";
    std::vector<fs::path> scenes;
    for (const auto& entry : fs::recursive_directory_iterator(fs::path(ABBE_SOURCE_DIR) / "scenes"))
        if (entry.path().extension() == ".scene") scenes.push_back(entry.path());
    std::ranges::sort(scenes);
    REQUIRE(scenes.size() > 40);
    std::size_t number = 0;
    for (const fs::path& path : scenes) {
        if (!nightly() && number++ % 4 != 0) continue;
        CAPTURE(path.string());
        std::stringstream stream;
        stream << std::ifstream(path).rdbuf();
        const std::string text = stream.str() + probe;
        if (buildText(text, nullptr, {}, path.parent_path())->diagnostics.hasErrors()) continue; // several cameras
        Series series(path.parent_path());
        series.next(text);
        ReuseCounters c =
            series.next(replaced(text, "reflectance 0.3 }\nshape sphere", "reflectance 0.7 }\nshape sphere"));
        CHECK(c.structuresBuilt == 0);
        CHECK(c.placesMade == 0);
        CHECK(c.shapesLoaded == 0);
        c = series.next(replaced(text, "power 10 W", "power 20 W"));
        CHECK(c.structuresBuilt == 0);
        c = series.next(replaced(text, "0.05 m; material", "0.07 m; material"));
        CHECK(c.placesMade == 1);
        BuildOptions other;
        other.camera = "reuse-other";
        series.next(text, other);
        CHECK(series.reuse.counters().shapesLoaded == 0);
        if (!nightly()) continue;
        BuildOptions small;
        small.size = Vec2i{12, 16};
        series.next(text, small);
        series.next(stream.str());
    }
}

} // namespace abbe::test
