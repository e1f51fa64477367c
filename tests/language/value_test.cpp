// Numbers with units, words, texts, files, lists.
#include "language_fixture.h"

#include <doctest/doctest.h>

using namespace language_test;

namespace {

std::unique_ptr<Loaded> camera(const std::string& body) { return loadBody("camera { " + body + " }"); }
std::unique_ptr<Loaded> render(const std::string& body) { return loadBody("render { " + body + " }"); }
std::unique_ptr<Loaded> film(const std::string& body) { return loadBody("film { " + body + " }"); }
std::unique_ptr<Loaded> mesh(const std::string& body) { return loadBody("shape mesh { " + body + " }"); }

} // namespace

TEST_CASE("quantities are converted to SI") {
    CHECK(camera("lens 35 mm")->params["camera"].lens == doctest::Approx(0.035));
    CHECK(camera("lens 2")->params["camera"].lens == 2); // bare lengths are the header's
    CHECK(camera("fov 90 deg")->params["camera"].fov == doctest::Approx(kPiD / 2));
    CHECK(camera("fov 90")->params["camera"].fov == doctest::Approx(kPiD / 2));
    CHECK(camera("fov 0.25 turn")->params["camera"].fov == doctest::Approx(kPiD / 2));
    CHECK(camera("shutter \"1/48\" s")->params["camera"].time.value() == doctest::Approx(1. / 48));
    CHECK(camera("sensor 25 20 mm")->params["camera"].sensor == Vec2d{25 * 0.001, 20 * 0.001});
    CHECK(render("noise 0.5 %")->params["render"].radianceScale == doctest::Approx(0.005));
    const auto l = loadBody("light a quad { power 60 W }\nlight b quad { power 800 lm }");
    CHECK(l->params["light a"].amount.dimension == Dimension::power);
    CHECK(l->params["light b"].amount.dimension == Dimension::luminousFlux);
    CHECK(l->params["light b"].amount.value == 800);
}

TEST_CASE("defaults are bound unless their group is stated") {
    CHECK(camera("")->params["camera"].lens == doctest::Approx(0.05));
    CHECK(camera("fov 40 deg")->params["camera"].lens == 0);
    CHECK(render("")->params["render"].samples == 64);
    CHECK(!camera("")->params["camera"].time.has_value());
    const auto l = loadBody("shape sphere { material dielectric }\nmaterial m dielectric\nshape plane { material m }");
    CHECK(l->resolver.values.at(0).text == "BK7");
}

TEST_CASE("wrong units") {
    const auto area = loadBody("light quad { power 800 lx }");
    CHECK(area->codes() == "E0302");
    CHECK(area->get("E0302").message == "lx measures light arriving; `power` needs W or lm");
    const auto angle = camera("fov 40 mm");
    CHECK(angle->get("E0302").message == "`fov` is an angle, not a length");
    CHECK(angle->get("E0302").label == "write deg");
    CHECK(camera("lens 50 mmm")->get("E0301").label == "did you mean `mm`?");
    CHECK(camera("fov 40 degrees")->get("E0301").label == "did you mean `deg`?");
    CHECK(camera("lens 50 parsec")->get("E0301").help.starts_with("`lens` takes `mm`, `cm`"));
    CHECK(camera("f-stop 2.8 foo")->codes() == "E0301");
    CHECK(camera("f-stop 2.8 cm")->get("E0302").fixes.empty()); // an f-number, or a diameter?
    CHECK(camera("f-stop 280 %")->get("E0302").fixes.at(0).replacement == "2.8");
}

TEST_CASE("ranges and finiteness") {
    CHECK(camera("fov 200 deg")->get("E0303").message == "`fov` must be between 0.1 and 179 deg");
    CHECK(camera("fov 200 deg")->get("E0303").label == "is 200 deg");
    CHECK(camera("lens 20 m")->get("E0303").message == "`lens` must be between 0.0001 and 10 m");
    CHECK(loadBody("shape sphere { radius 0 }")->get("E0303").message == "`radius` must be above 0");
    CHECK(loadBody("light quad { power -1 W }")->get("E0303").message == "`power` must be at least 0 W");
    CHECK(camera("lens #inf")->codes() == "E0305");
    CHECK(camera("from 0 #nan 0")->codes() == "E0305");
    CHECK(camera("shutter \"1/0\" s")->get("E0318").label == "is 0");
    CHECK(render("samples 2.5")->get("E0305").message == "`samples` must be a whole number");
    CHECK(render("samples 0")->codes() == "E0303");
    CHECK(mesh("points { - 0 0 0; - 0 #inf 0 }")->codes() == "E0305");
}

TEST_CASE("numbers of values") {
    CHECK(camera("from 0 1")->get("E0306").message == "`from` takes 3 numbers");
    CHECK(camera("from 0 1")->get("E0306").label == "has 2");
    CHECK(camera("from 0 1 2 3")->get("E0306").label == "unexpected");
    CHECK(camera("from")->get("E0306").label == "has none");
    CHECK(camera("sensor 36 mm 24 mm")->get("E0306").label == "write the unit once, behind the last number");
    CHECK(camera("lens 50 mm wide")->codes() == "E0306");
    CHECK(camera("lens wide")->codes() == "E0314");
    CHECK(camera("lens #true")->codes() == "E0314");
    CHECK(camera("lens 50 mm { blades 9 }")->codes() == "E0214");
    CHECK(camera("lens 50 mm on=hero")->codes() == "E0210");
}

TEST_CASE("switches") {
    CHECK(render("denoise on")->params["render"].denoise);
    CHECK(render("denoise #true")->params["render"].denoise);
    CHECK(!render("denoise off")->params["render"].denoise);
    CHECK(render("denoise \"yes\"")->get("E0308").fixes.at(0).replacement == "on");
    CHECK(render("denoise maybe")->codes() == "E0308");
    CHECK(render("denoise")->codes() == "E0308");
}

TEST_CASE("choices and texts") {
    const auto l = film("filter gaussian 1.5; output \"a.exr\" space=acescg");
    CHECK(l->codes().empty());
    CHECK(l->params["film"].filter.word == "gaussian");
    CHECK(l->params["film"].filter.number == 1.5);
    CHECK(l->params["film"].output.value == "a.exr");
    CHECK(l->params["film"].output.keys.at(0).second == "acescg");
    CHECK(!film("filter box")->params["film"].filter.number.has_value());
    CHECK(film("filter gausian")->get("E0307").label == "did you mean `gaussian`?");
    CHECK(film("filter 3")->codes() == "E0314");
    CHECK(film("filter")->codes() == "E0306");
    CHECK(film("filter gaussian 11")->codes() == "E0303");
    CHECK(film("filter gaussian 1 2")->codes() == "E0306");
    CHECK(film("output 3")->codes() == "E0314");
    CHECK(film("output \"a\" \"b\"")->codes() == "E0306");
    CHECK(film("output \"a\" spce=acescg")->get("E0210").label == "did you mean `space`?");
    CHECK(film("output \"a\" space=acesg")->get("E0307").label == "did you mean `acescg`?");
}

TEST_CASE("properties: unknown, twice, missing, synonyms") {
    CHECK(loadBody("material a diffuse { Kd 0.5 }\nshape sphere { material a }")->get("E0201").help ==
          "did you mean `reflectance`?");
    CHECK(camera("fovy 40 deg")
              ->get("E0201")
              .help.starts_with("did you mean `fov` (full horizontal angle, e.g. `40 deg`)?"));
    CHECK(camera("fovy 40 deg")->get("E0201").fixes.empty()); // it may be the vertical one
    CHECK(loadBody("shape sphere { r 2 }")->get("E0201").message == "`shape sphere` has no property `r`");
    CHECK(camera("xyzzy 3")->get("E0201").help.starts_with("its properties are `lens`, `fov`"));
    CHECK(camera("f-stop 2; f-stop 4")->codes() == "E0208");
    CHECK(loadBody("light quad { size 1 1 }")->get("E0207").message ==
          "`light quad` needs `power`, `luminance` or `radiance`");
    CHECK(loadBody("light quad { luminanse 100 nits }")->codes() == "E0201"); // misspelt, so not missing
    CHECK(loadBody("light quad { radiance 5 }")->codes().empty());
    CHECK(loadBody("shape sphere { material conductor }")->codes() == ""); // bound by whoever builds the inline one
    CHECK(loadBody("material a conductor\nshape sphere { material a }")->get("E0207").message ==
          "`material a` needs `ior`");
}

TEST_CASE("files") {
    const TemporaryFolder folder;
    folder.write("a.ply", "ply");
    folder.write("meshes/body.obj", "");
    const auto found = loadBody("shape mesh \"a.ply\"", folder.path());
    CHECK(found->codes().empty());
    CHECK(found->params["shape"].file.value == (folder.path() / "a.ply").string());
    CHECK(loadBody("shape mesh \"b.ply\"", folder.path())->get("E0401").help == "`a.ply` exists");
    CHECK(loadBody("shape mesh \"meshs/body.obj\"", folder.path())->get("E0401").help == "there is no folder `meshs`");
    CHECK(loadBody("shape mesh meshes", folder.path())->codes() == "E0402");
    CHECK(loadBody("shape mesh \"\"", folder.path())->codes() == "E0401");
    CHECK(loadBody("shape mesh \"a.ply\" { file \"a.ply\" }", folder.path())->codes() == "E0208");
}

TEST_CASE("lists and rows") {
    const auto l = load("scene 1 length=cm\nshape mesh { points { - 1 2 3;  - 4 5 6 mm\n - 0 0 0 1 1 1 }; faces { - 0 "
                        "1 2; - 3 2 1 0 }; weights 0 0.5 1 }");
    INFO(l->human());
    CHECK(l->codes().empty());
    const Params& p = l->params["shape"];
    REQUIRE(p.points.size() == 4);
    CHECK(p.points[0] == Vec3d{1 * 0.01, 2 * 0.01, 3 * 0.01});
    CHECK(p.points[1] == Vec3d{4 * 0.001, 5 * 0.001, 6 * 0.001});
    CHECK(p.faces.counts == std::vector<std::uint32_t>{3, 4});
    CHECK(p.faces.indices == std::vector<std::uint32_t>{0, 1, 2, 3, 2, 1, 0});
    CHECK(p.numbers == std::vector<double>{0, 0.5, 1});
    CHECK(mesh("points 0 0 0  1 0 0  1 1 0 mm")->params["shape"].points.at(1).x == 0.001);
    CHECK(mesh("points 0 0 0 1")->get("E0306").message == "a point has 3 coordinates");
    CHECK(mesh("points { - 0 0 }")->get("E0306").label == "has 2 numbers");
    CHECK(mesh("points { 0 0 0 }")->diagnostics.hasErrors());
    CHECK(mesh("points { p 0 0 0 }")->codes() == "E0309");
    CHECK(mesh("points")->codes() == "E0306");
    CHECK(mesh("points { }")->codes() == "E0306");
    CHECK(mesh("points 1 { - 1 2 3 }")->codes() == "E0306");
    CHECK(mesh("points 0 0 0 kg")->codes() == "E0301");
    CHECK(mesh("faces { - 0 1 }")->get("E0309").label == "has 2");
    CHECK(mesh("faces { - 0 1 -2 }")->get("E0309").label == "is negative");
    CHECK(mesh("faces { - 0 1 2.5 }")->get("E0309").label == "is not a whole number");
    CHECK(mesh("faces { - 0 1 5e9 }")->get("E0309").label == "is too large");
    CHECK(mesh("faces { - 0 1 a }")->get("E0309").label == "not a number");
    CHECK(mesh("faces 0 1 2")->codes() == "E0309");
    CHECK(mesh("faces { }")->codes() == "E0306");
    const auto range = mesh("weights { - 0.5 0.25; - 0.5 1.5 0.5 }");
    CHECK(range->codes() == "E0303");
    CHECK(range->text(range->get("E0303").span) == "1.5");
}

TEST_CASE("values of parameters point at their use") {
    const auto l = loadBody("param wide 200 deg\ncamera { fov $wide }");
    CHECK(l->text(l->get("E0303").span) == "$wide");
    CHECK(l->text(l->get("E0303").related.at(0).span) == "200");
}

TEST_CASE("a head that lost something to a syntax error gives no second error") {
    CHECK(loadBody("light quad .5x { }")->codes().find("E0207") == std::string::npos);
}
