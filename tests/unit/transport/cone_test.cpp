// The width of paths beyond curved mirrors and lenses, against neighbouring rays traced in double precision.
#include "geometry/mesh.h"
#include "geometry/round_shapes.h"
#include "support/scene_test.h"
#include "transport/path_state.h"

#include <doctest/doctest.h>
#include <optional>

namespace abbe::test {
namespace {

struct Beam {
    Vec3d o, d;
};

// What a sphere about the origin does to a ray that meets it at its first point or, from inside, its last one.
enum class Turn { mirror, enter, leave };
Beam turned(const Beam& b, double radius, bool inside, Turn turn, double ior) {
    const double along = dot(b.o, b.d), root = std::sqrt(along * along - dot(b.o, b.o) + radius * radius);
    const Vec3d p = b.o + b.d * (-along + (inside ? root : -root));
    Vec3d n = normalize(p);
    if (inside) n = -n; // towards the ray
    const double c = -dot(b.d, n);
    if (turn == Turn::mirror) return {p, b.d + n * (2 * c)};
    const double eta = turn == Turn::enter ? 1 / ior : ior; // before over after
    return {p, b.d * eta + n * (eta * c - std::sqrt(1 - eta * eta * (1 - c * c)))};
}

// A cone about the ray from the origin of `ray`, as wide there as a point, and four rays on its rim.
constexpr double kSpread = 1e-4;
struct Bundle {
    std::array<Beam, 5> rays;
    RayCone cone{0, static_cast<float>(kSpread)};

    explicit Bundle(const Beam& middle) {
        const Vec3d x = normalize(cross(middle.d, Vec3d(0, 1, 0))), y = cross(x, middle.d);
        rays[0] = middle;
        for (std::size_t i = 0; i < 4; ++i) {
            const Vec3d side = (i < 2 ? x : y) * (i % 2 ? -kSpread : kSpread);
            rays[i + 1] = {middle.o, normalize(middle.d + side)};
        }
    }
    void meet(double radius, bool inside, Turn turn, double ior, float curvature) {
        const Vec3d from = rays[0].o, direction = rays[0].d;
        for (Beam& b : rays) b = turned(b, radius, inside, turn, ior);
        cone.advance(static_cast<float>(length(rays[0].o - from)));
        const auto cosine = static_cast<float>(std::abs(dot(direction, normalize(rays[0].o))));
        const float bulge = inside ? -curvature : curvature;
        if (turn == Turn::mirror)
            cone.reflect(bulge, cosine);
        else
            cone.refract(bulge, static_cast<float>(turn == Turn::enter ? ior : 1 / ior), cosine);
    }
    // The radius of the disk that is as large as the section across the ray.
    double radiusAfter(double distance) const {
        const Vec3d p = rays[0].o + rays[0].d * distance;
        std::array<Vec3d, 4> rim;
        for (std::size_t i = 0; i < 4; ++i) {
            const Beam& b = rays[i + 1];
            rim[i] = b.o + b.d * (dot(p - b.o, rays[0].d) / dot(b.d, rays[0].d));
        }
        return std::sqrt(0.25 * length(cross(rim[0] - rim[1], rim[2] - rim[3])));
    }
    double coneAfter(double distance) const {
        RayCone c = cone;
        c.advance(static_cast<float>(distance));
        return static_cast<double>(c.radius);
    }
};

} // namespace

TEST_CASE("cones: beyond convex and concave mirrors as wide as neighbouring rays show, within 10 %") {
    constexpr double radius = 0.5;
    const Sphere sphere({}, radius);
    const float curvature = sphere.meanCurvature({});
    CHECK(curvature == doctest::Approx(2));
    double worst = 0;
    for (const double sine : {0.0, 0.2, 0.5, 0.7}) { // at the point that is met
        for (const double distance : {0.1, 0.5, 3.0}) {
            Bundle convex({{sine * radius, 0, 2}, {0, 0, -1}});
            convex.meet(radius, false, Turn::mirror, 1, curvature);
            const double traced = convex.radiusAfter(distance), estimate = convex.coneAfter(distance);
            CHECK_MESSAGE(std::abs(estimate / traced - 1) < 0.1, "convex, sine ", sine, " distance ", distance);
            worst = std::max(worst, std::abs(estimate / traced - 1));
        }
        if (sine > 0.5) continue; // near its foci a concave mirror has sections that are lines
        Bundle concave({{sine * radius, 0, 0.1}, {0, 0, -1}});
        concave.meet(radius, true, Turn::mirror, 1, curvature);
        for (const double distance : {0.05, 3.0}) {
            const double traced = concave.radiusAfter(distance), estimate = concave.coneAfter(distance);
            CHECK_MESSAGE(std::abs(estimate / traced - 1) < 0.1, "concave, sine ", sine, " distance ", distance);
            worst = std::max(worst, std::abs(estimate / traced - 1));
        }
    }
    MESSAGE("largest error ", worst);
}

TEST_CASE("cones: through a ball of glass as wide as neighbouring rays show, within 10 %") {
    constexpr double radius = 0.5;
    const float curvature = Sphere({}, radius).meanCurvature({});
    for (const double ior : {1.2, 1.5})
        for (const double sine : {0.0, 0.2, 0.4}) {
            Bundle b({{sine * radius, 0, 4}, {0, 0, -1}});
            b.meet(radius, false, Turn::enter, ior, curvature);
            CHECK(b.coneAfter(0.3) == doctest::Approx(b.radiusAfter(0.3)).epsilon(0.1));
            b.meet(radius, true, Turn::leave, ior, curvature);
            CHECK(b.coneAfter(6) == doctest::Approx(b.radiusAfter(6)).epsilon(0.1));
        }
    // A flat face narrows the spread by the index, and the next one widens it again.
    RayCone flat{0.001f, 0.01f};
    flat.refract(0, 1.5f, 1);
    CHECK(flat.spread == doctest::Approx(0.01 / 1.5));
    flat.refract(0, 1 / 1.5f, 1);
    CHECK(flat.spread == doctest::Approx(0.01));
    CHECK(flat.radius == doctest::Approx(0.001));
}

TEST_CASE("the mean curvature of meshes is that of what their normals bend as") {
    // A saddle-like patch z = a x² + b y² has the mean curvature -(a + b) at its top, seen from above.
    constexpr double a = 0.3, b = -0.1, h = 0.01;
    MeshData data;
    for (const double y : {-h, h})
        for (const double x : {-h, h}) {
            data.positions.push_back(Vec3(Vec3d(x, y, a * x * x + b * y * y)));
            data.normals.push_back(Vec3(normalize(Vec3d(-2 * a * x, -2 * b * y, 1))));
        }
    MeshData triangles = data;
    data.quads = {{0, 1, 3, 2}};
    triangles.triangles = {{0, 1, 3}, {0, 3, 2}};
    for (const std::uint32_t primitive : {0u, 1u}) {
        SurfaceHit hit;
        hit.primitive = primitive;
        CHECK(Mesh(triangles).meanCurvature(hit) == doctest::Approx(-(a + b)).epsilon(1e-3));
    }
    CHECK(Mesh(data).meanCurvature({}) == doctest::Approx(-(a + b)).epsilon(1e-3));
    data.normals.clear();
    CHECK(Mesh(data).meanCurvature({}) == 0);
}

TEST_CASE("what a small ball mirrors is averaged over as much of it as a pixel sees") {
    // The wall behind the camera is a checker whose squares are far smaller than what a pixel sees of it in the ball,
    // and far larger than what it would see in a flat mirror.
    const auto scene = TestScene::parse(R"(
        scene 1
        film { size 8 8; filter box }
        camera { from 0 0 1; look-at 0 0 0; fov 0.4 deg }
        render { max-depth 2 }
        light sky { luminance 1 nits }
        shape sphere { radius 0.02; material conductor { index metal Ag } }
        shape quad { size 100 100; material diffuse { reflectance checker { even 0; odd 0.8; scale 1000 } }
                     transform { rotate x 180 deg; translate 0 0 10 } })");
    const TestImage image = render(scene, 8);
    double sum = 0, squares = 0;
    for (int y = 0; y < 8; ++y)
        for (int x = 0; x < 8; ++x) {
            const double value = image.film.mean(x, y).y;
            sum += value;
            squares += value * value;
        }
    const double mean = sum / 64, deviation = std::sqrt(std::max(0.0, squares / 64 - mean * mean));
    MESSAGE("deviation of pixels ", deviation / mean);
    CHECK(deviation < 0.15 * mean);
}

} // namespace abbe::test
