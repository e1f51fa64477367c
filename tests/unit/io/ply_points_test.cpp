#include "io/ply_points.h"

#include <algorithm>
#include <cstring>
#include <doctest/doctest.h>
#include <fmt/format.h>

using namespace abbe;

namespace {

std::string pointsFailure(const std::string& bytes) {
    try {
        parsePlyPoints(bytes, "t");
    } catch (const IoError& e) {
        return e.what();
    }
    return "";
}

constexpr const char* kVertices = "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n";
constexpr const char* kBody = "0 0 0\n1 0 0\n2 0 0\n3 0 0\n";

std::string file(const std::string& elements, const std::string& body) {
    return "ply\nformat ascii 1.0\n" + elements + "end_header\n" + body;
}

} // namespace

TEST_CASE("ply points: positions, widths and normals") {
    const PointFile f = parsePlyPoints(
        file("element vertex 2\nproperty float x\nproperty uchar red\nproperty float y\nproperty float z\n"
             "property float width\nproperty float nx\nproperty float ny\nproperty float nz\n"
             "element other 1\nproperty list uchar int a\n",
             "1 7 2 3 0.5 0 0 1\n4 7 5 6 1 0 2 0\n2 8 9\n"),
        "t");
    REQUIRE(f.positions.size() == 2);
    CHECK(f.positions[1] == Vec3(4, 5, 6));
    CHECK(f.radii == std::vector<float>{0.25f, 0.5f});
    CHECK(f.normals[1] == Vec3(0, 2, 0));
    CHECK(f.strandSizes.empty());
}

TEST_CASE("ply points: strands by index and by count") {
    const PointFile byIndex = parsePlyPoints(
        file(std::string(kVertices) + "element strand 2\nproperty int colour\nproperty list uchar int vertex_indices\n",
             std::string(kBody) + "5 2 3 2\n6 3 0 1 2\n"),
        "t");
    CHECK(byIndex.strandSizes == std::vector<std::uint32_t>{2, 3});
    CHECK(byIndex.strandPoints == std::vector<std::uint32_t>{3, 2, 0, 1, 2});
    const PointFile byCount = parsePlyPoints(
        file(std::string(kVertices) + "element curve 2\nproperty uint count\n", std::string(kBody) + "1\n3\n"), "t");
    CHECK(byCount.strandSizes == std::vector<std::uint32_t>{1, 3});
    CHECK(byCount.strandPoints.empty());
    CHECK(byCount.radii.empty());
}

TEST_CASE("ply points: binary files of both byte orders") {
    for (const bool big : {false, true}) {
        std::string bytes = std::string("ply\nformat binary_") + (big ? "big" : "little") +
                            "_endian 1.0\nelement vertex 1\nproperty double x\nproperty float y\nproperty short z\n"
                            "property float radius\nend_header\n";
        const auto add = [&](auto value) {
            char c[sizeof(value)];
            std::memcpy(c, &value, sizeof(value));
            if (big) std::reverse(c, c + sizeof(value));
            bytes.append(c, sizeof(value));
        };
        add(1.5);
        add(-2.f);
        add(std::int16_t{-300});
        add(0.125f);
        const PointFile f = parsePlyPoints(bytes, "t");
        CHECK(f.positions.at(0) == Vec3(1.5f, -2, -300));
        CHECK(f.radii.at(0) == 0.125f);
        CHECK(pointsFailure(bytes.substr(0, bytes.size() - 1)).find("ends too early") != std::string::npos);
    }
}

TEST_CASE("ply points: damage is reported with its byte") {
    const std::string radius = std::string(kVertices) + "property float radius\n";
    const std::string list = std::string(kVertices) + "element curve 1\nproperty list uchar int vertex_indices\n";
    const std::string count = std::string(kVertices) + "element curve 1\nproperty int count\n";
    const std::string body = kBody;
    const std::pair<std::string, std::string> cases[] = {
        {file(radius, "0 0 0 1\n1 0 0 -2\n2 0 0 1\n3 0 0 1\n"), "`radius` of vertex 1 is negative"},
        {file(radius, "0 0 0 1\n1 0 0 nan\n2 0 0 1\n3 0 0 1\n"), "`radius` of vertex 1 is not finite"},
        {file(kVertices, "0 0 0\n1 inf 0\n2 0 0\n3 0 0\n"), "`y` of vertex 1 is not finite"},
        {file(kVertices, "0 0 0\n1 1e60 0\n2 0 0\n3 0 0\n"), "`y` of vertex 1 is not finite"},
        {file(kVertices, "0 0 0\n1 x 0\n2 0 0\n3 0 0\n"), "not a number"},
        {file(list, body + "2 1 4\n"), "vertex 4 of only 4"},
        {file(list, body + "2 1 -1\n"), "vertex -1"},
        {file(list, body + "200 1 1\n"), "more than the file holds"},
        {file(list, body + "2 1"), "ends too early"},
        {file(count, body + "5\n"), "a strand of 5 points out of 4"},
        {file(count, body + "3\n"), "the strands have 3 points, but there are 4"},
        {file(std::string(kVertices) + "element curve 1\nproperty int size\n", body + "4\n"), "neither a list"},
        {file("element face 0\nproperty int x\n", ""), "there are no vertices"},
    };
    for (const auto& [bytes, message] : cases) {
        CAPTURE(message);
        const std::string what = pointsFailure(bytes);
        CAPTURE(what);
        CHECK(what.find(message) != std::string::npos);
        CHECK(what.find("byte ") != std::string::npos);
    }
    CHECK(pointsFailure(cases[0].first).find(fmt::format("byte {}:", cases[0].first.find("-2"))) != std::string::npos);
}
