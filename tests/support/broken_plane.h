// A plane of which some samples are no light.
#pragma once

#include "film/pixel_film.h"
#include "geometry/embree_scene_builder.h"
#include "geometry/flat_shapes.h"
#include "lights/sky_light.h"
#include "materials/diffuse.h"
#include "rendering/path_tracer.h"
#include "spectrum/curve.h"
#include "support/scene_test_film.h"

#include <atomic>
#include <cstring>
#include <memory>

namespace abbe::test {

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
inline GateImage renderPlane(Spectrum factor) {
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

} // namespace abbe::test
