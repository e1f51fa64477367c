// Faults by the ten thousand: reading, checking and telling them takes a time in proportion to the file.
#include "base/diagnostic.h"
#include "support/scene_test.h"

#include <ctime>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <functional>

namespace abbe::test::complexity {

namespace {

// `count` times what `one` makes of a number.
std::string repeated(int count, const std::function<std::string(int)>& one) {
    std::string text;
    for (int i = 0; i < count; ++i) text += one(i);
    return text;
}

BuildOptions withoutGeometry() {
    BuildOptions options;
    options.geometry = false;
    return options;
}

// All that `abbe check` does, in each format, and `--fix`. Processor seconds; the less of two where one took longer
// than `allowed`.
double checkSeconds(const std::string& scene, double allowed) {
    double least = 1e9;
    for (int run = 0; run < 2 && least > allowed; ++run) {
        const std::clock_t begin = std::clock();
        SourceMap sources;
        Diagnostics diagnostics;
        const FileId file = sources.add("test.scene", scene);
        const schema::TypeTable types = makeTypeTable();
        const auto tree = schema::resolve(parse(sources, file, {}, diagnostics), types, ABBE_SOURCE_DIR, diagnostics);
        buildScene(tree, types, withoutGeometry(), diagnostics);
        const std::size_t told = formatHuman(diagnostics, sources).size() + formatShort(diagnostics, sources).size() +
                                 formatJson(diagnostics, sources).size() +
                                 applyFixes(sources.text(file), file, diagnostics).text.size();
        CHECK(told > 0);
        least = std::min(least, static_cast<double>(std::clock() - begin) / CLOCKS_PER_SEC);
    }
    return least;
}

struct Faults {
    const char* name;
    std::function<std::string(int count)> scene;
};

const std::vector<Faults>& faults() {
    using fmt::format;
    static const std::vector<Faults> all = {
        {"equal keys", [](int n) { return "film" + repeated(n, [](int) { return " k=1"; }); }},
        {"keys given twice", [](int n) { return "film" + repeated(n, [](int i) { return format(" k{}=1", i / 2); }); }},
        {"equal keys with a parameter",
         [](int n) { return "param p 1\nfilm" + repeated(n, [](int) { return " k=$p"; }); }},
        {"undefined names where nothing has one",
         [](int n) { return repeated(n, [](int i) { return format("shape sphere {{ material m{} }};", i); }); }},
        {"undefined names beside as many defined ones",
         [](int n) {
             return repeated(n, [](int i) {
                 return format("material metal{0} diffuse; shape sphere {{ material nickel{0} }};", i);
             });
         }},
        {"undefined spectra",
         [](int n) {
             return repeated(n, [](int i) { return format("material m{0} diffuse {{ reflectance s{0} }};", i); });
         }},
        {"undefined objects", [](int n) { return repeated(n, [](int i) { return format("instance o{};", i); }); }},
        {"undefined parameters", [](int n) { return "film" + repeated(n, [](int i) { return format(" $p{}", i); }); }},
        {"names defined twice",
         [](int n) { return repeated(n, [](int i) { return format("material m{} diffuse;", i / 2); }); }},
        {"unused names", [](int n) { return repeated(n, [](int i) { return format("material m{} diffuse;", i); }); }},
        {"properties given twice",
         [](int n) { return "camera {" + repeated(n, [](int) { return " fov 40 deg;"; }) + "}"; }},
        {"unknown properties",
         [](int n) { return "camera {" + repeated(n, [](int i) { return format(" fob{} 4;", i); }) + "}"; }},
        {"unknown kinds", [](int n) { return repeated(n, [](int i) { return format("kind{};", i); }); }},
        {"loose steps",
         [](int n) { return "shape sphere {" + repeated(n, [](int) { return " translate 0 0 1;"; }) + "}"; }},
        {"a faulty spectrum used by many",
         [](int n) {
             return "spectrum s 2;" +
                    repeated(n, [](int i) { return format("material m{} diffuse {{ reflectance s }};", i); });
         }},
        {"faulty spectra",
         [](int n) {
             return repeated(
                 n, [](int i) { return format("spectrum s{0} 2; material m{0} diffuse {{ reflectance s{0} }};", i); });
         }},
        {"objects in a ring",
         [](int n) {
             return repeated(
                 n, [n](int i) { return format("object o{} {{ instance o{}; instance o0 }};", i, (i + 1) % n); });
         }},
        {"units that stick", [](int n) { return "film {" + repeated(n, [](int) { return " size 5mm;"; }) + "}"; }},
        {"unclosed blocks", [](int n) { return repeated(n, [](int) { return "a { b } }\n"; }); }},
        {"out of range", [](int n) { return repeated(n, [](int) { return "shape sphere { radius -1 };"; }); }},
    };
    return all;
}

} // namespace

TEST_CASE("many faults take a time in proportion to their number, on one line, too") {
    constexpr int kFew = 700, kTimes = 8;
    for (const Faults& f : faults()) {
        const double few = std::max(checkSeconds(f.scene(kFew), 0), 0.004);
        const double allowed = 3 * kTimes * few; // a quadratic time is 64 times that of the few
        const double many = checkSeconds(f.scene(kTimes * kFew), allowed);
        CHECK_MESSAGE(many < allowed, std::string(f.name) << ": " << few << " s and " << many << " s");
    }
}

TEST_CASE("a key that is given again and again is one warning, with a count") {
    const auto scene = TestScene::parse("scene 1\nfilm { x-a" + repeated(20000, [](int) { return " k=1"; }) + " }");
    std::size_t told = 0;
    for (const Diagnostic& d : scene.diagnostics().all()) told += d.code == "W0101";
    CHECK(told == 1);
    CHECK(scene.report().find("the key `k` is given 20000 times") != std::string::npos);
}

TEST_CASE("suggestions for undefined names are looked for until they have taken long enough") {
    SourceMap sources;
    Diagnostics diagnostics;
    const FileId file = sources.add(
        "test.scene", "scene 1\n" + repeated(3000, [](int i) {
                          return fmt::format("material metal{0} diffuse; shape sphere {{ material mettal{0} }}\n", i);
                      }));
    const schema::TypeTable types = makeTypeTable();
    const auto tree = schema::resolve(parse(sources, file, {}, diagnostics), types, ABBE_SOURCE_DIR, diagnostics);
    buildScene(tree, types, withoutGeometry(), diagnostics);
    CHECK(tree.index.compared >= schema::SceneTree::kMostCompared);
    CHECK(tree.index.compared < schema::SceneTree::kMostCompared + 3000 * 16);
    CHECK(diagnostics.errorCount() >= 3000);
    const auto first = std::ranges::find(diagnostics.all(), "E0202", &Diagnostic::code);
    REQUIRE(first != diagnostics.all().end());
    CHECK(first->label == "did you mean `metal0`?");
}

} // namespace abbe::test::complexity
