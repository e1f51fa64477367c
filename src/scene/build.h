// From the meaning of a file to a scene that can be rendered.
#pragma once

#include "base/diagnostic.h"
#include "cameras/camera_params.h"
#include "film/film_params.h"
#include "film/layer_plan.h"
#include "math/motion.h"
#include "render/scene.h"
#include "rendering/render_params.h"
#include "scene/effect_switches.h"
#include "schema/scene_tree.h"

#include <optional>
#include <string>
#include <unordered_map>
#include <vector>

namespace abbe {

// What the command line may change.
struct BuildOptions {
    std::string camera;                        // name; empty: the only or first one
    std::optional<CameraPose> cameraPose = {}; // it stands there, and not where the scene says
    std::optional<Vec2i> size;                 // film size in pixels
    std::optional<std::int64_t> samples;
    std::optional<std::int64_t> seed;
    std::optional<double> noise;        // relative
    std::optional<double> timeLimit;    // s
    std::optional<double> textureCache; // MiB
    std::optional<bool> adaptive;
    std::optional<double> fps; // of an animation
    std::optional<int> pilot;  // RenderSettings::pilot; else by work
    std::optional<Technique::Strategy> strategy;
    std::optional<Technique::Numbers> sampler;
    bool geometry = true;   // false: check only; no acceleration structure is built
    EffectSwitches without; // what is left out of the scene
    bool textures = false;  // then read images to their ends all the same
};

// Facts for `abbe info` and the summary of a render.
struct SceneFacts {
    std::size_t shapes = 0, triangles = 0, quads = 0, analytic = 0, objects = 0, instances = 0;
    std::size_t strands = 0, segments = 0, points = 0; // of curves and points
    std::size_t lights = 0, materials = 0;
    Bounds3d bounds; // world space, m
    struct LightFact {
        std::string name, type;
        double watts = 0;
    };
    std::vector<LightFact> lightList;
    // A shape, a light with a surface, or what one line places of an object.
    struct ShapeFact {
        std::string kind, name, type; // of the line; of instances the object's name
        std::string inside;           // the object whose space the bounds are in; empty: world space
        std::size_t places = 1;
        Bounds3d bounds; // m, when the shutter opens; infinite for planes, empty where nothing is shown
    };
    std::vector<ShapeFact> shapeList;
    std::vector<std::string> files; // read while building
};

class SceneReuse;

struct BuiltScene {
    Scene scene;
    FilmParams film;
    LayerPlan layers;
    RenderParams render;
    Interval shutter;      // when the camera's shutter is open, from its first light to its last
    CameraPose cameraPose; // where the camera stands when the shutter opens, in the axes of the scene
    Exposure cameraExposure;
    Span cameraSpan;     // of the camera's definition
    double exposure = 1; // factor of the camera's exposure
    SceneFacts facts;
    std::unordered_map<const void*, Span> declared; // where, of shapes, lights and media
    std::vector<EffectUser> effectUsers;            // of what can be left out, be it so or not
    double commitSeconds = 0;                       // of the building, what the acceleration structure took
};

// Builds everything, or returns what could be built together with errors in `diagnostics`: the caller must not render
// a scene with errors. Never throws on bad input. Whole-scene sanity (no camera, no light, …) is checked here (E06xx).
// What `reuse` has of earlier buildings (scene/reuse.h) is taken over where it is the same.
BuiltScene buildScene(const schema::SceneTree&, const schema::TypeTable&, const BuildOptions&, Diagnostics&,
                      SceneReuse* reuse = nullptr);

// The camera alone, as buildScene() would make it: for one that is moved while its scene stays as it was built. Its
// rays are relative to its own position, `origin`. Null after an error.
struct LoneCamera {
    std::unique_ptr<const Camera> camera;
    Vec3d origin; // world space
    CameraPose pose;
};
LoneCamera buildCamera(const schema::SceneTree&, const schema::TypeTable&, const BuildOptions&, Diagnostics&);

} // namespace abbe
