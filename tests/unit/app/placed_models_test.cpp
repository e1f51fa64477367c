// Shapes that take the materials of their file: what becomes of them in the tree, and what is said where.
#include "app/load.h"
#include "packs/scene_files.h"
#include "scene/build.h"
#include "unit/exchange/gltf_cases.h"

#include <doctest/doctest.h>
#include <fstream>

using namespace abbe;

namespace {

// A square that emits, with a picture, seen in a scene whose other lines are given.
struct ModelCase {
    TemporaryFolder folder;
    std::unique_ptr<LoadedScene> loaded;
    BuiltScene built;

    explicit ModelCase(const std::string& header, const std::string& lines, const std::string& defined = "") {
        writeAll(folder / "case.bin", exchange::gltfBuffer());
        writeAll(folder / "tex.png", readAll(ABBE_SOURCE_DIR "/tests/snippets/any.png"));
        writeAll(folder / "wall.gltf",
                 exchange::gltfMaterial(
                     R"("emissiveFactor":[1,0,0],"pbrMetallicRoughness":{"baseColorTexture":{"index":0}})",
                     R"(,"textures":[{"source":0}],"images":[{"uri":"tex.png"}])"));
        writeAll(folder / "shot.scene",
                 header + "\ncamera { from 0 1 4; look-at 0 0 0 }\nlight sky { luminance 1000 nits }\n" + lines);
        SceneInput input{folder / "shot.scene", {}};
        if (!defined.empty()) input.defines.push_back(defined);
        loaded = loadScene(input);
    }
    void build() {
        BuildOptions options;
        options.geometry = false;
        built = buildScene(loaded->tree, loaded->types, options, loaded->diagnostics);
    }
    std::string report() const { return formatShort(loaded->diagnostics, loaded->sources); }
    bool has(schema::Kind kind, std::string_view name) const { return loaded->tree.find(kind, name) != nullptr; }
};

using schema::Kind;

} // namespace

TEST_CASE("a mesh with the materials of its file is a group of shapes whose names begin with its own") {
    const ModelCase c("scene 1", "shape ball mesh \"wall.gltf\" { materials on; transform { scale 2 } }\n"
                                 "shape mesh \"wall.gltf\" { materials on }\nshape mesh \"wall.gltf\" materials=on\n");
    INFO(c.report());
    CHECK_FALSE(c.loaded->diagnostics.hasErrors());
    CHECK(c.has(Kind::group, "ball"));
    CHECK_FALSE(c.has(Kind::shape, "ball"));
    CHECK(c.has(Kind::shape, "ball/wall"));
    CHECK(c.has(Kind::material, "ball/paint"));
    CHECK(c.has(Kind::texture, "ball/tex"));
    CHECK(c.has(Kind::material, "wall/paint"));
    CHECK(c.has(Kind::material, "wall-2/paint"));
    CHECK_FALSE(c.has(Kind::light, "ball/key")); // of a preview
}

TEST_CASE("a name of the scene that looks like one of a model stays its own") {
    const ModelCase c("scene 1", "material \"ball/paint\" diffuse\nshape quad { material \"ball/paint\" }\n"
                                 "shape ball mesh \"wall.gltf\" { materials on }\n");
    CHECK_FALSE(c.loaded->diagnostics.hasErrors());
    CHECK(c.has(Kind::material, "ball-2/paint"));
}

TEST_CASE("a model is in metres with y up, whatever the scene's header says") {
    ModelCase c("scene 1 length=mm up=z", "shape ball mesh \"wall.gltf\" { materials on }\n");
    c.build();
    INFO(c.report());
    const auto& shapes = c.built.facts.shapeList;
    REQUIRE(shapes.size() == 1);
    CHECK(shapes[0].name == "ball/wall");
    CHECK(shapes[0].bounds.lower.z == doctest::Approx(-1)); // its y
    CHECK(shapes[0].bounds.upper.z == doctest::Approx(1));
    CHECK(std::abs(shapes[0].bounds.upper.y) < 1e-6);
    CHECK(c.built.facts.lightList.size() == 2); // the sky, and what the file emits
}

TEST_CASE("what becomes of a model is said at the shape, with the place in the file") {
    const ModelCase c("scene 1", "shape ball mesh \"wall.gltf\" { materials on }\n");
    REQUIRE(c.loaded->diagnostics.all().size() == 1);
    const Diagnostic& d = c.loaded->diagnostics.all()[0];
    CHECK(d.code == "W0802");
    CHECK(c.loaded->sources.text(d.span) == "\"wall.gltf\"");
    CHECK(c.loaded->sources.path(d.span.file).ends_with("shot.scene"));
}

TEST_CASE("the file of a model counts with its buffer and its pictures, also where a parameter names it") {
    const ModelCase c("scene 1\nparam model \"none.gltf\" \"what is placed\"",
                      "shape ball mesh $model { materials on }\n", "model=wall.gltf");
    INFO(c.report());
    CHECK_FALSE(c.loaded->diagnostics.hasErrors());
    const auto files = filesOf(c.loaded->tree);
    REQUIRE(files.size() == 1);
    REQUIRE(files[0].parts.size() == 3);
    CHECK(files[0].parts[1].role == "case.bin");
    CHECK(files[0].parts[2].role == "tex.png");
}

TEST_CASE("materials of a file leave no room for one of the scene's") {
    for (const char* property : {"material diffuse", "emission 1", "interior homogeneous { scattering 1 per-m }"}) {
        const ModelCase c("scene 1", std::string("shape mesh \"wall.gltf\" { materials on; ") + property + " }\n");
        REQUIRE(c.loaded->diagnostics.errorCount() == 1);
        CHECK(c.report().find("E0616") != std::string::npos);
    }
    const ModelCase off("scene 1", "shape ball mesh \"wall.gltf\" { materials off; material diffuse }\n");
    CHECK(off.report() == "");
    CHECK(off.has(Kind::shape, "ball"));
}
