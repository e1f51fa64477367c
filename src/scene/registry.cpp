#include "scene/registry.h"

#include "base/check.h"
#include "cameras/lens_system.h"
#include "cameras/orthographic.h"
#include "cameras/perspective.h"
#include "cameras/spherical.h"
#include "film/film_params.h"
#include "lights/area_light_types.h"
#include "lights/beam_light.h"
#include "lights/daylight_light.h"
#include "lights/environment_light.h"
#include "lights/ies_light.h"
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
#include "materials/openpbr_inside.h"
#include "materials/sheen.h"
#include "materials/subsurface.h"
#include "materials/thin_dielectric.h"
#include "media/atmosphere.h"
#include "media/homogeneous.h"
#include "media/noise_types.h"
#include "media/phase_types.h"
#include "media/vdb_type.h"
#include "rendering/render_params.h"
#include "scene/camera_gltf.h"
#include "scene/instances_type.h"
#include "scene/shape_curves.h"
#include "scene/shape_parametric.h"
#include "scene/shape_subdivision.h"
#include "scene/shape_types.h"
#include "textures/attribute_texture.h"
#include "textures/checker_texture.h"
#include "textures/image_texture.h"
#include "textures/noise_texture.h"
#include "textures/product_texture.h"
#include "textures/ramp_texture.h"
#include "textures/triplanar_texture.h"

namespace abbe {

namespace {

// How a material is made and its type dressed.
struct MaterialMaker {
    MadeMaterial (*make)(const BindParams&, const MaterialParts&);
    void (*dress)(schema::TypeInfo&);
};
struct MaterialEntry {
    schema::TypeInfo (*type)();
    MaterialMaker maker;
};

// What no single property can say wrong, `checkParams(const Params&, const PlaceOf&, Diagnostics&)` does, and what
// fills shapes, `insideOf(const Params&)`, where there are such.
template <typename Params, auto make>
MadeMaterial made(const BindParams& bind, [[maybe_unused]] const MaterialParts& parts) {
    WithDress<Params> params;
    if (!bind(&params)) return {};
    const Params& own = params;
    const schema::PlaceOf where = [&](std::string_view property) { return placeOf(parts.definition, property); };
    if constexpr (requires { checkParams(own, where, parts.diagnostics); })
        if (!checkParams(own, where, parts.diagnostics)) return {};
    if constexpr (requires { insideOf(own); }) return {make(params), params.dress, insideOf(own)};
    return {make(params), params.dress, {}};
}
template <typename Params, auto make> constexpr MaterialMaker bound{made<Params, make>, addDress<Params>};

// One that consists of others.
template <typename Params, auto make> MadeMaterial madeOf(const BindParams& bind, const MaterialParts& parts) {
    WithDress<Params> params;
    if (!bind(&params)) return {};
    return {make(params, parts), params.dress, {}};
}
template <typename Params, auto make> constexpr MaterialMaker composed{madeOf<Params, make>, addDress<Params>};

// What is no surface wears nothing.
template <typename Params, auto make> MadeMaterial madeBare(const BindParams& bind, const MaterialParts&) {
    Params params;
    if (!bind(&params)) return {};
    return {make(params), {}, {}};
}
template <typename Params, auto make> constexpr MaterialMaker bare{madeBare<Params, make>, [](schema::TypeInfo&) {}};

// A material is one line here (docs/adding_a_material.md).
constexpr MaterialEntry kMaterials[] = {
    {diffuseType, bound<DiffuseParams, makeDiffuse>},
    {conductorType, bound<ConductorParams, makeConductor>},
    {dielectricType, bound<DielectricParams, makeDielectric>},
    {subsurfaceType, bound<SubsurfaceParams, makeSubsurfaceSurface>},
    {mixMaterialType, composed<MixParams, makeMixOf>},
    {twoSidedType, composed<TwoSidedParams, makeTwoSidedOf>},
    {layeredType, composed<LayeredParams, makeLayeredOf>},
    {boundaryType, bare<BoundaryParams, makeBoundary>},
    {sheenType, bound<SheenParams, makeSheen>},
    {thinDielectricType, bound<ThinDielectricParams, makeThinDielectric>},
    {diffuseTransmissionType, bound<DiffuseTransmissionParams, makeDiffuseTransmission>},
    {hairType, bound<HairParams, makeHair>},
    {openPbrType, bound<OpenPbrParams, makeOpenPbr>},
};

struct TextureEntry {
    schema::TypeInfo (*type)();
    std::unique_ptr<Texture> (*make)(const BindParams&, const std::shared_ptr<TextureStore>&, Diagnostics&);
};

std::unique_ptr<Texture> makeImage(const BindParams& bind, const std::shared_ptr<TextureStore>& store,
                                   Diagnostics& diagnostics) {
    ImageTextureParams params;
    return bind(&params) ? makeImageTexture(params, store, diagnostics) : nullptr;
}

std::unique_ptr<Texture> makeRamp(const BindParams& bind, const std::shared_ptr<TextureStore>&,
                                  Diagnostics& diagnostics) {
    RampTextureParams params;
    return bind(&params) ? makeRampTexture(params, diagnostics) : nullptr;
}

template <typename T, typename Params>
std::unique_ptr<Texture> pattern(const BindParams& bind, const std::shared_ptr<TextureStore>&, Diagnostics&) {
    Params params;
    return bind(&params) ? std::make_unique<T>(params) : nullptr;
}

constexpr TextureEntry kTextures[] = {
    {imageTextureType, makeImage},
    {noiseTextureType, pattern<NoiseTexture, NoiseTextureParams>},
    {checkerTextureType, pattern<CheckerTexture, CheckerTextureParams>},
    {rampTextureType, makeRamp},
    {triplanarTextureType, pattern<TriplanarTexture, TriplanarTextureParams>},
    {attributeTextureType, pattern<AttributeTexture, AttributeTextureParams>},
    {productTextureType, pattern<ProductTexture, ProductTextureParams>},
};

struct CameraEntry {
    schema::TypeInfo (*type)();
    std::optional<PlacedCamera> (*make)(const BindParams&, const CameraContext&, Diagnostics&);
};

template <typename Params, auto make>
std::optional<PlacedCamera> placed(const BindParams& bind, const CameraContext& context, Diagnostics& diagnostics) {
    Params params;
    return bind(&params) ? make(params, context, diagnostics) : std::nullopt;
}

// So is a camera.
constexpr CameraEntry kCameras[] = {
    {perspectiveType, placed<PerspectiveParams, makePerspective>},
    {orthographicType, placed<OrthographicParams, makeOrthographic>},
    {sphericalType, placed<SphericalParams, makeSpherical>},
    {lensSystemType, placed<LensSystemParams, makeLensSystem>},
    {gltfCameraType, placed<GltfCameraParams, makeGltfCamera>},
};

constexpr schema::TypeInfo (*kOthers[])() = {
    quadType,      sphereType,    diskType,        planeType,     meshType,
    lightQuadType, lightDiskType, lightSphereType, lightMeshType, pointLightType,
    spotLightType, beamLightType, sunLightType,    skyLightType,  environmentLightType,
    instancesType, filmType,      renderType,      daylightType,  iesLightType,
};

} // namespace

schema::TypeTable makeTypeTable() {
    schema::TypeTable table;
    for (const MaterialEntry& entry : kMaterials) {
        schema::TypeInfo type = entry.type();
        entry.maker.dress(type);
        table.add(std::move(type));
    }
    for (const TextureEntry& entry : kTextures) table.add(entry.type());
    for (const CameraEntry& entry : kCameras) table.add(entry.type());
    for (const auto type : kOthers) table.add(type());
    for (const auto type : {subdivisionType, curvesType, pointsType}) table.add(type());
    for (const schema::TypeInfo& type : parametricTypes()) table.add(type);
    for (const schema::TypeInfo& type : phaseTypes()) table.add(type);
    for (const auto type : {homogeneousType, atmosphereType, vdbType, noiseMediumType, noiseVolumeType})
        table.add(type());
    return table;
}

MadeMaterial makeMaterial(std::string_view type, const BindParams& bind, const MaterialParts& parts) {
    for (const MaterialEntry& entry : kMaterials)
        if (entry.type().name == type) return entry.maker.make(bind, parts);
    ABBE_CHECK(!"a registered material type");
    return {};
}

std::unique_ptr<Texture> makeTexture(std::string_view type, const BindParams& bind,
                                     const std::shared_ptr<TextureStore>& store, Diagnostics& diagnostics) {
    for (const TextureEntry& entry : kTextures)
        if (entry.type().name == type) return entry.make(bind, store, diagnostics);
    ABBE_CHECK(!"a registered texture type");
    return nullptr;
}

std::optional<PlacedCamera> makeCamera(std::string_view type, const BindParams& bind, const CameraContext& context,
                                       Diagnostics& diagnostics) {
    for (const CameraEntry& entry : kCameras)
        if (entry.type().name == type) return entry.make(bind, context, diagnostics);
    ABBE_CHECK(!"a registered camera type");
    return std::nullopt;
}

std::unique_ptr<const Material> makePlainMaterial(const Curve* reflectance) {
    DiffuseParams params;
    params.reflectance.curve = reflectance;
    return makeDiffuse(params);
}

} // namespace abbe
