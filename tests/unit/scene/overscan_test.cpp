// What is rendered beyond the edges of the picture does not change what is inside of them.
#include "support/layered_film.h"

#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

std::string overscanScene(const std::string& film, const std::string& camera) {
    return "scene 1\nfilm { size 20 14; filter mitchell 2; layers { depth; motion; deep 4 }; " + film + " }\n" +
           camera +
           R"(
shape floor quad { points -9 0 -9  -9 0 9  9 0 9  9 0 -9; material diffuse { reflectance 0.6 } }
shape ball sphere { center 0 0.6 0; radius 0.6; material dielectric { ior glass BK7 } }
shape edge sphere { center 1.6 0.5 0; radius 0.5; material conductor { index metal Au; roughness 0.1 }
    transform { at 0 s { translate 0 0 0 }; at 1 s { translate 0.1 0 0 } } }
light lamp quad { points -1 3 -1  1 3 -1  1 3 1  -1 3 1; luminance 3000 nits }
light sky { luminance 100 nits }
)";
}

} // namespace

TEST_CASE("pixels inside the frame are the same bits with any overscan, and a crop in the overscan is a part of it") {
    for (const char* camera :
         {"camera { from 0 1 4; look-at 0 0.5 0; fov 40 deg; shutter 1 s; f-stop 1.4 }",
          "camera spherical { from 0 1 3; look-at 0 0.5 0; width 120 deg; height 80 deg; shutter 1 s }",
          "camera orthographic { from 0 1 4; look-at 0 0.5 0; width 4 m; shutter 1 s }",
          "camera lens-system { prescription singlet; lens 30 mm; f-stop 11; from 0 1 4; look-at 0 0.5 0 }"}) {
        INFO(camera);
        const LayeredFilm plain(overscanScene("", camera), 8, 5),
            wide(overscanScene("overscan 3 17 6 2", camera), 8, 5);
        const LayeredFilm corner(overscanScene("overscan 3 17 6 2; crop -3 -17 4 5", camera), 8, 5);
        CHECK(wide.film.bounds().x0 == -3);
        CHECK(wide.film.bounds().y1 == 16);
        const DeepImage deep = plain.deep(), wideDeep = wide.deep();
        const auto same = [](const LayeredFilm& a, const LayeredFilm& b, int x, int y) {
            const auto i = a.at(x, y), j = b.at(x, y);
            REQUIRE(a.picture.r[i] == b.picture.r[j]);
            REQUIRE(a.picture.g[i] == b.picture.g[j]);
            REQUIRE(a.picture.variance[i] == b.picture.variance[j]);
            for (const char* plane : {"depth.Z", "forward.u", "forward.v"})
                REQUIRE(a.plane(plane)[i] == b.plane(plane)[j]);
        };
        for (int y = 0; y < 14; ++y)
            for (int x = 0; x < 20; ++x) {
                same(plain, wide, x, y);
                REQUIRE(deep.counts[plain.at(x, y)] == wideDeep.counts[wide.at(x, y)]);
            }
        for (int y = -17; y < 5; ++y)
            for (int x = -3; x < 4; ++x) same(corner, wide, x, y);
    }
}

TEST_CASE("the overscan goes on with the picture: it is what a larger frame shows there") {
    // A frame of twice the width seen twice as wide has pixels of the same size: with 10 on each side, the same
    // picture.
    const double tan20 = std::tan(20 * kPiD / 180), wide = 2 * std::atan(2 * tan20) * 180 / kPiD;
    const auto text = [](const std::string& film, double fov) {
        return fmt::format("scene 1\nfilm {{ {}; filter box 0.5; layers {{ depth }} }}\n"
                           "camera {{ from 0 1 4; look-at 0 0.5 0; fov {} deg }}\n"
                           "shape floor quad {{ points -9 0 -9  -9 0 9  9 0 9  9 0 -9; material diffuse }}\n"
                           "shape ball sphere {{ center 1.5 0.6 0; radius 0.6; material diffuse }}\n"
                           "light sky {{ luminance 100 nits }}\n",
                           film, fov);
    };
    const LayeredFilm overscan(text("size 20 14; overscan 10 0 10 0", 40), 256);
    const LayeredFilm large(text("size 40 14", wide), 256);
    for (int y = 0; y < 14; ++y)
        for (int x = -10; x < 30; ++x) {
            const double a = overscan.plane("depth.Z")[overscan.at(x, y)],
                         b = large.plane("depth.Z")[large.at(x + 10, y)];
            REQUIRE(a == doctest::Approx(b).epsilon(0.05));
        }
}

} // namespace abbe::test
