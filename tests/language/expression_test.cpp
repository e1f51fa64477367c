// Texts in the place of numbers: what they come to, and where they are wrong.
#include "language_fixture.h"
#include "schema/expression.h"

#include <cmath>
#include <doctest/doctest.h>
#include <fmt/format.h>

using namespace language_test;

namespace {

constexpr const char* kParameters = R"(param n 3
param r 2 cm
param two-words 5
param d "$r * $n" "of three"
param half "1/2"
param exposure "1/48" s
param frame 12
)";

std::unique_ptr<Loaded> ofSphere(const std::string& text) {
    return loadBody(std::string(kParameters) + "shape sphere { radius \"" + text + "\" }");
}

// In metres, or a fault.
double radius(const std::string& text) {
    const auto l = ofSphere(text);
    INFO(text, "\n", l->human());
    CHECK(!l->diagnostics.hasErrors());
    return l->params["shape"].radius;
}

// The one error of a text: its code, and what it points at.
std::string wrong(const std::string& text) {
    const auto l = ofSphere(text);
    INFO(text, "\n", l->human());
    CHECK(l->diagnostics.errorCount() == 1);
    for (const Diagnostic& d : l->diagnostics.all())
        if (d.severity == Severity::error) return d.code + " " + l->text(d.span);
    return "";
}

} // namespace

TEST_CASE("a text in the place of a number is computed") {
    struct Case {
        const char* text;
        double metres;
    };
    const Case cases[] = {
        {"2", 2},
        {"$r", 0.02},
        {"$r * 2", 0.04},
        {"$d", 0.06},
        {"2 * $r + 1 mm", 0.041},
        {"1 + 2 * 3", 7},
        {"(1 + 2) * 3", 9},
        {"8 / 2 / 2", 2},
        {"8 - 2 - 1", 5},
        {"-(-3)", 3},
        {"+3", 3},
        {"2 ^ 3", 8},
        {"2 ^ 3 ^ 0.5", std::pow(2, std::sqrt(3.))},
        {"2 ^ -1", 0.5},
        {"5 - 2 ^ 2", 1},
        {"$two-words - 4", 1},
        {"$two-words-4", 1},
        {"$n-1", 2},
        {"$half", 0.5},
        {"1/4 m", 0.25},
        {"1/4", 0.25},
        {"3 cm / 2 cm", 1.5},
        {"sqrt(3 cm * 3 cm + 4 cm * 4 cm)", 0.05},
        {"(2 cm) ^ 2 / 1 cm", 0.04},
        {"sqrt((2 cm)^2)", 0.02},
        {"1 / (4 per-m)", 0.25},
        {"min(3 cm, 2 cm, 4 cm)", 0.02},
        {"max(1, 5, 2)", 5},
        {"clamp(7, 1, 3)", 3},
        {"mix(1 cm, 3 cm, 0.25)", 0.015},
        {"floor(2.7) + ceil(2.2)", 5},
        {"abs(-2 cm)", 0.02},
        {"sin(30 deg)", 0.5},
        {"cos(pi / 3 * 1 rad)", 0.5},
        {"tan(0.125 turn)", 1},
        {"atan(1) / 1 deg", 45},
        {"acos(0.5) / 1 deg + asin(0.5) / 1 deg", 90},
        {"pi", kPiD},
        {"50 %", 0.5},
        {"1e2", 100},
        {" ( 2 ) ", 2},
        {"$frame / 24 * 2", 1},
    };
    for (const Case& c : cases) CHECK(radius(c.text) == doctest::Approx(c.metres));
}

TEST_CASE("a result without unit takes the one behind the text, or the property's own") {
    const auto radiusOf = [](const std::string& line, const std::string& header = "scene 1\n") {
        const auto l = load(header + "param n 3\nshape sphere { radius " + line + " }");
        INFO(l->human());
        CHECK(!l->diagnostics.hasErrors());
        return l->params["shape"].radius;
    };
    CHECK(radiusOf("\"$n * 2\" cm") == doctest::Approx(0.06));
    CHECK(radiusOf("\"$n * 2\"", "scene 1 length=mm\n") == doctest::Approx(0.006));
    CHECK(radiusOf("\"$n * 2 cm\"", "scene 1 length=mm\n") == doctest::Approx(0.06));
    const auto l = loadBody("shape sphere { radius \"2 cm\" m }");
    CHECK(l->get("E0302").message == "`radius` has its unit twice");
}

TEST_CASE("texts are computed in vectors, rows, spectra, transforms and integers") {
    const auto l = loadBody(R"(param x 1
camera { from "$x + 1" 0 "5 cm"; sensor "36 * $x" 24 mm; fov "$x * 40" deg; shutter "$x / 48" s }
render { samples "2 ^ 5"; noise "$x / 2" % }
shape mesh { points { - 0 0 0; - "$x" 0 0; - 0 "2 cm" 0 }; faces { - 0 1 "$x + 1" }; weights "0.5 * $x" 0 1 }
shape sphere { transform { rotate y "$x * 90" deg; translate "$x + 0.5" 0 0; scale "2 * $x" } }
material m diffuse { reflectance "$x / 2"; roughness "$x / 4" }
shape ball sphere { material m; radius 1 }
light sky { power "$x * 3 lm"; color blackbody "$x * 3200" K }
material c diffuse { reflectance rgb "$x / 2" 0 "0.1 * 2" }
shape big sphere { material c; radius 2 }
)");
    INFO(l->human());
    CHECK(!l->diagnostics.hasErrors());
    Params& camera = l->params["camera"];
    CHECK(camera.from == Vec3d{2, 0, 0.05});
    CHECK(camera.sensor.x == doctest::Approx(0.036));
    CHECK(camera.fov == doctest::Approx(40 * kPiD / 180));
    CHECK(camera.time.value() == doctest::Approx(1. / 48));
    CHECK(l->params["render"].samples == 32);
    CHECK(l->params["render"].radianceScale == doctest::Approx(0.005));
    Params& mesh = l->params["shape"];
    CHECK(l->params["material m"].roughness == 0.25);
    CHECK(l->params["light"].amount.dimension == Dimension::luminousFlux);
    CHECK(l->params["light"].amount.value == 3);
    CHECK(mesh.radius == 1);
    bool rgb = false, flat = false, kelvin = false;
    for (const SpectrumValue& v : l->resolver.values) {
        rgb = rgb || (v.form == SpectrumValue::Form::rgb && v.numbers == std::vector<double>{0.5, 0, 0.2});
        flat = flat || (v.form == SpectrumValue::Form::flat && v.numbers == std::vector<double>{0.5});
        kelvin = kelvin || (v.form == SpectrumValue::Form::blackbody && v.numbers == std::vector<double>{3200});
    }
    CHECK(rgb);
    CHECK(flat);
    CHECK(kelvin);
}

TEST_CASE("rows of meshes") {
    const auto l = loadBody(
        "param k 1\nshape mesh { points { - 0 0 0; - \"$k\" 0 0; - 0 \"2 cm\" 0 }; faces { - 0 1 \"$k + 1\" } }");
    INFO(l->human());
    Params& mesh = l->params["shape"];
    REQUIRE(mesh.points.size() == 3);
    CHECK(mesh.points[1].x == 1);
    CHECK(mesh.points[2].y == doctest::Approx(0.02));
    CHECK(mesh.faces.indices == std::vector<std::uint32_t>{0, 1, 2});
    CHECK(loadBody("shape mesh { points 0 0 0 1 0 0 0 1 0; faces { - 0 1 \"3 / 2\" } }")->get("E0309").label ==
          "is not a whole number");
}

TEST_CASE("texts that are no numbers stay texts") {
    const auto l = loadBody("param n 2\nfilm { output \"2 * $n.exr\" }\nshape \"2 * 3\" sphere { radius $n }");
    CHECK(!l->diagnostics.hasErrors());
    CHECK(l->params["film"].output.value == "2 * $n.exr");
    CHECK(l->params.contains("shape 2 * 3"));
    CHECK(loadBody("shape sphere { radius \"big\" }")->codes() == "E0314");
    const auto named = loadBody(
        "spectrum \"2 * 3\" rgb 1 0 0\nmaterial m diffuse { reflectance \"2 * 3\" }\nshape plane { material m }");
    CHECK(named->resolver.values.at(0).form == SpectrumValue::Form::rgb);
}

TEST_CASE("errors point into the text") {
    struct Case {
        const char *text, *fault;
    };
    const Case cases[] = {
        {"2 *", "E0316 "},
        {"2 * (3 + 1", "E0316 ("},
        {"2 + 3)", "E0316 )"},
        {"2 3", "E0316 3"},
        {"2 ** 3", "E0316 *"},
        {"2 + foo", "E0316 foo"},
        {"2 + n", "E0316 n"},
        {"3 cmm", "E0316 cmm"},
        {"3cm", "E0316 3cm"},
        {"2 > 1", "E0316 >"},
        {"sin", "E0314 \"sin\""},
        {"2 * sin", "E0316 sin"},
        {"sqrt(1, 2)", "E0316 sqrt(1, 2)"},
        {"min(1)", "E0316 min(1)"},
        {"2 cm^2", "E0316 2 cm"},
        {"$q * 2", "E0204 $q"},
        {"2 * $", "E0204 $"},
        {"2 m + 3 s", "E0317 + 3 s"},
        {"2 + 3 cm", "E0317 + 3 cm"},
        {"2 m * 3 m", "E0302 \"2 m * 3 m\""},
        {"2 s", "E0302 \"2 s\""},
        {"(2 cm) cm", "E0317 cm"},
        {"$r cm", "E0317 cm"},
        {"1 / 4 per-m", "E0302 \"1 / 4 per-m\""},
        {"sin(3)", "E0317 sin(3)"},
        {"asin(3 m)", "E0317 asin(3 m)"},
        {"floor(3 m)", "E0317 floor(3 m)"},
        {"sqrt(2 m)", "E0317 sqrt(2 m)"},
        {"2 ^ 1 m", "E0317 ^ 1 m"},
        {"(2 m) ^ 0.5", "E0317 ^ 0.5"},
        {"(2 m) ^ 9", "E0317 ^ 9"},
        {"1 / 0", "E0318 / 0"},
        {"1 / ($n - 3)", "E0318 / ($n - 3)"},
        {"sqrt(-1)", "E0318 sqrt(-1)"},
        {"acos(2)", "E0318 acos(2)"},
        {"clamp(1, 3, 2)", "E0318 clamp(1, 3, 2)"},
        {"1e300 * 1e300", "E0318 * 1e300"},
        {"(-1) ^ 0.5", "E0318 (-1) ^ 0.5"},
        {"0 ^ -1", "E0318 0 ^ -1"},
        {"1e400", "E0318 1e400"},
        {"-2 cm", "E0303 \"-2 cm\""},
    };
    for (const Case& c : cases) CHECK(wrong(c.text) == c.fault);
    CHECK(ofSphere("2 + foo")->get("E0316").help.starts_with("the functions are"));
    CHECK(ofSphere("2 + sinn(1 rad)")->get("E0316").label == "did you mean `sin`?");
    CHECK(ofSphere("$halv * 2")->get("E0204").label == "did you mean `$half`?");
    CHECK(ofSphere("2 + n")->get("E0316").label == "write `$n`");
    CHECK(ofSphere("3cm")->get("E0316").label == "write `3 cm`");
    CHECK(ofSphere("sin(3)")->get("E0317").help == "write the unit: `sin(… deg)` or `sin(… rad)`");
}

TEST_CASE("parameters of parameters") {
    const auto l = loadBody("param a \"$b + 1\"\nparam b \"$c * 2\"\nparam c 3\nshape sphere { radius \"$a\" }");
    CHECK(!l->diagnostics.hasErrors());
    CHECK(l->diagnostics.warningCount() == 0);
    CHECK(l->params["shape"].radius == 7);
    // The same by the word alone.
    CHECK(loadBody("param c 3\nparam a \"$c + 1\"\nshape sphere { radius $a }")->params["shape"].radius == 4);
    CHECK(loadBody("param c 3\nparam a \"$c + 1\"\nshape sphere { radius $a cm }")->params["shape"].radius ==
          doctest::Approx(0.04));
    const auto self = loadBody("param a \"$b\"\nparam b \"$a + 1\"\nshape sphere { radius $a }");
    CHECK(self->codes() == "E0225");
    CHECK(self->get("E0225").message.starts_with("parameter"));
    // A parameter that is wrong is wrong once, however often it is used.
    const auto wrong =
        loadBody("param a \"1 / 0\"\nshape x sphere { radius \"$a\" }\nshape y sphere { radius \"2 * $a\" }");
    CHECK(wrong->codes() == "E0318");
    CHECK(loadBody("param a 1 2 3\nshape sphere { radius \"$a\" }")->get("E0317").label == "has 3 values");
    CHECK(loadBody("param a glass\nshape sphere { radius \"$a\" }")->codes() == "E0317");
    CHECK(loadBody("param unused 1\nparam c 3\nshape sphere { radius \"$c\" }")->codes() == "W0205");
    // Given from outside.
    const auto given =
        load("scene 1\nparam c 3\nparam a \"$c + 1\"\nshape sphere { radius $a }", ".", {{"c=\"2 * 4\""}});
    INFO(given->human());
    CHECK(given->params["shape"].radius == 9);
}

TEST_CASE("expressions are bounded") {
    std::string deep(100, '('), chain = "scene 1\nparam p0 1\n", bomb = "scene 1\nparam p0 1\n";
    CHECK(wrong(deep + "1" + std::string(100, ')')).starts_with("E0316"));
    CHECK(wrong("1" + std::string(3000, ' ') + "+ 1").starts_with("E0316"));
    CHECK(wrong("1 + " + std::string(200, '-') + "1").starts_with("E0316"));
    for (int i = 1; i < 200; ++i) chain += fmt::format("param p{} \"$p{} + 1\"\n", i, i - 1);
    CHECK(load(chain + "shape sphere { radius $p199 }")->codes() == "E0225");
    // Every parameter twice the one before: 2^40 if each were computed anew, and 2^40 is the result.
    for (int i = 1; i <= 40; ++i) bomb += fmt::format("param p{0} \"$p{1} + $p{1}\"\n", i, i - 1);
    CHECK(load(bomb + "shape sphere { radius $p40 mm }")->params["shape"].radius ==
          doctest::Approx(std::pow(2., 40) * 1e-3));
}

TEST_CASE("no loops") {
    const auto points = [](const std::string& help) {
        for (const char* to : {"`instances`", "`scatter`", "Python package `abbe`"})
            CHECK_MESSAGE(help.find(to) != std::string::npos, help);
    };
    for (const std::string word : {"for", "foreach", "repeat", "loop", "if", "while"}) {
        INFO(word);
        const auto l = loadBody(word + " i 0 10 { shape sphere }");
        CHECK(l->codes() == "E0215");
        points(l->get("E0215").help);
        CHECK(loadBody("group { " + word + " 3 { shape sphere } }")->codes() == "E0215");
        const auto property = loadBody("shape sphere { " + word + " 3 }");
        CHECK(property->codes() == "E0201");
        points(property->get("E0201").help);
    }
}
