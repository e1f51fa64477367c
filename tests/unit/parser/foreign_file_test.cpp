// Files of other programs given as scenes: one diagnostic that says what to do.
#include "parse_text.h"
#include "parser/foreign_file.h"

#include <doctest/doctest.h>
#include <filesystem>
#include <fstream>
#include <unistd.h>

using namespace abbe;
using namespace std::string_view_literals;

namespace {

std::string whatIs(std::string_view text) {
    const auto found = parser::recogniseForeign(text, "x");
    return found ? std::string(found->what) : "";
}

} // namespace

TEST_CASE("files of other programs are known by how they begin") {
    const std::vector<std::pair<std::string_view, std::string_view>> cases = {
        {"# Blender\nmtllib a.mtl\no Cube\nv 1 1 -1\nv 1 -1 -1\n", "a Wavefront OBJ file"},
        {"v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n", "a Wavefront OBJ file"},
        {"newmtl red\nKd 1 0 0\n", "a Wavefront material library (MTL)"},
        {"# a comment\nLookAt 0 0 5  0 0 0  0 1 0\nCamera \"perspective\"\n", "a scene of pbrt"},
        {"Film \"rgb\" \"integer xresolution\" [400]\nWorldBegin\n", "a scene of pbrt"},
        {"<?xml version=\"1.0\"?>\n<scene version=\"3.0.0\">\n", "a scene of Mitsuba (XML)"},
        {"<COLLADA>", "a COLLADA file"},
        {"#usda 1.0\ndef Xform \"a\"\n{\n}\n", "a USD file"},
        {"PXR-USDC\0\0"sv, "a USD file"},
        {"{\n  \"asset\": { \"version\": \"2.0\" }\n}", "a glTF file"},
        {"{ \"camera\": 1 }", "a JSON file"},
        {"[ { \"a\": 1 } ]", "a JSON file"},
        {"glTF\2\0\0\0"sv, "a binary glTF file"},
        {"BLENDER-v300RENDH", "a Blender file"},
        {"\x89PNG\r\n\x1a\n", "a PNG picture"},
        {"\xff\xd8\xff\xe0", "a JPEG picture"},
        {"v/1\x01\2\0\0\0"sv, "an OpenEXR image"},
        {"II*\0"sv, "a TIFF picture"},
        {"#?RADIANCE\n", "a Radiance HDR picture"},
        {"ply\nformat ascii 1.0\n", "a PLY file"},
        {"solid a\n  facet normal 0 0 1\n", "an STL file"},
        {"Kaydara FBX Binary", "an FBX file"},
        {"Ogawa\xff", "an Alembic file"},
        {" BDV\0\0"sv, "an OpenVDB file"},
        {"IESNA:LM-63-2002\n", "a photometric file"},
        {"PK\x03\x04", "a ZIP archive or a packed USD file"},
        {"import bpy\n", "a Python script"},
        {"options\n{\n AA_samples 3\n}\n", "a scene of Arnold"},
        {"##RenderMan RIB\n", "a RenderMan RIB file"},
        {"400 0.1\n410 0.2\n", "a table of numbers"},
        {"400,0.1\r\n410,0.2\r\n", "a table of numbers"},
        {"ABBECKPT\1", "a checkpoint or a part of a render"},
    };
    for (const auto& [text, what] : cases) CHECK_MESSAGE(whatIs(text) == what, std::string(text));
}

TEST_CASE("what is no scene at all") {
    std::string prose;
    for (int i = 0; i < 25; ++i) prose += "Some words, and a number 7.\n";
    CHECK(whatIs(prose) == "a text without any `camera`, `light` or `shape`");
    CHECK(whatIs(prose + "  shape sphere\n") == "");
    CHECK(whatIs(prose.substr(0, 100)) == "a text without any `camera`, `light` or `shape`");
    for (const char* text : {"root:x:0:0:root:/root:/bin/sh\n", "hunter2", "- 0 1 4\n", "{ a }", "[1 2 3]",
                             "from 0 1 3\nfov 40\n", "// all of it\n// is a comment\n", "key = value # camera\n"})
        CHECK_MESSAGE(whatIs(text) == "a text without any `camera`, `light` or `shape`", text);
    CHECK(whatIs("abc\0def"sv) == "no text");
}

TEST_CASE("scenes are not taken for other files, however wrong they are") {
    for (const char* text :
         {"", "scene 1\ncamera { }\n", "# a comment\ncamera { }\n", "camera\n{\n}\n", "shape sphere", " \n",
          "scnee 1\n", "sc", "lihgt sky\n", "caemra{ }\n", "o 1\nshape plane\n", "param v 1\n", "\xef\xbb\xbfscene 1",
          "Camera { }", "film { }", "// 400 0.1\nlight sky { }", "x-tool { }\n", "material m diffuse\n"})
        CHECK_MESSAGE(whatIs(text) == "", text);
}

TEST_CASE("one diagnostic says what to do with a file of another program") {
    const std::filesystem::path path =
        std::filesystem::temp_directory_path() / ("abbe-foreign-" + std::to_string(getpid()) + ".obj");
    std::ofstream file(path);
    for (int i = 0; i < 5000; ++i) file << "v 0 " << i << " 0\n";
    file.close();
    SourceMap sources;
    Diagnostics diagnostics;
    CHECK_FALSE(readSceneFile(sources, path, diagnostics));
    REQUIRE(diagnostics.all().size() == 1);
    const Diagnostic& d = diagnostics.all()[0];
    CHECK(d.code == "E0413");
    CHECK(d.message == "`" + path.string() + "` is a Wavefront OBJ file, not a scene");
    CHECK(d.help == "`abbe render` takes it if its name ends in `.obj`; in a scene it is `shape mesh \"" +
                        path.filename().string() + "\" { material diffuse { } }`");
    std::filesystem::remove(path);
}
