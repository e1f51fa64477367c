// Transforms: steps from top to bottom, units, and what cannot be a transform.
#include "language_fixture.h"

#include <doctest/doctest.h>

using namespace language_test;

namespace {

std::unique_ptr<Loaded> sphere(const std::string& steps, const std::string& header = "scene 1\n") {
    return load(header + "shape sphere { transform { " + steps + " } }");
}

Vec3d moved(const std::string& steps, Vec3d p, const std::string& header = "scene 1\n") {
    const auto l = sphere(steps, header);
    INFO(l->human());
    CHECK(l->codes().empty());
    return l->params["shape"].transform.point(p);
}

bool near(Vec3d a, Vec3d b) { return length(a - b) < 1e-12; }

} // namespace

TEST_CASE("steps apply from top to bottom") {
    CHECK(near(moved("scale 2; translate 1 0 0", {1, 0, 0}), {3, 0, 0}));
    CHECK(near(moved("translate 1 0 0; scale 2", {1, 0, 0}), {4, 0, 0}));
    CHECK(near(moved("rotate z 90 deg; translate 0 0 5", {1, 0, 0}), {0, 1, 5}));
    CHECK(near(moved("rotate z 90", {1, 0, 0}), {0, 1, 0}));
    CHECK(near(moved("rotate 0 0 2 0.25 turn", {1, 0, 0}), {0, 1, 0}));
    CHECK(near(moved("scale 1 2 3", {1, 1, 1}), {1, 2, 3}));
    CHECK(near(moved("translate 10 0 0 mm", {0, 0, 0}), {0.01, 0, 0}));
    CHECK(near(moved("translate 10 0 0", {0, 0, 0}, "scene 1 length=cm\n"), {0.1, 0, 0}));
}

TEST_CASE("matrix and look-at") {
    const std::string rows = "matrix 1 0 0 5  0 2 0 0  0 0 1 0  0 0 0 1";
    CHECK(near(moved(rows, {1, 1, 1}), {6, 2, 1}));
    CHECK(near(moved(rows, {0, 0, 0}, "scene 1 length=cm\n"), {0.05, 0, 0}));
    CHECK(near(moved("matrix { - 1 0 0 5; - 0 2 0 0; - 0 0 1 0; - 0 0 0 1 }", {1, 1, 1}), {6, 2, 1}));
    // The local +z, the side that quads face, looks at the target.
    CHECK(near(moved("look-at 0 0 5  0 0 0", {0, 0, 1}), {0, 0, 4}));
    CHECK(near(moved("look-at 0 0 5  0 0 0  1 0 0", {0, 1, 0}), {1, 0, 5}));
    CHECK(near(moved("look-at 0 0 500  0 0 0 cm", {0, 0, 0}), {0, 0, 5}));
    CHECK(near(moved("look-at 0 5 0  0 0 0", {0, 1, 0}, "scene 1 up=z\n"), {0, 5, 1}));
}

TEST_CASE("transforms with mistakes") {
    CHECK(sphere("scale 0")->codes() == "E0313");
    CHECK(sphere("scale 1 0 1")->get("E0313").message == "`scale` flattens the object");
    CHECK(sphere("matrix 1 0 0 0  2 0 0 0  0 0 1 0  0 0 0 1")->codes() == "E0313");
    CHECK(sphere("matrix 1 0 0 0  0 1 0 0  0 0 1 0  0 0 1 1")->codes() == "E0313");
    CHECK(sphere("matrix 1 0 0")->get("E0313").label == "has 3");
    CHECK(sphere("rotate 0 0 0 30 deg")->codes() == "E0313");
    CHECK(sphere("rotate w 30 deg")->codes() == "E0313");
    CHECK(sphere("rotate y 30 mm")->codes() == "E0302");
    CHECK(sphere("rotate y")->codes() == "E0306");
    CHECK(sphere("translate 1 2")->codes() == "E0306");
    CHECK(sphere("translate #inf 0 0")->codes() == "E0305");
    CHECK(sphere("scale 2 mm")->codes() == "E0302");
    CHECK(sphere("scale 1 2")->codes() == "E0306");
    CHECK(sphere("look-at 0 0 0  0 0 0")->codes() == "E0313");
    CHECK(sphere("look-at 0 5 0  0 0 0")->codes() == "E0313"); // along the up direction
    CHECK(sphere("rotat y 3 deg")->get("E0313").label == "did you mean `rotate`?");
    CHECK(sphere("scale 1e200")->codes() == "E0303");
    std::string steps = "scale 1e30";
    for (int i = 0; i < 11; ++i) steps += "; scale 1e30";
    CHECK(sphere(steps)->codes() == "E0313");
    CHECK(sphere("scale 2 { x }")->codes() == "E0214");
    CHECK(loadBody("shape sphere { transform scale 2 }")->codes() == "E0313");
}

TEST_CASE("an axis of any size") {
    CHECK(near(moved("rotate 0 0 1e-200 90 deg", {1, 0, 0}), {0, 1, 0}));
    CHECK(near(moved("rotate 0 0 1e30 90 deg", {1, 0, 0}), {0, 1, 0}));
}
