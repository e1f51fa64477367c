// A scene rendered with its layers, as the program does it.
#pragma once

#include "film/layer_planes.h"
#include "support/scene_test.h"

namespace abbe::test {

struct LayeredFilm {
    TestScene scene;
    PixelFilm film;
    ResolvedImage picture;
    LayerPlanes layers;

    explicit LayeredFilm(const std::string& text, std::uint32_t samples = 32, std::uint64_t seed = 0)
        : scene(TestScene::parse(text)), film(makeFilm(scene)) {
        RenderSettings settings = scene.settings();
        settings.samples = samples;
        settings.seed = seed;
        makePathTracer(scene.scene().effects)->render(scene.scene(), film, settings, {});
        picture = film.resolve(rgb::ap1.fromXyz(), scene.built().exposure);
        layers = layerPlanes(film, picture, view());
    }
    static PixelFilm makeFilm(const TestScene& scene) {
        const FilmSettings s = filmSettings(scene.built().film);
        PixelFilm film(s.crop, PixelFilter(s.filter, s.filterRadius), 2);
        film.keepLayers(scene.built().layers, scene.scene().names, rgb::ap1,
                        {scene.scene().intersector.get(), scene.scene().camera.get()});
        return film;
    }
    LayerView view() const { return {&rgb::ap1, rgb::ap1.fromXyz(), scene.built().exposure, scene.scene().origin}; }
    DeepImage deep() const { return deepImage(film, view()); }
    const std::vector<float>& plane(std::string_view name) const {
        for (const NamedPlane& p : layers.planes)
            if (p.name == name) return p.values;
        throw std::runtime_error("no layer " + std::string(name));
    }
    // Index of a pixel in the planes.
    std::size_t at(int x, int y) const { return film.layers()->pixelIndex(x, y); }
};

} // namespace abbe::test
