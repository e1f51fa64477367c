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
#include "materials/measured.h"
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
#include "textures/channel_texture.h"
#include "textures/checker_texture.h"
#include "textures/image_texture.h"
#include "textures/noise_texture.h"
#include "textures/placed_texture.h"
#include "textures/product_texture.h"
#include "textures/ramp_texture.h"
#include "textures/triplanar_texture.h"

#include <concepts>
#include <map>
#include <utility>
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
        decltype(MadeMaterial::inside) inside{};
        if constexpr (requires { insideOf(own); }) inside = insideOf(own);
        if constexpr (std::invocable<decltype(make), const Params&, const MaterialContext&>)
            return {make(own, context), params.modifiers, std::move(inside)}; // it consists of others, or keeps tables
        else
            return {make(own), params.modifiers, std::move(inside)};
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
        site.addArea(
            params, [&](DigestWriter& writer) { addMeaning(writer, params); },
            [&](const Transform& toRender, const ShapeContext& context) { return place(params, toRender, context); });
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

void addMaterials(std::vector<RegistryEntry>& list) {
    list.push_back(material<DiffuseParams, makeDiffuse>(diffuseType()));
    list.push_back(material<ConductorParams, makeConductor>(conductorType()));
    list.push_back(material<DielectricParams, makeDielectric>(dielectricType()));
    list.push_back(material<SubsurfaceParams, makeSubsurfaceOf>(subsurfaceType()));
    list.push_back(material<MixParams, makeMixOf>(mixMaterialType()));
    list.push_back(material<TwoSidedParams, makeTwoSidedOf>(twoSidedType()));
    list.push_back(material<LayeredParams, makeLayeredOf>(layeredType()));
    list.push_back(material<MeasuredParams, makeMeasuredOf>(measuredType()));
    list.push_back(bareMaterial<BoundaryParams, makeBoundary>(boundaryType()));
    list.push_back(material<SheenParams, makeSheen>(sheenType()));
    list.push_back(material<ThinDielectricParams, makeThinDielectric>(thinDielectricType()));
    list.push_back(material<DiffuseTransmissionParams, makeDiffuseTransmission>(diffuseTransmissionType()));
    list.push_back(material<HairParams, makeHair>(hairType()));
    list.push_back(material<OpenPbrParams, makeOpenPbr>(openPbrType()));

    list.push_back(texture<ImageTextureParams, makeImageTexture>(imageTextureType()));
    list.push_back(texture<NoiseTextureParams, pattern<NoiseTexture, NoiseTextureParams>>(noiseTextureType()));
    list.push_back(texture<CheckerTextureParams, pattern<CheckerTexture, CheckerTextureParams>>(checkerTextureType()));
    list.push_back(texture<RampTextureParams, makeRampTexture>(rampTextureType()));
    list.push_back(
        texture<TriplanarTextureParams, pattern<TriplanarTexture, TriplanarTextureParams>>(triplanarTextureType()));
    list.push_back(
        texture<AttributeTextureParams, pattern<AttributeTexture, AttributeTextureParams>>(attributeTextureType()));
    list.push_back(texture<PlacedTextureParams, pattern<PlacedTexture, PlacedTextureParams>>(placedTextureType()));
    list.push_back(texture<ChannelTextureParams, makeChannelTexture>(channelTextureType()));
    list.push_back(texture<ProductTextureParams, pattern<ProductTexture, ProductTextureParams>>(productTextureType()));
}

void addCamerasShapesAndLights(std::vector<RegistryEntry>& list) {
    list.push_back(camera<PerspectiveParams, makePerspective>(perspectiveType()));
    list.push_back(camera<OrthographicParams, makeOrthographic>(orthographicType()));
    list.push_back(camera<SphericalParams, makeSpherical>(sphericalType()));
    list.push_back(camera<LensSystemParams, makeLensSystem>(lensSystemType()));
    list.push_back(camera<GltfCameraParams, makeGltfCamera>(gltfCameraType()));

    list.push_back(shape<QuadParams, makeQuad>(quadType()));
    list.push_back(shape<SphereParams, makeSphere>(sphereType()));
    list.push_back(shape<DiskParams, makeDisk>(diskType()));
    list.push_back(shape<PlaneParams, makePlane>(planeType()));
    list.push_back(loadedShape<MeshParams, loadMeshShape>(meshType()));

    list.push_back(areaLight<LightQuadParams, placeLightQuad>(lightQuadType()));
    list.push_back(areaLight<LightDiskParams, placeLightDisk>(lightDiskType()));
    list.push_back(areaLight<LightSphereParams, placeLightSphere>(lightSphereType()));
    list.push_back(areaLight<LightMeshParams, placeLightMesh>(lightMeshType()));
    list.push_back(light<PointLightParams, makePointLight>(pointLightType()));
    list.push_back(light<SpotLightParams, makeSpotLight>(spotLightType()));
    list.push_back(light<BeamLightParams, makeBeamLight>(beamLightType()));
    list.push_back(light<SunLightParams, makeSunLight>(sunLightType()));
    list.push_back(light<SkyLightParams, makeSkyLight>(skyLightType()));
    list.push_back(light<EnvironmentLightParams, loadEnvironmentLight>(environmentLightType()));

    list.push_back({instancesType()});
    list.push_back({filmType()});
    list.push_back({renderType()});

    list.push_back(light<DaylightParams, makeDaylight>(daylightType()));
    list.push_back(light<IesLightParams, loadIesLight>(iesLightType()));

    list.push_back(loadedShape<SubdivisionParams, loadSubdivision>(subdivisionType()));
    list.push_back(loadedShape<CurvesParams, loadCurves>(curvesType()));
    list.push_back(loadedShape<PointsParams, loadPoints>(pointsType()));
    list.push_back(shape<BoxParams, makeBox>(boxType()));
    list.push_back(shape<CylinderParams, makeCylinder>(cylinderType()));
    list.push_back(shape<ConeParams, makeCone>(coneType()));
    list.push_back(shape<TorusParams, makeTorus>(torusType()));
}

void addMedia(std::vector<RegistryEntry>& list) {
    list.push_back(phase<IsotropicPhaseParams, makeIsotropicPhase>(isotropicPhaseType()));
    list.push_back(phase<HenyeyGreensteinPhaseParams, makeHenyeyGreensteinPhase>(henyeyGreensteinPhaseType()));
    list.push_back(phase<RayleighPhaseParams, makeRayleighPhase>(rayleighPhaseType()));
    list.push_back(phase<DrainePhaseParams, makeDrainePhase>(drainePhaseType()));
    list.push_back(phase<MiePhaseParams, makeKeptMiePhase>(miePhaseType()));
    list.push_back(phase<TablePhaseParams, makeTablePhase>(tablePhaseType()));
    list.push_back(phase<MixPhaseParams, makeMixPhase>(mixPhaseType()));

    list.push_back(medium<HomogeneousParams, makeHomogeneous>(homogeneousType()));
    list.push_back(medium<AtmosphereParams, makeAtmosphere>(atmosphereType()));
    list.push_back(medium<VdbParams, makeVdbVolume>(vdbType()));
    list.push_back(medium<NoiseMediumParams, makeNoiseMedium>(noiseMediumType()));
    list.push_back(medium<NoiseVolumeParams, makeNoiseVolume>(noiseVolumeType()));
}

const std::vector<RegistryEntry>& entries() {
    // In the order in which `abbe explain` and the reference list them.
    static const std::vector<RegistryEntry> made = [] {
        std::vector<RegistryEntry> list;
        addMaterials(list);
        addCamerasShapesAndLights(list);
        addMedia(list);
        return list;
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
