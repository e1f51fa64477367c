#include "exchange/pbrt/pbrt_scanner.h"
#include "unit/exchange/pbrt_cases.h"

#include <doctest/doctest.h>

using namespace abbe;
using namespace abbe::exchange;

TEST_CASE("pbrt: words, numbers, texts and brackets, whatever stands between them") {
    PbrtScanner scanner("Shape\"a b\"[1 -2.5e3 .5]#x\n+4. \"q\\\"\\n\" 1e-400 true", FileId::none);
    using Kind = PbrtToken::Kind;
    CHECK(scanner.next().raw == "Shape");
    CHECK(scanner.next().text() == "a b");
    CHECK(scanner.next().kind == Kind::open);
    std::vector<double> numbers;
    scanner.numbers(numbers);
    CHECK(numbers == std::vector{1.0, -2500.0, 0.5});
    CHECK(scanner.next().kind == Kind::close);
    CHECK(scanner.next().number == 4);
    CHECK(scanner.next().text() == "q\"\n");
    CHECK(scanner.next().number == 0); // too small for a double
    CHECK(scanner.next().raw == "true");
    CHECK(scanner.next().kind == Kind::end);
}

TEST_CASE("pbrt: what is no number and no text is a fault with a place") {
    for (const char* text : {"1.2.3", "1e999", "-", "+x", "nan1", "\"open"}) {
        PbrtScanner scanner(text, FileId::none);
        const auto kind = scanner.next().kind;
        CHECK((kind == PbrtToken::Kind::fault || kind == PbrtToken::Kind::word));
    }
    const PbrtCase broken(pbrtWorld("Shape \"sphere\" \"float radius\" 1.2.3\nShape \"disk\"\n"));
    CHECK(broken.says("case.pbrt:5:31: error[E0801]"));
    CHECK(broken.has("shape disk"));
}

TEST_CASE("pbrt: parameters may be in brackets or not, and switches quoted") {
    const PbrtCase made(
        pbrtWorld("Shape \"sphere\" \"float radius\" [ 0.25 ] \"float zmin\" -1 \"string unheard\" \"x\"\n"));
    CHECK(made.has("radius 0.25"));
    CHECK(made.says("warning[W0803]: the shape `sphere` has no parameter `unheard`"));
    const PbrtCase near(pbrtWorld("Shape \"sphere\" \"float radiuss\" 2\n"));
    CHECK(near.diagnostics.all().at(0).help == "did you mean `radius`?");
}

TEST_CASE("pbrt: blocks that do not fit are errors where they stand") {
    CHECK(PbrtCase(pbrtWorld("AttributeEnd\n")).says("case.pbrt:5:1: error[E0801]: `AttributeEnd` closes nothing"));
    CHECK(PbrtCase(pbrtWorld("AttributeBegin\n")).says("case.pbrt:5:1: error[E0801]: this block is never closed"));
    CHECK(PbrtCase(pbrtWorld("ObjectBegin \"a\"\nAttributeEnd\n")).says("closes another kind of block"));
    std::string deep;
    for (int i = 0; i < 5000; ++i) deep += "AttributeBegin\n";
    CHECK(PbrtCase(pbrtWorld(deep)).says("more than 1000 blocks"));
    CHECK(PbrtCase("Shape \"sphere\"\n").says("`Shape` stands before `WorldBegin`"));
    CHECK(PbrtCase(pbrtWorld("Shap \"sphere\"\n")).diagnostics.all().at(0).help == "did you mean `Shape`?");
}

TEST_CASE("pbrt: a scene of version 3 is one error that says what to do") {
    for (const char* old :
         {"Film \"image\" \"integer xresolution\" 8\nWorldBegin\nWorldEnd\n",
          "WorldBegin\nLightSource \"point\" \"color I\" [1 1 1]\n",
          "WorldBegin\nMaterial \"matte\" \"rgb Kd\" [1 1 1]\nShape \"nothing\"\n",
          "WorldBegin\nTexture \"a\" \"color\" \"imagemap\"\n", "SurfaceIntegrator \"path\"\nWorldBegin\n"}) {
        const PbrtCase made(old);
        REQUIRE(made.diagnostics.all().size() == 1);
        CHECK(made.diagnostics.all()[0].code == "E0801");
        CHECK(made.says("written for pbrt-v3"));
        CHECK(made.diagnostics.all()[0].help.find("pbrt --upgrade") != std::string::npos);
    }
}

TEST_CASE("pbrt: files are included once more, but not in themselves") {
    PbrtCase made;
    writeAll(made.folder / "part.pbrt", "Shape \"sphere\"\nTranslate 1 0 0\n");
    made.import(
        pbrtWorld("Include \"part.pbrt\"\nInclude \"part.pbrt\"\nInclude \"case.pbrt\"\nInclude \"none.pbrt\"\n"));
    CHECK(made.says("case.pbrt:7:1: error[E0802]: `case.pbrt` includes itself"));
    CHECK(made.says("case.pbrt:8:1: error[E0802]"));
    CHECK(made.has("shape sphere { radius 1 }"));
    CHECK(made.has("shape sphere { radius 1; transform { translate 1 0 0 } }"));
    PbrtCase imported;
    writeAll(imported.folder / "part.pbrt", "Translate 1 0 0\nMakeNamedMaterial \"m\" \"string type\" \"diffuse\"\n");
    imported.import(pbrtWorld("Import \"part.pbrt\"\nNamedMaterial \"m\"\nShape \"sphere\"\n"));
    CHECK(imported.report() == "");
    CHECK(imported.has("shape sphere { radius 1; material m }"));
}

TEST_CASE("pbrt: two files that include each other many times end") {
    PbrtCase made;
    std::string again;
    for (int i = 0; i < 30; ++i) again += "Include \"next0.pbrt\"\n";
    for (int i = 0; i < 8; ++i) {
        std::string next = again;
        for (std::size_t at = 0; (at = next.find("next0", at)) != std::string::npos; ++at)
            next.replace(at, 5, "next" + std::to_string(i + 1));
        writeAll(made.folder / ("next" + std::to_string(i) + ".pbrt"), next);
    }
    writeAll(made.folder / "next8.pbrt", "");
    made.import(pbrtWorld(again));
    CHECK(made.says("included without end"));
}

TEST_CASE("pbrt: the current transform, its coordinate systems and its blocks") {
    const PbrtCase made(
        pbrtWorld("Translate 1 2 3\nCoordinateSystem \"here\"\nAttributeBegin\nScale 2 2 2\nShape \"sphere\"\n"
                  "AttributeEnd\nIdentity\nRotate 90 0 0 1\nCoordSysTransform \"here\"\nShape \"disk\"\n"
                  "Transform [1 0 0 0  0 1 0 0  0 0 1 0  7 8 9 1]\nShape \"sphere\" \"float radius\" 3\n"
                  "ConcatTransform [2 0 0 0  0 2 0 0  0 0 2 0  1 1 1 1]\nShape \"sphere\" \"float radius\" 4\n"
                  "CoordSysTransform \"nowhere\"\n"));
    CHECK(made.has("shape sphere { radius 1; transform { scale 2; translate 1 2 3 } }"));
    CHECK(made.has("shape disk { center 0 0 0; normal 0 0 1; radius 1; transform { translate 1 2 3 } }"));
    CHECK(made.has("shape sphere { radius 3; transform { translate 7 8 9 } }"));
    CHECK(made.has("shape sphere { radius 4; transform { scale 2; translate 8 9 10 } }"));
    CHECK(made.says("there is no coordinate system `nowhere`"));
}

TEST_CASE("pbrt: Attribute gives defaults that a directive may change") {
    const PbrtCase made(
        pbrtWorld("Attribute \"shape\" \"float radius\" 3\nShape \"sphere\"\n"
                  "Shape \"sphere\" \"float radius\" 2\nShape \"trianglemesh\" \"point3 P\" [0 0 1 1 0 1 0 1 1]\n"));
    CHECK(made.report() == "");
    CHECK(made.has("radius 3"));
    CHECK(made.has("radius 2"));
}

TEST_CASE("pbrt: the ends of a motion become keys") {
    const std::string move = "ActiveTransform EndTime\nTranslate 1 0 0\nActiveTransform All\nShape \"sphere\"\n";
    const PbrtCase made("TransformTimes 0.25 0.75\n" + pbrtWorld(move));
    CHECK(made.has("at 0.25 s { translate 0 0 0 }"));
    CHECK(made.has("at 0.75 s { translate 1 0 0 }"));
    CHECK(made.has("shutter 1 s"));
}

TEST_CASE("pbrt: numbers beyond float are errors, and so are transforms") {
    CHECK(PbrtCase(pbrtWorld("Shape \"sphere\" \"float radius\" 1e39\n")).says("too large for single precision"));
    CHECK(PbrtCase(pbrtWorld("Scale 1e25 1 1\nScale 1e25 1 1\nShape \"sphere\"\n")).says("infinitely large"));
    CHECK(PbrtCase(pbrtWorld("Scale 0 1 1\n")).says("a scale of 0"));
    CHECK(PbrtCase(pbrtWorld("Transform [1 0 0 0  1 0 0 0  0 0 1 0  0 0 0 1]\n")).says("no inverse"));
}
