#include "base/parallel.h"
#include "base/source.h"
#include "doctor/numeric_check.h"
#include "film/film_params.h"
#include "film/pixel_film.h"
#include "math/hash.h"
#include "parser/parse.h"
#include "rendering/path_tracer.h"
#include "scene/build.h"
#include "scene/registry.h"

#include <algorithm>
#include <stdexcept>
#include <vector>

namespace abbe::doctor {

namespace {

// Glass, metal, matte surfaces and two kinds of light: most of the path loop.
constexpr const char* kScene = R"(scene 1
film { size 48 32 }
camera { from 0.4 0.9 4; look-at 0 0.4 0; fov 40 deg }
shape plane { material diffuse { reflectance rgb 0.7 0.4 0.2 } }
shape sphere { center 0 0.5 0; radius 0.5; material dielectric { ior glass BK7; roughness 0.2 } }
shape quad { size 2 1; material conductor { index metal Cu; roughness 0.3 }; transform { translate 0 0.5 -1 } }
light quad { points -1 2 -1  -1 2 1  1 2 1  1 2 -1; luminance 3000 nits }
light sky { luminance 100 nits }
)";

PixelFilm renderWith(int threads, const BuiltScene& built) {
    setThreadCount(threads);
    const FilmSettings film = filmSettings(built.film);
    PixelFilm image(film.crop, PixelFilter(film.filter, film.filterRadius), 2);
    RenderSettings settings = renderSettings(built.render);
    settings.samples = 32;
    makePathTracer(built.scene.effects)->render(built.scene, image, settings, {});
    return image;
}

} // namespace

double filmMeanError() {
    PixelFilm film({0, 0, 1, 1}, {FilterShape::box, 0.5}, 1);
    constexpr std::uint32_t kBatches = 6'250'000, kBatch = 16;
    for (std::uint32_t i = 0; i < kBatches; ++i) film.add(0, 0, 0, Xyz{1, 0.1, 0.3} * kBatch, kBatch);
    if (film.samples(0, 0) != 100'000'000) return 1;
    return std::max(std::abs(film.mean(0, 0).y / 0.1 - 1), std::abs(film.mean(0, 0).x - 1));
}

double orderDependentSums() {
    RandomStream random(5);
    std::vector<double> terms;
    for (int i = 0; i < 20000; ++i)
        terms.push_back(
            std::ldexp(static_cast<double>(random.uniform()) - 0.5, static_cast<int>(random.bits() % 60) - 30));
    const auto sum = [&] {
        ExactSum total;
        for (const double t : terms) total += ExactSum(t);
        return total;
    };
    const ExactSum first = sum();
    int different = 0;
    for (int trial = 0; trial < 20; ++trial) {
        for (std::size_t i = terms.size() - 1; i > 0; --i) std::swap(terms[i], terms[random.bits() % (i + 1)]);
        different += sum() != first;
    }
    return different;
}

double threadDependentPixels() {
    SourceMap sources;
    Diagnostics diagnostics;
    const schema::TypeTable types = makeTypeTable();
    const auto document = parse(sources, sources.add("doctor.scene", kScene), {}, diagnostics);
    const schema::SceneTree tree = schema::resolve(document, types, ".", diagnostics);
    const BuiltScene built = buildScene(tree, types, {}, diagnostics);
    if (diagnostics.hasErrors()) throw std::logic_error("the scene of the doctor has errors");
    const int threads = threadCount();
    const PixelFilm one = renderWith(1, built), many = renderWith(std::max(2, threads), built);
    setThreadCount(threads);
    int different = 0;
    const PixelBounds b = one.bounds();
    for (int y = b.y0; y < b.y1; ++y)
        for (int x = b.x0; x < b.x1; ++x) {
            const Xyz s = one.mean(x, y), t = many.mean(x, y);
            different += s.x != t.x || s.y != t.y || s.z != t.z;
        }
    return different;
}

} // namespace abbe::doctor
