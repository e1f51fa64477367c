// The eleven lines with nine mistakes of the language's design, diagnostic by diagnostic.
#include "language_fixture.h"

#include <doctest/doctest.h>

using namespace language_test;

namespace {

constexpr const char* kBroken = R"(scene 1 length=cm

camera {
    from 0 165 320
    lense 85mm
    f-stop 2.8 cm
}
material skin subsurface { roughness 1.38 }
light rim quad { size 60 120; power 2400 lm; luminance 5000 nits }
shape hero subdivision "hero/bdoy.obj" { material sking }
material skin diffuse { reflectance rgb 1.2 0.8 0.7 }
)";

// The same with types that every version has, so that the nine mistakes are all there is.
std::string withKnownTypes() {
    std::string text = kBroken;
    text.replace(text.find("subsurface"), 10, "dielectric");
    text.replace(text.find("subdivision"), 11, "mesh");
    return text;
}

} // namespace

TEST_CASE("nine mistakes give nine diagnostics") {
    const TemporaryFolder folder;
    folder.write("hero/body.obj", "");
    const auto l = load(withKnownTypes(), folder.path());
    INFO(l->human());
    CHECK(l->codes() == "E0201 E0105 E0302 E0303 E0310 E0401 E0202 E0203 E0304");
    CHECK(l->diagnostics.warningCount() == 0);

    CHECK(l->get("E0201").message == "`camera` has no property `lense`");
    CHECK(l->get("E0201").label == "unknown property");
    CHECK(l->get("E0201").help == "did you mean `lens` (focal length, e.g. `50 mm`)?");
    CHECK(l->get("E0302").message == "`f-stop` is a plain number, not a length");
    CHECK(l->get("E0302").label == "remove the unit");
    CHECK(l->text(l->get("E0302").span) == "cm");
    CHECK(l->get("E0303").message == "`roughness` must be between 0 and 1");
    CHECK(l->get("E0303").label == "is 1.38");
    CHECK(l->get("E0310").message == "`light rim` states its amount twice");
    CHECK(l->text(l->get("E0310").span) == "luminance 5000 nits");
    CHECK(l->get("E0310").label == "second amount");
    REQUIRE(l->get("E0310").related.size() == 1);
    CHECK(l->text(l->get("E0310").related[0].span) == "power 2400 lm");
    CHECK(l->get("E0401").message == "file not found: `hero/bdoy.obj`");
    CHECK(l->get("E0401").label.starts_with("looked in " + folder.path().string()));
    CHECK(l->get("E0401").help == "`hero/body.obj` exists");
    CHECK(l->get("E0202").message == "no material is named `sking`");
    CHECK(l->get("E0202").label == "did you mean `skin`?");
    REQUIRE(l->get("E0202").related.size() == 1);
    CHECK(l->text(l->get("E0202").related[0].span) == "skin");
    CHECK(l->get("E0203").message == "material `skin` is defined twice");
    CHECK(l->get("E0203").label == "second definition");
    CHECK(l->get("E0203").related.at(0).text == "the first definition is here");
    CHECK(l->get("E0304").message == "a reflectance above 1 would create energy");
    CHECK(l->get("E0304").label == "red is 1.2");
    CHECK(l->text(l->get("E0304").span) == "1.2");
}

TEST_CASE("unknown types do not hide the mistakes in their blocks") {
    const TemporaryFolder folder;
    folder.write("hero/body.obj", "");
    const auto l = load(kBroken, folder.path());
    INFO(l->human());
    CHECK(l->codes() == "E0201 E0105 E0302 E0205 E0303 E0310 E0205 E0401 E0202 E0203 E0304");
    CHECK(l->text(l->get("E0205").span) == "subsurface");
    CHECK(l->get("E0205").help == "the types of `material` are `diffuse`, `dielectric` and `conductor`");
}

TEST_CASE("in a block of unknown type only what no type of the kind accepts is wrong") {
    const auto codes = [](const std::string& property) {
        return loadBody("material m subsurface { " + property + " }\nshape sphere { material m }")->codes();
    };
    CHECK(codes("ior 1.5") == "E0205");            // of a dielectric, not of a conductor
    CHECK(codes("ior metal Au") == "E0205");       // of both
    CHECK(codes("ior -1") == "E0205 E0303");       // of neither
    CHECK(codes("ior { n 1.5; k 2 }") == "E0205"); // of a conductor, not of a dielectric, which comes first
    CHECK(codes("mean-free-path 3 mm") == "E0205");
}
