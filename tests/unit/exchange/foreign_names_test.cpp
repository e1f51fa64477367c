// Every name that the other programs have is imported, or said to be left out where it stands: none is unknown.
// Plugins of Mitsuba 3.9.1 (its folder of plugins, and the integrators that it has in Python) and names of pbrt-v4
// (its parser, commit of 2024).
#include "exchange/mitsuba/mitsuba_import.h"
#include "unit/exchange/pbrt_cases.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

using namespace abbe;
using namespace abbe::exchange;

namespace {

struct ForeignName {
    const char* name;
    const char* codes = ""; // of what is said about it: W0801 left out, W0802 approximated, E0401 its file is not there
    const char* body = "";  // what it needs
};

// Codes of diagnostics, in order, each once; W0801 and W0802 must have a place.
std::string codesOf(const Diagnostics& diagnostics) {
    std::string codes;
    for (const Diagnostic& d : diagnostics.all()) {
        if (d.code != "E0802") CHECK(d.span.valid());
        if (codes.find(d.code) == std::string::npos) codes += (codes.empty() ? "" : " ") + d.code;
    }
    return codes;
}

std::string mitsubaCodes(const std::string& xml) {
    const TemporaryFolder folder;
    writeAll(folder / "a.xml", "<scene version=\"3.0.0\">" + xml + "</scene>");
    SourceMap sources;
    Diagnostics diagnostics;
    SideFiles files(folder / "a.scene");
    Import import{sources, diagnostics, files, {}};
    importMitsuba(folder / "a.xml", import);
    return codesOf(diagnostics);
}

// `element` is the tag, perhaps with the name of the parameter: "texture name='reflectance'".
void checkMitsuba(const std::string& element, std::string_view before, std::string_view behind,
                  std::initializer_list<ForeignName> names) {
    const std::string tag = element.substr(0, element.find(' '));
    for (const ForeignName& n : names) {
        const std::string xml =
            fmt::format("{}<{} type=\"{}\">{}</{}>{}", before, element, n.name, n.body, tag, behind);
        CHECK_MESSAGE(mitsubaCodes(xml) == std::string(n.codes), xml);
    }
}

constexpr const char* kNoFile = "<string name=\"filename\" value=\"none\"/>";
constexpr const char* kGrey = "<bsdf type=\"diffuse\"/>";

} // namespace

TEST_CASE("names: Mitsuba's BSDFs") {
    checkMitsuba("bsdf", "<shape type=\"sphere\">", "</shape>",
                 {{"blendbsdf", "", "<bsdf type=\"diffuse\"/><bsdf type=\"conductor\"/>"},
                  {"bumpmap", "", "<texture type=\"checkerboard\"/><bsdf type=\"diffuse\"/>"},
                  {"circular", "W0802"},
                  {"conductor"},
                  {"dielectric"},
                  {"diffuse"},
                  {"hair", "W0802"},
                  {"mask", "", kGrey},
                  {"measured", "E0401", kNoFile},
                  {"measured_polarized", "W0801", kNoFile},
                  {"normalmap", "", "<texture type=\"checkerboard\"/><bsdf type=\"diffuse\"/>"},
                  {"null"},
                  {"plastic", "W0802"},
                  {"polarizer", "W0802"},
                  {"pplastic", "W0802"},
                  {"principled", "W0802"},
                  {"principledthin", "W0802"},
                  {"retarder", "W0802"},
                  {"roughconductor", "W0802"},
                  {"roughdielectric", "W0802"},
                  {"roughplastic", "W0802"},
                  {"thindielectric"},
                  {"twosided", "", kGrey}});
}

TEST_CASE("names: Mitsuba's shapes, emitters and sensors") {
    checkMitsuba("shape", "", "",
                 {{"blender", "W0801"},
                  {"bsplinecurve", "E0401", kNoFile},
                  {"cube"},
                  {"cylinder"},
                  {"disk"},
                  {"ellipsoids", "W0801", kNoFile},
                  {"ellipsoidsmesh", "W0801", kNoFile},
                  {"instance", "", "<shape type=\"shapegroup\"><shape type=\"sphere\"/></shape>"},
                  {"linearcurve", "E0401", kNoFile},
                  {"merge", "", "<shape type=\"sphere\"/>"},
                  {"obj", "E0401", kNoFile},
                  {"ply", "E0401", kNoFile},
                  {"rectangle"},
                  {"sdfgrid", "W0801", kNoFile},
                  {"serialized", "E0401", kNoFile},
                  {"shapegroup", "", "<shape type=\"sphere\"/>"},
                  {"sphere"}});
    checkMitsuba("emitter", "<shape type=\"disk\">", "</shape>", {{"area"}, {"directionalarea"}});
    checkMitsuba("emitter", "", "",
                 {{"constant"},
                  {"directional"},
                  {"envmap", "E0401", kNoFile},
                  {"point"},
                  {"projector", "W0802"},
                  {"spot", "W0802"},
                  {"sunsky", "W0802"},
                  {"timed_sunsky", "W0802"}});
    checkMitsuba("sensor", "", "",
                 {{"batch", "W0802", "<sensor type=\"perspective\"/><sensor type=\"thinlens\"/>"},
                  {"distant", "W0801"},
                  {"flat_sensor", "W0801"},
                  {"orthographic"},
                  {"perspective"},
                  {"radiancemeter", "W0802"},
                  {"thinlens"}});
    checkMitsuba("sensor", "<shape type=\"rectangle\">", "</shape>", {{"irradiancemeter", "W0801"}});
}

TEST_CASE("names: Mitsuba's films, filters, samplers and integrators") {
    checkMitsuba("film", "<sensor type=\"perspective\">", "</sensor>", {{"hdrfilm"}, {"specfilm", "W0802"}});
    checkMitsuba("rfilter", "<sensor type=\"perspective\"><film type=\"hdrfilm\">", "</film></sensor>",
                 {{"box"}, {"catmullrom", "W0802"}, {"gaussian"}, {"lanczos", "W0802"}, {"mitchell"}, {"tent"}});
    checkMitsuba("sampler", "<sensor type=\"perspective\">", "</sensor>",
                 {{"independent"}, {"ldsampler"}, {"multijitter"}, {"orthogonal"}, {"stratified"}});
    checkMitsuba("integrator", "", "",
                 {{"aov", "", "<integrator type=\"path\"/>"},
                  {"depth", "W0802"},
                  {"direct"},
                  {"direct_projective"},
                  {"moment", "W0801", "<integrator type=\"path\"/>"},
                  {"path"},
                  {"prb"},
                  {"prb_basic"},
                  {"prb_projective"},
                  {"prbvolpath"},
                  {"ptracer"},
                  {"stokes", "W0801", "<integrator type=\"path\"/>"},
                  {"volpath"},
                  {"volpathmis"},
                  {"volprim_rf_basic", "W0802"}});
}

TEST_CASE("names: Mitsuba's textures, spectra, media and phase functions") {
    checkMitsuba(
        "texture name='reflectance'", "<shape type=\"sphere\"><bsdf type=\"diffuse\">", "</bsdf></shape>",
        {{"bitmap", "E0401", "<string name=\"filename\" value=\"none\"/>"},
         {"checkerboard"},
         {"mesh_attribute", "", "<string name=\"name\" value=\"vertex_color\"/>"},
         {"volume", "", "<volume type=\"constvolume\" name=\"volume\"><rgb name=\"value\" value=\"0.3\"/></volume>"}});
    checkMitsuba(
        "spectrum name='radiance'", "<emitter type=\"constant\">", "</emitter>",
        {{"blackbody", "", "<float name=\"temperature\" value=\"3000\"/>"},
         {"d65"},
         {"irregular", "", "<string name=\"wavelengths\" value=\"400, 700\"/><string name=\"values\" value=\"1, 2\"/>"},
         {"rawconstant", "", "<float name=\"value\" value=\"1\"/>"},
         {"regular", "", "<string name=\"values\" value=\"1, 2\"/>"},
         {"srgb", "", "<rgb name=\"color\" value=\"0.1, 0.2, 0.3\"/>"},
         {"uniform"}});
    const char* const before = "<integrator type=\"volpath\"/><shape type=\"sphere\"><bsdf type=\"dielectric\"/>";
    checkMitsuba("medium name='interior'", before, "</shape>",
                 {{"homogeneous"},
                  {"heterogeneous", "",
                   "<volume type=\"constvolume\" name=\"sigma_t\"><float name=\"value\" value=\"2\"/></volume>"},
                  {"heterogeneous", "W0801", "<volume type=\"gridvolume\" name=\"sigma_t\"/>"}});
    const std::string inside = std::string(before) + "<medium type=\"homogeneous\" name=\"interior\">";
    checkMitsuba("phase", inside, "</medium></shape>",
                 {{"blendphase", "", "<phase type=\"hg\"/><phase type=\"isotropic\"/>"},
                  {"hg"},
                  {"isotropic"},
                  {"rayleigh"},
                  {"sggx", "W0801"},
                  {"tabphase", "", "<string name=\"values\" value=\"1, 2, 3\"/>"}});
}

namespace {

void checkPbrt(std::string_view before, std::string_view behind, std::initializer_list<ForeignName> names) {
    for (const ForeignName& n : names) {
        const PbrtCase made(fmt::format("{}\"{}\" {}{}", before, n.name, n.body, behind));
        CHECK_MESSAGE(codesOf(made.diagnostics) == std::string(n.codes), std::string(n.name), "\n", made.report());
    }
}

} // namespace

TEST_CASE("names: pbrt's options of the view") {
    const char* const end = "\nWorldBegin\n";
    checkPbrt("Camera ", end, {{"orthographic"}, {"perspective"}, {"realistic", "E0802"}, {"spherical", "W0802"}});
    checkPbrt("Film ", end, {{"gbuffer"}, {"rgb"}, {"spectral"}});
    checkPbrt("PixelFilter ", end, {{"box"}, {"gaussian"}, {"mitchell"}, {"sinc", "W0802"}, {"triangle"}});
    checkPbrt("Sampler ", end,
              {{"halton"}, {"independent"}, {"paddedsobol"}, {"pmj02bn"}, {"sobol"}, {"stratified"}, {"zsobol"}});
    checkPbrt("Integrator ", end,
              {{"ambientocclusion", "W0802"},
               {"bdpt", "W0802"},
               {"function", "W0802"},
               {"lightpath", "W0802"},
               {"mlt", "W0802"},
               {"path"},
               {"randomwalk", "W0802"},
               {"simplepath"},
               {"simplevolpath"},
               {"sppm", "W0802"},
               {"volpath"}});
    checkPbrt("Accelerator ", end, {{"bvh"}, {"kdtree"}});
    checkPbrt("ColorSpace ", end, {{"aces2065-1"}, {"dci-p3"}, {"rec2020"}, {"srgb"}});
}

TEST_CASE("names: pbrt's world") {
    const std::string begin = pbrtWorld("");
    checkPbrt(begin + "Shape ", "\n",
              {{"bilinearmesh", "", "\"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]"},
               {"curve", "", "\"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0]"},
               {"cylinder"},
               {"disk"},
               {"loopsubdiv", "", "\"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]"},
               {"plymesh", "E0802", "\"string filename\" \"none.ply\""},
               {"sphere"},
               {"trianglemesh", "", "\"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2]"}});
    checkPbrt(begin + "Material ", "\nShape \"sphere\"\n",
              {{"coatedconductor", "W0802"},
               {"coateddiffuse", "W0802"},
               {"conductor"},
               {"dielectric"},
               {"diffuse"},
               {"diffusetransmission"},
               {"hair"},
               {"interface"},
               {"measured", "", "\"string filename\" \"none.bsdf\""},
               {"subsurface", "W0802"},
               {"thindielectric"}});
    checkPbrt(begin + "LightSource ", "\n",
              {{"distant"},
               {"goniometric"},
               {"infinite"},
               {"point"},
               {"projection", "E0802", "\"string filename\" \"none.exr\""},
               {"spot"}});
    checkPbrt(begin + "AreaLightSource ", "\nShape \"sphere\"\n", {{"diffuse"}});
    checkPbrt(begin + "Texture \"t\" \"spectrum\" ",
              "\nMaterial \"diffuse\" \"texture reflectance\" \"t\"\nShape \"sphere\"\n",
              {{"bilerp"},
               {"checkerboard"},
               {"constant"},
               {"directionmix", "W0802"},
               {"dots", "W0801"},
               {"imagemap", "E0802", "\"string filename\" \"none.exr\""},
               {"marble", "W0802"},
               {"mix"},
               {"ptex", "W0801", "\"string filename\" \"none.ptx\""},
               {"scale"}});
    checkPbrt(begin + "Texture \"t\" \"float\" ", "\n", {{"fbm", "W0802"}, {"windy", "W0802"}, {"wrinkled", "W0802"}});
    checkPbrt(begin + "MakeNamedMedium \"m\" \"string type\" ",
              "\nMediumInterface \"m\" \"\"\nMaterial \"interface\"\nShape \"sphere\"\n",
              {{"cloud", "W0802"},
               {"homogeneous"},
               {"nanovdb", "", "\"string filename\" \"none.nvdb\""},
               {"rgbgrid", "W0802", "\"integer nx\" 1 \"integer ny\" 1 \"integer nz\" 1 \"rgb sigma_s\" [1 1 1]"},
               {"uniformgrid", "", "\"integer nx\" 1 \"integer ny\" 1 \"integer nz\" 1 \"float density\" 1"}});
}
