// What constructs of pbrt become.
#include "io/mesh_file.h"
#include "unit/exchange/pbrt_cases.h"

#include <cstdint>
#include <cstring>
#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::exchange;

namespace {

std::string pbrtMade(const std::string& world) { return PbrtCase(pbrtWorld(world)).scene; }

bool pbrtHolds(const std::string& text, std::string_view part) {
    INFO(text);
    return text.find(part) != std::string::npos;
}

std::string pbrtBall(const std::string& material) { return pbrtMade(material + "\nShape \"sphere\"\n"); }

} // namespace

TEST_CASE("pbrt: materials by their own parameters and defaults") {
    CHECK(pbrtHolds(pbrtBall("Material \"diffuse\""), "diffuse-1 diffuse { reflectance 0.5 }"));
    CHECK(pbrtHolds(pbrtBall("Material \"conductor\""), "conductor { index metal Cu }"));
    CHECK(pbrtHolds(pbrtBall("Material \"conductor\" \"spectrum eta\" [400 1 700 2] \"spectrum k\" [400 3 700 3]"),
                    "index { n table { - 400 1; - 700 2 }; k table { - 400 3; - 700 3 } }"));
    CHECK(pbrtHolds(pbrtBall("Material \"dielectric\" \"float eta\" 1.33"), "dielectric { ior 1.33 }"));
    CHECK(pbrtHolds(pbrtBall("Material \"dielectric\" \"spectrum eta\" \"glass-F11\""), "ior glass SF11"));
    CHECK(pbrtHolds(pbrtBall("Material \"thindielectric\""), "thin-dielectric"));
    CHECK(pbrtHolds(pbrtBall("Material \"diffusetransmission\" \"float scale\" 0.5"),
                    "{ reflectance 0.125; transmittance 0.125 }"));
    CHECK(PbrtCase(pbrtWorld("Material \"diffusetransmission\" \"float scale\" 9\n")).says("scaled to 1 together"));
    CHECK(pbrtHolds(pbrtBall("Material \"dielectric\" \"spectrum eta\" [500 1.4]"), "ior 1.4"));
    CHECK(pbrtHolds(pbrtBall("Material \"hair\""), "eumelanin 1.3"));
    CHECK_FALSE(pbrtHolds(pbrtBall("Material \"hair\" \"rgb sigma_a\" [1 2 3]"), "eumelanin"));
    CHECK(pbrtHolds(pbrtBall("Material \"subsurface\" \"rgb reflectance\" [.8 .5 .4] \"float mfp\" 0.01"),
                    "mean-free-path 0.01 m"));
    CHECK(pbrtHolds(pbrtBall("Material \"subsurface\" \"string name\" \"Skin1\" \"float scale\" 1000"),
                    "scattering rgb 740 880 1010; absorption rgb 32 170 480"));
    CHECK(pbrtHolds(pbrtBall("Material \"measured\" \"string filename\" \"a.bsdf\""), "measured \""));
    CHECK(PbrtCase(pbrtWorld("Material \"measured\"\n")).says("E0802"));
    CHECK(PbrtCase(pbrtWorld("Material \"difuse\"\n")).diagnostics.all().at(0).help == "did you mean `diffuse`?");
}

TEST_CASE("pbrt: coats absorb as pbrt's slabs do, and metals under them have the relative index") {
    // exp(-thickness / cos) at a thickness of 0.01
    const std::string coat = pbrtBall("Material \"coateddiffuse\" \"float roughness\" 0.0081");
    CHECK(pbrtHolds(coat, "layered {"));
    CHECK(pbrtHolds(coat, "absorption 1 per-m"));
    CHECK(pbrtHolds(coat, "thickness 0.01 m"));
    CHECK(pbrtHolds(coat, "roughness 0.3"));
    const std::string metal =
        pbrtBall("Material \"coatedconductor\" \"float interface.eta\" 2 "
                 "\"spectrum conductor.eta\" [400 1 700 1] \"spectrum conductor.k\" [400 3 700 3]");
    CHECK(pbrtHolds(metal, "n table { - 400 0.5; - 700 0.5 }; k table { - 400 1.5; - 700 1.5 }"));
    CHECK(pbrtHolds(metal, "ior 2"));
}

TEST_CASE("pbrt: named materials may be mixed and defined later") {
    const PbrtCase made(pbrtWorld(
        "MakeNamedMaterial \"m\" \"string type\" \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" 0.3\n"
        "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"b\" \"string type\" \"conductor\"\n"
        "NamedMaterial \"m\"\nShape \"sphere\"\nNamedMaterial \"c\"\nShape \"disk\"\n"));
    CHECK(made.has("material m mix { first a; second b; amount 0.3 }"));
    CHECK(made.says("there is no material `c`"));
}

TEST_CASE("pbrt: textures, and the numbers that stand for them") {
    const std::string wood = "Texture \"w\" \"spectrum\" \"checkerboard\" \"float uscale\" 3 \"float vscale\" 2\n";
    const std::string quad = "Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0]\n";
    const std::string made = pbrtMade(wood + "Material \"diffuse\" \"texture reflectance\" \"w\"\n" + quad);
    CHECK(pbrtHolds(made, "texture w checker { even 1; odd 0; scale 1 }"));
    CHECK(pbrtHolds(made, "uvs { - 0 0; - 3 0; - 0 2; - 3 2 }")); // the mesh has the mapping
    CHECK(pbrtHolds(pbrtMade("Texture \"c\" \"float\" \"constant\" \"float value\" 0.0081\n"
                             "Material \"conductor\" \"texture roughness\" \"c\"\n" +
                             quad),
                    "roughness 0.3"));
    CHECK(pbrtHolds(pbrtMade("Texture \"a\" \"float\" \"fbm\"\nTexture \"b\" \"float\" \"scale\" \"texture tex\" \"a\" "
                             "\"float scale\" 0.2\n"
                             "Material \"diffuse\" \"texture displacement\" \"b\"\n" +
                             quad),
                    "bump 0.2 m { map a }"));
    CHECK(pbrtHolds(
        pbrtMade("Texture \"a\" \"float\" \"fbm\"\nTexture \"b\" \"spectrum\" \"mix\" \"texture amount\" \"a\"\n"
                 "Material \"diffuse\" \"texture reflectance\" \"b\"\n" +
                 quad),
        "texture b ramp { input a; stop 0 0; stop 1 1 }"));
    const PbrtCase lost(
        pbrtWorld("Texture \"a\" \"float\" \"dots\"\nTexture \"p\" \"spectrum\" \"ptex\" \"string filename\" \"x\"\n"
                  "Texture \"w\" \"spectrum\" \"windy\"\nMaterial \"diffuse\" \"texture reflectance\" \"q\"\n"));
    CHECK(lost.says("the dots of a texture is left out"));
    CHECK(lost.says("Ptex files are not read"));
    CHECK(lost.says("error[E0802]: there is no spectrum texture `q`"));
}

TEST_CASE("pbrt: images, how they are stored and where they end") {
    PbrtCase made;
    writeAll(made.folder / "a.png", "");
    made.import(
        pbrtWorld("Texture \"a\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" \"string wrap\" \"clamp\"\n"
                  "Texture \"b\" \"float\" \"imagemap\" \"string filename\" \"a.png\" \"string encoding\" \"linear\" "
                  "\"bool invert\" true\n"
                  "Texture \"c\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" \"float scale\" 0.5\n"
                  "Texture \"d\" \"spectrum\" \"imagemap\" \"string filename\" \"none.png\"\n"));
    CHECK(made.has("texture a image \"a.png\" { wrap clamp }"));
    CHECK(made.has("texture b-image image \"a.png\" space=data"));
    CHECK(made.has("texture b ramp { input b-image; stop 0 1; stop 1 0 }"));
    CHECK(made.has("texture c product { first c-image; second 0.5 }"));
    CHECK(made.says("the image `none.png` does not exist"));
}

TEST_CASE("pbrt: alpha is the opacity of a copy of the material") {
    const std::string made =
        pbrtMade("Material \"diffuse\"\nShape \"sphere\" \"float alpha\" 0.5\nShape \"disk\" \"float alpha\" 0.5\n"
                 "Shape \"sphere\" \"float alpha\" 1\n");
    CHECK(pbrtHolds(made, "material diffuse-1-cut diffuse { reflectance 0.5; opacity 0.5 }"));
    CHECK_FALSE(pbrtHolds(made, "cut-2"));
    CHECK(pbrtHolds(made, "shape sphere { radius 1; material diffuse-1 }"));
}

TEST_CASE("pbrt: large meshes go to files, with what their shape says") {
    std::string points, normals, indices;
    for (int i = 0; i < 30; ++i) {
        points += std::to_string(i) + " 0 " + std::to_string(i % 2) + " ";
        normals += "0 1 0 ";
        if (i + 2 < 30) indices += std::to_string(i) + " " + std::to_string(i + 1) + " " + std::to_string(i + 2) + " ";
    }
    const PbrtCase made(pbrtWorld("Shape \"trianglemesh\" \"point3 P\" [" + points + "] \"normal3 N\" [" + normals +
                                  "] \"integer indices\" [" + indices + "]\n"));
    CHECK(made.has("shape mesh \"case-files/mesh-1.ply\""));
    const MeshData mesh = readPly(made.folder / "case-files/mesh-1.ply").mesh;
    REQUIRE(mesh.positions.size() == 30);
    REQUIRE(mesh.triangles.size() == 28);
    for (const auto& t : mesh.triangles) { // all face where their normals point, up
        const Vec3 a = mesh.positions[t[0]], b = mesh.positions[t[1]], c = mesh.positions[t[2]];
        CHECK(cross(b - a, c - a).y > 0);
    }
    CHECK(PbrtCase(pbrtWorld("Shape \"trianglemesh\" \"point3 P\" [0 0 0] \"integer indices\" [0 1 2]\n"))
              .says("none of the 1 points"));
    CHECK(PbrtCase(pbrtWorld("Shape \"trianglemesh\" \"point3 P\" [0 0 1e300 0 0 1 1 1 1]\n"))
              .says("too large for single precision"));
    CHECK(PbrtCase(pbrtWorld("Shape \"plymesh\" \"string filename\" \"none.ply\"\n")).says("error[E0802]"));
}

TEST_CASE("pbrt: strands in a row are one shape") {
    std::string strands = "Material \"hair\"\n";
    for (int i = 0; i < 5; ++i)
        strands += "Shape \"curve\" \"point3 P\" [0 0 0 1 0 0 2 0 0 3 0 0] \"float width0\" 0.2 \"float width1\" 0.1\n";
    strands += "Translate 1 0 0\nShape \"curve\" \"point3 P\" [0 0 0 1 0 0 2 0 0 3 0 0] \"string basis\" \"bspline\"\n";
    const PbrtCase made(pbrtWorld(strands));
    CHECK(made.has("shape curves \"case-files/curves-1.ply\" { basis bezier; form flat; material hair-1 }"));
    CHECK(made.has("shape curves \"case-files/curves-2.ply\" { basis bspline; form flat; material hair-1; transform { "
                   "translate 1 0 0 } }"));
    const std::string ply = readAll(made.folder / "case-files/curves-1.ply");
    CHECK(ply.find("element vertex 20") != std::string::npos);
    CHECK(ply.find("element strand 5") != std::string::npos);
}

TEST_CASE("pbrt: parts of round shapes become meshes, whole ones stay exact") {
    CHECK(PbrtCase(pbrtWorld("Shape \"sphere\" \"float zmin\" 0\n")).says("a part of a sphere is approximated"));
    CHECK(PbrtCase(pbrtWorld("Shape \"disk\" \"float innerradius\" 0.5\n")).says("W0802"));
    const PbrtCase tube(pbrtWorld("Shape \"cylinder\" \"float radius\" 0.5 \"float zmin\" 0 \"float zmax\" 3\n"));
    CHECK(tube.report() == "");
    CHECK(tube.has("radius 0.5"));
    CHECK(tube.has("height 3"));
    CHECK(tube.has("caps off"));
    CHECK(pbrtHolds(pbrtMade("Shape \"loopsubdiv\" \"integer levels\" 4 \"point3 P\" [0 0 0 1 0 0 0 1 0 0 0 1] "
                             "\"integer indices\" [0 2 1 0 1 3 1 2 3 2 0 3]\n"),
                    "dicing 4"));
}

TEST_CASE("pbrt: objects are placed by instances, and do not shine") {
    const PbrtCase made(
        pbrtWorld("ObjectBegin \"o\"\nTranslate 1 0 0\nAreaLightSource \"diffuse\"\nShape \"sphere\"\nObjectEnd\n"
                  "Translate 0 0 4\nObjectInstance \"o\"\nObjectInstance \"p\"\n"));
    CHECK(made.has("object o {"));
    CHECK(made.has("instance o { transform { translate 0 0 4 } }"));
    CHECK(made.says("the light of a shape in an object is left out"));
    CHECK(made.says("there is no object `p`"));
    CHECK_FALSE(made.has("emission"));
}

TEST_CASE("pbrt: media inside of shapes, around the camera, and what has no counterpart") {
    const std::string fog =
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 2 3] \"rgb sigma_s\" [4 5 6] "
        "\"float scale\" 10 \"float g\" 0.5\n";
    const PbrtCase inside(pbrtWorld(fog + "MediumInterface \"fog\" \"\"\nMaterial \"interface\"\nShape \"sphere\"\n"));
    CHECK(inside.has("medium fog homogeneous {"));
    CHECK(inside.has("scattering rgb 40 50 60"));
    CHECK(inside.has("phase henyey-greenstein 0.5"));
    CHECK(inside.has("shape sphere { radius 1; material boundary; interior fog }"));
    const PbrtCase around(fog + "MediumInterface \"\" \"fog\"\n" + pbrtWorld("LightSource \"infinite\"\n"));
    CHECK(around.has("atmosphere fog"));
    const PbrtCase grid(pbrtWorld(
        "MakeNamedMedium \"g\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"integer ny\" 1 \"integer nz\" 1 "
        "\"float density\" [1 3]\nMediumInterface \"g\" \"\"\nMaterial \"interface\"\nShape \"sphere\"\n"));
    CHECK(grid.has("volume vdb \"case-files/g.vdb\""));
    CHECK(grid.has("scale 0.5 1 1; translate 0.25 0.5 0.5"));
    CHECK(grid.report() == "");
    const PbrtCase nano(
        pbrtWorld("MakeNamedMedium \"n\" \"string type\" \"nanovdb\" \"string filename\" \"a.nvdb\" \"float Lescale\" "
                  "2\nMediumInterface \"n\" \"\"\nMaterial \"interface\"\nShape \"sphere\"\n"));
    CHECK(nano.has("a.nvdb\""));
    CHECK(nano.says("emits by its temperature"));
    CHECK(pbrtHolds(pbrtMade("MakeNamedMedium \"c\" \"string type\" \"cloud\"\nMediumInterface \"c\" \"\"\nMaterial "
                             "\"interface\"\nShape \"sphere\"\n"),
                    "volume noise"));
}

TEST_CASE("pbrt: films, filters, samplers and integrators") {
    const auto view = [](const std::string& text) { return PbrtCase(text + "\nWorldBegin\n"); };
    const PbrtCase plain = view("");
    CHECK(plain.report() == "");
    CHECK(plain.has("film { size 1280 720; filter gaussian 1.5; output \"pbrt.exr\" space=rec709 }"));
    CHECK(plain.has("render { samples 16; max-depth 5 }"));
    CHECK(view("Film \"gbuffer\" \"integer xresolution\" 100 \"integer yresolution\" 50 \"float cropwindow\" [0.25 0.5 "
               "0 0.5]")
              .has("crop 25 0 50 25"));
    CHECK(view("Film \"spectral\" \"integer nbuckets\" 10 \"float lambdamin\" 400 \"float lambdamax\" 700")
              .has("spectral 400 700 30"));
    CHECK(view("Film \"rgb\" \"string sensor\" \"nikon_d850\"").has("sensor nikon-d850"));
    CHECK(view("Film \"rgb\" \"string sensor\" \"canon_eos_100d\"").says("W0802"));
    CHECK(view("Film \"rgb\" \"float maxcomponentvalue\" 10").says("nothing is clamped here"));
    CHECK(view("PixelFilter \"box\"").has("filter box 0.5"));
    CHECK(view("PixelFilter \"gaussian\" \"float xradius\" 2 \"float yradius\" 2").says("W0802"));
    CHECK(view("PixelFilter \"sinc\"").says("W0802"));
    CHECK(view("Sampler \"stratified\" \"integer xsamples\" 3 \"integer ysamples\" 5").has("samples 15"));
    CHECK(view("Integrator \"mlt\" \"integer maxdepth\" 9").has("max-depth 9"));
    CHECK(view("ColorSpace \"aces2065-1\"\nFilm \"rgb\"").has("space=aces2065-1"));
    CHECK(view("Camera \"orthographic\" \"float screenwindow\" [-3 3 -2 2]").has("width 6 m"));
    CHECK(view("Camera \"perspective\" \"float lensradius\" 0.1 \"float focaldistance\" 4").has("aperture 0.2 m"));
    CHECK(view("Scale 2 2 2\nCamera \"perspective\" \"float lensradius\" 0.1 \"float focaldistance\" 4")
              .has("focus 2 m"));
    CHECK(view("Camera \"spherical\" \"string mapping\" \"equirectangular\"").has("camera spherical"));
}

TEST_CASE("pbrt: the realistic camera takes its lens along") {
    PbrtCase made;
    writeAll(made.folder / "lens.dat", "# a plano-convex lens\n50 5 1.5 20\n0 2 0 10\n-1000 95 1 20\n");
    made.import(
        "Camera \"realistic\" \"string lensfile\" \"lens.dat\" \"float aperturediameter\" 8 \"float focusdistance\" 3\n"
        "Film \"rgb\" \"integer xresolution\" 40 \"integer yresolution\" 30 \"float diagonal\" 50\nWorldBegin\n");
    CHECK(made.has("surfaces mm { - 50 5 1.5 10; - stop 2 air 4; - -1000 95 air 10 }"));
    CHECK(made.has("sensor 40 30 mm"));
    CHECK(made.has("focus 3 m"));
}

TEST_CASE("pbrt: portals are counter-clockwise from inside, whichever way the world is turned") {
    // Behind a window at z = 3 light comes from +z; seen from z < 3 its corners run counter-clockwise.
    const std::string at = "LightSource \"infinite\" \"string filename\" \"none.exr\" "
                           "\"point3 portal\" [-1 -1 3 1 -1 3 1 1 3 -1 1 3]\n";
    CHECK(PbrtCase(pbrtWorld(at)).says("error[E0802]"));
}

TEST_CASE("pbrt: grids that emit, by their temperature or a spectrum") {
    const auto grid = [](const std::string& params) {
        return pbrtWorld("MakeNamedMedium \"g\" \"string type\" \"uniformgrid\" \"integer nx\" 2 \"integer ny\" 1 "
                         "\"integer nz\" 1 \"float density\" [1 3] \"rgb sigma_a\" [2 2 2] " +
                         params + "\nMediumInterface \"g\" \"\"\nMaterial \"interface\"\nShape \"sphere\"\n");
    };
    const PbrtCase hot(grid("\"float temperature\" [1 2] \"float temperaturescale\" 1000 \"float Lescale\" 5"));
    CHECK(hot.has("temperature temperature"));
    CHECK(hot.has("flame flame"));
    CHECK(hot.has("emissivity rgb 2 2 2"));
    CHECK(hot.says("W0802"));
    const PbrtCase even(grid("\"rgb Le\" [1 1 1] \"float Lescale\" [0 4]"));
    CHECK(even.has("flame flame"));
    CHECK(even.has("emission table"));
    CHECK_FALSE(even.has("temperature"));
    CHECK(even.report() == "");
    CHECK(PbrtCase(grid("\"float temperature\" [1 2 3]")).says("E0802"));
}

TEST_CASE("pbrt: a NanoVDB file tells how hot it is") {
    // A file of one grid: header, entry, name, and of the grid itself the maximum alone.
    std::string file(16 + 176 + 12 + 1024, '\0');
    const auto put = [&](std::size_t at, const auto& value) { std::memcpy(file.data() + at, &value, sizeof value); };
    put(0, std::uint64_t{0x304244566f6e614e});
    put(12, std::uint16_t{1});
    put(16 + 8, std::uint64_t{1024});
    put(16 + 136, std::uint32_t{12});
    std::memcpy(file.data() + 16 + 176, "temperature", 11);
    put(16 + 176 + 12 + 772, 20.0f);
    PbrtCase made;
    writeAll(made.folder / "fire.nvdb", file);
    made.import(pbrtWorld("MakeNamedMedium \"n\" \"string type\" \"nanovdb\" \"string filename\" \"fire.nvdb\" "
                          "\"float temperaturescale\" 100 \"float Lescale\" 2\nMediumInterface \"n\" \"\"\n"
                          "Material \"interface\"\nShape \"sphere\"\n"));
    CHECK(made.has("temperature temperature scale=100 offset=0"));
    CHECK(made.has("emissivity 0.01525")); // 2 over the 131.1 W of a black body of 2000 K at its peak
    CHECK(made.says("at 2000 K"));
}

TEST_CASE("pbrt: values at the corners of a texture") {
    const PbrtCase made(
        pbrtWorld("Texture \"t\" \"float\" \"bilerp\" \"float v10\" 0.5\nMaterial \"dielectric\" \"texture "
                  "roughness\" \"t\"\nShape \"sphere\"\n"));
    CHECK(made.has("ramp"));
    CHECK(made.has("over u"));
    CHECK(made.has("stop 0 0.5"));
}
