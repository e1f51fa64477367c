// What `abbe info` tells of the shapes of a scene.
#include "support/scene_test.h"

#include <cmath>
#include <doctest/doctest.h>

namespace abbe::test {
namespace {

using ShapeFact = SceneFacts::ShapeFact;

const ShapeFact& factOf(const TestScene& scene, std::string_view name) {
    for (const ShapeFact& fact : scene.built().facts.shapeList)
        if (fact.name == name) return fact;
    throw std::runtime_error("no such shape");
}

bool hasBounds(const ShapeFact& fact, Vec3d lower, Vec3d upper) {
    return length(fact.bounds.lower - lower) < 1e-5 && length(fact.bounds.upper - upper) < 1e-5;
}

} // namespace

TEST_CASE("shapes, lights and instances have their bounds in the world, parts of objects in the object") {
    const TestScene scene = TestScene::parse(R"(scene 1
camera { from 10 20 30; look-at 0 0 0 }
shape ball sphere { center 1 2 3; radius 0.5; transform { translate 0 1 0 } }
group { transform { scale 2 }
    shape slab box { min -1 0 -1; max 1 1 1 } }
shape ground plane
light lamp quad { size 2 4; luminance 100 nits; transform { rotate x 90 deg; translate 0 5 0 } }
object tree { shape trunk cylinder { radius 0.1; height 2 }; transform { scale 3 } }
instances tree { grid 1 1 1; transform { translate 7 0 0 } }
instance tree { transform { translate 0 0 -5 } }
)");
    scene.scene();
    REQUIRE(scene.built().facts.shapeList.size() == 7);
    CHECK(hasBounds(factOf(scene, "ball"), {0.5, 2.5, 2.5}, {1.5, 3.5, 3.5}));
    CHECK(factOf(scene, "ball").type == "sphere");
    CHECK(hasBounds(factOf(scene, "slab"), {-2, 0, -2}, {2, 2, 2}));
    CHECK_FALSE(isFinite(factOf(scene, "ground").bounds.upper));
    CHECK(hasBounds(factOf(scene, "lamp"), {-1, 5, -2}, {1, 5, 2}));
    CHECK(factOf(scene, "lamp").kind == "light");
    const ShapeFact& trunk = factOf(scene, "trunk");
    CHECK(trunk.inside == "tree");
    const Vec3d size = trunk.bounds.upper - trunk.bounds.lower;
    CHECK(size.x == doctest::Approx(0.6).epsilon(1e-4));
    CHECK(size.y == doctest::Approx(6).epsilon(1e-4));
    int placed = 0;
    for (const ShapeFact& fact : scene.built().facts.shapeList) {
        if (fact.name != "tree") continue;
        ++placed;
        CHECK(fact.places == 1);
        CHECK(fact.inside.empty());
        CHECK(fact.bounds.upper.x - fact.bounds.lower.x == doctest::Approx(0.6).epsilon(1e-4));
    }
    CHECK(placed == 2);
}

} // namespace abbe::test
