// Lights, and shapes that emit.
#pragma once

#include "geometry/shape_params.h"
#include "lights/area_light_types.h"
#include "lights/light_context.h"
#include "render/light.h"
#include "scene/build_context.h"
#include "scene/scene_motion.h"
#include "scene/shape_builder.h"

#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace abbe {

struct Place;
class LightBuilder;
class Placer;

// Where a light is made, for the maker of its type.
class LightSite {
  public:
    LightSite(const schema::Definition& definition, const Place& place, Placer& placer, LightBuilder& lights)
        : definition_(definition), place_(place), placer_(placer), lights_(lights) {}

    BuildContext& scene();
    // From the space of its parent; `motion` is set for what moves on from there, by its own transform or with what
    // holds it, and outlives the context. Nothing after an error.
    std::optional<LightContext> context(const KeyedTransform* own, std::optional<LightMotion>& motion);
    // What has no surface. Null is nothing.
    void add(std::unique_ptr<PlacedLight>, const LightContext&, Visibility own);
    void add(std::unique_ptr<DistantLight>, const LightContext&, Visibility own);
    // What has one: makes a shape in render space, which is then a light. `make` returns null after an error.
    // All that it depends on besides, `addMeaning` adds.
    using MakeSurface = std::function<std::unique_ptr<const Shape>(const Transform& place, const ShapeContext&)>;
    void addArea(const AreaLightParams&, const std::function<void(DigestWriter&)>& addMeaning, const MakeSurface& make);

  private:
    const schema::Definition& definition_;
    const Place& place_;
    Placer& placer_;
    LightBuilder& lights_;
};

// Makes a light of its registered type from bound parameters, and adds it to the scene.
using MakeLight = void (*)(const BindParams&, LightSite&);

class LightBuilder {
  public:
    using Definition = schema::Definition;

    LightBuilder(BuildContext& context, const SceneMotion& motion, TextureBuilder& textures, ShapeBuilder& shapes)
        : context_(context), motion_(motion), textures_(textures), shapes_(shapes) {}

    LightContext contextOf(const Definition&, const Motion& toRender);
    // Lights with a place are chosen by their power, in single precision: an error where it does not fit.
    bool checkPower(const Light&, Span);
    void add(std::unique_ptr<Light>, const Definition&, Visibility = kVisibleToAll);
    // The light that a placed shape is; null for none, or after an error.
    const SurfaceLight* emitterOf(const LoadedShape&, const Shape&, const Motion& toRender, Visibility);
    // The texture of an area light, if it has one; false after an error.
    bool takeTexture(const AreaLightParams&, const Shape&, const Definition&, LightContext&);
    ShapeBuilder& shapes() { return shapes_; }
    BuildContext& scene() { return context_; }
    const SceneMotion& motion() const { return motion_; }

    // Once all geometry is known, whose bounds these are: makes the lights ready. Returns what they emit, W.
    double commit(const Bounds3&);
    void checkGroups(); // that light groups name lights
    // Where the camera is in a room and no portals are stated: by which windows skies light it. Requires commit(), and
    // an intersector. It looks at some thousand rays outdoors, and at up to 150 000 in rooms.
    void findWindows();
    const std::vector<std::unique_ptr<Light>>& all() const { return lights_; }
    std::vector<std::unique_ptr<Light>> release() { return std::move(lights_); }

  private:
    BuildContext& context_;
    const SceneMotion& motion_;
    TextureBuilder& textures_;
    ShapeBuilder& shapes_;
    std::vector<std::unique_ptr<Light>> lights_;
    std::vector<std::pair<std::string, std::string>> names_; // name and type, like lights_
};

struct EnvironmentLightParams;
struct IesLightParams;
// Lights that files describe. Null after an error.
std::unique_ptr<PlacedLight> loadIesLight(const IesLightParams&, const LightContext&, BuildContext&);
std::unique_ptr<DistantLight> loadEnvironmentLight(const EnvironmentLightParams&, const LightContext&, BuildContext&);
// The surfaces of area lights; null after an error.
std::unique_ptr<const Shape> placeLightQuad(const LightQuadParams&, const Transform& place, const ShapeContext&);
std::unique_ptr<const Shape> placeLightDisk(const LightDiskParams&, const Transform& place, const ShapeContext&);
std::unique_ptr<const Shape> placeLightSphere(const LightSphereParams&, const Transform& place, const ShapeContext&);
std::unique_ptr<const Shape> placeLightMesh(const LightMeshParams&, const Transform& place, const ShapeContext&);
// All that these depend on besides their place and the header of the scene.
void addMeaning(DigestWriter&, const LightQuadParams&);
void addMeaning(DigestWriter&, const LightDiskParams&);
void addMeaning(DigestWriter&, const LightSphereParams&);
void addMeaning(DigestWriter&, const LightMeshParams&);

} // namespace abbe
