// A mirrored and unevenly scaled instance shows what the mesh with the transform in its vertices shows.
#include "support/scene_test.h"
#include "support/scene_test_compare.h"
#include "unit/io/temporary_folder.h"

#include <array>
#include <doctest/doctest.h>
#include <fmt/format.h>

namespace abbe::test {
namespace {

// An egg with bumps, whose normals lean away from those of its faces, and with texture coordinates: inside and outside,
// the sides of shading normals and the directions of tangents all show.
struct Egg {
    // Normals of files are made unit vectors, so that a blend in the file's space and one after the map differ by the
    // square of the angle between neighbours: fine enough for that not to show.
    static constexpr int around = 48, rings = 28;
    std::vector<Vec3d> positions, normals;

    Egg() {
        for (int j = 0; j <= rings; ++j)
            for (int i = 0; i <= around; ++i) {
                const double theta = kPiD * (0.02 + 0.96 * j / rings), phi = 2 * kPiD * i / around;
                const Vec3d n(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
                positions.push_back(n * (0.5 + 0.06 * std::sin(3 * phi) * std::sin(theta)));
                normals.push_back(normalize(n + Vec3d{0.15 * std::sin(5 * theta), 0, 0.1}));
            }
    }

    // With the map in its vertices.
    std::string obj(const Transform& map) const {
        std::string text;
        for (const Vec3d v : positions) {
            const Vec3d p = map.point(v);
            text += fmt::format("v {:.9g} {:.9g} {:.9g}\n", p.x, p.y, p.z);
        }
        for (int j = 0; j <= rings; ++j)
            for (int i = 0; i <= around; ++i)
                text += fmt::format("vt {:.9g} {:.9g}\n", 1.0 * i / around, 1 - 1.0 * j / rings);
        const auto inverse = map.inverse();
        for (const Vec3d n : normals) { // the transpose of the inverse, which keeps outside outside under mirrors
            const auto& a = inverse->a;
            text += fmt::format("vn {:.9g} {:.9g} {:.9g}\n", a[0][0] * n.x + a[1][0] * n.y + a[2][0] * n.z,
                                a[0][1] * n.x + a[1][1] * n.y + a[2][1] * n.z,
                                a[0][2] * n.x + a[1][2] * n.y + a[2][2] * n.z);
        }
        // The caps have texture coordinates of their own: where these lie on a line, tangents are anybody's.
        for (int i = 0; i < around; ++i)
            text += fmt::format("vt {:.9g} {:.9g}\n", std::cos(2 * kPiD * i / around), std::sin(2 * kPiD * i / around));
        const int caps = (rings + 1) * (around + 1), last = rings * (around + 1);
        const auto face = [&](std::array<int, 3> v, std::array<int, 3> uv) {
            if (map.determinant() < 0) {
                std::swap(v[1], v[2]);
                std::swap(uv[1], uv[2]);
            }
            text += fmt::format("f {0}/{1}/{0} {2}/{3}/{2} {4}/{5}/{4}\n", v[0], uv[0], v[1], uv[1], v[2], uv[2]);
        };
        for (int j = 0; j < rings; ++j)
            for (int i = 0; i < around; ++i) {
                const int a = 1 + j * (around + 1) + i, d = a + around + 1;
                face({a, a + 1, d + 1}, {a, a + 1, d + 1});
                face({a, d + 1, d}, {a, d + 1, d});
            }
        for (int i = 2; i < around; ++i) {
            face({1, i + 1, i}, {caps + 1, caps + i + 1, caps + i});
            face({last + 1, last + i, last + i + 1}, {caps + 1, caps + i, caps + i + 1});
        }
        return text;
    }
};

const std::string kRoom = R"(scene 1
film { size 32 32; filter box 0.5 }
render { max-depth 8 }
camera { from 0 0.3 4; look-at 0 0 0; fov 30 deg }
light sky { radiance 0.3 }
light quad { points -1.5 2 2  -1.5 2 1  -0.5 2 1  -0.5 2 2; radiance 12 }
shape floor quad { material diffuse { reflectance rgb 0.6 0.4 0.2 }; points -3 -1 3  3 -1 3  3 -1 -3  -3 -1 -3 }
shape wall quad { material diffuse { reflectance rgb 0.2 0.4 0.7 }; points 1.4 -1 2  1.4 -1 -3  1.4 3 -3  1.4 3 2 }
)";

struct Placed {
    std::string text; // of the language
    Transform map;
};
std::vector<Placed> mirrors() {
    const Transform uneven = Transform::scale({-1.3, 0.7, 0.9}).then(Transform::rotate({0, 0, 1}, kPiD / 6));
    const Transform odd = Transform::scale({-0.8, -1.2, -1})
                              .then(Transform::rotate({1, 0, 0}, 2 * kPiD / 9))
                              .then(Transform::translate({0.2, 0.1, 0}));
    return {{"scale -1.3 0.7 0.9; rotate z 30 deg", uneven},
            {"scale -0.8 -1.2 -1; rotate x 40 deg; translate 0.2 0.1 0", odd}};
}

TestImage imageOf(const std::string& body, std::uint64_t seed) {
    const auto scene = TestScene::parse(kRoom + body);
    REQUIRE(scene.report() == "");
    return render(scene, nightly() ? 4096 : 512, seed);
}

void checkBaked(const std::string& material) {
    const TemporaryFolder folder;
    for (const Placed& placed : mirrors()) {
        INFO(material, placed.text);
        REQUIRE(placed.map.determinant() < 0);
        const std::string plain = folder / "plain.obj", baked = folder / "baked.obj";
        writeAll(plain, Egg().obj({}));
        writeAll(baked, Egg().obj(placed.map));
        const std::string mesh = fmt::format("shape mesh {{ file \"{}\"; material {} ", plain, material);
        const auto expected = imageOf(fmt::format("shape mesh {{ file \"{}\"; material {} }}\n", baked, material), 1);
        const auto instance =
            imageOf("object egg { " + mesh + "} }\ninstance egg { transform { " + placed.text + " } }\n", 2);
        const auto shape = imageOf(mesh + "; transform { " + placed.text + " } }\n", 3);
        for (const Channel channel : {Channel::x, Channel::y, Channel::z}) {
            checkSame(compareImages(instance.film, expected.film, channel), 0.005);
            checkSame(compareImages(shape.film, expected.film, channel), 0.005);
        }
    }
}

} // namespace

TEST_CASE("mirrored instance equals baked mesh: rough absorbing glass") {
    checkBaked("dielectric { ior 1.5; roughness 0.4; absorption table 400 4  550 1  700 0.2 }");
}

TEST_CASE("mirrored instance equals baked mesh: brushed metal") {
    checkBaked("conductor { index metal Cu; roughness 0.4; anisotropy 0.8 }");
}

} // namespace abbe::test
