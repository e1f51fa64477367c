// Light under the surface of closed meshes: none of it gets out but by the walk.
#include "support/scene_test.h"

#include <array>
#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

const std::string kFilm = "scene 1\nfilm { size 8 8; filter box 0.5 }\n";

std::string corners(Vec3d a, Vec3d b) {
    std::string text;
    for (const double z : {a.z, b.z})
        text += fmt::format("- {0} {1} {4}; - {2} {1} {4}; - {2} {3} {4}; - {0} {3} {4}; ", a.x, a.y, b.x, b.y, z);
    return text;
}

// Of the box whose corners begin with number `first`; outwards or inwards.
std::string sides(int first, bool outwards = true) {
    constexpr int kSides[6][4] = {{3, 2, 1, 0}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
    std::string text;
    for (const auto& s : kSides)
        text += outwards ? fmt::format("- {} {} {} {}; ", first + s[0], first + s[1], first + s[2], first + s[3])
                         : fmt::format("- {} {} {} {}; ", first + s[3], first + s[2], first + s[1], first + s[0]);
    return text;
}

std::string mesh(const std::string& points, const std::string& faces, const std::string& material) {
    return "shape mesh { points { " + points + "}\nfaces { " + faces + "}\nmaterial " + material + " }\n";
}

Estimate seen(const std::string& text, std::uint32_t samples) {
    INFO(text);
    const TestScene scene = TestScene::parse(text);
    const TestImage image = render(scene, samples);
    // A path that has leaked never comes back: the medium that it took along has no end.
    CHECK(image.statistics.cappedPaths == 0);
    CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
    return image.film.image();
}

const std::string kMaterials[] = {"subsurface { reflectance {}; mean-free-path {}; roughness 0; boundary diffuse }",
                                  "subsurface { reflectance {}; mean-free-path {}; roughness 0 }",
                                  "openpbr { subsurface-weight 1; subsurface-color {}; subsurface-radius {}; "
                                  "subsurface-radius-scale 1; specular-roughness 0 }"};

std::string filled(std::string material, const std::string& color, const std::string& path) {
    material.replace(material.find("{}"), 2, color);
    material.replace(material.find("{}"), 2, path);
    return material;
}

} // namespace

// Parts from thousandths of a mean free path to several.
TEST_CASE("subsurface: a white plate, block and needle in one mesh lose nothing") {
    const std::string points = corners({-0.9, -0.9, 0.3}, {0.9, 0.9, 0.3001}) +
                               corners({-0.6, -0.6, -0.4}, {0.1, 0.6, 0.2}) +
                               "- 0.2 0 0; - 0.9 0.003 0; - 0.9 -0.003 0.002; - 0.9 -0.003 -0.002 ";
    const std::string faces = sides(0) + sides(8) + "- 16 17 18; - 16 18 19; - 16 19 17; - 17 19 18 ";
    for (const std::string& material : kMaterials) {
        const Estimate mean =
            seen(kFilm + "camera { from 1.5 1 -4; look-at 0 0 0; fov 24 deg }\nlight sky { radiance 1 }\n" +
                     mesh(points, faces, filled(material, "1", "10 cm")),
                 nightly() ? 2048 : 128);
        MESSAGE(mean.mean, " ± ", std::sqrt(mean.variance));
        CHECK(std::abs(mean.mean - 1) < 0.003 + 4 * std::sqrt(mean.variance));
        CHECK(std::sqrt(mean.variance) < 0.003);
    }
}

// A light in a hollow cube that scatters nothing: walls of a hundred mean free paths let none of its light out.
TEST_CASE("subsurface: light goes through a wall by its inside alone") {
    const std::string points = corners({-1, -1, -1}, {1, 1, 1}) + corners({-0.9, -0.9, -0.9}, {0.9, 0.9, 0.9}),
                      faces = sides(0) + sides(8, false),
                      lit = kFilm + "camera { from 3 2 -4; look-at 0 0 0; fov 50 deg }\nlight sphere { radius 0.3; "
                                    "radiance 100 }\n";
    for (const std::string& material : kMaterials) {
        CHECK(seen(lit + mesh(points, faces, filled(material, "0", "1 mm")), 512).mean == 0);
        CHECK(seen(lit + mesh(points, faces, filled(material, "0", "10 cm")), 64).mean > 0.1);
    }
}

} // namespace abbe::test
