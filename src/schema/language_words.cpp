#include "schema/describe.h"

#include <array>

namespace abbe::schema {

namespace {

constexpr auto kKindTexts = std::to_array<KindText>({
    {Kind::camera,
     "From where and through which lens the scene is seen. A file has one or more; the first one is rendered "
     "unless `--camera NAME` says otherwise.",
     "camera [NAME] [TYPE] { … }", "camera { from 0 1.3 4; look-at 0 0.5 0; fov 40 deg }"},
    {Kind::light, "A source of light. Its amount is in real units: lm, cd, lx, nits or W.", "light [NAME] TYPE { … }",
     "light key quad { size 60 120 cm; power 3600 lm; transform { rotate x 90 deg; translate 0 2.8 0 } }"},
    {Kind::shape, "A surface with a material. Closed shapes may have an inside, and most may emit.",
     "shape [NAME] TYPE { … }",
     "shape ball sphere { center 0 0.5 0; radius 0.5; material diffuse { reflectance 0.8 } }"},
    {Kind::group, "Definitions that are moved together. Groups may hold groups.", "group [NAME] { transform { … }; … }",
     "group table { transform { translate 0 0.7 0 }; shape quad { size 1 1; material diffuse } }"},
    {Kind::object, "Definitions that are shown only where an `instance` or `instances` places them.",
     "object NAME { … }", "object pebble { shape sphere { radius 2 cm } }; instance pebble"},
    {Kind::instance, "Places an object once.", "instance OBJECT { transform { … } }",
     "object pebble { shape sphere { radius 2 cm } }; instance pebble { transform { translate 0 0.02 0 } }"},
    {Kind::instances, "Places an object many times: at the points of a file, on a grid, or scattered over a shape.",
     "instances OBJECT { … }",
     "object pebble { shape sphere { radius 2 cm } }; instances pebble { grid 10 1 10; spacing 0.1 0.1 0.1 }"},
    {Kind::material, "What a surface does with light. Defined by name, or inside of a shape.",
     "material NAME TYPE { … }",
     "material gilt conductor { index metal Au; roughness 0.2 }; shape sphere { material gilt }"},
    {Kind::phase, "Where a medium scatters light to.", "phase NAME TYPE { … }",
     "phase forward henyey-greenstein { g 0.85 }; medium milk homogeneous { scattering 1200 per-m; phase forward }; "
     "shape sphere { material boundary; interior milk }"},
    {Kind::medium, "What fills a shape or all of space: fog, milk, smoke.", "medium NAME TYPE { … }",
     "medium fog homogeneous { extinction 0.5 per-m; albedo 0.9 }; shape box { size 2 1 2; material boundary; interior "
     "fog }"},
    {Kind::volume, "A medium with a place of its own: a cloud from a file, haze that thins with height.",
     "volume [NAME] TYPE { … }", "volume mist noise { size 4 1 4; scale 50 cm; extinction 0.4 per-m; albedo 0.99 }"},
    {Kind::atmosphere, "Puts a medium everywhere.", "atmosphere MEDIUM",
     "medium haze homogeneous { extinction 0.02 per-km }; atmosphere haze"},
    {Kind::spectrum, "Gives a spectrum a name: a colour, a curve over wavelength.", "spectrum NAME VALUE",
     "spectrum paint rgb 0.8 0.2 0.1; shape sphere { material diffuse { reflectance paint } }"},
    {Kind::texture, "A picture or pattern that may stand where a material takes a spectrum or a number.",
     "texture NAME TYPE { … }",
     "texture squares checker { even 0.8; odd 0.1; scale 4 }; shape quad { material diffuse { reflectance squares } }"},
    {Kind::film, "The picture: its size, its layers and its file.", "film { … }", "film { size 1280 720 }"},
    {Kind::render, "How long and by which means to render.", "render { … }", "render { samples 256; noise 1 % }"},
});

constexpr std::string_view kFirstScene = R"(scene 1
film { size 640 360 }
camera { from 0 1.3 3; look-at 0 0.45 0; exposure 1.5 stops }
light sky { luminance 8000 nits; color blackbody 8000 K }
light disk { center -4 5 3; normal 4 -5 -3; radius 2.5; luminance 50000 nits }
shape plane { material diffuse { reflectance rgb 0.75 0.7 0.65 } }
shape sphere { center 0 0.5 0; radius 0.5; material conductor { index metal Au; roughness 0.25 } }
)";

LanguageWord headerWord() {
    return {"scene",
            "The first line of a file: the edition of the language, and what holds for all of it.",
            "scene 1 length=mm rgb=acescg up=z",
            {{"length=", "a unit of length", "m", "Unit of lengths that are written without one.", "scene 1 length=cm"},
             {"rgb=", "a linear colour space", "lin_rec709_scene", "What the numbers behind `rgb` mean.",
              "scene 1 rgb=acescg"},
             {"up=", "`y` or `z`", "y", "The vertical axis.", "scene 1 up=z"}}};
}

LanguageWord paramWord() {
    return {"param",
            "Gives a value a name; `$NAME` stands for it anywhere in the file, and `-D NAME=VALUE` on the command line "
            "replaces it. It may be computed from others: `param r2 \"$r * 2\"`.",
            "param turn -32.9 deg \"rotation of the prism\"; shape box { transform { rotate y $turn } }",
            {}};
}

LanguageWord includeWord() {
    return {"include",
            "Brings in what another scene file defines, with the units of that file. With `as=NAME` all its names "
            "begin with "
            "`NAME:`; a block of `param NAME VALUE` gives its parameters other values.",
            "include \"room.scene\" as=set",
            {{"as=", "a name", "", "The prefix of its names.", "include \"room.scene\" as=set"}}};
}

LanguageWord overrideWord() {
    return {"override",
            "`override KIND [NAME] { … }` replaces the properties that it names, and keeps the others. It stands "
            "behind what it "
            "changes. The only camera, film or render needs no name; `--set kind.name.property=value` is the same from "
            "the command "
            "line.",
            "material chalk diffuse { reflectance 0.5 }; shape box { material chalk }; "
            "override material chalk { reflectance 0.8 }",
            {}};
}

LanguageWord removeWord() {
    return {"remove",
            "`remove KIND NAME` takes out a definition that stands before it.",
            "light key point { power 1 W }; remove light key",
            {}};
}

LanguageWord variantWord() {
    return {"variant",
            "`variant NAME { … }` holds overrides, removals and definitions that count when it is chosen: by "
            "`--variant NAME`, or by "
            "`variant NAME` without a block.",
            "light sky { luminance 100 nits }; variant dusk { override light sky { luminance 5 nits } }",
            {}};
}

LanguageWord transformWord() {
    return {"transform",
            "Steps that are applied to what has it, from top to bottom. With `at TIME { … }` blocks it moves.",
            "shape box { transform { scale 2; rotate y 45 deg; translate 0 1 0 } }",
            {{"translate", "three numbers, each a length", "", "Moves.", "translate 0 1 0"},
             {"rotate", "`x`, `y`, `z` or a direction, and an angle", "", "Turns about an axis through the origin.",
              "rotate y 45 deg"},
             {"scale", "one number or three", "", "Makes larger or smaller; negative numbers mirror.", "scale 1 2 1"},
             {"look-at", "two or three triples", "",
              "Moves the origin to the first point and turns +z, the side that quads and disks face, to the second; "
              "the third says what is up.",
              "look-at 0 2 1  0 0 0"},
             {"matrix", "16 numbers", "", "Rows of a matrix for column vectors; the last row is 0 0 0 1.",
              "matrix 1 0 0 0  0 1 0 0  0 0 1 0  0 0 0 1"}}};
}

LanguageWord momentWord() {
    return {"at",
            "A key of a motion, in the order of time: `at TIME { … }` in a `transform`, a camera, or a shape that "
            "deforms. It shows while the camera's shutter is open.",
            "shape box { transform { at 0 s { rotate z 0 deg }; at \"1/50\" s { rotate z 72 deg } } }",
            {}};
}

} // namespace

const KindText& kindText(Kind kind) { return kKindTexts[static_cast<std::size_t>(kind)]; }

std::span<const LanguageWord> languageWords() {
    static const std::array kWords = {headerWord(), paramWord(),   includeWord(),   overrideWord(),
                                      removeWord(), variantWord(), transformWord(), momentWord()};
    return kWords;
}

std::string_view firstScene() { return kFirstScene; }

} // namespace abbe::schema
