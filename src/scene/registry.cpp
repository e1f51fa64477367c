#include "scene/registry.h"

#include "base/check.h"
#include "cameras/camera_params.h"
#include "cameras/lens_system.h"
#include "cameras/perspective.h"
#include "cameras/projections.h"
#include "film/film_params.h"
#include "geometry/flat_shapes.h"
#include "geometry/frustum.h"
#include "geometry/round_shapes.h"
#include "geometry/torus.h"
#include "lights/area_light_types.h"
#include "lights/beam_light.h"
#include "lights/daylight_light.h"
#include "lights/environment_light.h"
#include "lights/ies_light.h"
#include "lights/moving_light.h"
#include "lights/point_light.h"
#include "lights/sky_light.h"
#include "lights/spot_light.h"
#include "lights/sun_light.h"
#include "materials/boundary.h"
#include "materials/conductor.h"
#include "materials/dielectric.h"
#include "materials/diffuse.h"
#include "materials/diffuse_transmission.h"
#include "materials/hair.h"
#include "materials/openpbr.h"
#include "materials/sheen.h"
#include "materials/subsurface.h"
#include "materials/thin_dielectric.h"
#include "media/atmosphere.h"
#include "media/grid_medium.h"
#include "media/homogeneous.h"
#include "media/noise_media.h"
#include "media/phase_types.h"
#include "rendering/render_params.h"
#include "scene/camera_builder.h"
#include "scene/instance_builder.h"
#include "scene/light_builder.h"
#include "scene/material_builder.h"
#include "scene/medium_builder.h"
#include "scene/shape_builder.h"
#include "scene/shape_mesh.h"
#include "scene/shape_points.h"
#include "scene/shape_subdivision.h"
#include "scene/texture_builder.h"
#include "textures/attribute_texture.h"
#include "textures/checker_texture.h"
#include "textures/image_texture.h"
#include "textures/noise_texture.h"
#include "textures/product_texture.h"
#include "textures/ramp_texture.h"
#include "textures/triplanar_texture.h"

#include <concepts>
#include <map>
#include <variant>

namespace abbe {

namespace {

// What makes things of a type; nothing for types that are settings or placements, and are bound where they are used.
using Maker =
    std::variant<std::monostate, MakeMaterial, MakeTexture, MakeCamera, MakePhase, MakeMedium, MakeLight, LoadShape>;

struct RegistryEntry {
    schema::TypeInfo type;
    Maker make = {};
};

// ---- one adapter for each kind: binds the parameters of a type and calls its maker

// What no single property can say wrong, `checkParams(const Params&, const PlaceOf&, Diagnostics&)` does; what fills
// shapes, `insideOf(const Params&)`; what the command leaves out, `leaveOutEffects(Params&, const MaterialContext&)`:
// where there are such.
template <typename Params, auto make> RegistryEntry material(schema::TypeInfo type) {
    addModifiers<Params>(type);
    const MakeMaterial maker = [](const BindParams& bind, const MaterialContext& context) -> MadeMaterial {
        WithModifiers<Params> params;
        if (!bind(&params)) return {};
        Params& own = params;
        if constexpr (requires { leaveOutEffects(own, context); }) leaveOutEffects(own, context);
        if constexpr (requires(const schema::PlaceOf& where) { checkParams(own, where, context.diagnostics()); }) {
            const schema::PlaceOf where = [&](std::string_view p) { return placeOf(context.definition, p); };
            if (!checkParams(own, where, context.diagnostics())) return {};
        }
        if constexpr (std::invocable<decltype(make), const Params&, const MaterialContext&>)
            return {make(own, context), params.modifiers, {}}; // it consists of others
        else if constexpr (requires { insideOf(own); })
            return {make(own), params.modifiers, insideOf(own)};
        else
            return {make(own), params.modifiers, {}};
    };
    return {std::move(type), maker};
}

// What is no surface has no modifiers.
template <typename Params, auto make> RegistryEntry bareMaterial(schema::TypeInfo type) {
    const MakeMaterial maker = [](const BindParams& bind, const MaterialContext&) -> MadeMaterial {
        Params params;
        if (!bind(&params)) return {};
        return {make(params), {}, {}};
    };
    return {std::move(type), maker};
}

// `make` is a function that takes the parameters, the store of images if it reads any, and diagnostics if it can fail.
template <typename Params, auto make> RegistryEntry texture(schema::TypeInfo type) {
    const MakeTexture maker = [](const BindParams& bind, const std::shared_ptr<TextureStore>& store,
                                 Diagnostics& diagnostics) -> std::unique_ptr<Texture> {
        Params params;
        if (!bind(&params)) return nullptr;
        if constexpr (std::invocable<decltype(make), const Params&, const std::shared_ptr<TextureStore>&, Diagnostics&>)
            return make(params, store, diagnostics);
        else
            return make(params, diagnostics);
    };
    return {std::move(type), maker};
}

template <typename T, typename Params> std::unique_ptr<Texture> pattern(const Params& params, Diagnostics&) {
    return std::make_unique<T>(params);
}

template <typename Params, auto make> RegistryEntry camera(schema::TypeInfo type) {
    const MakeCamera maker = [](const BindParams& bind, const CameraContext& context,
                                Diagnostics& diagnostics) -> std::optional<PlacedCamera> {
        Params params;
        if (!bind(&params)) return std::nullopt;
        return make(params, context, diagnostics);
    };
    return {std::move(type), maker};
}

template <typename Params, auto make> RegistryEntry phase(schema::TypeInfo type) {
    const MakePhase maker = [](const BindParams& bind,
                               [[maybe_unused]] const PhaseContext& context) -> std::shared_ptr<const PhaseFunction> {
        Params params;
        if (!bind(&params)) return nullptr;
        if constexpr (std::invocable<decltype(make), const Params&, const PhaseContext&>)
            return make(params, context);
        else
            return make(params);
    };
    return {std::move(type), maker};
}

template <typename Params, auto make> RegistryEntry medium(schema::TypeInfo type) {
    const MakeMedium maker = [](const BindParams& bind, const MediumContext& context) -> MadeMedium {
        Params params;
        if (!bind(&params)) return {};
        return make(params, context);
    };
    return {std::move(type), maker};
}

// A light without a surface, or several that are one for the language. `make` takes the parameters, the context and
// where it reports to: Diagnostics, or the BuildContext if it reads files.
template <typename Params, auto make> RegistryEntry light(schema::TypeInfo type) {
    const MakeLight maker = [](const BindParams& bind, LightSite& site) {
        Params params;
        if (!bind(&params)) return;
        const KeyedTransform* own = nullptr;
        if constexpr (requires { params.transform; }) own = &params.transform;
        std::optional<LightMotion> motion;
        const auto context = site.context(own, motion);
        if (!context) return;
        Visibility visible = kVisibleToAll;
        if constexpr (std::derived_from<Params, VisibleParams>) visible = visibilityOf(params.visibleTo);
        const auto made = [&] {
            if constexpr (std::invocable<decltype(make), const Params&, const LightContext&, BuildContext&>)
                return make(params, *context, site.scene());
            else
                return make(params, *context, site.scene().diagnostics);
        };
        if constexpr (std::convertible_to<decltype(made()), std::unique_ptr<Light>>)
            site.add(made(), *context, visible);
        else
            for (auto& one : made()) site.add(std::move(one), *context, visible);
    };
    return {std::move(type), maker};
}

// A light with a surface, which `place` makes.
template <typename Params, auto place> RegistryEntry areaLight(schema::TypeInfo type) {
    const MakeLight maker = [](const BindParams& bind, LightSite& site) {
        Params params;
        if (!bind(&params)) return;
        site.addArea(params, [&](const Transform& toRender, const ShapeContext& context) {
            return place(params, toRender, context);
        });
    };
    return {std::move(type), maker};
}

// `make` returns an UnplacedShape, or an optional one if it can fail.
template <typename Params, auto make> RegistryEntry shape(schema::TypeInfo type) {
    const LoadShape maker = [](const BindParams& bind, ShapeBuilder& builder, LoadedShape& loaded) {
        Params params;
        if (!bind(&params)) return;
        loaded.common = params;
        std::optional<UnplacedShape> made = make(params, builder.contextOf(*loaded.definition));
        if (!made) return;
        static_cast<UnplacedShape&>(loaded) = std::move(*made);
        loaded.sound = true;
    };
    return {std::move(type), maker};
}

// One that reads files, deforms, or is diced for the camera.
template <typename Params, auto load> RegistryEntry loadedShape(schema::TypeInfo type) {
    const LoadShape maker = [](const BindParams& bind, ShapeBuilder& builder, LoadedShape& loaded) {
        Params params;
        if (!bind(&params)) return;
        loaded.common = params;
        load(params, builder, loaded);
    };
    return {std::move(type), maker};
}

// ---- the list: a type is one line here (docs/adding_a_material.md, adding_a_light.md, adding_a_shape.md)

struct EntryList {
    std::vector<RegistryEntry> entries = {};
    void add(RegistryEntry entry) { entries.push_back(std::move(entry)); }
};

void addMaterials(EntryList& list) {
    list.add(material<DiffuseParams, makeDiffuse>(diffuseType()));
    list.add(material<ConductorParams, makeConductor>(conductorType()));
    list.add(material<DielectricParams, makeDielectric>(dielectricType()));
    list.add(material<SubsurfaceParams, makeSubsurfaceSurface>(subsurfaceType()));
    list.add(material<MixParams, makeMixOf>(mixMaterialType()));
    list.add(material<TwoSidedParams, makeTwoSidedOf>(twoSidedType()));
    list.add(material<LayeredParams, makeLayeredOf>(layeredType()));
    list.add(bareMaterial<BoundaryParams, makeBoundary>(boundaryType()));
    list.add(material<SheenParams, makeSheen>(sheenType()));
    list.add(material<ThinDielectricParams, makeThinDielectric>(thinDielectricType()));
    list.add(material<DiffuseTransmissionParams, makeDiffuseTransmission>(diffuseTransmissionType()));
    list.add(material<HairParams, makeHair>(hairType()));
    list.add(material<OpenPbrParams, makeOpenPbr>(openPbrType()));

    list.add(texture<ImageTextureParams, makeImageTexture>(imageTextureType()));
    list.add(texture<NoiseTextureParams, pattern<NoiseTexture, NoiseTextureParams>>(noiseTextureType()));
    list.add(texture<CheckerTextureParams, pattern<CheckerTexture, CheckerTextureParams>>(checkerTextureType()));
    list.add(texture<RampTextureParams, makeRampTexture>(rampTextureType()));
    list.add(
        texture<TriplanarTextureParams, pattern<TriplanarTexture, TriplanarTextureParams>>(triplanarTextureType()));
    list.add(
        texture<AttributeTextureParams, pattern<AttributeTexture, AttributeTextureParams>>(attributeTextureType()));
    list.add(texture<ProductTextureParams, pattern<ProductTexture, ProductTextureParams>>(productTextureType()));
}

void addCamerasShapesAndLights(EntryList& list) {
    list.add(camera<PerspectiveParams, makePerspective>(perspectiveType()));
    list.add(camera<OrthographicParams, makeOrthographic>(orthographicType()));
    list.add(camera<SphericalParams, makeSpherical>(sphericalType()));
    list.add(camera<LensSystemParams, makeLensSystem>(lensSystemType()));
    list.add(camera<GltfCameraParams, makeGltfCamera>(gltfCameraType()));

    list.add(shape<QuadParams, makeQuad>(quadType()));
    list.add(shape<SphereParams, makeSphere>(sphereType()));
    list.add(shape<DiskParams, makeDisk>(diskType()));
    list.add(shape<PlaneParams, makePlane>(planeType()));
    list.add(loadedShape<MeshParams, loadMeshShape>(meshType()));

    list.add(areaLight<LightQuadParams, placeLightQuad>(lightQuadType()));
    list.add(areaLight<LightDiskParams, placeLightDisk>(lightDiskType()));
    list.add(areaLight<LightSphereParams, placeLightSphere>(lightSphereType()));
    list.add(areaLight<LightMeshParams, placeLightMesh>(lightMeshType()));
    list.add(light<PointLightParams, makePointLight>(pointLightType()));
    list.add(light<SpotLightParams, makeSpotLight>(spotLightType()));
    list.add(light<BeamLightParams, makeBeamLight>(beamLightType()));
    list.add(light<SunLightParams, makeSunLight>(sunLightType()));
    list.add(light<SkyLightParams, makeSkyLight>(skyLightType()));
    list.add(light<EnvironmentLightParams, loadEnvironmentLight>(environmentLightType()));

    list.add({instancesType()});
    list.add({filmType()});
    list.add({renderType()});

    list.add(light<DaylightParams, makeDaylight>(daylightType()));
    list.add(light<IesLightParams, loadIesLight>(iesLightType()));

    list.add(loadedShape<SubdivisionParams, loadSubdivision>(subdivisionType()));
    list.add(loadedShape<CurvesParams, loadCurves>(curvesType()));
    list.add(loadedShape<PointsParams, loadPoints>(pointsType()));
    list.add(shape<BoxParams, makeBox>(boxType()));
    list.add(shape<CylinderParams, makeCylinder>(cylinderType()));
    list.add(shape<ConeParams, makeCone>(coneType()));
    list.add(shape<TorusParams, makeTorus>(torusType()));
}

void addMedia(EntryList& list) {
    list.add(phase<IsotropicPhaseParams, makeIsotropicPhase>(isotropicPhaseType()));
    list.add(phase<HenyeyGreensteinPhaseParams, makeHenyeyGreensteinPhase>(henyeyGreensteinPhaseType()));
    list.add(phase<RayleighPhaseParams, makeRayleighPhase>(rayleighPhaseType()));
    list.add(phase<DrainePhaseParams, makeDrainePhase>(drainePhaseType()));
    list.add(phase<MiePhaseParams, makeMiePhase>(miePhaseType()));
    list.add(phase<TablePhaseParams, makeTablePhase>(tablePhaseType()));
    list.add(phase<MixPhaseParams, makeMixPhase>(mixPhaseType()));

    list.add(medium<HomogeneousParams, makeHomogeneous>(homogeneousType()));
    list.add(medium<AtmosphereParams, makeAtmosphere>(atmosphereType()));
    list.add(medium<VdbParams, makeVdbVolume>(vdbType()));
    list.add(medium<NoiseMediumParams, makeNoiseMedium>(noiseMediumType()));
    list.add(medium<NoiseVolumeParams, makeNoiseVolume>(noiseVolumeType()));
}

const std::vector<RegistryEntry>& entries() {
    // In the order in which `abbe explain` and the reference list them.
    static const std::vector<RegistryEntry> made = [] {
        EntryList list;
        addMaterials(list);
        addCamerasShapesAndLights(list);
        addMedia(list);
        return std::move(list.entries);
    }();
    return made;
}

} // namespace

schema::TypeTable makeTypeTable() {
    schema::TypeTable table;
    for (const RegistryEntry& entry : entries()) table.add(entry.type);
    return table;
}

template <typename Make> Make makerOf(const schema::TypeInfo& type) {
    for (const RegistryEntry& entry : entries())
        if (entry.type.kind == type.kind && entry.type.name == type.name) return std::get<Make>(entry.make);
    ABBE_CHECK(!"a registered type");
    return nullptr;
}

template MakeMaterial makerOf(const schema::TypeInfo&);
template MakeTexture makerOf(const schema::TypeInfo&);
template MakeCamera makerOf(const schema::TypeInfo&);
template MakePhase makerOf(const schema::TypeInfo&);
template MakeMedium makerOf(const schema::TypeInfo&);
template MakeLight makerOf(const schema::TypeInfo&);
template LoadShape makerOf(const schema::TypeInfo&);

} // namespace abbe
