// Ray by ray: an instance has the hit points, normals and tangents of the mesh that has its transform in the vertices.
#include "scene_test_fixture.h"

#include <cmath>
#include <doctest/doctest.h>
#include <fmt/format.h>
#include <fstream>

namespace abbe::test {
namespace {

// Two triangles with texture coordinates and normals that lean far from those of the faces and from each other.
class LeaningObj {
  public:
    LeaningObj() : path_(std::filesystem::temp_directory_path() / "abbe_instance_frames_test.obj") {
        std::ofstream(path_) << "v -1 -1 0\nv 1 -1 0.1\nv 1 1 0\nv -1 1 0.3\n"
                                "vt 0 0\nvt 1 0.2\nvt 0.9 1\nvt 0 1\n"
                                "vn 0.5 0.1 1\nvn -0.3 0.4 1\nvn 0.2 0.6 1\nvn 0.1 -0.5 1\n"
                                "f 1/1/1 2/2/2 3/3/3\nf 1/1/1 3/3/3 4/4/4\n";
    }
    ~LeaningObj() { std::filesystem::remove(path_); }
    LeaningObj(const LeaningObj&) = delete;
    LeaningObj& operator=(const LeaningObj&) = delete;
    std::string shape(const std::string& transform) const {
        return fmt::format("shape mesh \"{}\" {{ {} }}\n", path_.string(), transform);
    }

  private:
    std::filesystem::path path_;
};

} // namespace

TEST_CASE("instances: normals and tangents are those of the transformed mesh, mirrors and uneven scales included") {
    const LeaningObj mesh;
    for (const char* steps : {"scale -1 1 1", "scale 0.4 -1.5 0.9; rotate z 30 deg", "scale 3 0.5 -1; rotate x 35 deg",
                              "scale -2 -0.5 -1; rotate y 20 deg", "scale 0.5 2 1"}) {
        INFO(std::string(steps));
        const std::string transform = fmt::format("transform {{ {} }}", steps);
        const auto baked = build(mesh.shape(transform));
        const auto placed = build("object o { " + mesh.shape("") + " }\ninstance o { " + transform + " }\n");
        const auto halves =
            build("object a { " + mesh.shape("") + " }\nobject b { instance a { " + transform + " } }\ninstance b");
        REQUIRE(baked.report() == "");
        int met = 0;
        for (int i = 0; i < 900; ++i) {
            const Vec3d to{-1.5 + 0.1 * (i % 30), -1.5 + 0.1 * static_cast<int>(i / 30), 0};
            const WorldHit a = trace(baked, {0.1, 0.2, 5}, to - Vec3d{0.1, 0.2, 5});
            if (!a.met) continue;
            for (const TestScene* scene : {&placed, &halves}) {
                const WorldHit b = trace(*scene, {0.1, 0.2, 5}, to - Vec3d{0.1, 0.2, 5});
                REQUIRE(b.met);
                if (a.hit.primitive != b.hit.primitive) continue; // on the edge between the two
                ++met;
                CHECK(near(a.p, b.p));
                CHECK(near(Vec3d(a.hit.ng), Vec3d(b.hit.ng)));
                CHECK(near(Vec3d(a.hit.shading.z), Vec3d(b.hit.shading.z)));
                CHECK(near(Vec3d(a.hit.shading.x), Vec3d(b.hit.shading.x)));
            }
        }
        CHECK(met > 200);
    }
}

} // namespace abbe::test
