// Trees made by hand: names without an index, kinds, colour spaces.
#include "schema/scene_tree.h"

#include <doctest/doctest.h>

using namespace abbe::schema;

TEST_CASE("definitions are found by kind and name, nested ones too") {
    SceneTree tree;
    Definition group, inner, light;
    group.kind = Kind::group;
    group.name = "g";
    inner.kind = Kind::material;
    inner.name = "a";
    group.children.push_back(inner);
    light.kind = Kind::light;
    light.name = "a";
    tree.definitions = {group, light};
    CHECK(tree.find(Kind::material, "a") == &tree.definitions[0].children[0]);
    CHECK(tree.find(Kind::light, "a") == &tree.definitions[1]);
    CHECK(tree.find(Kind::shape, "a") == nullptr);
    CHECK(tree.find(Kind::material, "") == nullptr);

    tree.index.sorted = {tree.find(Kind::light, "a"), tree.find(Kind::material, "a")};
    CHECK(tree.find(Kind::material, "a") == &tree.definitions[0].children[0]);
    const SceneTree copy = tree; // a copy must not point into the original
    CHECK(copy.find(Kind::material, "a") == &copy.definitions[0].children[0]);
    const SceneTree moved = std::move(tree);
    CHECK(moved.find(Kind::light, "a") == &moved.definitions[1]);
}

TEST_CASE("kinds and their keywords") {
    for (int i = 0; i <= static_cast<int>(Kind::render); ++i)
        CHECK(findKind(keyword(static_cast<Kind>(i))) == static_cast<Kind>(i));
    CHECK(!findKind("bsdf"));
}

TEST_CASE("colour spaces by id and alias") {
    for (const RgbSpaceName space : {RgbSpaceName::linRec709, RgbSpaceName::linRec2020, RgbSpaceName::linP3D65,
                                     RgbSpaceName::linAp1, RgbSpaceName::linAp0})
        CHECK(findRgbSpace(rgbSpaceId(space)) == space);
    CHECK(findRgbSpace("srgb-linear") == RgbSpaceName::linRec709);
    CHECK(findRgbSpace("acescg") == RgbSpaceName::linAp1);
    CHECK(findRgbSpace("aces2065-1") == RgbSpaceName::linAp0);
    CHECK(findRgbSpace("p3") == RgbSpaceName::linP3D65);
    CHECK(!findRgbSpace("srgb"));
}

TEST_CASE("an empty document resolves to an empty tree with a warning") {
    abbe::Diagnostics diagnostics;
    const SceneTree tree = resolve(std::make_shared<Document>(), TypeTable{}, ".", diagnostics);
    CHECK(tree.definitions.empty());
    CHECK(diagnostics.all().size() == 1);
    CHECK(diagnostics.all()[0].code == "W0501");
}
