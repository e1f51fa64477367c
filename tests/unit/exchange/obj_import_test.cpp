// OBJ models with material libraries in, scene text and diagnostics out. Whatever comes out is a legal scene.
#include "base/diagnostic_format.h"
#include "base/enclosure.h"
#include "exchange/importer/importer.h"
#include "io/mesh_file.h"
#include "parser/parse.h"
#include "scene/registry.h"
#include "schema/scene_tree.h"
#include "unit/io/temporary_folder.h"

#include <cmath>
#include <cstdlib>
#include <doctest/doctest.h>
#include <filesystem>
#include <fmt/format.h>
#include <fstream>

using namespace abbe;
using namespace abbe::exchange;

namespace {

namespace fs = std::filesystem;

constexpr std::string_view kSquare = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n";
constexpr std::string_view kFace = "f 1/1 2/2 3/3 4/4\n";

struct ObjCase {
    TemporaryFolder folder;
    SourceMap sources;
    Diagnostics diagnostics;
    std::string scene; // empty after errors

    void write(const std::string& name, std::string_view text) {
        std::ofstream(folder / name, std::ios::binary) << text;
    }
    // Imports `model.obj`, and reads the scene as the program would.
    void import() {
        const fs::path path = folder / "model.obj";
        const ImportFormat* const format = importFormat(path);
        REQUIRE(format);
        CHECK(format->name == "obj");
        scene = importScene(*format, path, folder / "model.scene", sources, diagnostics).value_or("");
        for (const Diagnostic& d : diagnostics.all())
            if (d.span.valid()) CHECK(d.span.end <= sources.text(d.span.file).size());
        Diagnostics ofScene;
        const FileId file = sources.add("model.scene", scene);
        schema::TypeTable types = makeTypeTable();
        const auto document = parse(sources, file, {}, ofScene);
        schema::resolve(document, types, folder / "", ofScene);
        CHECK_MESSAGE(!ofScene.hasErrors(), (formatShort(ofScene, sources) + scene));
    }
    bool has(std::string_view text) const { return scene.find(text) != std::string::npos; }
    std::string report() const { return formatShort(diagnostics, sources); }
    bool says(std::string_view text) const { return report().find(text) != std::string::npos; }
};

// A square of a material `m` that says this.
struct MaterialCase : ObjCase {
    explicit MaterialCase(const std::string& statements) {
        for (const char* picture : {"paint.png", "grey.png", "brick_normal.png"}) write(picture, "");
        write("model.mtl", "newmtl m\n" + statements);
        write("model.obj", fmt::format("mtllib model.mtl\n{}usemtl m\n{}", kSquare, kFace));
        import();
    }
};

} // namespace

TEST_CASE("a model without materials is grey, and comes with a camera and lights") {
    ObjCase c;
    c.write("model.obj", fmt::format("{}{}", kSquare, kFace));
    c.import();
    CHECK(c.report() == "");
    CHECK(c.has("shape model mesh \"model.obj\" { material diffuse { reflectance 0.5 } }"));
    CHECK(c.has("camera perspective"));
    CHECK(c.has("light key sun"));
}

TEST_CASE("each material becomes a shape, in the order of use") {
    ObjCase c;
    c.write("model.mtl", "newmtl red\nKd 0.8 0.1 0.1\n\nnewmtl blue\nKd 0.1 0.1 0.8\nKe 2 2 4\n");
    c.write("model.obj",
            fmt::format("mtllib model.mtl\n{0}usemtl blue\n{1}usemtl red\n{1}g b\nusemtl blue\n{1}", kSquare, kFace));
    c.import();
    CHECK(c.report() == "");
    CHECK(c.has("material blue diffuse { reflectance rgb 0.1 0.1 0.8 }"));
    CHECK(c.has("shape blue mesh \"model-files/blue.ply\" { material blue; emission rgb 2 2 4 }\n"
                "shape red mesh \"model-files/red.ply\" { material red }"));
    CHECK(readAll(c.folder / "model-files/blue.ply").find("element face 2\n") != std::string::npos);
    CHECK(readAll(c.folder / "model-files/red.ply").find("element vertex 4\n") != std::string::npos);
}

TEST_CASE("highlights become gloss as wide") {
    // α = √(2 / (Ns + 2)), roughness √α.
    const MaterialCase c("Kd 0.5 0.5 0.5\nKs 0.2 0.2 0.2\nNs 48\nNi 1.45\nillum 2\n");
    CHECK(c.report() == "");
    CHECK(c.has(fmt::format("material m openpbr {{ base-color 0.5; specular-weight 0.2; specular-roughness {}; "
                            "specular-ior 1.45 }}",
                            std::round(std::sqrt(0.2) * 1e4) / 1e4)));
    CHECK(MaterialCase("Kd 0.5\nKs 0.2\nillum 1\n").has("material m diffuse"));
    CHECK(MaterialCase("Kd 0.5\nKs 0\nNs 5\n").has("material m diffuse { reflectance 0.5 }"));
}

TEST_CASE("mirrors reflect Ks without Fresnel's factor") {
    const MaterialCase both("Kd 0.3\nKs 0.6\nNs 998\nillum 3\n");
    CHECK(both.report() == "");
    // A third is matte: shares times colours are Kd and Ks.
    CHECK(both.has("first diffuse { reflectance 0.9"));
    CHECK(both.has("amount 0.6667"));
    CHECK(MaterialCase("Kd 0 0 0\nKs 0.9 0.6 0.3\nNs 10\nillum 3\n")
              .has("openpbr { base-color rgb 0.9 0.6 0.3; base-metalness 1"));
}

TEST_CASE("glass, and what is no glass although it says illum 4") {
    CHECK(MaterialCase("Kd 0\nNi 1.33\nTf 1 1 1\nillum 7\n").has("material m dielectric { ior 1.33 }"));
    CHECK(MaterialCase("Kd 0\nNi 1.5\nd 0\nTf 0.9 0.5 0.5\nillum 6\n").has("transmission-color rgb 0.9 0.5 0.5"));
    CHECK(MaterialCase("Kd 0.5\nNi 1.5\nd 0.25\nillum 9\n").has("transmission-weight 0.75"));
    CHECK(MaterialCase("Kd 0.5\nTf 1 1 1\nNi 1\nillum 4\n").has("material m diffuse { reflectance 0.5 }"));
    CHECK(MaterialCase("Kd 0.5\nd 0.4\nillum 2\n").has("opacity 0.4"));
    CHECK(MaterialCase("Kd 0.5\nTr 0.4\n").has("opacity 0.6"));
}

TEST_CASE("pictures with their options") {
    const MaterialCase c("Kd 0.5 0.5 0.5\nmap_Kd -s 2 3 1 -o 0.5 -clamp on -blendu off paint.png\n"
                         "map_d -imfchan g grey.png\nmap_Bump -bm 2 grey.png\n");
    CHECK(c.has("first 0.5"));
    CHECK(c.has("placed"));
    CHECK(c.has("scale 2 3"));
    CHECK(c.has("offset 0.5 0"));
    CHECK(c.has("wrap clamp"));
    CHECK(c.has("take green"));
    // 0.2 % of the square's diagonal, twice.
    CHECK(c.has("bump 0.0057"));
    CHECK(c.report().find("W0802") != std::string::npos);
    const MaterialCase named("map_Kd C:\\work\\paint.png\nKd 0 0 0\nmap_Bump -bm 0.5 brick_normal.png\n");
    CHECK(named.has("reflectance image \"paint.png\""));
    CHECK(named.has("normal image \"brick_normal.png\" space=data strength=0.5"));
    CHECK(named.says("their product would be black"));
    const MaterialCase missing("map_Kd pain.png\nKd 0.4\n");
    CHECK(missing.has("reflectance 0.4"));
    CHECK(missing.says("model.mtl:2:8"));
    CHECK(missing.diagnostics.all()[0].help == "did you mean `paint.png`?");
}

TEST_CASE("the extension for physically based materials") {
    const MaterialCase c(
        "Kd 0.9 0.6 0.2\nPm 1\nPr 0.25\naniso 0.5\nanisor 0.25\nPc 0.5\nPcr 0.1\nPs 0.2\nmap_Pr grey.png\nNi 1.4\n");
    CHECK(c.report() == "");
    for (const char* part :
         {"base-color rgb 0.9 0.6 0.2", "base-metalness 1", "first 0.25", "image \"grey.png\" space=data",
          "specular-roughness-anisotropy 0.5", "geometry-tangent 0.25", "coat-weight 0.5", "coat-roughness 0.1",
          "fuzz-weight 0.2", "specular-ior 1.4"})
        CHECK_MESSAGE(c.has(part), part);
}

TEST_CASE("light of a picture") {
    CHECK(MaterialCase("Kd 0\nKe 1 1 1\nmap_Ke paint.png\n").has("emission image \"paint.png\""));
    CHECK(MaterialCase("Kd 0\nKe 0 0 0\n").has("emission") == false);
    const MaterialCase holes("Ke 3\nd 0.5\n");
    CHECK_FALSE(holes.has("opacity"));
    CHECK(holes.says("W0801"));
}

TEST_CASE("what a library may not say has a place in it") {
    CHECK(MaterialCase("Kd 0.1 a 0.3\n").says("model.mtl:2:8: error"));
    CHECK(MaterialCase("Kd 1 2\n").says("E0801"));
    CHECK(MaterialCase("Kd\n").says("E0801"));
    CHECK(MaterialCase("map_Kd\n").says("E0801"));
    CHECK(MaterialCase("newmtl\n").says("E0801"));
    CHECK(MaterialCase("Kd 1e999 0 0\n").says("E0801"));
    const MaterialCase misspelt("Kf 0.1 0.2 0.3\n");
    CHECK(misspelt.says("W0803"));
    CHECK(misspelt.diagnostics.all()[0].help.find("did you mean") == 0);
    CHECK(MaterialCase("Kd 2 2 2\n").says("W0802"));
    CHECK(MaterialCase("disp -mm 0 1 grey.png\n").says("W0801"));
    CHECK(MaterialCase("map_Kd -wrong paint.png\n").says("W0803"));
    CHECK(MaterialCase("Ka 1 1 1\nsharpness 60\nmap_Ka grey.png\nillum 2\nKd 0.5\n").report() == "");
    ObjCase early;
    early.write("model.mtl", "Kd 1 1 1\n");
    early.write("model.obj", fmt::format("mtllib model.mtl\n{}{}", kSquare, kFace));
    early.import();
    CHECK(early.says("before the first `newmtl`"));
}

TEST_CASE("a library or a material that is not there is a warning, and grey") {
    ObjCase c;
    c.write("mode.mtl", "newmtl red\nKd 1 0 0\n");
    c.write("model.obj", fmt::format("mtllib mdoe.mtl\n{}usemtl red\n{}", kSquare, kFace));
    c.import();
    CHECK(c.says("model.obj:1:8"));
    CHECK(c.diagnostics.all().size() == 1);
    CHECK(c.diagnostics.all()[0].help == "did you mean `mode.mtl`?");
    CHECK(c.has("material diffuse { reflectance 0.5 }"));

    ObjCase other;
    other.write("a b.mtl", "newmtl red\nKd 1 0 0\n");
    other.write("model.obj", fmt::format("mtllib a b.mtl\n{}usemtl rad\n{}", kSquare, kFace));
    other.import();
    CHECK(other.says("no library has it"));
    CHECK(other.has("shape model mesh \"model.obj\""));
    CHECK(other.diagnostics.all()[0].help == "did you mean `red`?");
}

TEST_CASE("a smoothing group has the normals that its file leaves out") {
    const auto normalOf = [](const std::string& smoothing) {
        ObjCase c;
        // A roof over the line from 1 to 2, which both faces share; its ends differ in their texture coordinates.
        c.write("model.obj",
                smoothing + "v 0 1 0\nv 0 1 1\nv -1 0 0\nv 1 0 0\nvt 0 0\nvt 1 1\nf 1/1 3/1 2/1\nf 1/2 2/2 4/2\n");
        c.import();
        const std::string mesh = c.has("model.ply") ? c.folder / "model-files/model.ply" : c.folder / "model.obj";
        const MeshData read = readMesh(mesh).mesh;
        return read.normals.empty() ? Vec3() : read.normals[0];
    };
    const Vec3 normal = normalOf("s 1\n");
    CHECK(normal.x == doctest::Approx(0).epsilon(1e-5));
    CHECK(normal.y > 0.9);
    for (const char* other : {"", "s off\n", "s 0\n"}) CHECK(normalOf(other) == Vec3());
}

TEST_CASE("any number of materials without a library are one warning, and one shape") {
    ObjCase c;
    std::string text(kSquare);
    for (int i = 0; i < 2000; ++i) text += fmt::format("usemtl m{}\n{}", i, kFace);
    c.write("model.obj", text);
    c.import();
    CHECK(c.diagnostics.all().size() == 1);
    CHECK(c.has("shape model mesh \"model.obj\" { material diffuse { reflectance 0.5 } }"));
}

TEST_CASE("what a model says besides faces is not lost without a word") {
    ObjCase c;
    c.write("model.mtl", "newmtl m\nmap_Kd paint.png\n");
    c.write("paint.png", "");
    c.write("model.obj",
            "mtllib model.mtl\nv 0 0 0 1 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\ns 1\nf 1 2 3\ns 2\nf 1 2 3\nl 1 2\np 1\n");
    c.import();
    for (const char* part :
         {"`l` is left out", "`p` is left out", "colours of vertices", "`s` is approximated", "no texture coordinates"})
        CHECK_MESSAGE(c.says(part), part);
    ObjCase broken;
    broken.write("model.obj", "v 0 0 0\nf 1 2 3\n");
    broken.import();
    CHECK(broken.scene.empty());
    CHECK(broken.says("line 2"));
}

TEST_CASE("a model in an enclosed folder, as that of a pack, reads nothing outside of it") {
    const TemporaryFolder folder;
    fs::create_directory(folder / "pack");
    writeAll(folder / "outside.mtl", "newmtl m\nKd 1 0 0\n");
    writeAll(folder / "outside.png", "");
    writeAll(folder / "pack/inside.mtl", "newmtl n\nmap_Kd ../outside.png\n");
    writeAll(folder / "pack/model.obj",
             fmt::format("mtllib ../outside.mtl inside.mtl\n{}usemtl m\n{}usemtl n\n{}", kSquare, kFace, kFace));
    const auto import = [&] {
        SourceMap sources;
        Diagnostics diagnostics;
        importScene(*importFormat(folder / "pack/model.obj"), folder / "pack/model.obj", folder / "made.scene", sources,
                    diagnostics);
        return formatShort(diagnostics, sources);
    };
    CHECK(import() == "");
    ::unsetenv("ABBE_PATH"); // and where the scene is not allowed to read
    CHECK(import().find("`../outside.mtl` are left out") != std::string::npos);
    ::setenv("ABBE_PATH", "/", 1);
    encloseFolder(folder / "pack");
    const std::string report = import();
    CHECK(report.find("the materials of `../outside.mtl` are left out") != std::string::npos);
    CHECK(report.find("the picture `../outside.png` is left out") != std::string::npos);
}
