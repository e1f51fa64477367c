#include "base/diagnostic_catalogue.h"

namespace abbe {

namespace {

// One entry per line. Ranges: E01 syntax, E02 names, E03 values and units, E04 files, E05 layers, E06 whole scene; W01
// … W06 are the same as warnings.
// clang-format off
constexpr CodeInfo kCodes[] = {
    // E01: syntax
    {"E0101", "unexpected character", "The character has no meaning where it stands. Lists are written as plain values, `from 0 1 4`, without brackets, parentheses or commas."},
    {"E0102", "a character that may not stand in a text", "Control characters, byte order marks inside the text and the Unicode characters that change the direction of writing are not allowed, because they can hide what a file says. Inside a quoted string write them as an escape: `\\u{200E}`."},
    {"E0103", "a text has no end", "A quoted text ends on the line where it began. Add the closing `\"`; for a text of several lines use `\"\"\"`, each of the two on a line end of its own; a raw text `#\"…\"#` ends with as many `#` as it began with."},
    {"E0104", "a comment has no end", "`/*` opens a comment that ends at the matching `*/`; such comments nest, so each inner `/*` needs a `*/` too."},
    {"E0105", "a number and its unit are two words", "Write a space between a number and its unit, as the SI asks: `35 mm`, `3200 K`, `0.5 %`."},
    {"E0106", "a number needs digits on both sides of its point", "Write `0.5` for `.5` and `1.0` or `1` for `1.`."},
    {"E0107", "a bare keyword", "`true`, `false`, `null`, `inf` and `nan` are written with a `#`: `#true`. Switches of the scene language take the words `on` and `off`. A name that is spelled like a keyword needs quotes."},
    {"E0108", "`#` does not begin a comment", "A comment begins with `//` and goes to the end of the line, or stands between `/*` and `*/`. `/-` in front of a node, a value or a block switches it off."},
    {"E0109", "`{` stands on a line of its own", "A line end finishes a node, so the block must open on the line of the node it belongs to: `camera {`."},
    {"E0110", "a block is not closed", "A `{` has no `}`. The place is found by comparing the indentation of closing braces with that of the lines that opened them."},
    {"E0111", "a `}` closes nothing", "There is one `}` more than there are open blocks. An earlier block may have been closed twice."},
    {"E0112", "a comma between values", "Values are separated by spaces: `rgb 0.8 0.2 0.1`. Decimals are written with a point."},
    {"E0113", "`=` in the wrong place", "A property is separated from its value by a space: `fov 40 deg`. Only the keys at the end of a line have an equals sign, and always between a word and one value: `output \"a.exr\" space=acescg`."},
    {"E0114", "text in single quotes", "Text is written in double quotes: `\"a.ply\"`. A single word needs no quotes."},
    {"E0115", "unknown escape in a text", "The escapes are `\\n \\r \\t \\\\ \\\" \\b \\f \\s`, `\\u{1F600}` and a backslash before white space, which removes it. In file names write `/`, or double the backslash, or use a raw text: `#\"C:\\scenes\\a.ply\"#`."},
    {"E0116", "a text of several lines is laid out wrongly", "After the opening `\"\"\"` comes a line end, and the closing `\"\"\"` stands alone on its line. The white space before the closing quotes is removed from every line, so every line that is not empty must begin with it."},
    {"E0117", "this is not a number", "A word that begins with a digit must be a number: `12`, `-0.5`, `1.5e-3`, `1_000_000`, `0xff`, `0o17`, `0b101`. A name that begins with a digit needs quotes; a fraction too: `\"1/48\"`."},
    {"E0118", "the number is too large", "Numbers are stored as 64-bit floating point, whose largest value is about 1.8e308."},
    {"E0119", "blocks are nested too deeply", "At most 256 blocks may stand inside each other."},
    {"E0120", "a space is missing", "Values, keys and blocks are separated by at least one space."},
    {"E0121", "a node begins with a word", "Every line begins with a word (or a quoted text) that says what it is; rows of numbers begin with `-`: `- 0 1 4`."},
    {"E0122", "`/-` has nothing to switch off", "`/-` removes the node, value, key or block that follows it. Only one `/-` may stand before each of them, and none between a key and its value."},
    {"E0123", "parentheses hold only a type annotation", "KDL allows one word in parentheses before a name or value, `(u8)12`; the scene language ignores it. There are no function calls: write `rgb 0.8 0.2 0.1`."},
    {"E0124", "something stands after a block", "A node ends with its block. Begin the next node on a new line or after a `;`, and write all values before the block."},
    {"E0125", "unknown keyword", "The words that begin with `#` are `#true`, `#false`, `#null`, `#inf`, `#-inf` and `#nan`. Colours as hexadecimal digits are texts: `\"#d87040\"`."},
    {"E0199", "too many syntax errors", "After a thousand syntax errors no more are listed. Probably this is not a scene file."},
    {"W0101", "a key is given twice", "The last of several equal keys on a node counts; the others have no effect."},
    // E02: names
    {"E0201", "unknown property", "The type has no property of this name. `abbe explain kind.type` lists the properties of a type with units, defaults and examples. Nodes whose name begins with `x-` are private data of other tools and ignored."},
    {"E0202", "undefined name", "No definition of the wanted kind has this name. Names may be used before they are defined; a bare word is first a defined name, then a built-in type."},
    {"E0203", "a name is defined twice", "Names are unique per kind: two materials cannot share one, a material and a shape can. Definitions inside groups and objects count too."},
    {"E0204", "no parameter has this name", "`$name` stands for the value of `param name value`, which must be written at the top level of the same file."},
    {"E0205", "unknown type", "After the kind comes the type, or a name and the type: `light quad { … }`, `light rim quad { … }`. The message lists the types of the kind."},
    {"E0206", "not available in this version", "The word belongs to the scene language, but this version of the program does not implement it yet."},
    {"E0207", "a property is missing", "The type cannot do without this property and there is no sensible default."},
    {"E0208", "a property is given twice", "A property may stand once in a block. An argument behind the type counts as its property: `mesh \"a.ply\" { file \"b.ply\" }` names two files."},
    {"E0209", "a name is missing or malformed", "A name begins with a letter or `_` and holds letters, digits and `_ . : -`; other names stand in quotes: `\"Cube.001 left\"`. `object`, `spectrum` and `instance` need a name."},
    {"E0210", "unknown key", "The keys behind a value, `key=value`, are fixed by the property."},
    {"E0211", "a type is missing", "Only some kinds have a default type (`camera` is a perspective camera). The others need a type: `shape sphere { … }`. One word after the kind is the type; two words are name and type."},
    {"E0212", "a definition in the wrong place", "Cameras, the film, render settings and parameters are not part of a group or object; they stand at the top level."},
    {"E0213", "an object contains itself", "An `instance` inside of an object places that object again, directly or through others, so that it would be infinitely large."},
    {"E0214", "a block where none is expected", "This value takes no block or arguments. A defined name stands alone: `material glass`; a type may have a block: `material dielectric { … }`."},
    {"E0215", "unknown kind", "A line at the top level of a scene begins with `scene`, `param`, or the kind of a definition: camera, light, shape, group, object, instance, material, spectrum, film, render. A type stands behind its kind: `shape sphere`."},
    {"E0220", "a parameter is defined twice", "Every `param` name may be defined once. To change its value from outside use `-D name=value`."},
    {"E0221", "a parameter of the command line does not exist", "`-D name=value` replaces the value of `param name …` in the scene; `abbe info` lists the parameters of a scene."},
    {"E0222", "a parameter is not complete", "Write `param name value`, with a unit where there is one and a text in quotes at the end that explains it: `param yaw 25 deg \"turntable angle\"`. A parameter has no block and no keys."},
    {"E0223", "a parameter refers to a parameter", "The value of a parameter is a literal: numbers, words or texts. There are no expressions in a scene file."},
    {"E0224", "a key takes one value", "A parameter that holds several values, such as a number and its unit, cannot be the value of a key, `key=$name`."},
    {"W0201", "never used", "The material, spectrum or object is defined, but nothing refers to it. Remove it, or switch it off with `/-`."},
    {"W0202", "a name hides a type", "A material has the name of a material type. Names win over types, so a bare `material diffuse` means the defined one."},
    {"W0205", "a parameter is never used", "No `$name` refers to this `param`. Remove it, or switch it off with `/-`."},
    // E03: values and units
    {"E0301", "unknown unit", "The word after the number is not a unit. `abbe explain units` lists them all."},
    {"E0302", "wrong dimension", "The unit measures something else than the property: a length where an angle is meant, or lux where lumens are. Light has radiometric units (W, W-per-m2) and photometric ones (lm, cd, lx, nits), which are not converted into each other silently."},
    {"E0303", "out of range", "The value is outside of the range that makes physical sense. `abbe explain kind.property` shows the range."},
    {"E0304", "a reflectance above 1", "A surface cannot reflect more light than it receives at any wavelength. If the values are percent, divide them by 100; if a brighter picture is wanted, use more light or more exposure."},
    {"E0305", "not a usable number", "The number is infinite, undefined (a division by zero), or has decimals where a whole number is needed."},
    {"E0306", "wrong number of values", "The property takes another number of values. A unit stands once, behind the last number: `sensor 36 24 mm`. A colour of three numbers has `rgb` in front."},
    {"E0307", "unknown choice", "The property takes one word out of a list, which the message shows."},
    {"E0308", "a switch wants `on` or `off`", "Switches are written `denoise on` or `denoise off`; `#true` and `#false` mean the same."},
    {"E0309", "a row is wrong", "`faces` and similar properties hold rows, `{ - 0 1 2; - 0 2 3 }`. A face has at least three vertices, given by whole numbers from 0 on."},
    {"E0310", "an amount is stated twice", "Some properties are several ways to state one thing, such as `power`, `radiance` and `luminance` of a light, or `lens` and `fov` of a camera. At most one of them may be given."},
    {"E0311", "this spectrum does not fit here", "Every use of a spectrum has its own forms: a reflectance cannot be a `blackbody`, a refractive index cannot be an `rgb` colour. `abbe explain spectrum` lists the forms."},
    {"E0312", "a table is wrong", "A table holds pairs of wavelength in nm and value, with increasing wavelengths, in the line, in rows or in a file. Wavelengths below 5 are probably µm."},
    {"E0313", "a transform is wrong", "`transform` holds the steps `translate`, `rotate`, `scale`, `matrix` and `look-at`, which are applied to the object from top to bottom. No step may flatten the object."},
    {"E0314", "the wrong kind of value", "A number stands where a word is needed, or a word where a number is needed."},
    {"E0315", "a colour is wrong", "`rgb` takes three linear numbers and perhaps `space=`; `srgb` takes an encoded colour, `srgb \"#d87040\"`, or three encoded numbers from 0 to 1. Spaces are lin_rec709_scene, lin_rec2020_scene, lin_p3d65_scene, lin_ap1_scene and lin_ap0_scene, or their short names."},
    {"E0330", "the wrong kind of spectrum", "A reflectance, a light and a refractive index are given by different kinds of spectra: `glass BK7` is an index, `illuminant D65` a light, `measured …` a reflectance. The message says what does not serve as what."},
    {"E0331", "an impossible refractive index", "The index must stay between 0.2 and 10 from 360 to 830 nm. Coefficients of `sellmeier` and `cauchy` take wavelengths in µm; those of catalogues in nm must be converted."},
    {"W0331", "a colour that no smooth spectrum has", "An RGB colour this strong is outside of what reflectances between 0 and 1 can reach. The nearest spectrum is used; the message says how far away it is."},
    {"W0332", "no absorption is tabulated", "The medium is known by its refractive index alone, so it is rendered clear. State `absorption` or `attenuation-color` for a tint."},
    {"E0340", "a light states no amount", "A light says how much it emits by exactly one of `power` (W or lm), `luminance` (nits), `intensity` (cd), `irradiance` (lx or W/m²) and an absolute `radiance`, as far as its type has them. Only `sky`, `sun` and `environment` have a default."},
    {"E0341", "`color` beside `radiance`", "`radiance` is an absolute spectrum, so there is nothing left for `color` to say. `color` gives the shape of the spectrum beside the other amounts."},
    {"E0342", "a power without an area", "Power is spread over the area of a light. A shape of zero or infinite area, such as a plane, can only state its luminance or radiance."},
    {"E0343", "the colour cannot give this light", "lm, cd, lx and nits count visible light only: an infrared line has no lumens. A spectrum that is zero everywhere gives no light at all."},
    {"E0344", "a light has no direction", "A direction of length 0, or a `look-at` that is the light's own position, points nowhere."},
    {"E0345", "the inner cone is larger than the outer one", "A spot is even inside `inner-angle` and dark outside `angle`. Both are full angles, from edge to edge."},
    {"E0346", "the sun's direction is stated twice", "Use `toward`, the direction in which the light travels, or `elevation` and `azimuth`, where the sun stands."},
    {"E0347", "a sun without a diameter has no luminance", "Light from a single direction fills no solid angle, so only its `irradiance` is finite."},
    {"E0348", "an environment is stretched", "The transform of an environment image may turn it, mirror it and scale all axes alike."},
    {"E0350", "a camera is placed twice", "`transform` places the camera instead of `from`, `look-at` and `up`."},
    {"E0351", "a camera is stretched or mirrored", "The transform of a camera may move and turn it; a uniform scale has no effect."},
    {"E0352", "a camera has no direction", "`look-at` is the camera's own position, or the camera looks along `up`. Change one of the three."},
    {"E0353", "the camera's aperture or exposure is incomplete", "`iso` gives a pixel a meaning in lux seconds only together with `shutter` and `f-stop` (or `aperture`); `rotation` and `roundness` of an aperture belong to `blades`."},
    {"E0354", "nothing to focus on", "`focus on=NAME` measures the distance to the middle of a shape's bounds. The shape must be finite, stand by itself or in groups, and lie in front of the camera; parts of an `object` have as many places as it has instances."},
    {"E0355", "a lens prescription is wrong", "`surfaces` holds a row for each surface from the scene to the film: its radius (`flat` for a plane, `stop` for the stop), the thickness to the next one, the medium behind it and the semi-aperture. There is one stop, in air, and the last medium is air."},
    {"E0356", "the lens makes no picture", "The lens diverges, cannot focus at this distance or open to this f-number, or leaves no room for a film behind it. The message says what it can do."},
    // E04: files
    {"E0401", "file not found", "Files are looked up beside the scene file. The message names a file with a similar name if there is one."},
    {"E0402", "the file cannot be used", "The path is a folder, or the file is not readable or not of the expected form."},
    {"E0410", "the scene file cannot be read", "The file does not exist, is a directory, or its permissions forbid reading it."},
    {"E0411", "the scene file is too large", "Scene files are limited to 4 GiB of text. Keep meshes in PLY or OBJ files and volumes in VDB files."},
    {"E0412", "the file is not UTF-8 text", "Scene files are UTF-8. Save the file again with that encoding; binary files are named in a scene, not read as one."},
    {"E0403", "the environment cannot be used", "The image was read, but no environment can be made of it; the message says why."},
    {"E0404", "a file does not fit into memory", "The mesh is larger than the memory of this machine."},
    {"E0430", "the image cannot be written", "Found out before rendering: the folder does not exist, or it cannot be written to, or the name belongs to a folder or a device. `-o FILE` writes the image elsewhere."},
    {"E0431", "the image must be an EXR", "`-o` and the film's `output` name an OpenEXR file. `--png` or `--png=FILE` adds a PNG through a display view."},
    {"E0440", "an environment image is empty", "The image has no pixels."},
    {"E0441", "an environment image is not finite", "Pixels that are infinite or not a number cannot be rendered; the message counts them. They often come from a division by zero, or from values above 65504 in a half-float file."},
    {"W0440", "negative pixels in an environment image", "Radiance cannot be negative. Such pixels, often colours outside of the file's gamut or ringing of a filter, are taken as 0."},
    // E05: layers
    {"E0501", "unknown language edition", "`scene N` names the edition of the language that a file is written in. This version of the program reads edition 1."},
    {"E0502", "the `scene` line is in the wrong place", "A file has one `scene` line, and it is the first one."},
    {"E0503", "the `scene` line is wrong", "It reads `scene 1`, and may have `length=` with a unit of length, `rgb=` with a linear RGB space, `up=y` or `up=z`, and `minor=` with a whole number."},
    {"W0501", "no language edition", "A file without `scene N` is read as edition 1. Write `scene 1` in its first line."},
    // E06: whole scene
    {"E0601", "no camera", "A scene is seen by a camera: `camera { from 0 1 4; look-at 0 0.5 0 }`. With several, `--camera NAME` chooses one."},
    {"E0602", "an object contains itself", "An `instance` inside an `object` may not lead back to that object, also not by way of others: the scene would be infinite. The message names the chain."},
    {"E0603", "a quad has four points", "`points` of a quad lists its four corners in order around it, twelve numbers in all."},
    {"E0604", "a shape without area", "All of it lies in a line or a point, or a transform flattens it. It cannot be seen and cannot emit."},
    {"E0605", "a shape is too far away", "Positions are exact up to about 1e15 m from the camera. A wrong unit is the likely reason: see `length=` in the `scene` line."},
    {"E0606", "an infinite plane emits", "A light needs an end to have a power. Use a quad or a disk."},
    {"E0607", "too many instances", "Instances inside instances multiply. More than 100 million are taken for a mistake."},
    {"E0608", "a second one", "A scene has one `film` and one `render`."},
    {"E0609", "the film is wrong", "The size is two whole numbers, the crop lies within it, and the filter has a positive radius; the message says which rule is broken."},
    {"E0610", "no light", "Without a light the picture would be black. Add one, `light sky { luminance 5000 nits }`, or an `emission` to a shape."},
    {"E0611", "a damaged mesh", "A face names a vertex that is not there, a number is missing, or a coordinate is not finite."},
    {"E0621", "damaged curves or points", "The numbers of points, radii, normals and `counts` must match. A strand needs two points if it is linear, at least four for B-splines and Catmull-Rom, and 4, 7, 10, … for Bézier curves."},
    {"E0622", "curves or points are stretched unevenly", "Their transform, with those of the groups around them, may move, turn, mirror and scale evenly: their radius is one number. An `instance` of an `object` may stretch them; tubes and spheres become elliptical."},
    {"E0623", "curves or points emit", "This version cannot make lights of them. Use shapes that can emit: `mesh`, `quad`, `disk`, `sphere`."},
    {"E0650", "the image does not fit into memory", "The sums of a pixel take 28 bytes per replicate, and writing needs some more. `crop` in the film renders a part."},
    {"W0602", "a black environment", "No pixel of the environment image is above zero, so it lights nothing and is left out."},
    {"W0603", "faces without area", "Faces whose corners lie in a line or a point cannot be seen and are left out."},
    {"W0621", "curves or points without width", "Segments whose control points all have the radius 0 or lie in one place, and points with radius 0, cannot be seen. The message counts them."},
    {"W0630", "values beyond half floats", "The film's `output` asks for 16-bit values, whose largest is 65504. Larger ones were written as that."},
    {"W0631", "a channel was left out", "An ACES container (half, uncompressed, ACES2065-1) holds red, green and blue alone."},
    {"W0640", "samples were dropped", "A sample that is not finite or is negative never reaches the image: it is left out of its pixel's mean and counted. A few hint at a numerical limit, many at a mistake in the scene or in the program. `--pixel X,Y` repeats one pixel."},
    {"W0641", "a black image", "No light reaches the camera. It may look away from the scene or stand inside something; a light may face the other way or be enclosed; the exposure may be far too low."},
    {"W0642", "endless paths", "Paths that scatter 100000 times are cut, because nothing in the scene absorbs them. Reflectances of exactly 1 in a closed room do this."},
};
// clang-format on

} // namespace

const CodeInfo* findCode(std::string_view code) {
    for (const CodeInfo& info : kCodes)
        if (info.code == code) return &info;
    return nullptr;
}

std::span<const CodeInfo> allCodes() { return kCodes; }

} // namespace abbe
