// Scenes of tests: from a text to an image in this process, through the same parser, schema and builder as the program.
#pragma once

#include "base/diagnostic_format.h"
#include "base/source.h"
#include "parser/layer_files.h"
#include "parser/presets.h"
#include "rendering/path_tracer.h"
#include "scene/build.h"
#include "scene/registry.h"
#include "support/nightly.h"
#include "support/scene_test_film.h"

#include <filesystem>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace abbe::test {

using Strategy = Technique::Strategy;

// A scene and everything it was read from. Paths in a text are relative to the source tree.
class TestScene {
  public:
    static TestScene parse(std::string text, const BuildOptions& options = {}) {
        TestScene scene;
        const FileId file = scene.parts_->sources.add("test.scene", std::move(text));
        scene.build(file, std::filesystem::path(ABBE_SOURCE_DIR) / "test.scene", options);
        return scene;
    }
    // A file relative to the source tree, with the library of materials; `definitions` as `-D` of the command line
    // takes them, "name=value".
    static TestScene load(const std::filesystem::path& path, const BuildOptions& options = {},
                          const std::vector<std::string>& definitions = {}) {
        TestScene scene;
        const auto full = std::filesystem::path(ABBE_SOURCE_DIR) / path;
        Parts& p = *scene.parts_;
        addPresets(p.types, p.sources, p.diagnostics);
        LayerOptions layers;
        for (const std::string& text : definitions)
            if (const auto found = readOverride(p.sources, text, p.diagnostics)) layers.defines.push_back(*found);
        if (const auto file = readSceneFile(p.sources, full, p.diagnostics)) scene.build(*file, full, options, layers);
        return scene;
    }

    const Diagnostics& diagnostics() const { return parts_->diagnostics; }
    // One line for each diagnostic.
    std::string report() const { return formatShort(parts_->diagnostics, parts_->sources); }
    // What the diagnostics advise, one line each.
    std::string advice() const {
        std::string all;
        for (const Diagnostic& d : parts_->diagnostics.all()) all += d.help + '\n';
        return all;
    }
    const BuiltScene& built() const { return parts_->built; }
    // Throws if the scene has errors: a test that renders rubbish must not pass.
    const Scene& scene() const {
        if (diagnostics().hasErrors()) throw std::runtime_error(report());
        return parts_->built.scene;
    }
    // For tests that put something else in place of a part of it.
    Scene& changeable() { return parts_->built.scene; }
    // Puts another medium in place of the first volume of the scene.
    void standIn(std::unique_ptr<const Medium> medium) {
        parts_->built.scene.openMedia.at(0) = medium.get();
        parts_->built.scene.media.push_back(std::move(medium));
    }
    RenderSettings settings() const { return renderSettings(parts_->built.render); }

  private:
    struct Parts {
        SourceMap sources;
        schema::TypeTable types = makeTypeTable();
        schema::SceneTree tree;
        Diagnostics diagnostics;
        BuiltScene built;
    };

    void build(FileId file, const std::filesystem::path& path, const BuildOptions& options,
               const LayerOptions& layers = {}) {
        Parts& p = *parts_;
        const auto files = readLayerFiles(p.sources, file, path, layers, p.diagnostics);
        p.tree = schema::resolve(files, p.types, p.diagnostics);
        p.built = buildScene(p.tree, p.types, options, p.diagnostics);
    }

    std::unique_ptr<Parts> parts_ = std::make_unique<Parts>();
};

// An image with what the render said about itself.
struct TestImage {
    RecordingFilm film;
    RenderStatistics statistics;
};

// The kernel is the one that the scene asks for, or a larger one. By camera paths alone: what is compared here are ways
// to look for lights, all of which miss the same caustics.
inline TestImage render(const TestScene& scene, const RenderSettings& settings, Effects atLeast = {},
                        int replicates = 8) {
    TestImage image{RecordingFilm(scene.built().film, replicates), {}};
    image.statistics = makePathTracer(scene.scene().effects | atLeast)->render(scene.scene(), image.film, settings, {});
    return image;
}

// With light paths and manifold sampling where the program would have them.
inline TestImage renderAsProgram(const TestScene& scene, const RenderSettings& settings, int replicates = 8) {
    TestImage image{RecordingFilm(scene.built().film, replicates), {}};
    const auto tracer = makePathTracer(scene.scene().effects);
    image.film.keepSplatsOf(*tracer, scene.scene(), settings);
    image.statistics = tracer->render(scene.scene(), image.film, settings, {});
    return image;
}

// By both strategies, by light samples alone and by scattering alone, in this order; each with a seed of its own.
inline std::vector<TestImage> renderByEachStrategy(const TestScene& scene, std::uint32_t samples) {
    RenderSettings settings = scene.settings();
    settings.samples = samples;
    std::vector<TestImage> images;
    for (const auto strategy : {Strategy::mis, Strategy::lightsOnly, Strategy::bsdfOnly}) {
        settings.technique.strategy = strategy;
        ++settings.seed;
        images.push_back(render(scene, settings));
    }
    return images;
}

// With the scene's own settings but for samples (per pixel, all replicates together) and seed.
inline TestImage render(const TestScene& scene, std::uint32_t samples, std::uint64_t seed = 1) {
    RenderSettings settings = scene.settings();
    settings.samples = samples;
    settings.seed = seed;
    return render(scene, settings);
}

} // namespace abbe::test
