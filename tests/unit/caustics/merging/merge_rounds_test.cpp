// Rounds of merging with more camera paths where their neighbours find light: less noise, the same mean, whatever part
// of the picture is rendered.
#include "caustics/merging/merge_kernel.h"
#include "caustics/shared/aim_targets.h"
#include "light_sampling/light_sampler.h"
#include "path_tracing/path_kernels.h"
#include "support/caustics_of.h"
#include "support/statistics.h"

#include <doctest/doctest.h>
#include <string>
#include <vector>

namespace abbe::test {
namespace {

constexpr PixelBounds kRoundFrame{0, 0, 32, 24};
constexpr std::uint32_t kRounds = 1024;

// The caustic of a ball of glass, mirrored in its rim and seen through it: few pixels see it, some of their paths do.
TestScene rimScene(const std::string& angle = "5 deg") {
    return TestScene::parse(
        "scene 1\nfilm { size 32 24; filter box 0.5 }\nrender { max-depth 8 }\n"
        "camera { from 0.6 3 4; look-at 0.3 0.2 0; fov " +
        angle +
        " }\n"
        "shape quad { points -3 0 3  3 0 3  3 0 -3  -3 0 -3; material diffuse { reflectance 0.6 } }\n"
        "shape sphere { center 0 0.6 0; radius 0.5; material dielectric { ior 1.5 } }\n"
        "light sphere { center -1.6 2.6 0; radius 0.05; radiance 400 }\n");
}

// Y of what one round brings to each pixel.
class RoundFilm final : public Film {
  public:
    explicit RoundFilm(PixelBounds bounds)
        : bounds_(bounds), y_(static_cast<std::size_t>(bounds.area())), shares_(y_.size()), splats_(y_.size()) {}
    PixelBounds bounds() const override { return bounds_; }
    int replicates() const override { return 1; }
    FilterSample filter(Vec2 u) const noexcept override { return {{u.x - 0.5f, u.y - 0.5f}, 1}; }
    void add(int, int, int, const ExactXyz&, std::uint32_t) noexcept override {}
    Xyz mean(int, int) const noexcept override { return {}; }
    double relativeNoise() const override { return 0; }
    bool takesMerged() const override { return true; }
    void splat(int x, int y, int, const Splat& splat) noexcept override {
        y_[at(x, y)] += splat.value.y;
        shares_[at(x, y)] += splat.factor;
        ++splats_[at(x, y)];
    }

    double of(int x, int y) const { return y_[at(x, y)]; }
    // Of the camera paths of a pixel, those that found light; and how many that were.
    double share(int x, int y) const { return shares_[at(x, y)]; }
    int lit(int x, int y) const { return splats_[at(x, y)]; }

  private:
    std::size_t at(int x, int y) const {
        return static_cast<std::size_t>((y - bounds_.y0) * bounds_.width() + x - bounds_.x0);
    }
    PixelBounds bounds_;
    std::vector<double> y_, shares_;
    std::vector<int> splats_;
};

class Rounds {
  public:
    // `bright`: as in MergePlan.
    Rounds(const TestScene& test, std::uint32_t more, float bright, std::uint32_t photons = 4096)
        : lights_(test.scene().lights, test.settings().technique.lightChoice),
          plan_(planOf(test.scene(), more, bright, photons)), context_{test.scene(), lights_, test.settings()} {
        context_.merging = &plan_;
    }

    RoundFilm of(std::uint32_t number, PixelBounds bounds = kRoundFrame) const {
        RoundFilm film(bounds);
        kernelFor(kLoopEffects).lightPaths.merge(context_, film, {number, number + 1}, nullptr);
        return film;
    }

  private:
    static MergePlan planOf(const Scene& scene, std::uint32_t more, float bright, std::uint32_t photons) {
        const Bounds3 bounds = scene.intersector->bounds();
        EmissionPlan aimed;
        aimed.targets = aimTargets(scene.focusing, bounds, boxesOfBalls(scene.surfaces)).balls;
        MergePlan plan{
            AimedEmission(scene.lights, bounds, aimed), {}, photons, 1, 1e-5f * bounds.radius(), more, bright};
        for (const auto& light : scene.lights) plan.lights.insert(light.get());
        return plan;
    }

    LightSampler lights_;
    MergePlan plan_;
    PathContext context_;
};

} // namespace

TEST_CASE("merging: how bright the pixels near one are, without itself") {
    BrightnessAround around;
    around.start({10, 20, 30, 30});
    around.add(15, 25, 2);
    CHECK(around.of(15, 25) == 0);
    CHECK(around.of(16, 25) == 2);
    CHECK(around.of(18, 28) == 2);
    CHECK(around.of(19, 25) == 0);
    around.add(17, 24, 1);
    CHECK(around.of(15, 25) == 1);
    CHECK(around.of(17, 24) == 2);
    around.add(10, 20, 3); // a corner
    CHECK(around.of(10, 20) == 0);
    CHECK(around.of(13, 23) == 3);
}

TEST_CASE("merging: more camera paths where pixels near are bright, in proportion") {
    const TestScene test = rimScene();
    const Scene& scene = test.scene();
    const MergePlan plan{AimedEmission(scene.lights, scene.intersector->bounds(), {}), {}, 1, 1, 1, 16, 2};
    CHECK(plan.moreBeside(0) == 0);
    CHECK(plan.moreBeside(0.19f) == 0);
    CHECK(plan.moreBeside(0.26f) == 3);
    CHECK(plan.moreBeside(1) == 8);
    CHECK(plan.moreBeside(2) == 16);
    CHECK(plan.moreBeside(200) == 16);
}

// Both have the same photons and the same first paths, so that their difference is known better than either.
TEST_CASE("merging: more camera paths of a round leave the mean and take the noise") {
    const TestScene test = rimScene("12 deg"); // pixels whose neighbours see nothing, too
    const Rounds plain(test, 0, 0, 1024), more(test, 15, 1, 1024);
    Moments whole, difference;
    std::vector<Moments> pixels[2];
    for (auto& of : pixels) of.resize(static_cast<std::size_t>(kRoundFrame.area()));
    for (std::uint32_t i = 0; i < kRounds; ++i) {
        const RoundFilm a = plain.of(i), b = more.of(i);
        double sums[2] = {};
        for (int y = 0, at = 0; y < kRoundFrame.height(); ++y)
            for (int x = 0; x < kRoundFrame.width(); ++x, ++at) {
                sums[0] += a.of(x, y);
                sums[1] += b.of(x, y);
                pixels[0][static_cast<std::size_t>(at)].add(a.of(x, y));
                pixels[1][static_cast<std::size_t>(at)].add(b.of(x, y));
            }
        whole.add(sums[0]);
        difference.add(sums[1] - sums[0]);
    }
    const double error = std::sqrt(difference.variance() / kRounds);
    CAPTURE(whole.mean());
    CAPTURE(difference.mean());
    CAPTURE(error);
    CHECK(error < 0.03 * whole.mean());
    CHECK(std::abs(difference.mean()) < 4 * error);
    double noise[2] = {};
    for (int k = 0; k < 2; ++k)
        for (const Moments& m : pixels[k]) noise[k] += m.variance();
    CAPTURE(noise[0]);
    CAPTURE(noise[1]);
    CHECK(noise[1] < 0.6 * noise[0]);
}

TEST_CASE("merging: camera paths of a round count alike, and as one") {
    // A floor in a mirror, lit evenly by a light in a ball of glass.
    const TestScene test = TestScene::parse(
        "scene 1\nfilm { size 32 24; filter box 0.5 }\nrender { max-depth 8 }\n"
        "camera { from 0 3 1; look-at 0 0.5 -2.5; fov 12 deg }\n"
        "shape quad { points -3 0 3  3 0 3  3 0 -3  -3 0 -3; material diffuse { reflectance 0.5 } }\n"
        "shape quad { points -3 0 -2.5  3 0 -2.5  3 3 -2.5  -3 3 -2.5; material conductor { index metal Ag } }\n"
        "shape sphere { center 0 0.9 0; radius 0.4; material dielectric { ior 1.5 } }\n"
        "light sphere { center 0 0.9 0; radius 0.3; radiance 10 }\n");
    const Rounds more(test, 15, 1e-6f, 65536);
    double most = 0;
    int all = 0; // pixels all of whose paths have found light
    for (std::uint32_t i = 0; i < 4; ++i) {
        const RoundFilm film = more.of(i);
        for (int y = 0; y < kRoundFrame.height(); ++y)
            for (int x = 0; x < kRoundFrame.width(); ++x) {
                most = std::max(most, film.share(x, y));
                all += film.lit(x, y) == 16 && film.share(x, y) == doctest::Approx(1);
            }
    }
    CHECK(most == doctest::Approx(1));
    CHECK(all > 10);
}

TEST_CASE("merging: more camera paths, and a crop has the bits of the whole") {
    const TestScene test = rimScene();
    const Rounds more(test, 15, 1);
    const PixelBounds crop{3, 5, 17, 15};
    int lit = 0, different = 0;
    for (std::uint32_t i = 0; i < 8; ++i) {
        const RoundFilm whole = more.of(i), part = more.of(i, crop);
        for (int y = crop.y0; y < crop.y1; ++y)
            for (int x = crop.x0; x < crop.x1; ++x) {
                lit += whole.of(x, y) > 0;
                different += whole.of(x, y) != part.of(x, y);
            }
    }
    CHECK(lit > 100);
    CHECK(different == 0);
}

TEST_CASE("merging: a caustic that a rim mirrors gets more camera paths") {
    const TestScene test = rimScene("30 deg");
    RenderSettings settings = test.settings();
    for (const int pilot : {1, 2}) {
        settings.pilot = pilot;
        settings.technique.merging = Technique::Merging::always;
        const MergeFindings found = causticsOf(test, settings).of<MergeFindings>();
        CAPTURE(pilot);
        CHECK(found.used);
        CHECK(found.more >= 4);
    }
}

} // namespace abbe::test
