// pbrt's documented conventions, each with the pixel value that pbrt would show, worked out by hand. The imported scene
// is rendered and must show it, too.
#include "io/exr_writer.h"
#include "support/scene_test.h"
#include "unit/exchange/pbrt_cases.h"

#include <cmath>
#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::exchange;

namespace {

// The mean Y of a part of the picture, with the exposure.
double pbrtPixel(const PbrtCase& made, PixelBounds part = {3, 3, 5, 5}, std::uint32_t samples = 256) {
    const ImportedPixel pixel = renderImported(made, "scene 1\n" + made.scene, part, samples);
    return pixel.mean * pixel.exposure;
}

double pbrtPixel(const std::string& world) { return pbrtPixel(PbrtCase(pbrtWorld(world))); }

// A wall that faces the camera at z = 2, of reflectance 1/2.
const std::string kPbrtWall = "Shape \"trianglemesh\" \"point3 P\" [-9 -9 2  9 -9 2  9 9 2  -9 9 2] "
                              "\"integer indices\" [0 2 1 0 3 2]\n";

bool pbrtNear(double a, double b, double share = 0.005) {
    INFO(a, " for ", b);
    return std::abs(a - b) <= share * std::abs(b);
}

} // namespace

TEST_CASE("pbrt: an L of 1 shows as 1, of any spectrum and from any light") {
    // Seen itself: Y = scale · luminance; of a colour 0.2126 · 3 + 0.7152 · 2 + 0.0722 · 1 = 2.1404.
    CHECK(pbrtNear(pbrtPixel("LightSource \"infinite\" \"rgb L\" [3 2 1]\n"), 2.1404, 0.01));
    // The scale of a spectrum that is no colour is divided out: what is left is `scale`.
    CHECK(pbrtNear(pbrtPixel("LightSource \"infinite\" \"blackbody L\" 3000 \"float scale\" 3\n"), 3));
    CHECK(pbrtNear(pbrtPixel("LightSource \"infinite\" \"spectrum L\" [400 50 700 50]\n"), 1));
    CHECK(pbrtNear(pbrtPixel("LightSource \"infinite\" \"spectrum L\" \"stdillum-A\"\n"), 1));
    // An area light; through `emission` a black body is a table of Y = 4.
    CHECK(pbrtNear(pbrtPixel("AreaLightSource \"diffuse\" \"rgb L\" [2 2 2]\n" + kPbrtWall), 2 + 0, 0.01));
    CHECK(pbrtNear(pbrtPixel("AreaLightSource \"diffuse\" \"blackbody L\" 4000 \"float scale\" 4\n" + kPbrtWall), 4,
                   0.01));
}

TEST_CASE("pbrt: a matte wall under an even sky has the sky's radiance times its reflectance") {
    // L_o = ρ L = 0.5 · 2
    CHECK(pbrtNear(pbrtPixel("LightSource \"infinite\" \"rgb L\" [2 2 2]\n" + kPbrtWall), 1));
    // illuminance: L = E / π, so L_o = ρ E / π = 0.5 · 10 / π = 1.5915
    CHECK(pbrtNear(pbrtPixel("LightSource \"infinite\" \"float illuminance\" 10\n" + kPbrtWall), 1.5915));
}

TEST_CASE("pbrt: distant lights have an irradiance of L, or the illuminance") {
    // L_o = ρ E / π: 0.5 · 1 / π = 0.15915; with 10 lx ten times that; at 60° half of it
    const std::string from = "\"point3 from\" [0 0 -1] \"point3 to\" [0 0 0]\n";
    CHECK(pbrtNear(pbrtPixel("LightSource \"distant\" " + from + kPbrtWall), 0.15915));
    CHECK(pbrtNear(pbrtPixel("LightSource \"distant\" \"float illuminance\" 10 " + from + kPbrtWall), 1.5915));
    CHECK(pbrtNear(pbrtPixel("LightSource \"distant\" \"float scale\" 2 \"point3 from\" [0 0.8660254 -0.5] "
                             "\"point3 to\" [0 0 0]\n" +
                             kPbrtWall),
                   0.15915));
}

TEST_CASE("pbrt: point lights have an intensity of I, or power / 4π") {
    // E = I / d² = 1 / 4, L_o = 0.5 / π · 0.25 = 0.039789
    CHECK(pbrtNear(pbrtPixel("LightSource \"point\"\n" + kPbrtWall), 0.039789));
    // I = 100 / 4π = 7.9577; L_o = 0.5 / π · 7.9577 / 4 = 0.31663
    CHECK(pbrtNear(pbrtPixel("LightSource \"point\" \"float power\" 100\n" + kPbrtWall), 0.31663));
    // moved to a distance of 1: four times as much as the first
    CHECK(pbrtNear(pbrtPixel("Translate 0 0 1\nLightSource \"point\"\nTranslate 0 0 -1\n" + kPbrtWall), 0.15915, 0.01));
}

TEST_CASE("pbrt: spots have half angles, and their power counts the cubic falloff as a half") {
    const std::string spot = "LightSource \"spot\" \"float coneangle\" 30 \"float conedeltaangle\" 5 ";
    CHECK(PbrtCase(pbrtWorld(spot)).has("angle 60 deg"));
    CHECK(PbrtCase(pbrtWorld(spot)).has("inner-angle 50 deg"));
    // on the axis I / d²: 0.5 / π / 4
    CHECK(pbrtNear(pbrtPixel(spot + "\n" + kPbrtWall), 0.039789));
    // ∫ = 2π ((1 - cos 25°) + (cos 25° - cos 30°) / 2) = 2π (0.093692 + 0.020141) = 0.71525, I = 10 / 0.71525 = 13.981;
    // L_o = 0.5 / π · 13.981 / 4 = 0.55630
    CHECK(pbrtNear(pbrtPixel(spot + "\"float power\" 10\n" + kPbrtWall), 0.55630));
    // Seen 27.5° off the axis, where cos is 0.88701: t = (0.88701 - cos 30°) / (cos 25° - cos 30°)
    //   = (0.88701 - 0.86603) / (0.90631 - 0.86603) = 0.52096, t² (3 - 2t) = 0.53142.
    // The axis (0, sin 27.5°, cos 27.5°) = (0, 0.46175, 0.88701): 0.039789 · 0.53142 = 0.021145
    CHECK(pbrtNear(pbrtPixel(spot + "\"point3 to\" [0 0.46175 0.88701]\n" + kPbrtWall), 0.021145, 0.03));
}

TEST_CASE("pbrt: the power of area lights is that of each of their parts, on one side or two") {
    // A disk of radius 1 has π m²: L = 10 / (π · π) = 1.01321, on two sides half of it.
    const std::string disk = "Shape \"disk\" \"float height\" 2\n";
    CHECK(pbrtNear(pbrtPixel("ReverseOrientation\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
                             "AreaLightSource \"diffuse\" \"float power\" 10\n" +
                             disk),
                   1.01321, 0.01));
    CHECK(pbrtNear(pbrtPixel("AreaLightSource \"diffuse\" \"float power\" 10 \"bool twosided\" true\n" + disk), 0.50661,
                   0.01));
    // Two triangles of 2 m² each: L = 10 / (π · 2) = 1.59155
    CHECK(pbrtNear(
        pbrtPixel("AreaLightSource \"diffuse\" \"float power\" 10\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
                  "Shape \"trianglemesh\" \"point3 P\" [-1 -1 2  1 -1 2  1 1 2  -1 1 2] "
                  "\"integer indices\" [0 2 1 0 3 2]\n"),
        1.59155, 0.01));
}

TEST_CASE("pbrt: lights emit where the normal of their shape points") {
    const std::string light = "AreaLightSource \"diffuse\"\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\n";
    const auto mesh = [](const char* indices, const char* normals) {
        return std::string(
                   "Shape \"trianglemesh\" \"point3 P\" [-9 -9 2  9 -9 2  9 9 2  -9 9 2] \"integer indices\" [") +
               indices + "]" + normals + "\n";
    };
    const char* const towards = " \"normal N\" [0 0 -1 0 0 -1 0 0 -1 0 0 -1]";
    CHECK(pbrtNear(pbrtPixel(light + mesh("0 2 1 0 3 2", "")), 1));
    CHECK(pbrtPixel(light + mesh("0 1 2 0 2 3", "")) == 0);
    CHECK(pbrtNear(pbrtPixel(light + "ReverseOrientation\n" + mesh("0 1 2 0 2 3", "")), 1));
    CHECK(pbrtNear(pbrtPixel(light + mesh("0 1 2 0 2 3", towards)), 1)); // normals decide
    CHECK(pbrtPixel(light + "ReverseOrientation\n" + mesh("0 2 1 0 3 2", towards)) == 0);
    // a mirror keeps the outside outside
    CHECK(pbrtNear(pbrtPixel(light + "Scale -1 1 1\n" + mesh("0 2 1 0 3 2", "")), 1));
}

TEST_CASE("pbrt: the film's pixel is radiance · exposure time · ISO / 100") {
    // 1 · 0.5 s · 400 / 100 = 2
    const PbrtCase made(
        "Camera \"perspective\" \"float shutteropen\" 0 \"float shutterclose\" 0.5\n"
        "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8 \"float iso\" 400\nWorldBegin\n"
        "LightSource \"infinite\"\n");
    CHECK(made.has("exposure 1 stops"));
    CHECK(pbrtNear(pbrtPixel(made), 2));
}

TEST_CASE("pbrt: the angle of view is that of the shorter side") {
    const auto fov = [](int x, int y, const char* more) {
        return PbrtCase("Camera \"perspective\" \"float fov\" 90 " + std::string(more) +
                        "\nFilm \"rgb\" \"integer xresolution\" " + std::to_string(x) + " \"integer yresolution\" " +
                        std::to_string(y) + "\nWorldBegin\n")
            .scene;
    };
    // half of the width is tan 45° · 2 / 1 = 2: 2 atan 2 = 126.8699°
    CHECK(fov(16, 8, "").find("fov 126.8698976") != std::string::npos);
    CHECK(fov(8, 16, "").find("fov 90 deg") != std::string::npos);
    // a window of twice the height, shifted by half of it: 2 · 45°, and f = 18 mm / 1, half of which is 9 mm
    CHECK(fov(8, 8, "\"float screenwindow\" [-0.5 1.5 -1 1]").find("shift 9 0 mm") != std::string::npos);
}

TEST_CASE("pbrt: its world is left-handed, unless the camera looks through a mirror") {
    // A light at x > 0, seen along +z with y up, is right in the picture.
    const std::string world =
        "WorldBegin\nAreaLightSource \"diffuse\"\nMaterial \"diffuse\" \"rgb reflectance\" [0 0 0]\n"
        "Shape \"trianglemesh\" \"point3 P\" [0 -9 2  9 -9 2  9 9 2  0 9 2] "
        "\"integer indices\" [0 2 1 0 3 2]\n";
    const std::string look = "LookAt 0 0 0  0 0 1  0 1 0\nCamera \"perspective\" \"float fov\" 40\n"
                             "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\n";
    const PbrtCase plain(look + world);
    CHECK(pbrtNear(pbrtPixel(plain, {6, 2, 8, 6}), 1));
    CHECK(pbrtPixel(plain, {0, 2, 2, 6}) == 0);
    const PbrtCase mirrored("Scale -1 1 1\n" + look + world);
    CHECK(pbrtNear(pbrtPixel(mirrored, {0, 2, 2, 6}), 1));
    CHECK(pbrtPixel(mirrored, {6, 2, 8, 6}) == 0);
    CHECK_FALSE(mirrored.has("group"));
}

TEST_CASE("pbrt: images all around are squares of equal area, z up") {
    // The upper half of the sphere is the inner square |u| + |v| < 1 of [-1, 1]²; only where x > 0 too there is light.
    constexpr int kSize = 64;
    std::vector<float> light;
    for (int y = 0; y < kSize; ++y)
        for (int x = 0; x < kSize; ++x) {
            const double u = 2 * (x + 0.5) / kSize - 1, v = 2 * (y + 0.5) / kSize - 1;
            light.push_back(std::abs(u) + std::abs(v) < 1 && u > 0 ? 2.f : 0.f);
        }
    const auto seen = [&](const char* to, const char* before) {
        PbrtCase made;
        ExrPicture sky{{0, 0, kSize, kSize}, {0, 0, kSize, kSize}, light, light, light};
        sky.chromaticities = Chromaticities::of(rgb::rec709);
        writeExr(made.folder / "sky.exr", sky);
        made.import("LookAt 0 0 0 " + std::string(to) +
                    "\nCamera \"perspective\" \"float fov\" 5\n"
                    "Film \"rgb\" \"integer xresolution\" 8 \"integer yresolution\" 8\nWorldBegin\n" +
                    before + "LightSource \"infinite\" \"string filename\" \"sky.exr\" \"float scale\" 1.5\n");
        return pbrtPixel(made);
    };
    CHECK(pbrtNear(seen("1 0 1  0 1 0", ""), 3)); // 2 · 1.5
    CHECK(pbrtNear(seen("1 1 1  0 1 0", ""), 3));
    CHECK(pbrtNear(seen("1 -1 1  0 1 0", ""), 3));
    CHECK(seen("-1 0 1  0 1 0", "") == 0);
    CHECK(seen("1 0 -1  0 1 0", "") == 0);
    CHECK(pbrtNear(seen("-1 0 1  0 1 0", "Rotate 180 0 0 1\n"), 3));
    CHECK(pbrtNear(seen("1 1 0.5  0 0 1", "Rotate -90 1 0 0\n"), 3)); // z up becomes y up
}

TEST_CASE("pbrt: roughness becomes α by its root, and ours is the root of α") {
    const auto rough = [](const std::string& more) {
        return PbrtCase(pbrtWorld("Material \"conductor\" " + more + "\nShape \"sphere\"\n")).scene;
    };
    // α = √0.0081 = 0.09, ours √0.09 = 0.3; without remapping α = 0.09
    CHECK(rough("\"float roughness\" 0.0081").find("roughness 0.3") != std::string::npos);
    CHECK(rough("\"float roughness\" 0.09 \"bool remaproughness\" false").find("roughness 0.3") != std::string::npos);
    // αu = 0.4, αv = 0.2: ours √√((0.16 + 0.04) / 2) = 0.5623, anisotropy 1 - 0.2 / 0.4
    const std::string stretched = rough("\"float uroughness\" 0.16 \"float vroughness\" 0.04");
    CHECK(stretched.find("roughness 0.562341") != std::string::npos);
    CHECK(stretched.find("anisotropy 0.5") != std::string::npos);
}

TEST_CASE("pbrt: colours are in the space that is in force where they stand") {
    const PbrtCase made(
        pbrtWorld("ColorSpace \"rec2020\"\nMaterial \"diffuse\" \"rgb reflectance\" [0.1 0.5 0.2]\nShape \"sphere\"\n"
                  "LightSource \"infinite\" \"rgb L\" [0 1 0]\n"));
    CHECK(made.has("reflectance rgb 0.1 0.5 0.2 space=lin_rec2020_scene"));
    // The luminance of Rec. 2020's green is 0.6780; behind it nothing reflects towards the camera inside of the ball.
    CHECK(made.has("luminance 49482")); // 0.6780 · 72983 nits
}

TEST_CASE("pbrt: a conductor of a reflectance has that at normal incidence") {
    // n = 1, k = 2 √0.5 / √0.5 = 2: R = k² / (4 + k²) = 0.5; a mirror behind which a sky of 1 is: 0.5
    const PbrtCase made(pbrtWorld("Material \"conductor\" \"spectrum reflectance\" [300 0.5 900 0.5]\n"
                                  "LightSource \"infinite\"\n" +
                                  kPbrtWall));
    CHECK(pbrtNear(pbrtPixel(made), 0.5, 0.01));
}

TEST_CASE("pbrt: media have their coefficients per unit of length, and absorb by them") {
    // A box of 1 m before a sky of 1: exp(-0.7) = 0.49659
    const std::string slab =
        "Shape \"trianglemesh\" \"point3 P\" [-9 -9 2  9 -9 2  9 9 2  -9 9 2 -9 -9 3  9 -9 3  9 9 3  -9 9 3] "
        "\"integer indices\" [0 2 1 0 3 2  4 5 6 4 6 7  0 1 5 0 5 4  3 6 2 3 7 6  0 4 7 0 7 3  1 2 6 1 6 5]\n";
    const std::string medium =
        "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [0.07 0.07 0.07] "
        "\"rgb sigma_s\" [0 0 0] \"float scale\" 10\nMediumInterface \"fog\" \"\"\nMaterial \"interface\"\n";
    CHECK(pbrtNear(pbrtPixel("LightSource \"infinite\"\n" + medium + slab), 0.49659, 0.01));

    // The same of a grid of density 7 throughout its middle, in a box from z = 1 to 4 of 9 voxels: all rays pass 9
    // voxels, of which the outer ones fade over the half beyond their middles; ∫ density = 0.1 · 7 · 3 · (8 + 2 · 1/2)
    // / 9.
    std::string density;
    for (int i = 0; i < 9 * 9 * 9; ++i) density += " 7";
    const std::string grid =
        "MakeNamedMedium \"g\" \"string type\" \"uniformgrid\" \"integer nx\" 9 \"integer ny\" 9 \"integer nz\" 9 "
        "\"float density\" [" +
        density +
        "] \"point3 p0\" [-5 -5 1] \"point3 p1\" [5 5 4] "
        "\"rgb sigma_a\" [0.1 0.1 0.1] \"rgb sigma_s\" [0 0 0]\nMediumInterface \"g\" \"\"\nMaterial \"interface\"\n";
    const PbrtCase cloud(pbrtWorld("LightSource \"infinite\"\n" + grid + "Shape \"sphere\"\n"));
    CHECK(pbrtNear(pbrtPixel(cloud, {0, 0, 8, 8}, 2048), std::exp(-2.1), 0.05)); // collisions are found by chance
}
