// What is not a radiance never reaches the film: it is counted by its cause, and the image elsewhere does not change
// (docs/hard_cases.md, case 58).
#include "film/pixel_film.h"
#include "geometry/embree_scene.h"
#include "geometry/plane.h"
#include "integrators/path_tracer.h"
#include "lights/sky_light.h"
#include "materials/diffuse.h"
#include "spectrum/sampled_curve.h"
#include "support/scene_test_film.h"

#include <atomic>
#include <cstring>
#include <doctest/doctest.h>
#include <limits>

namespace abbe::test {
namespace {

// A matte surface that is broken at one point in 2048, by the bits of its position: `factor` scales what it reflects.
class BrokenMaterial final : public Material {
  public:
    explicit BrokenMaterial(Spectrum factor) : sound_(makeDiffuse({})), factor_(factor) {}

    const Bsdf* bsdf(const SurfaceHit& hit, const Wavelengths& lambda, Arena& arena) const noexcept override {
        const Bsdf* sound = sound_->bsdf(hit, lambda, arena);
        std::uint32_t x, z;
        std::memcpy(&x, &hit.p.x, 4);
        std::memcpy(&z, &hit.p.z, 4);
        if (((x * 0x9e3779b1u + z * 0x85ebca6bu) >> 21) != 0) return sound;
        ++faults_;
        return arena.make<BrokenBsdf>(*sound, factor_);
    }
    std::uint64_t faults() const { return faults_; }

  private:
    class BrokenBsdf final : public Bsdf {
      public:
        BrokenBsdf(const Bsdf& sound, Spectrum factor) : sound_(sound), factor_(factor) {}
        Lobes lobes() const noexcept override { return sound_.lobes(); }
        BsdfEval eval(Vec3 wo, Vec3 wi, Transport t) const noexcept override {
            BsdfEval e = sound_.eval(wo, wi, t);
            if (e.pdfSolidAngle > 0) e.fcos *= factor_;
            return e;
        }
        std::optional<BsdfSample> sample(Vec3 wo, float uLobe, Vec2 u, Transport t) const noexcept override {
            auto s = sound_.sample(wo, uLobe, u, t);
            if (s) s->weight *= factor_;
            return s;
        }

      private:
        const Bsdf& sound_;
        Spectrum factor_;
    };

    std::unique_ptr<const Material> sound_;
    Spectrum factor_;
    mutable std::atomic<std::uint64_t> faults_{0};
};

class DownCamera final : public Camera {
  public:
    CameraRay ray(const CameraSample& s) const noexcept override {
        return {{{s.film.x * 0.1f, 5, s.film.y * 0.1f}, {0, -1, 0}}, 1};
    }
};

struct GateImage {
    RecordingFilm film;
    RenderStatistics statistics;
    std::uint64_t faults;
};

// A plane under a sky, one scattering to a path: every fault is in exactly one sample.
GateImage renderPlane(Spectrum factor) {
    static const ConstantCurve unit(1);
    auto owned = std::make_unique<BrokenMaterial>(factor);
    const BrokenMaterial& material = *owned;
    Scene scene;
    scene.shapes.push_back(std::make_unique<Plane>(Vec3d{0, 0, 0}, Vec3d{0, 1, 0}));
    EmbreeSceneBuilder builder;
    builder.addShape(*scene.shapes.front(), {&material, nullptr});
    scene.intersector = builder.build();
    auto sky = std::make_unique<SkyLight>(ScaledCurve{&unit, 1});
    sky->commit({{-1, -1, -1}, {1, 1, 1}});
    scene.lights.push_back(std::move(sky));
    scene.camera = std::make_unique<DownCamera>();
    scene.materials.push_back(std::move(owned));
    FilmSettings film;
    film.crop = {0, 0, 24, 24};
    film.filter = FilterShape::box;
    film.filterRadius = 0.5;
    GateImage image{RecordingFilm(film, 2), {}, 0};
    const RenderSettings settings{.samples = 512, .seed = 3, .maxDepth = 1};
    image.statistics = makePathTracer({})->render(scene, image.film, settings, {});
    image.faults = material.faults();
    return image;
}

Spectrum lane5(float value) {
    Spectrum s(1.f);
    s.v[5] = value;
    return s;
}

} // namespace

TEST_CASE("film gate: faults are counted exactly, by cause, and left out") {
    constexpr float nan = std::numeric_limits<float>::quiet_NaN();
    const GateImage clean = renderPlane(Spectrum(1.f));
    CHECK(clean.faults > 80);
    CHECK(clean.statistics.dropped == std::array<std::uint64_t, 3>{});
    struct Case {
        const char* name;
        Spectrum factor;
        DropCause cause;
    };
    for (const Case& c : {Case{"NaN", Spectrum(nan), DropCause::nan},
                          {"one lane NaN", lane5(nan), DropCause::nan},
                          {"infinite", Spectrum(kInfinity), DropCause::infinite},
                          {"one lane infinite", lane5(kInfinity), DropCause::infinite},
                          {"minus infinity", Spectrum(-kInfinity), DropCause::infinite},
                          {"negative", Spectrum(-1.f), DropCause::negative},
                          {"one lane negative", lane5(-1e-3f), DropCause::negative}}) {
        INFO(std::string(c.name));
        const GateImage broken = renderPlane(c.factor);
        const auto cause = static_cast<std::size_t>(c.cause);
        CHECK(broken.faults == clean.faults);
        CHECK(broken.statistics.dropped[cause] == broken.faults);
        CHECK(broken.statistics.dropped[0] + broken.statistics.dropped[1] + broken.statistics.dropped[2] ==
              broken.faults);
        CHECK(broken.statistics.examples.size() == 4);
        for (const DroppedSample& s : broken.statistics.examples) CHECK(s.cause == c.cause);

        std::uint64_t missing = 0;
        bool sameElsewhere = true, sound = true;
        for (int y = 0; y < 24; ++y)
            for (int x = 0; x < 24; ++x)
                for (int r = 0; r < 2; ++r) {
                    const auto [sum, count] = broken.film.replicate(x, y, r);
                    const auto [cleanSum, cleanCount] = clean.film.replicate(x, y, r);
                    missing += cleanCount - count;
                    if (count == cleanCount)
                        sameElsewhere =
                            sameElsewhere && sum.x == cleanSum.x && sum.y == cleanSum.y && sum.z == cleanSum.z;
                    // ρ L = 0.5: the samples that are left have the mean that all had.
                    sound = sound && std::abs(sum.y / count - 0.5) < 0.02;
                }
        CHECK(missing == broken.faults);
        CHECK(sameElsewhere);
        CHECK(sound);
    }
}

TEST_CASE("film gate: a dropped sample can be found again") {
    const GateImage broken = renderPlane(Spectrum(-1.f));
    for (const DroppedSample& s : broken.statistics.examples) {
        CHECK(s.x >= 0);
        CHECK(s.x < 24);
        CHECK(s.y < 24);
        CHECK(s.replicate < 2);
        CHECK(s.index < 256);
        CHECK(broken.film.replicate(s.x, s.y, s.replicate).second < 256);
    }
}

} // namespace abbe::test
