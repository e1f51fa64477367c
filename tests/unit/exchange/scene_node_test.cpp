#include "exchange/shared/scene_node.h"

#include <doctest/doctest.h>
#include <limits>
#include <list>
#include <string>
#include <utility>

using namespace abbe;
using namespace abbe::exchange;

namespace {

std::string printed(const SceneNode& node) { return printScene(std::span(&node, 1)); }

} // namespace

TEST_CASE("a short node stands on one line, a long one in a block") {
    SceneNode ball("shape");
    ball.name("ball").word("sphere");
    ball.child("radius").number(0.1).word("m");
    ball.child("material").name("blue glass");
    CHECK(printed(ball) == "shape ball sphere { radius 0.1 m; material \"blue glass\" }\n");

    SceneNode mesh("shape");
    mesh.name("floor").word("mesh").remark("From `a.xml`.");
    SceneNode& points = mesh.child("points");
    for (int i = 0; i < 12; ++i) points.child("-").vector({1.25 * i, 2, 3});
    CHECK(printed(mesh) == "// From `a.xml`.\n"
                           "shape floor mesh {\n"
                           "    points {\n"
                           "        - 0 2 3; - 1.25 2 3; - 2.5 2 3; - 3.75 2 3; - 5 2 3; - 6.25 2 3; - 7.5 2 3; - 8.75 "
                           "2 3; - 10 2 3; - 11.25 2 3\n"
                           "        - 12.5 2 3; - 13.75 2 3\n"
                           "    }\n"
                           "}\n");
}

TEST_CASE("a remark below keeps a node from being one line") {
    SceneNode camera("camera");
    camera.child("fov").number(40).word("deg").remark("across the width");
    CHECK(printed(camera) == "camera {\n    // across the width\n    fov 40 deg\n}\n");
}

TEST_CASE("numbers are the shortest that read back, texts keep every character or its escape") {
    CHECK(numberText(0.1) == "0.1");
    CHECK(numberText(-0.0) == "0");
    CHECK(numberText(1e300) == "1e+300");
    CHECK(numberText(std::numeric_limits<double>::min()) == "2.2250738585072014e-308"); // denormals: 0 after a render
    SceneNode node("output");
    node.text("a\"b\\c\n\x01é\u202e\x80");
    CHECK(printed(node) == "output \"a\\\"b\\\\c\\n\\u{1}é\\u{202e}\ufffd\"\n");
}

TEST_CASE("what is no word is quoted") {
    for (const char* word : {"a", "a-b", "_x", "Mesh.001", "n:m"}) CHECK(isPlainWord(word));
    for (const char* word : {"", "1a", "-a", "a b", "true", "é", "a\"b", "a,b", "$a", "#a"})
        CHECK_FALSE(isPlainWord(word));
}

TEST_CASE("a remark has one line for each of its own, without what comments may not hold") {
    SceneNode node("film");
    node.remark("one\ntwo\x02 \u202e!\n");
    CHECK(printed(node) == "// one\n// two !\nfilm\n");
}

TEST_CASE("nodes that are given away, printed before or not, print the same") {
    const auto some = [](bool settle) {
        std::list<SceneNode> nodes;
        nodes.emplace_back("scene").number(1);
        for (int i = 0; i < 3; ++i) {
            SceneNode& shape = nodes.emplace_back("shape").name("a").word("mesh");
            if (i == 1) shape.remark("the second");
            for (int k = 0; k < 40 * i; ++k) shape.child("points").vector({1, 2, 3});
            if (settle) shape.settle();
        }
        nodes.emplace_back("film");
        return nodes;
    };
    const std::string text = printScene(some(false));
    CHECK(text.find("\n\n// the second\nshape a mesh {\n    points 1 2 3\n") != std::string::npos);
    const std::list<SceneNode> kept = some(false), settled = some(true);
    CHECK(printScene(kept) == text);
    CHECK(printScene(settled) == text);
    std::list<SceneNode> given = some(true);
    CHECK(printScene(std::move(given)) == text);
    CHECK(printScene(std::list<SceneNode>()) == "");
}

TEST_CASE("nodes of one kind stand together") {
    std::list<SceneNode> nodes;
    nodes.emplace_back("scene").number(1);
    nodes.emplace_back("material").name("a").word("diffuse");
    nodes.emplace_back("material").name("b").word("diffuse");
    nodes.emplace_back("film");
    CHECK(printScene(nodes) == "scene 1\n\nmaterial a diffuse\nmaterial b diffuse\n\nfilm\n");
}
