// The image is a function of scene and seed alone: the same bits from any kernel that suffices, any number of threads,
// and any goal.
#include "base/parallel.h"
#include "support/same_bits.h"
#include "support/scene_test.h"

#include <doctest/doctest.h>

namespace abbe::test {
namespace {

// Dome, lights and shapes of every kind, one of them moving; %s is a material.
std::string sceneText(const std::string& material) {
    return R"(scene 1
film { size 37 21 }
camera { from 0.4 0.9 4; look-at 0 0.4 0; fov 40 deg; shutter 1 s { closing 0.5 } }
shape plane { material diffuse { reflectance rgb 0.7 0.4 0.2 } }
shape sphere { center 0 0.5 0; radius 0.5; material )" +
           material + R"( }
shape quad { size 2 1; material conductor { index metal Cu; roughness 0.3 }; transform { translate 0 0.5 -1 } }
light quad { points -1 2 -1  -1 2 1  1 2 1  1 2 -1; luminance 3000 nits }
light sphere { center 1.2 0.3 0.5; radius 0.1; power 300 lm; transform { at 0 s { scale 1 }
at 1 s { rotate y 30 deg } } }
light sky { luminance 100 nits }
)";
}

const Effects kAbsorption = Effect::absorption;

} // namespace

TEST_CASE("superset: a larger kernel renders the bits of a smaller one where its effects do not occur") {
    struct Case {
        const char* material;
        Effects effects; // that the scene asks for
    };
    for (const Case& c : {Case{"diffuse", {}},
                          {"dielectric { ior 1.5 }", {}},
                          {"dielectric { ior 1.5; roughness 0.3 }", {}},
                          {"conductor { index metal Au; roughness 0.2 }", {}},
                          {"dielectric { ior 1.5; absorption 3 }", kAbsorption},
                          {"dielectric { ior 1.5; roughness 0.4; absorption 3 }", kAbsorption}}) {
        INFO(std::string(c.material));
        const auto scene = TestScene::parse(sceneText(c.material));
        REQUIRE(scene.report() == "");
        CHECK((scene.scene().effects & kLoopEffects) == c.effects);
        RenderSettings settings = scene.settings();
        settings.samples = 48;
        const TestImage least = render(scene, settings, {}, 2);
        for (const Effects effects : {kAbsorption, kLoopEffects}) {
            if (!effects.contains(c.effects)) continue;
            const TestImage larger = render(scene, settings, effects, 2);
            CHECK(sameBits(least.film, larger.film));
            CHECK(sameCounts(least.statistics, larger.statistics));
        }
    }
}

TEST_CASE("the smallest kernel that holds the effects is taken") {
    const auto kernel = [](const char* material, Effects atLeast) {
        const auto scene = TestScene::parse(sceneText(material));
        return render(scene, RenderSettings{.samples = 1}, atLeast, 1).statistics.kernel;
    };
    CHECK(kernel("diffuse", {}) == "plain");
    CHECK(kernel("diffuse", kAbsorption) == "absorption");
    CHECK(kernel("diffuse", Effect::dispersion) == "absorption+dispersion");
    CHECK(kernel("dielectric { ior 1.5; absorption 3 }", {}) == "absorption");
    CHECK(kernel("dielectric { ior glass BK7 }", {}) == "absorption+dispersion");
}

TEST_CASE("one and two threads, and many, render the same bits") {
    const auto scene = TestScene::parse(sceneText("dielectric { ior glass SF11; roughness 0.2 }"));
    RenderSettings settings = scene.settings();
    settings.samples = 64;
    setThreadCount(1);
    const TestImage one = render(scene, settings, {}, 2);
    for (const int threads : {2, 7}) {
        setThreadCount(threads);
        const TestImage more = render(scene, settings, {}, 2);
        CHECK(sameBits(one.film, more.film));
        CHECK(sameCounts(one.statistics, more.statistics));
    }
    setThreadCount(0);
}

TEST_CASE("a goal changes nothing before it: longer renders begin with the bits of shorter ones") {
    const auto scene = TestScene::parse(sceneText("dielectric { ior 1.5; roughness 0.3 }"));
    // A film that remembers what it held at the end of every pass.
    for (const std::uint32_t shorter : {8u, 16u, 20u, 32u, 48u, 64u}) { // samples of each of two replicates
        RenderSettings settings = scene.settings();
        settings.samples = 2 * shorter;
        const TestImage small = render(scene, settings, {}, 2);

        // The longer render, stopped after the same pass.
        RenderSettings longer = settings;
        longer.samples = 4096;
        RecordingFilm film(scene.built().film, 2);
        std::atomic<bool> stop = false;
        struct Watch final : Film {
            Watch(RecordingFilm& target, std::atomic<bool>& flag, std::uint64_t stopAt)
                : film(target), stop(flag), last(stopAt) {}
            PixelBounds bounds() const override { return film.bounds(); }
            int replicates() const override { return film.replicates(); }
            FilterSample filter(Vec2 u) const noexcept override { return film.filter(u); }
            void add(int x, int y, int r, const ExactXyz& sum, std::uint32_t n) noexcept override {
                film.add(x, y, r, sum, n);
                if ((added += n) >= last) stop = true;
            }
            Xyz mean(int x, int y) const noexcept override { return film.mean(x, y); }
            double relativeNoise() const override { return film.relativeNoise(); }
            RecordingFilm& film;
            std::atomic<bool>& stop;
            std::uint64_t last;
            std::atomic<std::uint64_t> added{0};
        } watch(film, stop, static_cast<std::uint64_t>(film.bounds().area()) * settings.samples);
        const RenderControl control{&stop, {}};
        makePathTracer(scene.scene().effects)->render(scene.scene(), watch, longer, control);
        INFO("samples " << shorter);
        CHECK(sameBits(small.film, film));
    }
}

TEST_CASE("seeds: the same one repeats, another one does not") {
    const auto scene = TestScene::parse(sceneText("diffuse"));
    const TestImage a = render(scene, 16, 5), again = render(scene, 16, 5), other = render(scene, 16, 6);
    CHECK(sameBits(a.film, again.film));
    CHECK_FALSE(sameBits(a.film, other.film));
}

TEST_CASE("a crop has the bits of the whole image") {
    const auto whole = TestScene::parse(sceneText("diffuse"));
    std::string text = sceneText("diffuse");
    text.replace(text.find("size 37 21"), 10, "size 37 21; crop 11 5 29 17");
    const auto part = TestScene::parse(text);
    RenderSettings settings = whole.settings();
    settings.samples = 64;
    const TestImage a = render(whole, settings, {}, 2), b = render(part, settings, {}, 2);
    REQUIRE(b.film.bounds().x0 == 11);
    bool same = true;
    for (int y = 5; y < 17; ++y)
        for (int x = 11; x < 29; ++x)
            for (int r = 0; r < 2; ++r)
                same = same && a.film.replicate(x, y, r).first.y == b.film.replicate(x, y, r).first.y;
    CHECK(same);
}

TEST_CASE("samples are rounded up to whole replicates, and counted") {
    const auto scene = TestScene::parse(sceneText("diffuse"));
    RenderSettings settings = scene.settings();
    settings.samples = 13;
    const TestImage image = render(scene, settings, {}, 8);
    CHECK(image.statistics.samplesPerPixel == 16);
    CHECK(image.statistics.paths == 37 * 21 * 16);
    CHECK(image.film.pixelFilm().samples(3, 4) == 16);
    CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
    CHECK(image.statistics.rays() == image.statistics.vertices + image.statistics.shadowRays);
    CHECK_FALSE(image.statistics.stopped);
}

TEST_CASE("films of one pixel, one row and one column") {
    for (const Vec2i size : {Vec2i{1, 1}, {32768, 1}, {1, 2000}}) {
        BuildOptions options;
        options.size = size;
        const auto scene = TestScene::parse(sceneText("diffuse"), options);
        const TestImage image = render(scene, RenderSettings{.samples = 2}, {}, 2);
        CHECK(image.film.bounds().width() == size.x);
        CHECK(image.film.bounds().height() == size.y);
        CHECK(image.statistics.paths == 2 * static_cast<std::uint64_t>(size.x) * static_cast<std::uint64_t>(size.y));
        CHECK(image.statistics.dropped == std::array<std::uint64_t, 3>{});
        CHECK(image.film.image().mean > 0);
    }
}

} // namespace abbe::test
