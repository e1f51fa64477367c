// Curves and points from text and files to what rays meet, and what is said about wrong ones.
#include "scene_test_fixture.h"

#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fstream>

namespace abbe::test {
namespace {

class TemporaryPly {
  public:
    explicit TemporaryPly(const std::string& text)
        : path_(std::filesystem::temp_directory_path() / "abbe_curves_points_test.ply") {
        std::ofstream(path_) << text;
    }
    ~TemporaryPly() { std::filesystem::remove(path_); }
    std::string path() const { return path_.string(); }

  private:
    std::filesystem::path path_;
};

const std::string kLine = "points { - 0 -2 0; - 0 -1 0; - 0 1 0; - 0 2 0 }; ";

} // namespace

TEST_CASE("curves: every basis and form is met, at the header's unit and through transforms") {
    for (const char* basis : {"linear", "bspline", "catmull-rom", "bezier"})
        for (const char* form : {"round", "flat"}) {
            INFO(fmt::format("{} {}", basis, form));
            const auto scene = build(fmt::format("shape curves {{ basis {}; form {}; radius 0.1; {}\n"
                                                 "  transform {{ scale -2; translate 1 0 0 }} }}",
                                                 basis, form, kLine));
            REQUIRE(scene.report() == "");
            const WorldHit hit = trace(scene, {1.15, 0, 3}, {0, 0, -1});
            REQUIRE(hit.met);
            const double depth = form == std::string("round") ? std::sqrt(0.2 * 0.2 - 0.15 * 0.15) : 0;
            CHECK(near(hit.p, {1.15, 0, depth}, 1e-4));
            CHECK_FALSE(trace(scene, {1.25, 0, 3}, {0, 0, -1}).met);
        }
}

TEST_CASE("curves: counts, radii and units") {
    const auto scene = TestScene::parse("scene 1 length=mm\ncamera { from 0 0 5 m; look-at 0 0 0 }\n" + kSky +
                                        "shape curves { basis linear; counts 2 2; radii 10 20 1 1 cm\n"
                                        "  points { - 0 0 0; - 0 1000 0; - 2000 0 0; - 2000 1000 0 } }");
    REQUIRE(scene.report() == "");
    CHECK(trace(scene, {0, 0.5, 5}, {0, 0, -1}).p.z == doctest::Approx(0.15).epsilon(0.01));
    CHECK(trace(scene, {2, 0.5, 5}, {0, 0, -1}).p.z == doctest::Approx(0.01).epsilon(0.01));
    CHECK(trace(scene, {2, 0.5, 5}, {0, 0, -1}).hit.primitive == 1);
    CHECK(scene.built().facts.strands == 2);
    CHECK(scene.built().facts.segments == 2);
    CHECK_FALSE(trace(scene, {1, 0.5, 5}, {0, 0, -1}).met);
}

TEST_CASE("curves and points: files") {
    const TemporaryPly ply("ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\n"
                           "property float z\nproperty float radius\nelement curve 2\n"
                           "property list uchar int vertex_indices\nend_header\n"
                           "0 0 0 10\n0 100 0 10\n50 0 0 20\n50 100 0 20\n100 50 0 30\n2 0 1\n2 2 3\n");
    const std::string head = "scene 1 length=cm\ncamera { from 0 0 5 m; look-at 0 0 0 }\n" + kSky;
    const auto curves = TestScene::parse(head + "shape curves \"" + ply.path() + "\" { basis linear }");
    REQUIRE(curves.report() == "");
    CHECK(trace(curves, {0, 0.5, 5}, {0, 0, -1}).p.z == doctest::Approx(0.1));
    CHECK(trace(curves, {0.5, 0.5, 5}, {0, 0, -1}).p.z == doctest::Approx(0.2));
    CHECK_FALSE(trace(curves, {1, 0.5, 5}, {0, 0, -1}).met);
    const auto points = TestScene::parse(head + "shape points \"" + ply.path() + "\"");
    REQUIRE(points.report() == "");
    CHECK(trace(points, {1, 0.5, 5}, {0, 0, -1}).p.z == doctest::Approx(0.3));
    CHECK(points.built().facts.points == 5);
    const auto thin = TestScene::parse(head + "shape points \"" + ply.path() + "\" { radius 1 mm; form disk }");
    REQUIRE(thin.report() == "");
    CHECK(trace(thin, {1.0005, 0.5, 5}, {0, 0, -1}).met);
    CHECK_FALSE(trace(thin, {1.002, 0.5, 5}, {0, 0, -1}).met);
}

TEST_CASE("points: disks across their normals") {
    const auto scene = build("shape points { form disk; radius 0.2; points 0 0 0  1 0 0; normals 0 0 7  1 0 0\n"
                             "  transform { rotate y 90 deg } }");
    REQUIRE(scene.report() == "");
    const WorldHit hit = trace(scene, {3, 0.1, 0}, {-1, 0, 0});
    REQUIRE(hit.met);
    CHECK(near(Vec3d(hit.hit.ng), {1, 0, 0}));
    CHECK(near(Vec3d(trace(scene, {0, 0.1, -3}, {0, 0, 1}).hit.ng), {0, 0, -1}));
}

TEST_CASE("curves and points: an instance may stretch what a transform may not") {
    const auto scene = build("object cloud { shape points { radius 0.1; points { - 0 0 0 } } }\n"
                             "instance cloud { transform { scale 1 1 3 } }");
    REQUIRE(scene.report() == "");
    CHECK(near(trace(scene, {0, 0, 3}, {0, 0, -1}).p, {0, 0, 0.3}, 1e-6));
    CHECK(codes(build("shape points { radius 0.1; points { - 0 0 0 }; transform { scale 1 1 3 } }")) == "E0622");
    CHECK(codes(build("shape curves { radius 0.1; " + kLine + "transform { scale 1 1 3 } }")) == "E0622");
}

TEST_CASE("curves and points: what is wrong is said where it is") {
    const std::pair<std::string, std::string> cases[] = {
        {"shape curves { radius 0.1; emission 1; " + kLine + "}", "E0623"},
        {"shape points { radius 0.1; emission 1; " + kLine + "}", "E0623"},
        {"shape curves { radius 0.1; points { - 0 0 0; - 1 0 0; - 1 1 0 } }", "E0621"},
        {"shape curves { radius 0.1; basis linear; points { - 0 0 0 } }", "E0621"},
        {"shape curves { radius 0.1; basis bezier; counts 6; points { - 0 0 0; - 1 0 0; - 1 1 0; - 0 0 1; - 0 0 2; - 0 "
         "0 "
         "3 } }",
         "E0621"},
        {"shape curves { radius 0.1; counts 5; " + kLine + "}", "E0621"},
        {"shape curves { radius 0.1; counts 3.5 0.5; " + kLine + "}", "E0303"},
        {"shape curves { radius 0.1; counts 2.5 1.5; " + kLine + "}", "E0621"},
        {"shape curves { radius 0.1; counts 4000000000 4; " + kLine + "}", "E0621"},
        {"shape curves { " + kLine + "}", "E0621"},
        {"shape curves { radii 1 2 3; " + kLine + "}", "E0621"},
        {"shape curves { radius -1; " + kLine + "}", "E0303"},
        {"shape curves { radii 1 1 -1 1; " + kLine + "}", "E0303"},
        {"shape curves { radius 0.1 }", "E0604"},
        {"shape curves { radius 0; " + kLine + "}", "E0604"},
        {"shape curves { radii 1 1 1 1; radius 1; " + kLine + "}", "E0310"},
        {"shape points { radius 0; points { - 0 0 0 } }", "E0604"},
        {"shape points { radius 0.1; normals { - 0 1 0 }; points { - 0 0 0 } }", "E0621"},
        {"shape points { radius 0.1; form disk; normals { - 0 1 0; - 0 1 0 }; points { - 0 0 0 } }", "E0621"},
        {"shape points { radius 0.1; form disk; normals { - 0 0 0 }; points { - 0 0 0 } }", "E0621"},
        {"shape points { radius 1e14; points { - 1e15 0 0 } }", "E0605"},
        {"shape points { radii 0.1 0; points { - 0 0 0; - 1 0 0 } }", "W0621"},
        {"shape curves { radii 1 1 1 1 0 0 0 0; counts 4 4; points { - 0 0 0; - 1 0 0; - 2 0 0; - 3 0 0; - 0 1 0; - 1 "
         "1 0; "
         "- 2 1 0; - 3 1 0 } }",
         "W0621"},
    };
    for (const auto& [text, code] : cases) {
        INFO(text);
        CHECK(codes(build(text)) == code);
    }
    const TemporaryPly ply("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                           "property float z\nend_header\n0 0 nan\n");
    CHECK(codes(build("shape points \"" + ply.path() + "\" { radius 0.1 }")) == "E0402");
}

} // namespace abbe::test
