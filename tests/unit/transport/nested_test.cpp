// Dielectrics inside one another: what fills the space decides, however the walls were modelled.
#include "materials/dielectric.h"
#include "support/tank.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {

TEST_CASE("a tank of water is as bright along its axis as the layers say, with overlapping and coincident walls") {
    const double expected = tankBrightness();
    // Overlapping by half the wall; by a hair; coincident; apart by less than light can tell (optical contact).
    for (const double half : {0.011, 0.01001, 0.01, 0.01 - 2e-8}) {
        CAPTURE(half);
        const RayEstimate e = seenAlong(tank(half), {0.001f, 0.0007f, 0.2f}, {0, 0, -1});
        CHECK(std::abs(e.mean - expected) < 4 * e.error + 1e-5);
    }
    // Apart by an air film, there is an air film.
    const RayEstimate apart = seenAlong(tank(0.00995), {0.001f, 0.0007f, 0.2f}, {0, 0, -1});
    CHECK(std::abs(apart.mean - filmedTankBrightness(0.0199)) < 4 * apart.error + 1e-5);
    CHECK(std::abs(expected - filmedTankBrightness(0.0199)) > 0.01);
}

TEST_CASE("overlapping and coincident walls agree at any angle, and with the eye in the water") {
    const TestScene overlapping = tank(0.011), coincident = tank(0.01);
    for (const auto& [origin, direction] : {std::pair{Vec3{0.05f, 0.02f, 0.2f}, Vec3{-0.21f, -0.06f, -1}},
                                            {Vec3{0.003f, 0.002f, 0.001f}, Vec3{0.3f, -0.5f, 1}},
                                            {Vec3{0.0f, 0.04f, 0.05f}, Vec3{0.02f, -0.8f, -1}}}) {
        const RayEstimate a = seenAlong(overlapping, origin, direction), b = seenAlong(coincident, origin, direction);
        CAPTURE(a.mean);
        CAPTURE(b.mean);
        CHECK(std::abs(a.mean - b.mean) < 4 * std::hypot(a.error, b.error) + 1e-5);
    }
}

TEST_CASE("the priority decides what fills the overlap") {
    // Water over glass: less glass, more water.
    const RayEstimate glass = seenAlong(tank(0.011, 2), {0.001f, 0.0007f, 0.2f}, {0, 0, -1});
    const RayEstimate water = seenAlong(tank(0.011, 0), {0.001f, 0.0007f, 0.2f}, {0, 0, -1});
    CHECK(water.mean < glass.mean * std::exp(-30 * 0.001));
}

TEST_CASE("the list of dielectrics: priorities, equals, strangers, and no room") {
    const auto glass = makeDielectric({}), ink = makeDielectric({});
    DielectricStack stack;
    CHECK(stack.top() == nullptr);
    stack.leave(glass.get());
    CHECK(stack.size() == 0);
    CHECK(stack.enter(glass.get()));
    CHECK(stack.enter(ink.get()));
    CHECK(stack.top() == ink.get()); // of equals, the one entered last
    CHECK(stack.enter(glass.get())); // twice in the same
    CHECK(stack.top() == glass.get());
    stack.leave(glass.get());
    CHECK(stack.top() == ink.get());
    stack.leave(ink.get());
    CHECK(stack.top() == glass.get());
    int entered = stack.size();
    while (stack.enter(ink.get())) ++entered;
    CHECK(entered == DielectricStack::kMax);
}

TEST_CASE("opaque surfaces in glass reflect as against glass") {
    const auto seen = [](const char* material) {
        return seenAlong(TestScene::parse(fmt::format(
                             R"(scene 1
camera {{ from 0 0 0.2; look-at 0 0 0 }}
light sky {{ radiance 1 }}
shape mesh {{ material dielectric {{ ior 1.5 }}; points {{ {} }}; faces {{ {} }} }}
shape mesh {{ material {}; points {{ {} }}; faces {{ {} }} }}
)",
                             corners(0.012), box(0.012, false, 0), material, corners(0.01), box(0.01, false, 0))),
                         {0.001f, 0.0007f, 0.2f}, {0, 0, -1});
    };
    const double outer = interfaceReflectance(1, 1.5);
    const auto expected = [&](double inner) {
        Stack stack;
        stack.add(outer, 1 - outer);
        stack.add(inner, 0);
        return stack.r;
    };
    const auto check = [](const RayEstimate& e, double value) { CHECK(std::abs(e.mean - value) < 4 * e.error + 1e-5); };
    check(seen("openpbr { base-weight 0; specular-ior 1.5; specular-roughness 0 }"), expected(0));
    check(seen("openpbr { base-weight 0; specular-ior 1.8; specular-roughness 0 }"),
          expected(interfaceReflectance(1.5, 1.8)));
    check(seen("conductor { index { n 1.5; k 0 } }"), expected(0));
    check(seen("conductor { index { n 0.3; k 3 } }"), expected((1.2 * 1.2 + 9) / (1.8 * 1.8 + 9)));
    check(
        seen("mix { amount 0.5; first conductor { index { n 1.5; k 0 } }; second conductor { index { n 1.5; k 0 } } }"),
        expected(0));
}

TEST_CASE("dielectrics that are apart ask for nothing") {
    const auto asks = [](const char* place, const char* material) {
        const TestScene scene = TestScene::parse(fmt::format(R"(scene 1
camera {{ from 0 0 9; look-at 0 0 0 }}
light sky {{ radiance 1 }}
shape sphere {{ material dielectric {{ ior 1.5 }} }}
shape sphere {{ center {} 0 0; material {} }}
)",
                                                             place, material));
        return scene.scene().effects.has(Effect::interfaces);
    };
    for (const char* material : {"dielectric { ior 1.33 }", "openpbr", "conductor { index metal Au }"}) {
        CAPTURE(material);
        CHECK(!asks("3", material));
        CHECK(asks("0.9", material));
    }
    CHECK(!asks("0.9", "diffuse"));
}

} // namespace abbe::test
