// The parameter table of the OpenPBR surface, in the order of its specification.
#include "materials/openpbr.h"

namespace abbe {

using namespace schema;

namespace {

using P = OpenPbrParams;

std::vector<FieldInfo> baseFields() {
    return {field(FieldType::number, "base-weight", &P::baseWeight)
                .doc("Factor of base-color.")
                .example("base-weight 0.8")
                .unit({Dimension::none, Dimension::fraction})
                .range(0, 1)
                .byDefault("1")
                .synonyms({"base_weight", "base", "diffuse_weight"}),
            field(FieldType::spectrum, "base-color", &P::baseColor)
                .doc("Colour of the matte base; for metal, the reflectance at normal incidence.")
                .example("base-color rgb 0.6 0.3 0.1")
                .role(SpectrumRole::albedo)
                .range(0, 1)
                .byDefault("0.8")
                .synonyms({"base_color", "baseColor", "color", "colour", "albedo", "diffuse_color", "reflectance"}),
            field(FieldType::number, "base-diffuse-roughness", &P::baseDiffuseRoughness)
                .doc("Roughness of the matte base: 0 is Lambert's, 1 is flat like the full moon.")
                .example("base-diffuse-roughness 0.5")
                .unit({Dimension::none, Dimension::fraction})
                .range(0, 1)
                .byDefault("0")
                .synonyms({"base_diffuse_roughness", "diffuse_roughness", "base_roughness", "sigma"}),
            field(FieldType::number, "base-metalness", &P::baseMetalness)
                .doc("Share of the base that is metal.")
                .example("base-metalness 1")
                .unit({Dimension::none, Dimension::fraction})
                .range(0, 1)
                .byDefault("0")
                .synonyms({"base_metalness", "metalness", "metallic", "metalness_weight", "base_metallic"}),
            field(FieldType::complexIndex, "base-metal-index", &P::baseMetalIndex)
                .doc("Measured complex index of the metal, in place of base-color and specular-color there.")
                .example("base-metal-index metal Au")
                .range(0, 1e6)
                .synonyms({"index", "metal", "eta"})};
}

std::vector<FieldInfo> specularFields() {
    return {
        field(FieldType::number, "specular-weight", &P::specularWeight)
            .doc(
                "Factor of the reflectance at normal incidence, by way of the index; of a metal's as a whole. Above 1, "
                "up to where all is reflected.")
            .example("specular-weight 0.5")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1e9)
            .byDefault("1")
            .synonyms({"specular_weight", "specular", "specular_level"}),
        field(FieldType::spectrum, "specular-color", &P::specularColor)
            .doc("Tint of the gloss of plastic and glass; for metal, of its reflectance at 82 degrees.")
            .example("specular-color rgb 1 0.9 0.8")
            .role(SpectrumRole::albedo)
            .range(0, 1)
            .byDefault("1")
            .synonyms({"specular_color", "specularColor", "specular_tint", "edge_tint"}),
        field(FieldType::number, "specular-roughness", &P::specularRoughness)
            .doc("Roughness of base and gloss: 0 is polished, 1 is as rough as it gets; the GGX width α is its square.")
            .example("specular-roughness 0.2")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("0.3")
            .synonyms({"specular_roughness", "roughness", "alpha", "glossiness"}),
        field(FieldType::number, "specular-roughness-anisotropy", &P::specularRoughnessAnisotropy)
            .doc("Stretches the highlight along the tangent: αy = (1 - anisotropy) αx, mean square kept.")
            .example("specular-roughness-anisotropy 0.7")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("0")
            .synonyms({"specular_roughness_anisotropy", "anisotropy", "anisotropic", "specular_anisotropy"}),
        field(FieldType::number, "geometry-tangent", &P::geometryTangent)
            .doc("Turns from the texture's u to the direction that the highlight of the base is stretched along; or a "
                 "texture of directions.")
            .example("geometry-tangent 0.25")
            .range(-1, 1)
            .byDefault("0")
            .synonyms({"geometry_tangent", "tangent", "specular_rotation", "anisotropic_rotation", "rotation"}),
        field(FieldType::spectrum, "specular-ior", &P::specularIor)
            .doc("Refractive index of plastic and glass; a curve that varies disperses.")
            .example("specular-ior 1.5")
            .role(SpectrumRole::index)
            .range(0.2, 10)
            .byDefault("1.5")
            .synonyms({"specular_ior", "specular_IOR", "ior", "eta", "int_ior"})};
}

std::vector<FieldInfo> transmissionFields() {
    return {
        field(FieldType::number, "transmission-weight", &P::transmissionWeight)
            .doc("Share of the base that is not metal which is clear: glass instead of plastic.")
            .example("transmission-weight 1")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("0")
            .synonyms({"transmission_weight", "transmission", "spec_trans"}),
        field(FieldType::spectrum, "transmission-color", &P::transmissionColor)
            .doc("Share of light left after transmission-depth inside; with depth 0, or thin walls, a tint of what "
                 "passes.")
            .example("transmission-color rgb 0.7 0.9 0.8")
            .role(SpectrumRole::albedo)
            .range(0, 1)
            .byDefault("1")
            .synonyms({"transmission_color", "transmissionColor", "attenuation_color", "attenuationColor"}),
        field(FieldType::quantity, "transmission-depth", &P::transmissionDepth)
            .doc("Distance inside after which transmission-color is left; 0 tints at the surface.")
            .example("transmission-depth 5 cm")
            .unit({Dimension::length})
            .range(0, 1e9)
            .byDefault("0 m")
            .synonyms({"transmission_depth", "attenuation_distance", "attenuationDistance", "at_distance"}),
        field(FieldType::spectrum, "transmission-scatter", &P::transmissionScatter)
            .doc("What the inside scatters, milky glass or juice: its coefficient is this over transmission-depth.")
            .example("transmission-scatter rgb 0.4 0.3 0.2")
            .role(SpectrumRole::albedo)
            .range(0, 1)
            .byDefault("0")
            .synonyms({"transmission_scatter", "transmissionScatter", "scatter_color"}),
        field(FieldType::number, "transmission-scatter-anisotropy", &P::transmissionScatterAnisotropy)
            .doc("Mean cosine of that scattering: 0 is even, towards 1 forward.")
            .example("transmission-scatter-anisotropy 0.8")
            .range(-0.99, 0.99)
            .byDefault("0")
            .synonyms({"transmission_scatter_anisotropy", "scatter_anisotropy"}),
        field(FieldType::number, "transmission-dispersion-scale", &P::transmissionDispersionScale)
            .doc("Divides the Abbe number: 0 has no dispersion, 1 has that of the number.")
            .example("transmission-dispersion-scale 1")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("0")
            .synonyms({"transmission_dispersion_scale", "dispersion", "transmission_dispersion"}),
        field(FieldType::number, "transmission-dispersion-abbe-number", &P::transmissionDispersionAbbeNumber)
            .doc(
                "Abbe number (n - 1)/(nF - nC) at the lines d, F and C, with Cauchy's curve through specular-ior at d.")
            .example("transmission-dispersion-abbe-number 55")
            .range(5, 1e6)
            .byDefault("20")
            .synonyms({"transmission_dispersion_abbe_number", "abbe", "abbe_number", "transmission_dispersion_abbe"})};
}

std::vector<FieldInfo> subsurfaceFields() {
    return {
        field(FieldType::number, "subsurface-weight", &P::subsurfaceWeight)
            .doc("Share of the matte base that scatters light under its surface.")
            .example("subsurface-weight 1")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("0")
            .synonyms({"subsurface_weight", "subsurface", "sss_weight"}),
        field(FieldType::spectrum, "subsurface-color", &P::subsurfaceColor)
            .doc("Colour of the subsurface part: the share of the light that it scatters.")
            .example("subsurface-color rgb 0.8 0.5 0.4")
            .role(SpectrumRole::albedo)
            .range(0, 1)
            .byDefault("0.8")
            .synonyms({"subsurface_color", "subsurfaceColor", "sss_color"}),
        field(FieldType::quantity, "subsurface-radius", &P::subsurfaceRadius)
            .doc("Mean distance between two collisions under the surface of a solid; times subsurface-radius-scale.")
            .example("subsurface-radius 2 mm")
            .unit({Dimension::length})
            .range(1e-9, 1e9)
            .byDefault("1 mm")
            .synonyms({"subsurface_radius", "sss_radius", "mean-free-path", "mfp", "scattering_distance"}),
        field(FieldType::spectrum, "subsurface-radius-scale", &P::subsurfaceRadiusScale)
            .doc("Factor of subsurface-radius for each wavelength: how much farther red goes than blue.")
            .example("subsurface-radius-scale rgb 1 0.35 0.17")
            .role(SpectrumRole::albedo)
            .range(0, 1)
            .byDefault("rgb 1 0.5 0.25")
            .synonyms({"subsurface_radius_scale", "subsurfaceRadiusScale", "sss_scale"}),
        field(FieldType::number, "subsurface-scatter-anisotropy", &P::subsurfaceScatterAnisotropy)
            .doc(
                "Mean cosine of a collision. Thin walls: towards 1 the light goes through, towards -1 it is sent back.")
            .example("subsurface-scatter-anisotropy 0.3")
            .range(-1, 1)
            .byDefault("0")
            .synonyms({"subsurface_scatter_anisotropy", "subsurface_anisotropy", "g"})};
}

std::vector<FieldInfo> coatFields() {
    return {
        field(FieldType::number, "coat-weight", &P::coatWeight)
            .doc("Share of the surface that carries a clear coat.")
            .example("coat-weight 1")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("0")
            .synonyms({"coat_weight", "coat", "clearcoat"}),
        field(FieldType::spectrum, "coat-color", &P::coatColor)
            .doc("Colour that the coat gives to what lies below, at normal incidence; the square of its transmittance.")
            .example("coat-color rgb 0.9 0.6 0.2")
            .role(SpectrumRole::albedo)
            .range(0, 1)
            .byDefault("1")
            .synonyms({"coat_color", "coatColor", "clearcoat_color"}),
        field(FieldType::number, "coat-roughness", &P::coatRoughness)
            .doc("Roughness of the coat; it blurs what lies below, too.")
            .example("coat-roughness 0.1")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("0")
            .synonyms({"coat_roughness", "clearcoat_roughness", "clearcoatRoughness"}),
        field(FieldType::number, "coat-roughness-anisotropy", &P::coatRoughnessAnisotropy)
            .doc("Stretches the coat's highlight along the tangent.")
            .example("coat-roughness-anisotropy 0.5")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("0")
            .synonyms({"coat_roughness_anisotropy", "coat_anisotropy"}),
        field(FieldType::number, "coat-ior", &P::coatIor)
            .doc("Refractive index of the coat.")
            .example("coat-ior 1.5")
            .range(0.2, 10)
            .byDefault("1.6")
            .synonyms({"coat_ior", "coat_IOR", "clearcoat_ior"}),
        field(FieldType::number, "coat-darkening", &P::coatDarkening)
            .doc("How far the coat darkens an opaque base by sending light back to it; 0 leaves its colour.")
            .example("coat-darkening 0.5")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("1")
            .synonyms({"coat_darkening", "coat_affect_color"}),
        field(FieldType::number, "geometry-coat-normal", &P::geometryCoatNormal)
            .doc("A normal map for the coat alone; or how far it follows the base's `normal` and `bump`: 0 is smooth.")
            .example("geometry-coat-normal 0")
            .unit({Dimension::none, Dimension::fraction})
            .range(0, 1)
            .byDefault("1")
            .synonyms({"geometry_coat_normal", "coat_normal", "coatNormal", "clearcoat_normal"}),
        field(FieldType::number, "geometry-coat-tangent", &P::geometryCoatTangent)
            .doc("Turns from the texture's u to the direction that the coat's highlight is stretched along; or a "
                 "texture "
                 "of directions.")
            .example("geometry-coat-tangent 0.25")
            .range(-1, 1)
            .byDefault("0")
            .synonyms({"geometry_coat_tangent", "coat_tangent", "coat_rotation", "coat_anisotropy_angle"})};
}

std::vector<FieldInfo> fuzzFields() {
    return {field(FieldType::number, "fuzz-weight", &P::fuzzWeight)
                .doc("Share of the surface that carries fuzz: short upright fibres, dust.")
                .example("fuzz-weight 0.6")
                .unit({Dimension::none, Dimension::fraction})
                .range(0, 1)
                .byDefault("0")
                .synonyms({"fuzz_weight", "fuzz", "sheen", "sheen_weight"}),
            field(FieldType::spectrum, "fuzz-color", &P::fuzzColor)
                .doc("Colour of the fuzz.")
                .example("fuzz-color rgb 0.9 0.8 0.7")
                .role(SpectrumRole::albedo)
                .range(0, 1)
                .byDefault("1")
                .synonyms({"fuzz_color", "fuzzColor", "sheen_color"}),
            field(FieldType::number, "fuzz-roughness", &P::fuzzRoughness)
                .doc("0 is a forest of upright fibres, 1 is dust.")
                .example("fuzz-roughness 0.3")
                .unit({Dimension::none, Dimension::fraction})
                .range(0, 1)
                .byDefault("0.5")
                .synonyms({"fuzz_roughness", "sheen_roughness"})};
}

std::vector<FieldInfo> filmFields() {
    return {field(FieldType::number, "thin-film-weight", &P::thinFilmWeight)
                .doc("Share of the base that carries a film which shows colours of interference.")
                .example("thin-film-weight 1")
                .unit({Dimension::none, Dimension::fraction})
                .range(0, 1)
                .byDefault("0")
                .synonyms({"thin_film_weight", "thin_film", "iridescence"}),
            field(FieldType::quantity, "thin-film-thickness", &P::thinFilmThickness)
                .doc("Thickness of the film, or what a map makes of it. Beyond 10 µm there are no fringes, only their "
                     "mean.")
                .example("thin-film-thickness 350 nm")
                .unit({Dimension::length})
                .range(0, 1)
                .byDefault("500 nm")
                .synonyms({"thin_film_thickness", "iridescence_thickness"})
                .block({field(FieldType::number, "map", &P::thinFilmMap)
                            .doc("A texture, as a factor of the thickness; its first channel counts.")
                            .example("map noise { scale 1 cm }")
                            .range(0, 1e9)
                            .byDefault("1")
                            .synonyms({"texture", "image"})}),
            field(FieldType::number, "thin-film-ior", &P::thinFilmIor)
                .doc("Refractive index of the film.")
                .example("thin-film-ior 1.33")
                .range(0.2, 10)
                .byDefault("1.4")
                .synonyms({"thin_film_ior", "thin_film_IOR", "iridescence_ior"})};
}

std::vector<FieldInfo> emissionFields() {
    return {
        field(FieldType::quantity, "emission-luminance", &P::emissionLuminance)
            .doc("Luminance that the base gives off where emission-color is white, seen without coat and fuzz. Thin "
                 "walls shine on both sides.")
            .example("emission-luminance 1000 nits")
            .unit({Dimension::luminance})
            .range(0, 1e12)
            .byDefault("0 nits")
            .synonyms({"emission_luminance", "emission", "emission_weight", "emission_intensity"}),
        field(FieldType::spectrum, "emission-color", &P::emissionColor)
            .doc("Colour of that light: rgb, plain numbers and textures are factors of D65 of the full luminance; "
                 "spectra of light, such as `blackbody 2700 K`, have all of it. D65 when left out.")
            .example("emission-color rgb 1 0.5 0.2")
            .role(SpectrumRole::tint)
            .range(0, 1e12)
            .synonyms({"emission_color", "emissionColor", "emissive_color"}),
        field(FieldType::toggle, "geometry-thin-walled", &P::geometryThinWalled)
            .doc("The surface is a thin sheet, such as a leaf or a bubble, without an inside.")
            .example("geometry-thin-walled on")
            .byDefault("off")
            .synonyms({"geometry_thin_walled", "thin_walled", "thin"})};
}

} // namespace

TypeInfo openPbrType() {
    TypeInfo type{.kind = Kind::material,
                  .name = "openpbr",
                  .doc = "The OpenPBR 1.1 surface: plastic, metal, glass, car paint, cloth, by one set of parameters.",
                  .example = "material paint openpbr { base-color rgb 0.6 0.05 0.05; coat-weight 1 }",
                  .fields = {}};
    for (const auto fields : {baseFields, specularFields, transmissionFields, subsurfaceFields, coatFields, fuzzFields,
                              filmFields, emissionFields})
        for (FieldInfo& field : fields()) type.fields.push_back(std::move(field));
    return type;
}

} // namespace abbe
