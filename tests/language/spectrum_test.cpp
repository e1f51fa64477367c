// Every form of a spectrum, in every role.
#include "language_fixture.h"

#include <cmath>
#include <doctest/doctest.h>

using namespace language_test;

namespace {

using Form = SpectrumValue::Form;

std::unique_ptr<Loaded> albedo(const std::string& value, const std::filesystem::path& folder = ".") {
    return loadBody("material m diffuse { reflectance " + value + " }\nshape sphere { material m }", folder);
}
std::unique_ptr<Loaded> index(const std::string& value) {
    return loadBody("material m dielectric { ior " + value + " }\nshape sphere { material m }");
}
std::unique_ptr<Loaded> emission(const std::string& value) { return loadBody("light quad { radiance " + value + " }"); }
std::unique_ptr<Loaded> absorption(const std::string& value) {
    return loadBody("material m dielectric { absorption " + value + " }\nshape sphere { material m }");
}

// The first value that was resolved; the scene must be right.
SpectrumValue value(const std::unique_ptr<Loaded>& l) {
    INFO(l->human());
    CHECK(l->codes().empty());
    return l->resolver.values.empty() ? SpectrumValue{} : l->resolver.values[0];
}

} // namespace

TEST_CASE("forms of a spectrum") {
    CHECK(value(albedo("0.18")).numbers == std::vector<double>{0.18});
    CHECK(value(albedo("rgb 0.8 0.2 0.1")).numbers == std::vector<double>{0.8, 0.2, 0.1});
    CHECK(value(albedo("rgb 0.8 0.2 0.1")).space == RgbSpaceName::linRec709);
    CHECK(value(albedo("rgb 0.8 0.2 0.1 space=acescg")).space == RgbSpaceName::linAp1);
    CHECK(value(albedo("table 400 0.1 500 0.2 700 0.3")).numbers == std::vector<double>{400, 0.1, 500, 0.2, 700, 0.3});
    CHECK(value(albedo("table { - 400 0.1; - 700 0.3 }")).numbers == std::vector<double>{400, 0.1, 700, 0.3});
    CHECK(value(albedo("measured cornell-white")).text == "cornell-white");
    CHECK(value(emission("blackbody 3200 K")).numbers == std::vector<double>{3200});
    CHECK(value(emission("illuminant D65")).text == "D65");
    CHECK(value(emission("line 589.3 nm")).numbers.at(0) == doctest::Approx(589.3).epsilon(1e-12));
    CHECK(value(emission("line 589.3")).numbers.at(0) == doctest::Approx(589.3).epsilon(1e-12));
    CHECK(value(index("glass BK7")).text == "BK7");
    CHECK(value(index("metal Au")).form == Form::metal);
    CHECK(value(index("1.5")).numbers == std::vector<double>{1.5});
    CHECK(value(index("cauchy 1.5046 0.0042")).numbers == std::vector<double>{1.5046, 0.0042});
    CHECK(value(index("sellmeier 1 2 3 4 5 6")).numbers.size() == 6);
}

TEST_CASE("encoded sRGB is decoded") {
    const auto hex = value(albedo("srgb \"#d87040\""));
    CHECK(hex.form == Form::rgb);
    CHECK(hex.space == RgbSpaceName::linRec709);
    // By the published curve: 216/255, 112/255, 64/255.
    CHECK(hex.numbers.at(0) == doctest::Approx(0.686685).epsilon(1e-5));
    CHECK(hex.numbers.at(1) == doctest::Approx(0.162029).epsilon(1e-5));
    CHECK(hex.numbers.at(2) == doctest::Approx(0.0512695).epsilon(1e-5));
    CHECK(value(albedo("srgb \"#f80\"")).numbers.at(0) == 1);
    CHECK(value(albedo("srgb \"#f80\"")).numbers.at(2) == 0);
    CHECK(value(albedo("srgb 1 0.5 0")).numbers.at(1) == doctest::Approx(0.214041).epsilon(1e-5));
    CHECK(load("scene 1 rgb=acescg\nlight quad { radiance srgb 1 1 1 }")->resolver.values.at(0).space ==
          RgbSpaceName::linRec709);
    CHECK(albedo("srgb \"#d8704\"")->codes() == "E0315");
    CHECK(albedo("srgb 1.2 0 0")->codes() == "E0303");
    CHECK(albedo("rgb \"#d87040\"")->get("E0315").help == "write `srgb \"#d87040\"`");
    CHECK(albedo("\"#d87040\"")->get("E0202").label == "write `srgb \"#d87040\"`");
    CHECK(albedo("srgb 1 1 1 space=acescg")->codes() == "E0210");
}

TEST_CASE("values that a role forbids") {
    CHECK(albedo("1.2")->get("E0304").label == "is 1.2");
    CHECK(albedo("rgb 0.2 1.5 0.1")->get("E0304").label == "green is 1.5");
    CHECK(albedo("table 400 0.5 700 1.1")->get("E0304").label == "at 700 nm it is 1.1");
    CHECK(albedo("-0.1")->get("E0303").message == "`reflectance` cannot be negative");
    CHECK(emission("rgb 2 -1 0")->get("E0303").label == "green is -1");
    CHECK(value(emission("rgb 200 100 50")).numbers.at(0) == 200);
    CHECK(index("0")->get("E0303").message == "`ior` must be above 0");
    CHECK(index("rgb 1 1 1")->get("E0311").message == "`rgb` is not a refractive index");
    CHECK(albedo("blackbody 3200 K")->get("E0311").message == "`blackbody` cannot be the value of `reflectance`");
    CHECK(emission("glass BK7")->codes() == "E0311");
    CHECK(emission("blackbody 50 K")->get("E0303").message == "`blackbody` must be between 100 and 1000000 K");
    CHECK(emission("blackbody 3200 nm")->codes() == "E0302");
    CHECK(emission("line 900 nm")->get("E0303").message == "`line` must be between 360 and 830 nm");
    CHECK(emission("line 0.5893 um")->codes().empty());
    CHECK(albedo("#nan")->codes() == "E0305");
}

TEST_CASE("forms with mistakes") {
    CHECK(albedo("")->codes() == "E0306");
    CHECK(albedo("0.1 0.2 0.3")->get("E0306").fixes.at(0).replacement == "rgb ");
    CHECK(albedo("rgb 0.1 0.2")->get("E0306").label == "has 2");
    CHECK(albedo("rgbb 0.1 0.2 0.3")->get("E0311").label == "did you mean `rgb`?");
    CHECK(albedo("rgb 0.1 0.2 0.3 spce=acescg")->codes() == "E0210");
    CHECK(albedo("rgb 0.1 0.2 0.3 space=foo")->codes() == "E0315");
    CHECK(albedo("rgb 0.1 0.2 0.3 mm")->codes() == "E0302");
    CHECK(albedo("measured")->get("E0306").label == "a name is missing");
    CHECK(index("glass BK7 SF11")->codes() == "E0306");
    CHECK(index("BK7")->get("E0202").help == "write `glass BK7`");
    CHECK(emission("D65")->get("E0202").help == "write `illuminant D65`");
    CHECK(albedo("BK7")->get("E0202").help.starts_with("write a number or one of"));
    CHECK(index("cauchy 1.5")->codes() == "E0306");
    CHECK(index("cauchy 1 2 3 4 5")->codes() == "E0306");
    CHECK(index("sellmeier 1 2 3")->codes() == "E0306");
    CHECK(albedo("0.5 { }")->codes() == "E0214");
    CHECK(albedo("#true")->codes() == "E0314");
}

TEST_CASE("tables") {
    CHECK(albedo("table 400 0.1 500")->get("E0312").message == "a table needs pairs of wavelength and value");
    CHECK(albedo("table 400 0.1")->codes() == "E0312");
    CHECK(albedo("table 500 0.1 400 0.2")->get("E0312").message == "the wavelengths of a table must increase");
    CHECK(albedo("table 0.4 0.1 0.7 0.2")->get("E0312").label == "did you mean µm? wavelengths are in nm");
    CHECK(albedo("table 4000 0.1 7000 0.2")->get("E0312").help == "did you mean Å? wavelengths are in nm");
    CHECK(albedo("table -400 0.1 700 0.2")->codes() == "E0312");
    CHECK(albedo("table { - 400 0.1 3 }")->codes() == "E0312");
    CHECK(albedo("table")->codes() == "E0312");
}

TEST_CASE("tables from files") {
    const TemporaryFolder folder;
    folder.write("ok.spd", "# a comment\nwavelength, value\r\n400, 0.1\r\n500;0.2 # more\n\n700\t0.3\n");
    folder.write("percent.csv", "400 10\n500 90\n");
    folder.write("odd.spd", "400 0.1\n500 0.2 0.3\n");
    folder.write("words.spd", "400 0.1\nfive 0.2\n");
    folder.write("falling.spd", "400 0.1\n300 0.2\n");
    folder.write("above.spd", "400 0.1\n500 1.2\n");
    folder.write("empty.spd", "# nothing\n");
    folder.write("nan.spd", "400 nan\n500 0.1\n");
    const auto at = [&](const char* name) { return albedo(std::string("table \"") + name + "\"", folder.path()); };
    CHECK(value(at("ok.spd")).numbers == std::vector<double>{400, 0.1, 500, 0.2, 700, 0.3});
    CHECK(at("ok.spdd")->get("E0401").help == "`ok.spd` exists");
    CHECK(at("percent.csv")->get("E0312").message == "the values of `percent.csv` look like percent");
    CHECK(at("odd.spd")->get("E0402").notes.at(0) == "line 2 of odd.spd");
    CHECK(at("words.spd")->codes() == "E0402");
    CHECK(at("falling.spd")->get("E0312").notes.at(0) == "line 2 of falling.spd");
    CHECK(at("above.spd")->get("E0304").notes.at(0) == "line 2 of above.spd");
    CHECK(at("above.spd")->get("E0304").label == "at 500 nm it is 1.2");
    CHECK(at("empty.spd")->codes() == "E0402");
    CHECK(at("nan.spd")->codes() == "E0312");
    CHECK(value(loadBody("light quad { radiance table \"percent.csv\" }", folder.path())).numbers.at(3) == 90);
}

TEST_CASE("units of spectra") {
    CHECK(value(absorption("rgb 1 2 3 per-cm")).numbers == std::vector<double>{100, 200, 300});
    CHECK(value(absorption("2 per-mm")).numbers == std::vector<double>{2000});
    CHECK(value(absorption("table 400 1 700 2 per-cm")).numbers == std::vector<double>{400, 100, 700, 200});
    CHECK(value(absorption("2")).numbers == std::vector<double>{2});
    CHECK(absorption("2 mm")->codes() == "E0302");
}

TEST_CASE("named spectra") {
    const auto l = loadBody("spectrum paint rgb 0.8 0.2 0.1 space=acescg\n"
                            "material a diffuse { reflectance paint }\nshape sphere { material a }");
    CHECK(value(l).space == RgbSpaceName::linAp1);
    CHECK(value(albedo("flat\n}\nspectrum flat 0.5\ngroup {")).numbers == std::vector<double>{0.5});
    const auto twice =
        loadBody("spectrum paint rgb 1.8 0.2 0.1\nmaterial a diffuse { reflectance paint }\n"
                 "material b diffuse { reflectance paint }\nshape sphere { material a }\nshape plane { material b }");
    CHECK(twice->codes() == "E0304"); // wrong once, however often it is used
    CHECK(twice->text(twice->get("E0304").span) == "1.8");
    CHECK(albedo("paintt\n}\nspectrum paint 0.5\ngroup {")->get("E0202").label == "did you mean `paint`?");
    CHECK(loadBody("spectrum sun blackbody 5778 K\nmaterial a diffuse { reflectance sun }\nshape sphere { material a }")
              ->codes() == "E0311");
    CHECK(loadBody("spectrum sun blackbody 5778 K\nlight sky { power 1 W; color sun }")->codes().empty());
    CHECK(loadBody("spectrum s foo 3\nlight sky { power 1 W; color s }")->codes() == "E0311");
    CHECK(loadBody("spectrum rgb 1 2 3")->codes().starts_with("E0"));
    CHECK(loadBody("spectrum s table \"none.spd\"\nlight sky { power 1 W; color s }")->codes() == "E0401");
    CHECK(loadBody("spectrum 5")->codes() == "E0209");
}

TEST_CASE("metals") {
    const auto metal = [](const std::string& ior) {
        return loadBody("material m conductor { ior " + ior + " }\nshape sphere { material m }");
    };
    CHECK(metal("metal Au")->resolver.metals == std::vector<std::string>{"Au"});
    const auto parts = metal("{ n table 400 1.5 700 0.2; k 3.5 }");
    CHECK(parts->codes().empty());
    CHECK(parts->params["material m"].metal.n != nullptr);
    CHECK(parts->params["material m"].metal.k != nullptr);
    CHECK(metal("1.5")->codes() == "E0311");
    CHECK(metal("{ n 1.5 }")->get("E0207").label == "`k` is missing");
    CHECK(metal("{ n 1.5; k 2; k 3 }")->codes() == "E0208");
    CHECK(metal("{ n 1.5; k 2; j 3 }")->codes() == "E0201");
    CHECK(metal("{ n 0.05; k 4 }")->codes().empty()); // silver: no glass has such an index
    CHECK(metal("{ n -1; k 2 }")->codes() == "E0303");
}
