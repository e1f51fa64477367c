// Textures of a scene: cycles and excess, texture coordinates, attributes, what sticks to a shape, what is kept.
#include "render/material.h"
#include "render/surface_input.h"
#include "scene_test_fixture.h"

#include <algorithm>
#include <doctest/doctest.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

using namespace abbe;
using namespace abbe::test;

namespace {

const std::string kQuad = "shape quad { size 2 2; material m }\n";

// The reflectance at a hit, at 550 nm, by the weight of a sample.
float reflectanceAt(const WorldHit& hit) {
    Arena arena;
    const Bsdf* bsdf = hit.hit.material->bsdf(hit.hit, Wavelengths::single(550), arena);
    const auto sample = bsdf->sample({0, 0, 1}, 0, {0.3f, 0.4f}, Transport::radiance);
    return sample ? sample->weight[0] : -1;
}

struct TexturedPly {
    std::filesystem::path path =
        std::filesystem::temp_directory_path() / fmt::format("abbe_textures_{}.ply", ::getpid());
    explicit TexturedPly(std::string_view text) { std::ofstream(path, std::ios::binary) << text; }
    ~TexturedPly() { std::filesystem::remove(path); }
};

} // namespace

TEST_CASE("textures within textures: cycles, depth and number are limited") {
    CHECK(codes(build("texture a checker { even b }\ntexture b checker { odd a }\n"
                      "material m diffuse { reflectance a }\n" +
                      kQuad)) == "E0731");
    CHECK(codes(build("texture a product { first a; second 0.5 }\nmaterial m diffuse { reflectance a }\n" + kQuad)) ==
          "E0731");
    std::string chain = "texture t0 checker\n", wide = chain;
    for (int i = 1; i < 40; ++i) chain += fmt::format("texture t{} checker {{ even t{} }}\n", i, i - 1);
    CHECK(codes(build(chain + "material m diffuse { reflectance t39 }\n" + kQuad)) == "E0732");
    for (int i = 1; i < 20; ++i) wide += fmt::format("texture t{0} checker {{ even t{1}; odd t{1} }}\n", i, i - 1);
    CHECK(codes(build(wide + "material m diffuse { reflectance t19 }\n" + kQuad)).starts_with("E0732"));
    CHECK(codes(build("texture r ramp { stop 1 0.5; stop 0 0.2 }\nmaterial m diffuse { reflectance r }\n" + kQuad)) ==
          "E0735");
}

TEST_CASE("textures over uv need texture coordinates, also inside of other textures; boxes have them") {
    const std::string triangle = "{ points 0 0 0  1 0 0  0 1 0; faces { - 0 1 2 }; material m }\n";
    const std::string over = "material m diffuse { reflectance product { first noise; second checker } }\n";
    const TestScene bad = build(over + "shape mesh " + triangle);
    CHECK(codes(bad) == "E0733");
    CHECK(bad.diagnostics().all()[0].related.size() == 1);
    CHECK(codes(build("material m diffuse { reflectance noise }\nshape mesh " + triangle)).empty());
    for (const char* dress : {"normal checker", "bump 1 mm { map ramp { stop 0 0; stop 1 1 } }", "opacity checker"}) {
        const std::string material = fmt::format("material m diffuse {{ {} }}\n", dress);
        CHECK(codes(build(material + "shape mesh " + triangle)) == "E0733");
        CHECK(codes(build("material n mix { first diffuse { " + std::string(dress) +
                          " }; second diffuse }\nmaterial m two-sided { front n; back n }\nshape mesh " + triangle)) ==
              "E0733 E0733");
        CHECK(codes(build(material + kQuad)).empty());
    }
    CHECK(codes(build("material m diffuse { bump 1 mm { map noise } }\nshape mesh " + triangle)).empty());
    CHECK(codes(build("material m diffuse { reflectance triplanar { map checker } }\nshape mesh " + triangle)).empty());
    CHECK(codes(build(over + "shape box { material m }\nshape sphere { material m }\n")).empty());
}

TEST_CASE("coloured parts of numbers are warned of; effects are noted") {
    const TestScene scene =
        build("material m conductor { index metal Al; roughness checker { even rgb 0.1 0.5 0.2; odd 0.3 } }\n" + kQuad);
    CHECK(codes(scene) == "W0730");
    CHECK(scene.scene().effects.has(Effect::textures));
    CHECK(!build("material m diffuse { reflectance 0.4 }\n" + kQuad).scene().effects.has(Effect::textures));
}

TEST_CASE("patterns stick to their shapes, whatever places these") {
    const std::string material = "material m diffuse { reflectance ramp { over x; stop -1 0; stop 1 1 } }\n";
    const std::string shape = "shape quad { size 2 2; material m; transform { scale 0.5; rotate z 90 deg } }\n";
    const std::string bare = "shape quad { size 2 2; material m }\n";
    // x of the shape's own space runs upwards after the turn.
    const auto check = [&](const std::string& body, double x, double y, double wanted) {
        CAPTURE(body);
        const TestScene scene = build(material + body);
        REQUIRE(codes(scene).empty());
        const WorldHit hit = trace(scene, {x, y, 3}, {0, 0, -1});
        REQUIRE(hit.met);
        CHECK(reflectanceAt(hit) == doctest::Approx(wanted).epsilon(1e-4));
    };
    check(bare, 0.5, 0.1, 0.75);
    check(shape, 0.1, 0.25, 0.75);
    check("group { transform { translate 0 1 0; scale 2 1 1 }\n" + shape + "}\n", 0.1, 1.25, 0.75);
    check("object o {\n" + bare + "}\ninstance o { transform { scale -1 1 1; translate 0.2 0 0 } }\n", -0.3, 0.1, 0.75);
    check("object o {\n" + shape + "}\ninstance o { transform { translate 0.2 0 0; scale 3 1 1 } }\n", 0.3, 0.25, 0.75);
    check("shape quad { size 2 2; material m; transform { at 0 s { scale 0.5 }; at 1 s { scale 0.5; translate 9 0 0 } "
          "} }\n"
          "camera { from 0 0 5; look-at 0 0 0; shutter 0.001 s }\n",
          0.25, 0.1, 0.75);
}

TEST_CASE("attributes: properties of PLY vertices, interpolated, as colours and as numbers") {
    const TexturedPly file(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float wear\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "-1 -1 0 51 51 51 0\n1 -1 0 255 255 255 0.25\n1 1 0 255 255 255 1\n-1 1 0 51 51 51 0.5\n"
        "4 0 1 2 3\n");
    const std::string mesh = fmt::format("shape mesh \"{}\" {{ material m }}\n", file.path.string());
    const auto at = [&](const std::string& texture, double x, double y) {
        const TestScene scene = build("material m diffuse { reflectance " + texture + " }\n" + mesh);
        REQUIRE(codes(scene).empty());
        const WorldHit hit = trace(scene, {x, y, 3}, {0, 0, -1});
        REQUIRE(hit.met);
        return reflectanceAt(hit);
    };
    CHECK(at("attribute \"color\"", -0.999999, 0) == doctest::Approx(0.2).epsilon(1e-3));
    CHECK(at("attribute \"color\"", 0, 0) == doctest::Approx(0.6).epsilon(1e-3));
    CHECK(at("attribute \"color\" { encoding srgb }", 0.999999, 0) == doctest::Approx(1).epsilon(1e-3));
    CHECK(at("attribute \"color\" { encoding srgb }", -0.999999, 0) == doctest::Approx(0.0331).epsilon(1e-2));
    CHECK(at("ramp { input attribute \"wear\"; stop 0 0; stop 1 1 }", 0, -1) == doctest::Approx(0.125).epsilon(1e-3));
    CHECK(at("ramp { input attribute \"wear\"; stop 0 0; stop 1 1 }", 0.999999, 0) ==
          doctest::Approx(0.625).epsilon(1e-3));

    const TestScene missing = build("material m diffuse { reflectance attribute \"dirt\" }\n" + mesh);
    CHECK(codes(missing) == "E0734");
    CHECK(missing.diagnostics().all()[0].help == "its attributes are `color` and `wear`");
    CHECK(codes(build("material m diffuse { reflectance checker { even attribute \"color\" } }\n" + kQuad)) == "E0734");
}

namespace {

std::optional<Vec3> attributeAt(const TestScene& scene, std::string_view name, Vec3d from, Vec3d towards) {
    const WorldHit hit = trace(scene, from, towards);
    REQUIRE(hit.met);
    REQUIRE(hit.hit.shape);
    const VertexAttributes* const attributes = hit.hit.shape->attributes();
    REQUIRE(attributes);
    return attributes->attribute(name, hit.hit);
}

const std::string kPainted = "material m diffuse { reflectance attribute \"color\" }\n";

} // namespace

TEST_CASE("attributes in place: a number or three for each point, on meshes that stand still and that deform") {
    const std::string values = "faces { - 0 1 2 3 }; attribute \"wear\" 0 1 3 2; "
                               "attribute \"color\" { - 0 0 0; - 1 0 0; - 1 1 0; - 0 1 0.5 }; material m }\n";
    const std::string still = kPainted + "shape mesh { points 0 0 0  1 0 0  1 1 0  0 1 0; " + values;
    const std::string moving = kPainted + "camera { from 0 0 5; look-at 0 0 0; shutter 1 s }\n" +
                               "shape mesh { at -0.5 s { points 0 0 0  1 0 0  1 1 0  0 1 0 }; "
                               "at 0.5 s { points 0 0 1  1 0 1  1 1 1  0 1 1 }; " +
                               values;
    for (const std::string& text : {still, moving}) {
        const TestScene scene = build(text);
        REQUIRE(codes(scene).empty());
        const auto wear = attributeAt(scene, "wear", {0.25, 0.5, 3}, {0, 0, -1});
        REQUIRE(wear);
        CHECK(wear->x == doctest::Approx(1.25));
        CHECK(wear->y == wear->x);
        const auto color = attributeAt(scene, "color", {0.75, 0.25, 3}, {0, 0, -1});
        REQUIRE(color);
        CHECK(color->x == doctest::Approx(0.75));
        CHECK(color->y == doctest::Approx(0.25));
        CHECK_FALSE(attributeAt(scene, "dirt", {0.25, 0.5, 3}, {0, 0, -1}));
    }
    const std::string mesh =
        "material m diffuse\nshape mesh { points 0 0 0  1 0 0  0 1 0; faces { - 0 1 2 }; material m; ";
    CHECK(codes(build(mesh + "attribute \"a\" 0 1 }\n")) == "E0737");
    CHECK(codes(build(mesh + "attribute \"a\" 0 1 2; attribute \"a\" 0 1 2 }\n")) == "E0737");
    CHECK(codes(build(mesh + "attribute 0 1 2 }\n")) == "E0306");
    CHECK(codes(build(mesh + "attribute \"a\" }\n")) == "E0306");
    CHECK(codes(build(mesh + "attribute \"a\" 0 1 1e300 }\n")) == "E0303");
    CHECK(codes(build(mesh + "uvs 0 0 1 0 }\n")) == "E0611");
    CHECK(codes(build("shape mesh { points 0 0 0  1 0 0  0 1 0; faces { - 0 1 2 }; uvs 0 0  1 0  0 1; "
                      "material diffuse { reflectance checker; normal checker } }\n"))
              .empty());
    const TestScene near =
        build("shape mesh { points 0 0 0  1 0 0  0 1 0; faces { - 0 1 2 }; attribute \"wear\" 0 0 1; "
              "material diffuse { reflectance attribute \"waer\" } }\n");
    CHECK(codes(near) == "E0734");
    CHECK(near.diagnostics().all()[0].help == "did you mean `wear`? it has `wear`");
}

TEST_CASE("attributes of subdivision surfaces are smoothed as the points are: a copy of these is the point itself") {
    const std::string points = "-1 -1 -1  1 -1 -1.2  1.1 1 -1  -1 1 -1  -1 -1 1  1.3 -1 1  1 1 1.1  -1 0.9 1";
    const std::string rest = "faces { - 0 3 2 1; - 4 5 6 7; - 0 1 5 4; - 2 3 7 6; - 1 2 6 5; - 0 4 7 3 }; "
                             "crease 4 5 6 sharpness=2; dicing 3; material m; attribute \"color\" " +
                             points;
    const std::string still = "shape subdivision { points " + points + "; " + rest;
    const std::string raised = "-1 -1 0  1 -1 -0.2  1.1 1 0  -1 1 0  -1 -1 2  1.3 -1 2  1 1 2.1  -1 0.9 2";
    const std::string moving =
        "camera { from 0 0 5; look-at 0 0 0; shutter 1 s }\nshape subdivision { at -0.5 s { points " + points +
        " }; at 1.5 s { points " + raised + " }; " + rest;
    int compared = 0;
    for (const std::string& text : {still + " }\n", still + "; displacement 0 mm { map noise } }\n",
                                    still + "; uvs 0 0 1 0 1 1 0 1; uv-faces { - 0 1 2 3; - 0 1 2 3; - 0 1 2 3; - 0 1 "
                                            "2 3; - 0 1 2 3; - 0 1 2 3 } }\n"}) {
        const TestScene scene = build(kPainted + text);
        REQUIRE(codes(scene).empty());
        for (const Vec3d from : {Vec3d{0.1, 0.2, 3}, Vec3d{0.6, -0.5, 3}, Vec3d{-0.3, 0.4, -3}, Vec3d{0.2, 0.15, 3}}) {
            const WorldHit hit = trace(scene, from, {0, 0, from.z > 0 ? -1.f : 1.});
            REQUIRE(hit.met);
            const auto copy = hit.hit.shape->attributes()->attribute("color", hit.hit);
            REQUIRE(copy);
            CHECK(length(Vec3d(*copy) - hit.p) < 2e-5);
            ++compared;
        }
    }
    CHECK(compared == 12);
    const TestScene deforming = build(kPainted + moving + " }\n");
    REQUIRE(codes(deforming).empty());
    const WorldHit moved = trace(deforming, {0.3, 0.4, 5}, {0, 0, -1});
    REQUIRE(moved.met);
    const Vec3d there(moved.hit.shape->attributes()->attribute("color", moved.hit).value_or(Vec3{}));
    CHECK(length(there - (moved.p - Vec3d(0, 0, 0.25))) < 2e-5); // a quarter of the way at the start of the shutter
    const TexturedPly file(
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "property float wear\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0 0\n1 0 0 1\n1 1 0 1\n0 1 0 0\n4 0 1 2 3\n");
    const TestScene flat =
        build(fmt::format("shape subdivision \"{}\" {{ scheme bilinear; dicing 2; material diffuse {{ "
                          "reflectance attribute \"wear\" }} }}\n",
                          file.path.string()));
    REQUIRE(codes(flat).empty());
    CHECK(attributeAt(flat, "wear", {0.3, 0.6, 3}, {0, 0, -1})->x == doctest::Approx(0.3));
}

TEST_CASE("heights may be a channel of a picture") {
    const auto raised = [](const std::string& map) {
        return build(
            fmt::format("material m diffuse\nshape subdivision {{ scheme bilinear; points 0 0 0  1 0 0  1 1 0  0 1 0; "
                        "faces {{ - 0 1 2 "
                        "3 }}; uvs 0 0 1 0 1 1 0 1; material m; displacement 0.5 m {{ map {}; midpoint 0 }} }}\n",
                        map));
    };
    const std::string picture = "image \"" ABBE_SOURCE_DIR "/tests/snippets/any.png\" space=data";
    const TestScene whole = raised(picture), red = raised("channel { of " + picture + "; take red }");
    REQUIRE(codes(whole).empty());
    REQUIRE(codes(red).empty());
    double highest = 0;
    for (const Vec3d from : {Vec3d{0.2, 0.3, 3}, Vec3d{0.7, 0.4, 3}, Vec3d{0.6, 0.8, 3}}) {
        const WorldHit a = trace(whole, from, {0, 0, -1}), b = trace(red, from, {0, 0, -1});
        REQUIRE(a.met);
        REQUIRE(b.met);
        highest = std::max(highest, a.p.z);
        CHECK(b.p.z == doctest::Approx(a.p.z).epsilon(1e-5));
    }
    CHECK(highest > 0.01);
}
