// Places, sizes and closed surfaces: cases 6 to 8 of docs/hard_cases.md.
#include "geometry/embree_scene_builder.h"
#include "geometry/mesh.h"
#include "geometry/round_shapes.h"
#include "hard_cases/hard_case.h"
#include "math/warp.h"
#include "support/ray_estimate.h"
#include "transport/surroundings.h"
#include "unit/geometry/test_meshes.h"

using namespace abbe;
using namespace abbe::test;

namespace {

std::string meshText(const MeshData& m, Vec3d offset, bool rounded) {
    std::string text = "points { ";
    for (const Vec3 p : m.positions) {
        Vec3d q = Vec3d(p) + offset;
        if (rounded) q = Vec3d(Vec3(q));
        text += fmt::format("- {:.9f} {:.9f} {:.9f}; ", q.x, q.y, q.z);
    }
    text += "}; faces { ";
    for (const auto& t : m.triangles) text += fmt::format("- {} {} {}; ", t[0], t[1], t[2]);
    return text + "}";
}

// What one path along a ray brings; it is too heavy for roulette to end.
double carried(const TestScene& scene, Vec3 origin, Vec3 direction) {
    static const LightSampler lights(scene.scene().lights);
    static const PathContext context{scene.scene(), lights, {}, true};
    static auto media = PathWalk<kLoopEffects.bits()>::makeMedia(scene.scene());
    static Sampler sampler;
    static Arena arena;
    PathCounters counters;
    sampler.startPixel(7, Technique::Numbers::random, true);
    sampler.start(0);
    CameraPath<kLoopEffects.bits()> path(context, sampler, arena, counters, media);
    const Vec3 eye = Vec3(Vec3d(origin) - scene.scene().origin);
    path.walk().startIn(surroundingsAt(scene.scene(), eye, 0));
    return mean(path.radiance({eye, direction}, Wavelengths::sample(0.3f), 1e9f));
}

} // namespace

// Three spheres of absorbing glass of index 1 inside one another: a ray through vertices of one of them leaves with the
// light that the chords let through; what believes to be still inside is black, what lost an inside is too bright.
TEST_CASE("case 6: two hits at a shared edge") {
    HardCase c;
    constexpr double sigma = 2;
    std::string text = "scene 1\ncamera { from 0 0 9; look-at 0 0 0 }\nlight sky { radiance 1 }\n";
    std::vector<MeshData> spheres;
    for (const double radius : {1.0, 0.7, 0.4}) {
        spheres.push_back(icosphere(2, {}, radius));
        text += fmt::format("shape mesh {{ {}; material dielectric {{ ior 1; absorption {} }} }}\n",
                            meshText(spheres.back(), {}, false), sigma);
    }
    const TestScene scene = TestScene::parse(text);
    REQUIRE(!scene.diagnostics().hasErrors());
    Random random(1);
    double worst = 0;
    int wrong = 0; // of those at vertices
    for (int i = 0; i < 6000; ++i) {
        const MeshData& m = spheres[static_cast<std::size_t>(i % 3)];
        const auto& face = m.triangles[random.bits() % m.triangles.size()];
        const bool atVertex = i % 2;
        const Vec3d corner(m.positions[face[0]]), next(m.positions[face[1]]);
        const Vec3d target = atVertex ? corner : corner + (next - corner) * random.uniformDouble();
        const Vec3d from =
            normalize(Vec3d(random.uniformDouble() - 0.5, random.uniformDouble() - 0.5, random.uniformDouble() - 0.5)) *
            3;
        // Priorities are equal, so the innermost absorbs: everywhere the same, along the chord of the outermost.
        const Vec3 direction(normalize(target - from));
        const double seen = carried(scene, Vec3(from), direction);
        // The chord by brute force in double.
        double in = 1e9, out = -1e9;
        for (const auto& t : spheres[0].triangles) {
            const Vec3d a(spheres[0].positions[t[0]]), e1 = Vec3d(spheres[0].positions[t[1]]) - a,
                                                       e2 = Vec3d(spheres[0].positions[t[2]]) - a, d(direction);
            const Vec3d p = cross(d, e2), s = Vec3d(Vec3(from)) - a, q = cross(s, e1);
            const double det = dot(e1, p), u = dot(s, p) / det, v = dot(d, q) / det, at = dot(e2, q) / det;
            if (std::abs(det) < 1e-12 || u < -1e-6 || v < -1e-6 || u + v > 1 + 1e-6) continue;
            in = std::min(in, at);
            out = std::max(out, at);
        }
        if (out - in < 0.3) continue; // at the outline the chord is a matter of rounding
        const double error = std::abs(seen - std::exp(-sigma * std::max(0.0, out - in)));
        if (atVertex)
            wrong += error > 1e-3;
        else
            worst = std::max(worst, error);
    }
    c.measured("largest error of the transmittance of 3000 rays at edges of nested spheres", worst, 1e-3);
    // Counting the hits, two of them where a ray meets an edge.
    const Mesh mesh(spheres[0]);
    EmbreeSceneBuilder builder;
    builder.addShape(mesh, {});
    const auto single = builder.build();
    int odd = 0;
    for (int i = 0; i < 100000; ++i) {
        const Vec3 from =
            normalize(Vec3(random.uniform() - 0.5f, random.uniform() - 0.5f, random.uniform() - 0.5f)) * 3.f;
        const Vec3 target = mesh.data().positions[random.bits() % mesh.data().positions.size()];
        Vec3 origin = from;
        const Vec3 d = normalize(target - from);
        SurfaceHit hit;
        int hits = 0;
        for (; hits < 9 && single->intersect({origin, d}, hit); ++hits) origin = spawnOrigin(hit, d);
        odd += hits % 2;
    }
    c.naive("share of rays that end inside by counting hits", odd / 1e5);
    c.measured("share of 3000 rays at their very vertices with another transmittance", wrong / 3e3, 0.02);
}

// A crinkled ball of millimetres, whole kilometres away from the origin of the scene.
TEST_CASE("case 7: details of mm at 1000 km") {
    HardCase c;
    MeshData ball = icosphere(3, {}, 0.2);
    Random random(3);
    for (Vec3& p : ball.positions) p = p * (1 + 0.02f * random.uniform());
    const auto render = [&](double far, bool rounded) {
        const TestScene scene = TestScene::parse(fmt::format(
            "scene 1\nfilm {{ size 32 32; filter box 0.5 }}\ncamera "
            "{{ from {0} {0} {1}; look-at {0} {0} {0}; fov 30 deg }}\n"
            "light sky {{ radiance 0.2 }}\nlight sun {{ toward -1 -2 -1; radiance 3e4 }}\nshape mesh {{ {2} }}\n",
            far, far + 1, meshText(ball, {far, far, far}, rounded)));
        REQUIRE_MESSAGE(!scene.diagnostics().hasErrors(), scene.report());
        return test::render(scene, 64);
    };
    const auto relMse = [](const TestImage& a, const TestImage& b) {
        double mean = 0, sum = 0;
        for (int i = 0; i < 1024; ++i) mean += b.film.mean(i % 32, i / 32).y / 1024;
        for (int i = 0; i < 1024; ++i) {
            const double x = a.film.mean(i % 32, i / 32).y, r = b.film.mean(i % 32, i / 32).y;
            sum += square(x - r) / (square(r) + 0.01 * square(mean)) / 1024;
        }
        return sum;
    };
    const TestImage here = render(0, false);
    c.measured("relMSE between the picture at the origin and at 1e6 m", relMse(render(1e6, false), here), 1e-4);
    c.naive("with vertices rounded to float in world space", relMse(render(1e6, true), here));
}

TEST_CASE("case 8: scenes of 1e-5 or 1e5 times the size") {
    HardCase c;
    int allEscaped = 0, naive = 0;
    std::vector<double> sums;
    for (double scale : {1e-5, 1.0, 1e5}) {
        const MeshData room =
            moved(cube({-2.78f, -2.74f, -2.8f}, {2.78f, 2.74f, 2.8f}), Transform::scale({scale, scale, scale}));
        const MeshData box = moved(cube({-1, -2.74f, -1}, {0.5f, -1, 0.5f}),
                                   Transform::rotate({0, 1, 0}, 0.3).then(Transform::scale({scale, scale, scale})));
        const Mesh roomMesh(room), boxMesh(box);
        const Sphere ball(Vec3d(1, -1, 1) * scale, 0.7 * scale);
        EmbreeSceneBuilder builder;
        for (const Shape* shape : std::initializer_list<const Shape*>{&roomMesh, &boxMesh, &ball})
            builder.addShape(*shape, {});
        const auto scene = builder.build();
        Random random(4);
        int escaped = 0;
        double sum = 0;
        // Light paths of ten segments bounce about: all stay inside, and all take the same way.
        for (int i = 0; i < 20000; ++i) {
            Vec3 origin = Vec3(Vec3d(0, 2, 0) * scale), d = squareToSphere({random.uniform(), random.uniform()});
            for (int bounce = 0; bounce < 10; ++bounce) {
                SurfaceHit hit;
                if (!scene->intersect({origin, d}, hit)) {
                    ++escaped;
                    break;
                }
                if (bounce < 3) sum += static_cast<double>(hit.distance) / scale;
                const Vec3 n = dot(hit.ng, d) < 0 ? hit.ng : -hit.ng;
                d = Frame::fromNormal(n).toWorld(squareToCosineHemisphere({random.uniform(), random.uniform()}));
                if (dot(d, n) <= 0) break;
                origin = spawnOrigin(hit, d);
                SurfaceHit lost;
                naive += scale < 1 && bounce == 0 && !scene->intersect({hit.p + n * 1e-4f, d}, lost);
            }
        }
        allEscaped += escaped;
        sums.push_back(sum);
    }
    c.measured("of 6e5 path segments in a closed room, those that get out", allEscaped, 0);
    c.naive("of 2e4 with an offset of 1e-4 m at 1e-5 of the size", naive);
    c.measured("largest relative difference of the lengths of paths",
               std::max(std::abs(sums[0] / sums[1] - 1), std::abs(sums[2] / sums[1] - 1)), 1e-4);
}

// Spectral densities, probabilities and offsets: the whole renderer, with light that grows with the area.
TEST_CASE("case 8: the picture of the same scene") {
    HardCase c;
    const auto picture = [](double s) {
        const TestScene scene = TestScene::parse(fmt::format(
            "scene 1\nfilm {{ size 16 16; filter box 0.5 }}\n"
            "camera {{ from 0 {0} {1}; look-at 0 {0} 0; fov 40 deg }}\n"
            "shape plane {{ material diffuse {{ reflectance 0.6 }} }}\n"
            "shape sphere {{ center 0 {0} 0; radius {0}; material dielectric {{ ior 1.5; roughness 0.3 }} }}\n"
            "light sphere {{ center {2} {2} {0}; radius {3}; radiance 10 }}\n"
            "light sky {{ radiance 0.1 }}\n",
            s, 6 * s, 2 * s, 0.2 * s));
        REQUIRE_MESSAGE(!scene.diagnostics().hasErrors(), scene.report());
        return render(scene, 64);
    };
    const TestImage one = picture(1);
    double worst = 0;
    for (const double s : {1e-5, 1e5}) {
        const TestImage other = picture(s);
        for (int i = 0; i < 256; ++i) {
            const Estimate a = one.film.pixel(i % 16, i / 16), b = other.film.pixel(i % 16, i / 16);
            worst =
                std::max(worst, std::abs(a.mean - b.mean) / std::sqrt(std::max(a.variance, 1e-12 * a.mean * a.mean)));
        }
    }
    c.measured("largest difference of a pixel from that of the scene of size 1, in standard errors", worst, 3);
}
