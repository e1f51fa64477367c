#include "schema/foreign_terms.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <string>

namespace abbe::schema {

namespace {

// clang-format off
constexpr auto kTerms = std::to_array<ForeignTerm>({
    {"adaptive sampling", "all", "Pixels are sampled until they are as good as `noise` asks, which is on by default.", "render.noise"},
    {"alpha", "Blender", "The share of light that a surface stops is `opacity`; holes are a texture there. An image has alpha where `alpha` stands in its layers.", "material.opacity"},
    {"ambient light", "games", "A light from everywhere is `light sky`; light that goes round is always simulated.", "light.sky"},
    {"aov", "Arnold, Mitsuba", "Further images of a render are rows of `layers` in `film`.", "film.layers"},
    {"area light", "Blender, Arnold, Mitsuba, pbrt", "`light quad`, `light disk` and `light sphere`; `light mesh` for any surface. A shape with a material emits by `emission`.", "light.quad"},
    {"arnold standard surface", "Arnold", "`material openpbr`; docs/coming_from/arnold.md has its parameters.", "material.openpbr"},
    {"background", "Blender", "`light environment` for a picture, `light sky` for one colour.", "light.environment"},
    {"bidirectional path tracing", "LuxCore, Mitsuba, pbrt", "Light paths are taken where a pilot finds that they pay; `light-paths` decides it by hand.", "render.light-paths"},
    {"blackbody", "all", "A colour by its temperature: `color blackbody 3200 K`.", "spectrum"},
    {"blend", "Arnold, Mitsuba", "`material mix`.", "material.mix"},
    {"bokeh", "photography", "The shape of the aperture: `f-stop 2.8 { blades 9; rotation 12 deg }`.", "camera.f-stop"},
    {"bump map", "all", "`bump 2 mm { map … }` of any material.", "material.bump"},
    {"car paint", "Arnold, Cycles", "`material openpbr` with a coat over a metallic base; `abbe explain presets` lists paints.", "material.openpbr"},
    {"caustics", "all", "Nothing to switch on: a pilot plans for them. `light-paths`, `merging` and `manifold` of `render` decide it by hand.", "render.light-paths"},
    {"clamping", "Blender, Arnold", "Nothing is clamped, as that loses light. Bright rare samples are shown by W0649.", "W0649"},
    {"clearcoat", "Disney, glTF", "`coat-weight` and `coat-roughness` of `material openpbr`.", "material.openpbr"},
    {"color ramp", "Blender", "`texture ramp`.", "texture.ramp"},
    {"constant", "Mitsuba", "Light of one colour from everywhere: `light sky`.", "light.sky"},
    {"cryptomatte", "all", "`layers { cryptomatte }` of `film`.", "film.layers"},
    {"cube", "Blender, Mitsuba", "`shape box`.", "shape.box"},
    {"daylight", "all", "`light daylight` computes sun and sky from where the sun stands.", "light.daylight"},
    {"depth of field", "all", "`f-stop` or `aperture` opens the lens; `focus` says where it is sharp. Without these the camera is a pinhole.", "camera.focus"},
    {"diffuse bsdf", "Blender", "`material diffuse`.", "material.diffuse"},
    {"directional light", "Mitsuba, games", "`light sun` with `angular-diameter 0 deg`.", "light.sun"},
    {"disney principled", "Disney", "`material openpbr`.", "material.openpbr"},
    {"displacement map", "all", "`displacement` of `shape subdivision`.", "shape.displacement"},
    {"distant light", "Arnold, pbrt", "`light sun`.", "light.sun"},
    {"dome light", "RenderMan, V-Ray, USD", "`light environment`; of one colour `light sky`.", "light.environment"},
    {"driver", "Blender", "A text in the place of a number is computed: `rotate z \"$frame * 15\" deg`.", "param"},
    {"emission shader", "Blender", "`emission` of a shape; `light mesh` for what only emits.", "shape.emission"},
    {"emitter", "Mitsuba", "A `light`, or `emission` of a shape.", "light"},
    {"environment map", "all", "`light environment \"studio.exr\"`.", "light.environment"},
    {"envmap", "Mitsuba", "`light environment \"studio.exr\"`.", "light.environment"},
    {"face set", "USD, Houdini", "`material NAME group=GROUP` of a mesh gives groups of faces their materials.", "shape.mesh"},
    {"fireflies", "all", "Bright rare samples are no fault of the picture. W0649 says where they are likely; larger lights and rougher surfaces help.", "W0649"},
    {"firefly clamp", "Arnold, V-Ray", "Nothing is clamped, as that loses light.", "W0649"},
    {"fog", "all", "A `medium` in `atmosphere`, or in the `interior` of a box with `material boundary`.", "medium.homogeneous"},
    {"fresnel", "all", "Every material has it: of an index (`ior`, `index`), never as a curve of one's own.", "material.dielectric"},
    {"fur", "all", "`shape curves` with `material hair`.", "material.hair"},
    {"geometry light", "Arnold", "`light mesh`, or `emission` of a shape.", "light.mesh"},
    {"glass bsdf", "Blender", "`material dielectric`; a pane without thickness is `thin-dielectric`.", "material.dielectric"},
    {"glossy bsdf", "Blender", "`material conductor` with `roughness`.", "material.conductor"},
    {"goniometric light", "pbrt", "`light ies`.", "light.ies"},
    {"hdri", "all", "`light environment \"studio.exr\"`.", "light.environment"},
    {"heterogeneous", "Mitsuba", "`volume vdb` or `volume noise`.", "volume.vdb"},
    {"hosek wilkie", "Blender, Mitsuba", "`light daylight`.", "light.daylight"},
    {"image based lighting", "all", "`light environment \"studio.exr\"`.", "light.environment"},
    {"image texture", "Blender", "`texture image`, or `image \"wood.png\"` in the place of a value.", "texture.image"},
    {"index of refraction", "all", "`ior 1.5`, or of a glass by name: `ior glass N-BK7`.", "material.ior"},
    {"infinite light", "pbrt", "`light environment` for a picture, `light sky` for one colour.", "light.environment"},
    {"instancer", "Arnold, Houdini", "`object` and `instance`, or `instances` for many.", "instances"},
    {"integrator", "Mitsuba, pbrt", "There is one, a path tracer; `render` has what is to choose.", "render"},
    {"interface material", "pbrt", "`material boundary`.", "material.boundary"},
    {"lambert", "Maya", "`material diffuse`.", "material.diffuse"},
    {"light group", "all", "`layers { light-group NAME }` of `film`.", "film.layers"},
    {"light linking", "Arnold, Blender", "There is none: a light reaches what it reaches. `visible-to` hides shapes from kinds of rays.", "shape.visible-to"},
    {"light portal", "Blender, Arnold", "`portals` of `environment`, `sky` and `daylight`; windows are found without them.", "light.portals"},
    {"matte", "games, Maya", "`material diffuse`.", "material.diffuse"},
    {"max bounces", "Blender", "`max-depth` of `render`; without it paths end by Russian roulette.", "render.max-depth"},
    {"mesh light", "Arnold, Blender", "`light mesh`, or `emission` of a shape.", "light.mesh"},
    {"metallic", "Blender, glTF", "`base-metalness` of `material openpbr`; a metal by name is `material conductor { index metal Au }`.", "material.conductor"},
    {"metropolis", "Mitsuba, pbrt", "There is none. Light that is hard to find is found by light paths, photon merging and manifold sampling.", "render.light-paths"},
    {"mirror", "all", "`material conductor { index metal Ag }`.", "material.conductor"},
    {"mix shader", "Blender, Arnold", "`material mix`.", "material.mix"},
    {"motion blur", "all", "`shutter` of the camera, and keys in what moves: `transform { at 0 s { … }; at 1 s { … } }`.", "camera.shutter"},
    {"nishita", "Blender", "`light daylight`.", "light.daylight"},
    {"noise threshold", "Blender, Arnold", "`noise 1 %` of `render`: the relative error of the picture.", "render.noise"},
    {"normal map", "all", "`normal image \"n.png\" space=data` of any material.", "material.normal"},
    {"null bsdf", "Mitsuba", "`material boundary`.", "material.boundary"},
    {"participating media", "pbrt, Mitsuba", "`medium` in the `interior` of a shape, `volume`, or `atmosphere` for everywhere.", "medium"},
    {"path depth", "all", "`max-depth` of `render`; without it paths end by Russian roulette.", "render.max-depth"},
    {"path guiding", "Cycles, Mitsuba", "`guiding` of `render`; a pilot decides whether it pays.", "render"},
    {"photometric light", "Arnold, V-Ray", "`light ies`.", "light.ies"},
    {"photon mapping", "Mitsuba, pbrt", "`merging` of `render`; a pilot decides whether it pays.", "render.merging"},
    {"physical sky", "Arnold", "`light daylight`.", "light.daylight"},
    {"plastic", "Mitsuba, games", "`material openpbr`, or `material layered` over a `diffuse`.", "material.openpbr"},
    {"point cloud", "Blender, Houdini", "`shape points`.", "shape.points"},
    {"polymesh", "Arnold, Houdini", "`shape mesh`.", "shape.mesh"},
    {"preetham", "Blender", "`light daylight`.", "light.daylight"},
    {"principled", "Blender, Mitsuba, Disney", "`material openpbr`.", "material.openpbr"},
    {"principled hair", "Blender", "`material hair`.", "material.hair"},
    {"principled volume", "Blender", "`volume vdb` for a file, `medium homogeneous` for the `interior` of a shape.", "volume.vdb"},
    {"proxy", "Houdini, V-Ray", "`object` and `instance`; `include` for a file of its own.", "include"},
    {"rectangle", "Mitsuba", "`shape quad`; as a light `light quad`.", "shape.quad"},
    {"refractive index", "all", "`ior 1.5`, or of a glass by name: `ior glass N-BK7`.", "material.ior"},
    {"render passes", "Blender", "Rows of `layers` in `film`.", "film.layers"},
    {"roughconductor", "Mitsuba", "`material conductor` with `roughness`, which is the square root of Mitsuba's `alpha`.", "material.conductor"},
    {"roughdielectric", "Mitsuba", "`material dielectric` with `roughness`, which is the square root of Mitsuba's `alpha`.", "material.dielectric"},
    {"roughplastic", "Mitsuba", "`material openpbr`, or `material layered` over a `diffuse`.", "material.openpbr"},
    {"russian roulette", "all", "On by default; `roulette` of `render` chooses its kind.", "render"},
    {"samples per pixel", "all", "`samples` of `render`.", "render.samples"},
    {"scatter", "Blender, Houdini", "`instances` with `on`: scattered over a shape.", "instances"},
    {"sheen", "Disney, Blender", "`material sheen`, or `fuzz-weight` of `material openpbr`.", "material.sheen"},
    {"sky dome", "Arnold", "`light environment`; of one colour `light sky`.", "light.environment"},
    {"sky texture", "Blender", "`light daylight`: sun and sky from where the sun stands.", "light.daylight"},
    {"skydome light", "Arnold", "`light environment \"studio.exr\"`; of one colour `light sky`.", "light.environment"},
    {"smoke", "all", "`volume vdb` for a file, `volume noise` without one.", "volume.vdb"},
    {"specular", "games, Maya", "Mirrors are `material conductor`, gloss on a colour is `material openpbr` with `specular-roughness`.", "material.openpbr"},
    {"spot lamp", "Blender", "`light spot`.", "light.spot"},
    {"standard hair", "Arnold", "`material hair`.", "material.hair"},
    {"standard surface", "Arnold, MaterialX", "`material openpbr`; docs/coming_from/arnold.md has its parameters.", "material.openpbr"},
    {"standard volume", "Arnold", "`volume vdb`, `medium homogeneous`.", "volume.vdb"},
    {"subdivision surface", "Blender", "`shape subdivision`.", "shape.subdivision"},
    {"subsurface scattering", "all", "`material subsurface`, or `subsurface-weight` of `material openpbr`.", "material.subsurface"},
    {"sun lamp", "Blender", "`light sun`.", "light.sun"},
    {"sunsky", "Mitsuba", "`light daylight`.", "light.daylight"},
    {"thin walled", "Arnold, OpenPBR", "`material thin-dielectric`, or `geometry-thin-walled on` of `openpbr`.", "material.thin-dielectric"},
    {"tone mapping", "all", "The EXR is as measured. The PNG beside it goes through an OpenColorIO view: `--view`, `--ocio`.", "film"},
    {"translucent bsdf", "Blender", "`material diffuse-transmission`.", "material.diffuse-transmission"},
    {"transparent bsdf", "Blender", "`opacity` of any material.", "material.opacity"},
    {"trianglemesh", "pbrt", "`shape mesh`.", "shape.mesh"},
    {"uv map", "all", "Texture coordinates come with the mesh; `texture placed` moves and repeats a picture.", "texture.placed"},
    {"velvet", "Blender", "`material sheen`.", "material.sheen"},
    {"vertex color", "Blender, Maya", "`texture attribute` looks at values of vertices by name.", "texture.attribute"},
    {"volume absorption", "Blender", "`absorption` of `material dielectric` for glass, of `medium homogeneous` for smoke.", "medium.homogeneous"},
    {"volume scatter", "Blender", "`medium homogeneous` with `scattering`.", "medium.homogeneous"},
    {"wax", "all", "`material subsurface`; `abbe explain presets` lists some.", "material.subsurface"},
    {"white balance", "photography", "`white` of `film`.", "film"},
    {"world", "Blender", "`light environment` for a picture, `light sky` for one colour, `light daylight` for the weather.", "light.environment"},
});
// clang-format on

// "AreaLight", "area_light" and "area-light" are "area light"; a last word that says only what kind of thing it is
// goes.
std::string normal(std::string_view words) {
    std::string text;
    for (std::size_t i = 0; i < words.size(); ++i) {
        const auto c = static_cast<unsigned char>(words[i]);
        if (std::isalnum(c))
            text += static_cast<char>(std::tolower(c));
        else if (!text.empty() && text.back() != ' ')
            text += ' ';
    }
    while (text.ends_with(' ')) text.pop_back();
    return text;
}

std::string squeezed(std::string_view words) {
    std::string text = normal(words);
    std::erase(text, ' ');
    return text;
}

const ForeignTerm* findSqueezed(const std::string& letters) {
    const auto found = std::ranges::find_if(kTerms, [&](const ForeignTerm& t) { return squeezed(t.term) == letters; });
    return found == kTerms.end() ? nullptr : &*found;
}

} // namespace

std::span<const ForeignTerm> foreignTerms() { return kTerms; }

const ForeignTerm* findForeignTerm(std::string_view words) {
    std::string letters = squeezed(words);
    if (const ForeignTerm* term = findSqueezed(letters)) return term;
    for (const std::string_view tail : {"node", "shader", "bsdf", "material", "light", "texture", "lamp", "s"})
        if (letters.ends_with(tail))
            if (const ForeignTerm* term = findSqueezed(letters.substr(0, letters.size() - tail.size()))) return term;
    return nullptr;
}

} // namespace abbe::schema
