// Where light paths are told to aim: the boxes of what focuses light, wherever it is placed.
#include "support/scene_test.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

// In world space.
std::vector<Bounds3> boxes(const std::string& text) {
    const TestScene test = TestScene::parse("scene 1\ncamera { from 1 2 9; look-at 1 2 0; shutter 1 s }\n"
                                            "light sky { radiance 1 }\nmaterial glass dielectric { ior 1.5 }\n" +
                                            text);
    REQUIRE_FALSE(test.diagnostics().hasErrors());
    std::vector<Bounds3> all;
    for (const FocusingShape& shape : test.scene().focusing) {
        const Vec3 origin(test.scene().origin);
        CHECK(shape.name.starts_with("ball"));
        all.push_back({shape.box.lower + origin, shape.box.upper + origin});
    }
    return all;
}

void isBox(const Bounds3& box, Vec3 lower, Vec3 upper) {
    for (int axis = 0; axis < 3; ++axis) {
        CHECK(box.lower[axis] == doctest::Approx(lower[axis]).epsilon(1e-4));
        CHECK(box.upper[axis] == doctest::Approx(upper[axis]).epsilon(1e-4));
    }
}

const std::string kBall = "object bead { shape ball sphere { radius 0.5; material glass }\n"
                          "    shape paper sphere { radius 9; material diffuse } }\n";

} // namespace

TEST_CASE("focusing shapes: in an instance, where that stands; no object that nobody placed") {
    CHECK(boxes(kBall).empty());
    const auto found = boxes(kBall + "instance bead { transform { scale 2; translate 10 0 0 } }\n"
                                     "instance bead { transform { translate 0 -5 0 } }\n"
                                     "shape ball-2 sphere { center 3 3 3; radius 1; material glass }\n");
    REQUIRE(found.size() == 3);
    isBox(found[0], {9, -1, -1}, {11, 1, 1});
    isBox(found[1], {-0.5f, -5.5f, -0.5f}, {0.5f, -4.5f, 0.5f});
    isBox(found[2], {2, 2, 2}, {4, 4, 4});
}

TEST_CASE("focusing shapes: in objects within objects") {
    const auto found = boxes(kBall + "object pair { instance bead { transform { translate -1 0 0 } }\n"
                                     "    instance bead { transform { translate 1 0 0 } } }\n"
                                     "instance pair { transform { scale 2; translate 0 20 0 } }\n");
    REQUIRE(found.size() == 2);
    isBox(found[0], {-3, 19, -1}, {-1, 21, 1});
    isBox(found[1], {1, 19, -1}, {3, 21, 1});
}

TEST_CASE("focusing shapes: the whole way of what moves") {
    const std::string keys = "transform { at 0 s { translate 0 0 0 }; at 1 s { translate 8 0 0 } }";
    for (const std::string& text : {kBall + "instance bead { " + keys + " }\n",
                                    "group { " + keys + "\n shape ball sphere { radius 0.5; material glass } }\n",
                                    "shape ball sphere { radius 0.5; material glass; " + keys + " }\n"}) {
        CAPTURE(text);
        const auto found = boxes(text);
        REQUIRE(found.size() == 1);
        isBox(found[0], {-0.5f, -0.5f, -0.5f}, {8.5f, 0.5f, 0.5f});
    }
}

TEST_CASE("focusing shapes: of very many places there is one box") {
    CHECK(boxes(kBall + "instances bead { grid 16 16 16; spacing 2 2 2 }\n").size() == 4096);
    const auto found = boxes(kBall + "instances bead { grid 17 16 16; spacing 2 2 2 }\n");
    REQUIRE(found.size() == 1);
    CHECK(found[0].diagonal().x == doctest::Approx(33));
    CHECK(found[0].diagonal().y == doctest::Approx(31));
}

} // namespace abbe::test
