#include "parser/foreign_file.h"

#include "schema/scene_tree.h"
#include "schema/suggest.h"
#include "schema/type.h"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <span>

namespace abbe::parser {

namespace {

using namespace std::string_view_literals;

// What a scene does with a file of another program; `{}` is its name.
constexpr auto kMesh = "write a scene that shows it: `shape mesh \"{}\" {{ material diffuse {{ }} }}`"sv;
constexpr auto kModel =
    "`abbe render` takes it if its name ends in `.obj`; in a scene it is `shape mesh \"{}\" {{ material "
    "diffuse {{ }} }}`"sv;
constexpr auto kPicture = "write a scene that uses it: `texture picture image \"{0}\"` on a surface, or "
                          "`light environment \"{0}\"` all around"sv;
constexpr auto kVolume =
    "write a scene that shows it: `volume cloud vdb \"{}\" {{ extinction 1 per-m; albedo 0.9 }}`"sv;
constexpr auto kPhotometry = "write a scene that uses it: `light ies \"{}\"`"sv;
constexpr auto kSpectrum = "write a scene that uses it: `table \"{}\"` in the place of a spectrum"sv;
constexpr auto kGltf = "meshes and cameras of it can be used: `shape mesh \"{0}\"`, `camera gltf \"{0}\"`"sv;
constexpr auto kExport = "export its meshes as PLY, OBJ or glTF and write a scene: `shape mesh \"model.ply\" "
                         "{{ material diffuse {{ }} }}`"sv;
constexpr auto kRewrite =
    "scenes of this program are not read: keep the meshes (PLY, OBJ, glTF) and pictures, and write "
    "lights, camera and materials anew; `abbe explain` lists the words"sv;
constexpr auto kImport = "`abbe render {0}` renders it, `abbe import {0}` makes a scene file of it"sv;
constexpr auto kMaterials = "give the OBJ file that names it: `abbe render model.obj`"sv;
constexpr auto kOwnImage =
    "`abbe info {0}` says what is in it; a scene uses it as a picture: `texture picture image \"{0}\"`"sv;
constexpr auto kCheckpoint = "`abbe merge` puts parts together; to go on with a render give its scene and `--resume`"sv;
constexpr auto kUnpack = "unpack it first and name the scene file in it"sv;
constexpr auto kNothing = "a scene is a text that begins with `scene 1`"sv;

struct Beginning {
    std::string_view bytes, what, help;
};

// The first bytes of files, by their specifications.
constexpr auto kBeginnings = std::to_array<Beginning>({
    {"\x89PNG\r\n", "a PNG picture", kPicture},
    {"\xff\xd8\xff", "a JPEG picture", kPicture},
    {"v/1\x01", "an OpenEXR image", kOwnImage},
    {"II*\0"sv, "a TIFF picture", kPicture},
    {"MM\0*"sv, "a TIFF picture", kPicture},
    {"II\xbc\x01", "a JPEG XR picture", kNothing},
    {"#?RADIANCE", "a Radiance HDR picture", kPicture},
    {"#?RGBE", "a Radiance HDR picture", kPicture},
    {"GIF8", "a GIF picture", kPicture},
    {"PF\n", "a PFM picture", kPicture},
    {"P6\n", "a PPM picture", kPicture},
    {"glTF", "a binary glTF file", kGltf},
    {"ply\n", "a PLY file", kMesh},
    {"ply\r", "a PLY file", kMesh},
    {"BLENDER", "a Blender file", kExport},
    {"\x28\xb5\x2f\xfd", "a compressed file (Zstandard; Blender saves such files)", kExport},
    {"Kaydara FBX", "an FBX file", kExport},
    {"; FBX", "an FBX file", kExport},
    {"Ogawa", "an Alembic file", kExport},
    {"\x89HDF", "an HDF5 file", kExport},
    {"PXR-USDC", "a USD file", kExport},
    {"#usda", "a USD file", kExport},
    {" BDV", "an OpenVDB file", kVolume},
    {"IESNA", "a photometric file", kPhotometry},
    {"PK\x03\x04", "a ZIP archive or a packed USD file", kUnpack},
    {"\x1f\x8b", "a file compressed by gzip", kUnpack},
    {"##RenderMan", "a RenderMan RIB file", kRewrite},
    {"%PDF", "a PDF file", kNothing},
    {"\x7f"
     "ELF",
     "a program", kNothing},
    {"ABBECKPT", "a checkpoint or a part of a render", kCheckpoint},
});

std::string_view trimmed(std::string_view text) {
    const std::size_t first = text.find_first_not_of(" \t\r\n\v\f");
    return first == std::string_view::npos ? std::string_view() : text.substr(first);
}

// The first lines that are neither empty nor a comment with `#`: enough to know a format by.
std::array<std::string_view, 4> firstLines(std::string_view text) {
    std::array<std::string_view, 4> lines;
    std::size_t count = 0;
    while (!text.empty() && count < lines.size()) {
        const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
        const std::string_view line = trimmed(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        if (!line.empty() && line[0] != '#') lines[count++] = line;
    }
    return lines;
}

std::string_view firstWord(std::string_view line) {
    return line.substr(0, std::min(line.find_first_of(" \t"), line.size()));
}

bool isOneOf(std::string_view word, std::span<const std::string_view> words) {
    return std::ranges::find(words, word) != words.end();
}

bool beginsNumber(std::string_view text) {
    return !text.empty() && ((text[0] >= '0' && text[0] <= '9') || text[0] == '-' || text[0] == '.');
}

// Every line begins with a keyword of the format: `v 0 1 0`, `mtllib a.mtl`. None of them is a word of scenes, but for
// `o` and `g` alone, which is why all lines are asked.
bool isObj(std::span<const std::string_view> lines) {
    constexpr auto words =
        std::to_array<std::string_view>({"v", "vn", "vt", "vp", "f", "l", "o", "g", "s", "mtllib", "usemtl", "newmtl",
                                         "Ka", "Kd", "Ks", "Ns", "Ni", "d", "illum"});
    return !lines[0].empty() && std::ranges::all_of(lines, [&](std::string_view line) {
        return line.empty() || isOneOf(firstWord(line), words);
    });
}

// Statements of pbrt begin with a capital letter, words of scenes never do.
bool isPbrt(std::string_view line) {
    constexpr auto words = std::to_array<std::string_view>({"LookAt",
                                                            "Camera",
                                                            "Sampler",
                                                            "Integrator",
                                                            "SurfaceIntegrator",
                                                            "VolumeIntegrator",
                                                            "Renderer",
                                                            "Film",
                                                            "PixelFilter",
                                                            "Filter",
                                                            "Accelerator",
                                                            "WorldBegin",
                                                            "AttributeBegin",
                                                            "TransformBegin",
                                                            "Scale",
                                                            "Translate",
                                                            "Rotate",
                                                            "Transform",
                                                            "ConcatTransform",
                                                            "CoordinateSystem",
                                                            "Include",
                                                            "Import",
                                                            "Material",
                                                            "MakeNamedMaterial",
                                                            "NamedMaterial",
                                                            "Shape",
                                                            "LightSource",
                                                            "AreaLightSource",
                                                            "Texture",
                                                            "Option",
                                                            "ColorSpace",
                                                            "Identity",
                                                            "ObjectBegin",
                                                            "MakeNamedMedium",
                                                            "MediumInterface"});
    const std::string_view word = firstWord(line), rest = trimmed(line.substr(word.size()));
    return isOneOf(word, words) && (rest.empty() || rest[0] == '"' || rest[0] == '[' || beginsNumber(rest));
}

bool isRib(std::string_view line) {
    constexpr auto words =
        std::to_array<std::string_view>({"Display", "Projection", "Format", "version", "FrameBegin"});
    return isOneOf(firstWord(line), words) && line.find_first_of("\"0123456789") != std::string_view::npos;
}

bool isPython(std::string_view line) {
    const std::string_view word = firstWord(line);
    return (word == "import" || word == "from") && !beginsNumber(trimmed(line.substr(word.size())));
}

std::optional<ForeignFile> jsonFile(std::string_view text) {
    const std::string_view inside = trimmed(text.substr(1));
    const bool list = text[0] == '[';
    const bool sound =
        inside.starts_with('"') || inside.starts_with(list ? ']' : '}') || (list && inside.starts_with('{'));
    if (!sound && !(list && beginsNumber(inside) && inside.find(',') < 40)) return std::nullopt;
    const std::string_view start = text.substr(0, 4096);
    if (start.find("\"asset\"") != std::string_view::npos) return ForeignFile{"a glTF file", std::string(kGltf)};
    return ForeignFile{"a JSON file", std::string(kRewrite)};
}

std::optional<ForeignFile> xmlFile(std::string_view text) {
    const std::string_view start = text.substr(0, 4096);
    const auto holds = [&](std::string_view word) { return start.find(word) != std::string_view::npos; };
    if (holds("<scene")) return ForeignFile{"a scene of Mitsuba (XML)", std::string(kImport)};
    if (holds("<COLLADA")) return ForeignFile{"a COLLADA file", std::string(kExport)};
    if (holds("<materialx")) return ForeignFile{"a MaterialX file", std::string(kRewrite)};
    if (holds("<html") || holds("<!DOCTYPE html")) return ForeignFile{"a web page", std::string(kNothing)};
    if (holds("<svg")) return ForeignFile{"an SVG drawing", std::string(kNothing)};
    return ForeignFile{"an XML file", std::string(kRewrite)};
}

bool isBitmap(std::string_view text) { // `BM`, its size, and four zeros [Windows BITMAPFILEHEADER]
    return text.starts_with("BM") && text.size() > 14 && text.substr(6, 4) == "\0\0\0\0"sv;
}

// `400 0.1`, `400, 0.1`: rows of numbers and nothing else.
bool isNumbers(std::span<const std::string_view> lines) {
    const auto numeric = [](std::string_view line) {
        return line.find_first_not_of("0123456789+-.,;eE \t\r") == std::string_view::npos && beginsNumber(line) &&
               line.find_first_of(",; \t") != std::string_view::npos && !line.starts_with("- ");
    };
    return !lines[1].empty() && std::ranges::all_of(lines, [&](std::string_view l) { return l.empty() || numeric(l); });
}

std::optional<ForeignFile> byText(std::string_view text) {
    const std::string_view start = trimmed(text.starts_with("\xef\xbb\xbf") ? text.substr(3) : text);
    if (start.empty()) return std::nullopt;
    if (start[0] == '{' || start[0] == '[') return jsonFile(start);
    if (start[0] == '<') return xmlFile(start);
    const auto lines = firstLines(start);
    const auto known = [](std::string_view what, std::string_view help) {
        return ForeignFile{what, std::string(help)};
    };
    if (lines[0].starts_with("newmtl ")) return known("a Wavefront material library (MTL)", kMaterials);
    if (isObj(lines)) return known("a Wavefront OBJ file", kModel);
    if (lines[0].starts_with("solid ") && lines[1].starts_with("facet")) return known("an STL file", kExport);
    if (isPbrt(lines[0])) return known("a scene of pbrt", kRewrite);
    if (isRib(lines[0])) return known("a RenderMan RIB file", kRewrite);
    if (lines[0] == "options" || lines[0].starts_with("options {")) return known("a scene of Arnold", kRewrite);
    if (isPython(lines[0])) return known("a Python script", kNothing);
    if (isNumbers(lines)) return known("a table of numbers", kSpectrum);
    return std::nullopt;
}

enum class Match { none, misspelt, word };

// Of a line's first word to those that begin one in a scene.
Match matchOf(std::string_view line, bool mayBeMisspelt) {
    const std::string_view word = line.substr(0, std::min(line.find_first_of(" \t{;("), line.size()));
    if (word == "scene" || word == "param" || word.starts_with("x-") || schema::findKind(word) ||
        line.starts_with("/-"))
        return Match::word;
    if (!mayBeMisspelt) return Match::none;
    const bool cut = !word.empty() && "scene"sv.starts_with(word);
    const bool near = schema::suggestKind(word) || !schema::nearest(word, {"scene", "param"}).empty();
    return cut || near ? Match::misspelt : Match::none;
}

// No text at all, or one none of whose lines begins like one of a scene; in a short one the words may be misspelt. What
// stands in it is nobody's business: a scene's diagnostics would quote it.
std::optional<ForeignFile> byWhatIsMissing(std::string_view text) {
    constexpr std::size_t kEnough = 20; // lines
    if (text.substr(0, 1024).find('\0') != std::string_view::npos) return ForeignFile{"no text", std::string(kNothing)};
    if (text.starts_with("\xef\xbb\xbf")) text.remove_prefix(3);
    std::size_t lines = 0;
    bool misspelt = false;
    while (!text.empty()) {
        const std::size_t end = std::min(text.find_first_of("\r\n"), text.size());
        const std::string_view line = trimmed(text.substr(0, end));
        text.remove_prefix(std::min(end + 1, text.size()));
        if (line.empty()) continue;
        const Match likeness = matchOf(line, lines < kEnough);
        if (likeness == Match::word) return std::nullopt;
        misspelt = misspelt || likeness == Match::misspelt;
        ++lines;
    }
    if (lines == 0 || (misspelt && lines < kEnough)) return std::nullopt;
    return ForeignFile{"a text without any `camera`, `light` or `shape`", std::string(kNothing)};
}

} // namespace

std::optional<ForeignFile> recogniseForeign(std::string_view text, std::string_view name) {
    std::optional<ForeignFile> found;
    for (const Beginning& b : kBeginnings)
        if (text.starts_with(b.bytes)) found = ForeignFile{b.what, std::string(b.help)};
    if (!found && isBitmap(text)) found = ForeignFile{"a BMP picture", std::string(kPicture)};
    if (!found) found = byText(text);
    if (!found) found = byWhatIsMissing(text);
    if (found) found->help = fmt::format(fmt::runtime(found->help), name);
    return found;
}

} // namespace abbe::parser
