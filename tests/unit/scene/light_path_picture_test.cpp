// Pictures that light paths are part of: their layers, their single samples, and what is said of them.
#include "film/layer_planes.h"
#include "rendering/path_tracer.h"
#include "support/caustics_of.h"
#include "support/scene_test.h"

#include <atomic>
#include <doctest/doctest.h>
#include <initializer_list>
#include <memory>
#include <numeric>
#include <utility>

namespace abbe::test {
namespace {

constexpr int kPictureWidth = 24, kPictureHeight = 16;

std::string lightPathScene(const std::string& render, const std::string& more = "") {
    return "scene 1\nfilm { size 24 16; output \"x.exr\" space=acescg; "
           "layers { components; light-group lamp; light-group fill } }\nrender { samples 64; " +
           render + R"( }
camera { from 0 2 4; look-at 0 0.3 0; fov 45 deg }
shape floor quad { points -3 0 -3  -3 0 3  3 0 3  3 0 -3; material diffuse { reflectance 0.7 } }
shape ball sphere { center 0 0.7 0; radius 0.6; material dielectric { ior glass BK7 } }
light lamp sphere { center 1 3 0.5; radius 3 cm; power 800 lm }
light fill sky { luminance 2 nits }
)" + more;
}

struct Picture {
    TestScene scene;
    PixelFilm film;
    RenderStatistics statistics;
    ResolvedImage picture;
    LayerPlanes layers;

    explicit Picture(const std::string& text) : scene(TestScene::parse(text)), film(makeFilm(scene)) {
        const RenderSettings settings = scene.settings();
        const auto tracer = makePathTracer(scene.scene().effects);
        film.keepSplatsOf(*tracer, scene.scene(), settings);
        statistics = tracer->render(scene.scene(), film, settings, {});
        const double exposure = scene.built().exposure;
        picture = film.resolve(rgb::ap1.fromXyz(), exposure);
        layers = layerPlanes(film, picture, {&rgb::ap1, rgb::ap1.fromXyz(), exposure, scene.scene().origin});
    }
    static PixelFilm makeFilm(const TestScene& scene) {
        const FilmSettings s = filmSettings(scene.built().film);
        PixelFilm film(s.crop, PixelFilter(s.filter, s.filterRadius), 2);
        film.keepLayers(scene.built().layers, scene.scene().names, rgb::ap1);
        return film;
    }
    const std::vector<float>& plane(const std::string& name) const {
        for (const NamedPlane& p : layers.planes)
            if (p.name == name) return p.values;
        FAIL(name);
        return layers.planes[0].values;
    }
    double mean(const std::string& name) const {
        double sum = 0;
        for (const float x : plane(name)) sum += static_cast<double>(x);
        return sum / (kPictureWidth * kPictureHeight);
    }
};

// Every fourth hit is made one of a silhouette, where the cosine of the arriving ray is 0 and not nearly so.
class SilhouetteIntersector final : public Intersector {
  public:
    explicit SilhouetteIntersector(std::unique_ptr<const Intersector> sound) : sound_(std::move(sound)) {}
    bool intersect(const Ray& ray, SurfaceHit& hit) const noexcept override {
        if (!sound_->intersect(ray, hit)) return false;
        const Vec3 d = ray.direction, n = normalize(Vec3{d.y, -d.x, 0});
        if (++hits_ % 4 != 0 || dot(d, n) != 0) return true;
        hit.ng = n;
        hit.shading = Frame::fromNormal(n);
        ++silhouettes;
        return true;
    }
    bool occluded(const Ray& ray) const noexcept override { return sound_->occluded(ray); }
    bool occluded(Vec3 from, Vec3 to, float time, RayKind kind) const noexcept override {
        return sound_->occluded(from, to, time, kind);
    }
    Bounds3 bounds() const override { return sound_->bounds(); }
    std::uint64_t rejectedRays() const override { return sound_->rejectedRays(); }

    mutable std::atomic<std::uint64_t> silhouettes{0};

  private:
    std::unique_ptr<const Intersector> sound_;
    mutable std::atomic<std::uint64_t> hits_{0};
};

LightPathFindings findingsOf(const TestScene& scene) {
    return causticsOf(scene, scene.settings()).of<LightPathFindings>();
}

LightPathFindings findingsOf(const std::string& text) { return findingsOf(TestScene::parse(text)); }

} // namespace

TEST_CASE("light paths: what is met along its surface brings nothing, and no sample is lost for it") {
    TestScene scene =
        TestScene::parse(lightPathScene("light-paths alone", "shape pole cylinder { radius 0.1; height 2 }\n"));
    auto owned = std::make_unique<SilhouetteIntersector>(std::move(scene.changeable().intersector));
    const SilhouetteIntersector& world = *owned;
    scene.changeable().intersector = std::move(owned);
    const TestImage image = renderAsProgram(scene, scene.settings(), 2);
    CHECK(world.silhouettes > 1000);
    CHECK(image.statistics.splats > 1000);
    CHECK(std::accumulate(image.statistics.dropped.begin(), image.statistics.dropped.end(), std::uint64_t{0}) == 0);
}

TEST_CASE("light paths: components and light groups add up to the picture with all light of the splats") {
    for (const char* choice : {"always", "alone"}) {
        const Picture image(lightPathScene(std::string("light-paths ") + choice));
        REQUIRE(image.statistics.splats > 1000);
        const auto sum = [&](std::initializer_list<const char*> names, std::size_t i) {
            float total = 0;
            for (const char* name : names) total += image.plane(std::string(name) + ".G")[i];
            return total;
        };
        std::size_t splatted = 0;
        for (std::size_t i = 0; i < image.picture.g.size(); ++i) {
            CHECK(sum({"direct", "indirect", "caustic"}, i) == image.picture.g[i]);
            CHECK(sum({"group_lamp", "group_fill"}, i) == image.picture.g[i]);
            const int x = static_cast<int>(i) % kPictureWidth, y = static_cast<int>(i) / kPictureWidth;
            splatted += image.film.splatMean(SplatKind::lightPath, x, y, 0, 2).y > 0;
        }
        CHECK(splatted > image.picture.g.size() / 3);
        CHECK(image.mean("caustic.G") > 0.01 * image.mean("group_lamp.G"));
    }
}

TEST_CASE("light paths: a sample taken again is what camera paths bring, and together they are the picture's") {
    const Picture image(lightPathScene("light-paths always"));
    const auto tracer = makePathTracer(image.scene.scene().effects);
    for (const Vec2i at : {Vec2i{12, 8}, Vec2i{3, 12}}) {
        PixelFilm film = Picture::makeFilm(image.scene);
        film.keepSplatsOf(*tracer, image.scene.scene(), image.scene.settings());
        std::vector<SampleId> samples;
        for (std::uint32_t i = 0; i < 32; ++i) samples.push_back({at.x, at.y, 0, i});
        tracer->repeat(image.scene.scene(), film, image.scene.settings(), samples);
        CHECK(film.lightPaths() == 0);
        for (int r = 0; r < 2; ++r) {
            CHECK(film.samples(at.x, at.y, r, r + 1) == 32);
            CHECK(film.mean(at.x, at.y, r, r + 1).y == image.film.sampleMean(at.x, at.y, r, r + 1).y);
        }
    }
}

TEST_CASE("light paths: where nobody sees any light one for each camera path is the guess") {
    // The light and its glass are behind the camera, which looks into the dark.
    const LightPathFindings found = findingsOf(R"(scene 1
camera { from 0 0 0; look-at 0 0 -1 }
film { size 16 12 }
shape wall quad { points { - -1 -1 -3; - 1 -1 -3; - 1 1 -3; - -1 1 -3 }; material diffuse { reflectance 0 } }
shape ball sphere { center 0 0 5; radius 0.5; material dielectric { ior 1.5 } }
light lamp sphere { center 0 3 8; radius 0.1; radiance 1 }
)");
    CHECK(found.verdict == LightPathVerdict::used);
    CHECK(found.share == 1);
}

TEST_CASE("light paths: findings name lights and targets, are those of the render, and say why there are none") {
    using enum LightPathVerdict;
    const std::string text = lightPathScene("");
    const Picture image(text);
    const auto& found = image.statistics.caustics.of<LightPathFindings>();
    CHECK(found.verdict == used);
    CHECK(found.gain > 1.15);
    CHECK(found.lights == 2);
    CHECK(found.targets == 1);
    REQUIRE(found.shares.size() >= 2);
    double all = 0, before = 0, after = 0;
    bool aimed = false;
    for (const LightPathShare& s : found.shares) {
        all += s.share;
        before += s.before;
        after += s.after;
        aimed |= s.light == "lamp" && s.target == "ball" && s.share > 0.02 && s.before > 0.5 * found.before;
    }
    CHECK(all == doctest::Approx(1));
    CHECK(before >= found.before); // second moments, and variances
    CHECK(after >= found.after);
    CHECK(after < before);
    CHECK(aimed);
    const LightPathFindings alone = findingsOf(text);
    CHECK(alone.verdict == found.verdict);
    CHECK(alone.gain == found.gain);
    CHECK(alone.rays == found.rays);
    REQUIRE(alone.shares.size() == found.shares.size());
    for (std::size_t i = 0; i < alone.shares.size(); ++i) CHECK(alone.shares[i].share == found.shares[i].share);

    CHECK(findingsOf(lightPathScene("light-paths off")).verdict == off);
    CHECK(findingsOf(lightPathScene("light-paths always")).verdict == requested);
    CHECK(findingsOf(lightPathScene("strategy lights")).verdict == otherTechnique);
    std::string plain = text;
    plain.replace(plain.find("dielectric { ior glass BK7 }"), 28, "diffuse { reflectance 0.5 }");
    CHECK(findingsOf(plain).verdict == nothingFocuses);
    std::string wide = text;
    wide.replace(wide.find("radius 3 cm"), 11, "radius 160 cm");
    const LightPathFindings needless = findingsOf(wide);
    CHECK(needless.share == 0);
    CHECK(needless.measured);
    CHECK((needless.verdict == noGain || needless.verdict == nothingFound));
    TestScene dark = TestScene::parse(text);
    dark.changeable().lights.clear();
    CHECK(findingsOf(dark).verdict == noLights);
}

// A small light and a ball of glass, in whose rim the caustic is mirrored: nothing but the pilots differs. Of the
// smallest, camera paths that met the caustic in the rim used to be all of the noise or none of it, by luck.
TEST_CASE("light paths: the plan jumps neither with the seed nor with the size of pilots") {
    const TestScene scene = TestScene::parse(
        "scene 1\nfilm { size 96 96; filter box 0.5 }\ncamera { from 0.6 3 4; look-at 0.3 0.2 0; fov 34 deg }\n"
        "shape quad { points -3 0 3  3 0 3  3 0 -3  -3 0 -3; material diffuse { reflectance 0.6 } }\n"
        "shape sphere { center 0 0.6 0; radius 0.5; material dielectric { ior 1.5 } }\n"
        "light sphere { center -1.6 2.6 0; radius 0.05; radiance 400 }\n");
    for (const int size : {1, 2, 4}) {
        CAPTURE(size);
        double least = 100, most = 0;
        for (std::uint64_t seed = 1; seed <= 8; ++seed) {
            RenderSettings settings = scene.settings();
            settings.seed = seed;
            settings.pilot = size;
            const CausticFindings all = causticsOf(scene, settings);
            const auto& found = all.of<LightPathFindings>();
            CAPTURE(seed);
            CHECK(found.gain > 100);
            CHECK(all.of<MergeFindings>().used);
            least = std::min(least, found.share);
            most = std::max(most, found.share);
            double elsewhere = 0; // paths that are not aimed at the ball
            for (const LightPathShare& s : found.shares)
                if (s.target.empty()) elsewhere += s.share;
            CHECK(elsewhere < 0.25);
        }
        MESSAGE("pilots of size " << size << ": " << least << " to " << most << " light paths for each camera path");
        CHECK(most < (size == 4 ? 2.1 : 3.1) * least);
    }
}

// All wavelengths of a light path go through glass that disperses, and each is seen by itself.
TEST_CASE("light paths: dispersion costs no wavelengths") {
    const auto picture = [](const std::string& index) {
        return Picture("scene 1\nfilm { size 24 16; output \"x.exr\" space=acescg }\n"
                       "render { samples 64; light-paths always; max-depth 4 }\n"
                       "camera { from 0 2 4; look-at 0 0.3 0; fov 45 deg }\n"
                       "shape quad { points -3 0 -3  -3 0 3  3 0 3  3 0 -3; material diffuse { reflectance 0.7 } }\n"
                       "shape sphere { center 0 0.7 0; radius 0.6; material dielectric { " +
                       index + " } }\nlight sphere { center 1 3 0.5; radius 3 cm; power 800 lm }\n");
    };
    const Picture plain = picture("ior 1.52"), disperses = picture("ior glass BK7");
    const auto splats = [](const Picture& p) {
        return static_cast<double>(p.statistics.splats) / static_cast<double>(p.statistics.lightPaths);
    };
    MESSAGE("splats of a light path: " << splats(plain) << ", " << splats(disperses));
    CHECK(splats(disperses) > 2 * splats(plain));
}

// Hardly anything that has been spread comes back to what the camera sees: for the mean of all pixels it would be best
// to end nine of ten of these paths. What ends them saves next to nothing, though.
TEST_CASE("light paths: going on past a rough surface is left off only as far as it saves time") {
    const LightPathFindings open = findingsOf(lightPathScene(""));
    CHECK(open.afterSpread > 0.5);
    // Within white walls paths that go on are long, and a camera that looks at the caustic sees little of what they
    // bring.
    std::string text = lightPathScene(
        "light-paths always", "shape room box { min -3 -1 -3; max 3 4 6; material diffuse { reflectance 0.97 } }\n");
    text.replace(text.find("look-at 0 0.3 0; fov 45 deg"), 27, "look-at -0.45 0 0; fov 4 deg");
    const LightPathFindings closed = findingsOf(text);
    CHECK(closed.afterSpread < 0.5);
}

// Under a ball of glass: with a light as wide as the ball the samples of a pixel, stratified over what is full of
// the light, beat paths from it.
TEST_CASE("light paths: a small light needs them, a large one does not") {
    for (const double radius : {1.0, 0.02}) {
        CAPTURE(radius);
        const TestScene scene = TestScene::parse(
            "scene 1\nfilm { size 32 32; filter box 0.5 }\n"
            "camera orthographic { from 0 0.2 0; look-at 0 0 0; up 0 0 -1; width 0.6 }\n"
            "shape sphere { center 0 1.3 0; radius 1; material dielectric { ior 1.5 } }\n"
            "shape quad { size 0.6 0.6; material diffuse { reflectance 0.5 }; transform { rotate x -90 deg } }\n"
            "light disk { center 0 5.8 0; normal 0 -1 0; radius " +
            std::to_string(radius) + "; radiance 1 }\n");
        const LightPathFindings found = findingsOf(scene);
        CHECK(found.measured);
        CHECK(found.verdict == (radius > 0.1 ? LightPathVerdict::noGain : LightPathVerdict::used));
        CHECK((radius > 0.1 ? found.gain < 1 : found.gain > 100));
        CHECK(found.rest == 0);                      // there is no other light
        CHECK((radius > 0.1) == (found.before < 5)); // what camera paths seldom find is not stratified
    }
}

} // namespace abbe::test
